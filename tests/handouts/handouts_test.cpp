// Handouts are true: what they cite exists, what cites them is answered, and the points they print
// are the rubric's.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/math.h"
#include "framework/grading/verdicts/rubric.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::source_dir();
const fs::path kPrivate = kRoot / "solutions_private";  // absent from what students get

std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// First group of each match.
std::set<std::string> all(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
    found.insert((*it)[1]);
  return found;
}

struct Assignment {
  std::string id;      // "a1"
  std::string folder;  // "a1_impulse"
  std::string header, handout;
  fs::path handout_file() const { return kRoot / "handouts" / (folder + ".md"); }
};

std::vector<Assignment> assignments() {
  std::vector<Assignment> found;
  for (const auto& entry : fs::directory_iterator(kRoot / "assignments")) {
    const std::string folder = entry.path().filename();
    if (!fs::exists(entry.path() / "rubric.json")) continue;
    Assignment assignment{folder.substr(0, folder.find('_')), folder,
                          contents_of(entry.path() / (folder + ".h")), ""};
    assignment.handout = contents_of(assignment.handout_file());
    found.push_back(assignment);
  }
  std::sort(found.begin(), found.end(),
            [](const Assignment& a, const Assignment& b) { return a.id < b.id; });
  return found;
}

std::set<std::string> anchors_of(const std::string& handout) {
  return all(handout, "<a id=\"([a-z0-9-]+)\"");
}

std::string sources_below(const std::vector<std::string>& folders) {
  std::string text;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder))
      if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
        text += contents_of(entry.path()) + "\n";
  return text;
}

TEST(Handouts, NumberTheEquationsOfTheHeader) {
  // in all headers: an assignment may do without numbered equations, the course does not
  std::size_t found = 0;
  for (const Assignment& a : assignments()) {
    const std::string A = "A" + a.id.substr(1);
    // In a header an equation's number stands at the end of its line; in a handout it opens the
    // paragraph, below its anchor.
    const std::set<std::string> in_header = all(a.header, " \\(" + A + "\\.(\\d+)[a-z]?\\)\\n");
    const std::set<std::string> in_handout = all(a.handout, "\\n\\*\\*\\(" + A + "\\.(\\d+)\\)");
    const std::set<std::string> anchored =
        all(a.handout, "<a id=\"eq-" + a.id + "-(\\d+)\"></a>\\n\\*\\*\\(" + A + "\\.\\d+\\)");
    found += in_header.size();
    EXPECT_EQ(in_header, in_handout) << a.folder;
    EXPECT_EQ(in_handout, anchored) << a.folder;
  }
  EXPECT_GT(found, 20u) << "the equations of the headers were not found";
}

TEST(Handouts, HaveTheAnchorsThatSourcesPointTo) {
  const std::string sources = sources_below({"assignments", "framework", "tests"}) +
                              (fs::exists(kPrivate) ? sources_below({"solutions_private"}) : "");
  for (const Assignment& a : assignments()) {
    const std::set<std::string> anchors = anchors_of(a.handout);
    // Anchors put together at run time end in a dash here; the equations' test covers them.
    const std::set<std::string> cited =
        all(sources, "handouts/" + a.folder + "\\.md#([a-z0-9-]*[a-z0-9])(?![a-z0-9-])");
    EXPECT_FALSE(cited.empty()) << a.folder << ": no citations were found";
    for (const std::string& anchor : cited)
      EXPECT_TRUE(anchors.contains(anchor)) << a.handout_file().filename() << " has no #" << anchor;
  }
}

/// Every page of the folder by its file's name: the assignments' handouts and the notation.
std::map<std::string, std::string> pages() {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::directory_iterator(kRoot / "handouts"))
    if (entry.path().extension() == ".md")
      found[entry.path().filename()] = contents_of(entry.path());
  return found;
}

TEST(Handouts, LinkToWhatExists) {
  const std::map<std::string, std::string> found = pages();
  for (const auto& [name, page] : found)
    for (const std::string& link : all(page, "\\]\\(([^)\\s]+)\\)")) {
      if (link.starts_with("http")) continue;
      const std::size_t hash = link.find('#');
      const std::string file = link.substr(0, hash),
                        anchor = hash == link.npos ? "" : link.substr(hash + 1);
      const auto to = found.find(file.empty() ? name : file);
      if (to == found.end())
        EXPECT_TRUE(fs::exists(kRoot / "handouts" / file)) << name << ": " << link;
      else
        EXPECT_TRUE(anchor.empty() || anchors_of(to->second).contains(anchor))
            << name << ": " << link;
    }
}

TEST(Handouts, AndNotationLinkEachOther) {
  const std::string notation = pages().at("notation.md");
  for (const Assignment& a : assignments()) {
    EXPECT_NE(a.handout.find("](notation.md"), std::string::npos) << a.handout_file();
    EXPECT_NE(notation.find("](" + a.folder + ".md#eq-"), std::string::npos) << a.folder;
  }
}

/// Whether `word` stands in the text as a whole; a suffix such as _world may end a longer name.
bool has_word(const std::string& text, const std::string& word) {
  const auto in_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool begins = word[0] == '_' || at == 0 || !in_name(text[at - 1]);
    if (begins && (end == text.size() || !in_name(text[end]))) return true;
  }
  return false;
}

// A student looks a term up in the notation to find its place in the code.
TEST(Handouts, NotationNamesWhatTheCodeHas) {
  const std::string code = sources_below({"assignments", "framework"});
  const std::set<std::string> names = all(pages().at("notation.md"), "`([^`]+)`");
  EXPECT_GT(names.size(), 100u) << "the names of the notation were not found";
  for (const std::string& name : names) {
    if (name.find('/') != name.npos) {
      EXPECT_TRUE(fs::exists(kRoot / "framework" / name))
          << "handouts/notation.md names framework/" << name;
      continue;
    }
    const std::size_t scope = name.find("::");
    const std::string owner = scope == name.npos ? name : name.substr(0, scope),
                      member = scope == name.npos ? name : name.substr(scope + 2);
    EXPECT_TRUE(has_word(code, owner) && has_word(code, member))
        << name
        << " is in handouts/notation.md and nowhere in the code: change its row, or drop it";
  }
}

TEST(Handouts, NameTestsAndScenesThatExist) {
  for (const Assignment& a : assignments()) {
    const std::string tests = sources_below({"tests/" + a.folder, "tests/handouts"});
    const auto exists = [&tests](const std::string& suite, const std::string& name) {
      return std::regex_search(tests, std::regex("TEST(_F)?\\(" + suite + ", " + name + "\\)"));
    };
    for (const std::string& test : all(a.handout, "`([A-Z]\\w+\\.[A-Z]\\w+)`"))
      EXPECT_TRUE(exists(test.substr(0, test.find('.')), test.substr(test.find('.') + 1)))
          << a.handout_file() << " names " << test;
    for (const std::string& suite : all(a.header, "(\\w+)\\.\\*"))
      EXPECT_TRUE(exists(suite, "\\w+")) << a.folder << ".h names " << suite << ".*";
    for (const std::string& scene_name :
         all(a.handout, "\\./tumble (?:run|poke) ([a-z0-9_/]+(?:\\.3ds)?)")) {
      bool found = scene::sized_scene_named(scene_name) != nullptr ||
                   (scene_name.ends_with(".3ds") &&
                    (fs::exists(kRoot / scene_name) || fs::exists(kRoot / "models" / scene_name)));
      for (const Assignment& other : assignments())
        found = found || fs::exists(kRoot / "assignments" / other.folder / "scenes" /
                                    (scene_name + ".json"));
      EXPECT_TRUE(found) << a.handout_file() << " runs the scene " << scene_name;
    }
  }
}

// handouts/a2_integration.md#euler-example: of the lecture's two triples only the x axes agree, 90
// degrees apart about them; in the order of (A2.8) the y axes.
TEST(Handouts, EulerAnglesOfTheLectureShareOneAxis) {
  constexpr double kDegree = std::numbers::pi / 180.0, kRounding = 1e-15;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const auto product = [&](const Vector3d& first, const Vector3d& second, const Vector3d& third,
                           double a, double b, double c) -> Matrix3d {
    using Turn = Eigen::AngleAxisd;
    return (Turn(c * kDegree, third) * Turn(b * kDegree, second) * Turn(a * kDegree, first))
        .toRotationMatrix();
  };
  const auto same_axes = [&](const Matrix3d& one, const Matrix3d& other) {
    std::string same;
    for (int i = 0; i < 3; ++i)
      if ((one.col(i) - other.col(i)).norm() < 4 * kRounding) same += "xyz"[i];
    return same;
  };
  const Matrix3d one = product(z, x, y, 90, 45, 45), other = product(z, x, y, 45, 0, -45);
  EXPECT_EQ(same_axes(one, other), "x");
  EXPECT_LT((one.col(0) - Vector3d(0.5, std::sqrt(0.5), 0.5)).norm(), 4 * kRounding);
  EXPECT_NEAR(Eigen::AngleAxisd(Matrix3d(one.transpose() * other)).angle(), 90 * kDegree, 1e-14);
  EXPECT_EQ(same_axes(product(x, y, z, 90, 45, 45), product(x, y, z, 45, 0, -45)), "y");
}

// handouts/a2_integration.md, the second slip of the lecture's slide: k4 at y3, where k3 was taken.
TEST(Handouts, TheLastSlopeAtTheThirdPointCostsThreeOrders) {
  const auto slope = [](double y) { return 6.0 * y - 0.007 * y * y; };
  const auto reached = [&](int steps) {
    const double h = 0.5 / steps;
    double y = 10.0;
    for (int i = 0; i < steps; ++i) {
      const double k1 = slope(y), k2 = slope(y + 0.5 * h * k1), y3 = y + 0.5 * h * k2,
                   k3 = slope(y3), k4 = slope(y3);
      y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return y;
  };
  EXPECT_NEAR(reached(1), 104.6, 0.05);  // as printed
  const double exact = 6.0 / 0.007 / (1.0 + (6.0 / 0.07 - 1.0) * std::exp(-3.0));
  // the observed order at steps of 1/512
  EXPECT_NEAR(std::log2((reached(128) - exact) / (reached(256) - exact)), 1.0, 0.02);
}

double points_of(const grading::Rubric& rubric, const std::string& level) {
  double sum = 0;
  for (const grading::RubricItem& item : rubric.items) sum += item.level == level ? item.points : 0;
  return sum;
}

TEST(Handouts, PrintThePointsOfTheRubric) {
  for (const Assignment& a : assignments()) {
    const std::string table = a.handout.substr(
        std::min(a.handout.size(), a.handout.find("<!-- points: " + a.id + " -->")));
    const grading::Rubric open =
        grading::read_rubric(kRoot / "assignments" / a.folder / "rubric.json");
    for (const std::string level : {"basic", "intermediate", "advanced"}) {
      std::smatch row;
      ASSERT_TRUE(std::regex_search(
          table, row, std::regex("\\| " + level + " \\|[^|]*\\| (\\d+) \\| (\\d+) \\| (\\d+) \\|")))
          << a.id << " " << level;
      EXPECT_EQ(std::stod(row[1]), points_of(open, level))
          << a.handout_file() << ", " << level << ", public";
      EXPECT_EQ(std::stod(row[1]) + std::stod(row[2]), std::stod(row[3]))
          << a.handout_file() << ", " << level;
      if (!fs::exists(kPrivate)) continue;
      const grading::Rubric hidden =
          grading::read_rubric(kPrivate / a.folder / "rubric_hidden.json", true);
      EXPECT_EQ(std::stod(row[2]), points_of(hidden, level))
          << a.handout_file() << ", " << level << ", hidden";
    }
  }
}

}  // namespace
}  // namespace tumble::testing
