#include "framework/extend/check_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/grading/verdicts/rubric.h"

namespace tumble::extend {
namespace {

namespace fs = std::filesystem;

using grading::Rubric;
using grading::RubricItem;

int line_at(const std::string& text, std::size_t at) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

std::string place_of(const fs::path& file, int line) {
  return file.string() + ":" + std::to_string(line);
}

// Where the text stands first, or the file's first line.
std::string place_of(const fs::path& root, const fs::path& file, const std::string& words) {
  const std::string text = text_of(root / file);
  const std::size_t at = text.find(words);
  return place_of(file, at == std::string::npos ? 1 : line_at(text, at));
}

std::vector<fs::path> sources_in(const fs::path& root, const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(root / folder, ignored))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
      files.push_back(entry.path().lexically_relative(root));
  std::sort(files.begin(), files.end());
  return files;
}

fs::path public_tests(const std::string& folder) { return fs::path("tests") / folder; }
fs::path hidden_tests(const std::string& folder) {
  return fs::path("solutions_private") / folder / "tests";
}

std::string number(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

double points_of(const Rubric& rubric, const std::string& level) {
  double sum = 0.0;
  for (const RubricItem& item : rubric.items)
    if (item.level == level) sum += item.points;
  return sum;
}

std::string id_of(const std::string& folder) { return folder.substr(0, folder.find('_')); }
std::string head_of_table(const std::string& folder) {
  return "<!-- points: " + id_of(folder) + " -->";
}

// A row of the handout's table: "| basic | what | 30 | 10 | 40 |".
struct Row {
  std::string level;  // empty: there is no table
  std::size_t at;     // of its last three columns in the text; npos: there is no such row
  std::string found, right;
};

std::vector<Row> rows_of_handout(const fs::path& file, const std::string& folder,
                                 const Rubric& open, const Rubric& hidden) {
  const std::string text = text_of(file);
  const std::size_t table = text.find(head_of_table(folder));
  if (table == std::string::npos) return {{"", std::string::npos, "", ""}};
  static const std::regex numbers(R"(\| ?[^|]* \| ?[^|]* \| ?[^|]* \|$)");
  std::vector<Row> rows;
  for (const char* level : {"basic", "intermediate", "advanced"}) {
    const double shown = points_of(open, level), kept = points_of(hidden, level);
    Row row{level, std::string::npos, "",
            "| " + number(shown) + " | " + number(kept) + " | " + number(shown + kept) + " |"};
    const std::size_t begin = text.find(std::string("\n| ") + level + " |", table);
    if (begin != std::string::npos) {
      const std::size_t end = std::min(text.find('\n', begin + 1), text.size());
      const std::string line = text.substr(begin + 1, end - begin - 1);
      if (std::smatch match; std::regex_search(line, match, numbers)) {
        row.at = begin + 1 + static_cast<std::size_t>(match.position());
        row.found = match.str();
      }
    }
    // a level without points may go without a row
    if (row.at != std::string::npos || shown + kept > 0.0) rows.push_back(row);
  }
  return rows;
}

class Check {
 public:
  Check(const fs::path& root, const std::string& folder) : root_(root), folder_(folder) {
    open_file_ = fs::path("assignments") / folder / "rubric.json";
    hidden_file_ = fs::path("solutions_private") / folder / "rubric_hidden.json";
  }

  std::vector<std::string> run() {
    open_ = grading::read_rubric(root_ / open_file_);
    hidden_ = grading::read_rubric(root_ / hidden_file_, true);
    tests_ = tests_of_sources(root_, folder_);
    check_tests();
    check_items(open_, open_file_, false);
    check_items(hidden_, hidden_file_, true);
    check_sum();
    check_functions();
    check_handout();
    check_own_tests();
    return std::move(faults_);
  }

 private:
  void say(const std::string& place, const std::string& problem) {
    faults_.push_back(place + ": " + problem);
  }

  void check_tests() {
    for (const TestPlace& test : tests_) {
      const bool in_open = open_.find(test.name) != nullptr,
                 in_hidden = hidden_.find(test.name) != nullptr;
      const std::string own = (test.hidden ? hidden_file_ : open_file_).string();
      if (!in_open && !in_hidden)
        say(test.place, test.name + " is worth no points. Give it an entry in " + own +
                            " (of 0 points if it should earn none).");
      else if (test.hidden ? !in_hidden : !in_open)
        say(test.place,
            test.name + " has its points in the other rubric. Move its entry to " + own + ".");
    }
  }

  void check_items(const Rubric& rubric, const fs::path& file, bool hidden) {
    std::vector<std::string> names;
    for (const TestPlace& test : tests_) names.push_back(test.name);
    for (const RubricItem& item : rubric.items) {
      const std::string place = place_of(root_, file, '"' + item.test + '"');
      if (std::find(names.begin(), names.end(), item.test) == names.end())
        say(place,
            "names " + item.test + ", and no test is called so." + did_you_mean(item.test, names));
      if (hidden && open_.find(item.test) != nullptr)
        say(place, item.test + " is in " + open_file_.string() + " too. Take out one of the two.");
    }
  }

  void check_sum() {
    constexpr double kFull = 100.0, kSlack = 1e-9;  // points: round-off of the sum
    const double sum = open_.total() + hidden_.total();
    if (std::abs(sum - kFull) > kSlack)
      say(place_of(open_file_, 1),
          "the points sum to " + number(sum) + ": " + number(open_.total()) + " here and " +
              number(hidden_.total()) + " in " + hidden_file_.string() + ". They must sum to 100.");
  }

  void check_functions() {
    std::string tests;
    for (const fs::path& room : {public_tests(folder_), hidden_tests(folder_)})
      for (const fs::path& file : sources_in(root_, room)) tests += text_of(root_ / file) + "\n";
    const fs::path header = fs::path("assignments") / folder_ / (folder_ + ".h");
    for (const std::string& function : functions_of_header(root_, folder_))
      if (!std::regex_search(tests, std::regex("(\\.|::|->)" + function + "\\b")))
        say(place_of(root_, header, " " + function + "("), "no test calls " + function +
                                                               ". Write one: ./tumble new test " +
                                                               id_of(folder_) + " Suite.Name");
  }

  void check_handout() {
    const fs::path file = fs::path("handouts") / (folder_ + ".md");
    for (const Row& row : rows_of_handout(root_ / file, folder_, open_, hidden_))
      if (row.at == std::string::npos)
        say(row.level.empty() ? place_of(file, 1) : place_of(root_, file, head_of_table(folder_)),
            row.level.empty()
                ? "has no table of points. It begins with a line  " + head_of_table(folder_)
                : "the table has no row of level " + row.level + ". It ends with  " + row.right);
      else if (row.found != row.right)
        say(place_of(file, line_at(text_of(root_ / file), row.at)),
            "the row of level " + row.level + " is not the rubrics'. It ends with  " + row.right +
                "  (./tumble new points " + id_of(folder_) + " writes it)");
  }

  // Points of the rule stand in the public rubric, the slips to catch in the hidden one.
  void check_own_tests() {
    const bool has_points = open_.own_tests && open_.own_tests->points > 0.0;
    const std::vector<std::string> slips =
        hidden_.own_tests ? hidden_.own_tests->slips : std::vector<std::string>();
    const auto rule_in = [&](const fs::path& file) {
      return place_of(root_, file, "\"own_tests\"");
    };
    if (has_points && slips.empty())
      say(rule_in(open_file_),
          "gives points for students' own tests, and no slip is there to catch. Name some:  "
          "\"own_tests\": {\"slips\": [...]}  in " +
              hidden_file_.string());
    if (!slips.empty() && !has_points)
      say(rule_in(hidden_file_),
          "names slips for students' own tests, and there are no points for them. Give some:  "
          "\"own_tests\": {\"points\": 5, \"share\": 0.75}  in " +
              open_file_.string());
    const fs::path folder = fs::path("solutions_private") / folder_ / "mutants";
    std::vector<std::string> known;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(root_ / folder, ignored))
      if (entry.path().extension() == ".slip" || entry.path().extension() == ".cpp")
        known.push_back(entry.path().stem().string());
    std::sort(known.begin(), known.end());
    std::set<std::string> seen;
    for (const std::string& slip : slips) {
      const std::string place = place_of(root_, hidden_file_, '"' + slip + '"');
      if (!seen.insert(slip).second)
        say(place, "names the slip " + slip + " twice. Take out one of the two.");
      else if (!std::binary_search(known.begin(), known.end(), slip))
        say(place, "names the slip " + slip + ", and " + folder.string() +
                       " has none of that name." + did_you_mean(slip, known));
    }
  }

  const fs::path& root_;
  const std::string& folder_;
  fs::path open_file_, hidden_file_;
  Rubric open_, hidden_;
  std::vector<TestPlace> tests_;
  std::vector<std::string> faults_;
};

}  // namespace

std::vector<TestPlace> tests_of_sources(const fs::path& root, const std::string& folder) {
  static const std::regex test(R"((^|\n)TEST(?:_F)?\(\s*(\w+)\s*,\s*(\w+)\s*\))");
  std::vector<TestPlace> places;
  for (const bool hidden : {false, true})
    for (const fs::path& file :
         sources_in(root, hidden ? hidden_tests(folder) : public_tests(folder))) {
      // Found are the files that are built: fixtures and tests.
      const std::string name = file.stem().string(), text = text_of(root / file);
      if (!name.ends_with("_test") && !name.ends_with("_fixtures")) continue;
      for (std::sregex_iterator it(text.begin(), text.end(), test), end; it != end; ++it)
        places.push_back({(*it)[2].str() + "." + (*it)[3].str(),
                          place_of(file, line_at(text, static_cast<std::size_t>(it->position(2)))),
                          hidden});
    }
  return places;
}

std::vector<std::string> functions_of_header(const fs::path& root, const std::string& folder) {
  const fs::path file = fs::path("assignments") / folder / (folder + ".h");
  const std::string text = text_of(root / file);
  static const std::regex listed(R"(\nTUMBLE_MODULE\(([^)]*)\))"), word("\\w+");
  std::smatch match;
  if (!std::regex_search(text, match, listed))
    throw UserError(file.string(), "does not end with TUMBLE_MODULE(id, functions...)",
                    "framework/modules/README.md says what a module is.");
  const std::string inside = match[1];
  std::vector<std::string> names;
  for (std::sregex_iterator it(inside.begin(), inside.end(), word), end; it != end; ++it)
    names.push_back(it->str());
  if (!names.empty()) names.erase(names.begin());  // the id
  return names;
}

std::vector<std::string> check_points(const fs::path& root, const std::string& folder) {
  try {
    return Check(root, folder).run();
  } catch (const UserError& error) {
    std::string where = error.where();
    if (where.starts_with(root.string() + "/")) where.erase(0, root.string().size() + 1);
    return {where + ": " + error.problem() + " " + error.remedy()};
  }
}

std::string with_points_of_rubrics(const fs::path& root, const std::string& folder) {
  const fs::path file = root / "handouts" / (folder + ".md");
  std::string text = text_of(file);
  std::vector<Row> rows = rows_of_handout(
      file, folder, grading::read_rubric(root / "assignments" / folder / "rubric.json"),
      grading::read_rubric(root / "solutions_private" / folder / "rubric_hidden.json", true));
  // from the end, so that places before stay
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.at > b.at; });
  for (const Row& row : rows) {
    if (row.at == std::string::npos)
      throw UserError(
          file.string(),
          row.level.empty() ? "has no table of points" : "has no row of level " + row.level,
          "It is written as in handouts/a1_impulse.md, below a line " + head_of_table(folder));
    text.replace(row.at, row.found.size(), row.right);
  }
  return text;
}

}  // namespace tumble::extend
