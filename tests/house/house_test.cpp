// The house rules of the design, read off the sources: knowledge runs one way and never in a
// circle, third parties stay in their rooms, and the framework names no assignment and no solution.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::source_dir();

// Top to bottom: a folder includes only what stands above it (or itself).
const std::vector<std::string> kFolders = {
    "core",    "geometry", "scene",   "dynamics", "collision", "trajectory", "effects",
    "modules", "engines",  "truths",  "cost",     "sampling",  "render",     "report",
    "live",    "farm",     "grading", "extend",   "cli"};

// Rooms of two folders, in the same order. A file that lies beside the rooms is their entry: it may
// include all of them.
const std::map<std::string, std::vector<std::string>> kRooms = {
    {"engines", {"base", "stepping", "contact", "judging", "rd", "events", "timewarp"}},
    {"grading",
     {"verdicts", "test_program", "sandbox", "compiler", "worker", "own_tests", "course", "handins",
      "grades", "platforms", "attacks"}}};

int rank_of(const std::string& folder) {
  const auto it = std::find(kFolders.begin(), kFolders.end(), folder);
  return it == kFolders.end() ? -1 : static_cast<int>(it - kFolders.begin());
}

struct Include {
  std::string file;    // relative to the root
  std::string folder;  // framework folder of the file
  int line;
  std::string target;  // as written between the brackets or quotes
};

std::vector<fs::path> sources_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".h" || extension == ".cpp"))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Include> framework_includes() {
  static const std::regex include_line(R"(^\s*#\s*include\s*["<]([^">]+)[">])");
  std::vector<Include> includes;
  for (const fs::path& path : sources_below(kRoot / "framework")) {
    const fs::path relative = path.lexically_relative(kRoot);
    std::ifstream in(path);
    std::string text;
    for (int line = 1; std::getline(in, text); ++line) {
      std::smatch match;
      if (std::regex_search(text, match, include_line))
        includes.push_back(
            {relative.string(), std::next(relative.begin())->string(), line, match[1]});
    }
  }
  return includes;
}

TEST(House, KnowledgeRunsDownTheTable) {
  for (const Include& include : framework_includes()) {
    if (!include.target.starts_with("framework/")) continue;
    const std::string target = std::next(fs::path(include.target).begin())->string();
    const int from = rank_of(include.folder), to = rank_of(target);
    EXPECT_TRUE(to >= 0 && to <= from)
        << include.file << ':' << include.line << ": " << include.folder << " includes "
        << include.target << ", which stands below it in the design's table";
  }
}

// framework/engines/contact/sleeping.h -> contact; framework/engines/run.h -> nothing.
std::string room_of(const std::string& file) {
  const fs::path path(file);
  return std::distance(path.begin(), path.end()) == 4 ? std::next(path.begin(), 2)->string() : "";
}

TEST(House, RoomsIncludeOnlyWhatStandsAboveThem) {
  for (const Include& include : framework_includes()) {
    const std::string prefix = "framework/" + include.folder + "/";
    if (!kRooms.contains(include.folder) || !include.target.starts_with(prefix)) continue;
    const std::vector<std::string>& rooms = kRooms.at(include.folder);
    const std::string from = room_of(include.file), to = room_of(include.target);
    if (from.empty()) continue;
    if (to.empty()) {
      ADD_FAILURE() << include.file << ':' << include.line << ": a room includes the entry "
                    << include.target;
      continue;
    }
    const auto from_at = std::find(rooms.begin(), rooms.end(), from),
               to_at = std::find(rooms.begin(), rooms.end(), to);
    EXPECT_TRUE(from_at != rooms.end() && to_at <= from_at)
        << include.file << ':' << include.line << ": " << from << " includes " << include.target
        << ", which stands below it";
  }
}

/// The nodes of a graph that lie on a circle: those that reach themselves.
std::vector<std::string> on_a_circle(const std::map<std::string, std::set<std::string>>& edges) {
  std::vector<std::string> found;
  for (const auto& [start, ignored] : edges) {
    std::set<std::string> reached;
    std::vector<std::string> open = {start};
    while (!open.empty()) {
      const std::string node = open.back();
      open.pop_back();
      const auto out = edges.find(node);
      if (out == edges.end()) continue;
      for (const std::string& next : out->second)
        if (reached.insert(next).second) open.push_back(next);
    }
    if (reached.contains(start)) found.push_back(start);
  }
  return found;
}

std::string unit_of(const std::string& file) { return fs::path(file).replace_extension().string(); }
std::string folder_of(const std::string& file) { return fs::path(file).parent_path().string(); }
std::string file_of(const std::string& file) { return file; }

// Each thing by itself: a header with its source is a unit.
void expect_no_circle(const std::string& what, std::string (*part_of)(const std::string&)) {
  std::map<std::string, std::set<std::string>> edges;
  for (const Include& include : framework_includes())
    if (include.target.starts_with("framework/") &&
        part_of(include.file) != part_of(include.target))
      edges[part_of(include.file)].insert(part_of(include.target));
  for (const std::string& part : on_a_circle(edges))
    ADD_FAILURE() << part << ": includes of " << what << " lead back to it";
}

TEST(House, IncludesOfFilesMakeNoCircle) { expect_no_circle("files", file_of); }
TEST(House, IncludesOfUnitsMakeNoCircle) {
  expect_no_circle("headers with their sources", unit_of);
}
TEST(House, IncludesOfFoldersMakeNoCircle) { expect_no_circle("folders", folder_of); }

// A forward declaration of what another folder defines is knowledge that no include shows: it may
// not look down the table either.
TEST(House, ForwardDeclarationsLookUpTheTable) {
  static const std::regex declaration(R"(^\s*(?:class|struct)\s+(\w+)\s*;)"),
      definition(R"(^\s*(?:class|struct)\s+(\w+)\s*(?:final\s*)?(?::[^:]|\{|$))");
  std::map<std::string, std::set<std::string>> defined_in;  // name -> files
  struct Declared {
    std::string name, file;
    int line;
  };
  std::vector<Declared> declared;
  for (const fs::path& path : sources_below(kRoot / "framework")) {
    if (path.extension() != ".h") continue;
    const std::string file = path.lexically_relative(kRoot).string();
    std::ifstream in(path);
    std::string text;
    std::smatch match;
    for (int line = 1; std::getline(in, text); ++line) {
      if (std::regex_search(text, match, declaration))
        declared.push_back({match[1], file, line});
      else if (std::regex_search(text, match, definition))
        defined_in[match[1]].insert(file);
    }
  }
  const auto folder_rank = [](const std::string& file) {
    return rank_of(std::next(fs::path(file).begin())->string());
  };
  for (const Declared& here : declared)
    for (const std::string& there : defined_in[here.name]) {
      if (defined_in[here.name].contains(here.file)) continue;
      EXPECT_LE(folder_rank(there), folder_rank(here.file))
          << here.file << ':' << here.line << " declares " << here.name << ", which " << there
          << " defines";
      if (folder_of(here.file) == folder_of(there)) continue;
      const auto& rooms = kRooms.find(std::next(fs::path(here.file).begin())->string());
      if (rooms == kRooms.end() || folder_rank(here.file) != folder_rank(there)) continue;
      const auto at = [&](const std::string& file) {
        return std::find(rooms->second.begin(), rooms->second.end(), room_of(file));
      };
      EXPECT_LE(at(there), at(here.file)) << here.file << ':' << here.line << " declares "
                                          << here.name << ", which " << there << " defines";
    }
}

TEST(House, NeighboursDoNotIncludeEachOther) {
  const std::set<std::pair<std::string, std::string>> apart = {
      {"dynamics", "collision"}, {"collision", "dynamics"}, {"render", "report"},
      {"report", "render"},      {"render", "engines"},     {"report", "engines"}};
  for (const Include& include : framework_includes()) {
    if (!include.target.starts_with("framework/")) continue;
    const std::string target = std::next(fs::path(include.target).begin())->string();
    EXPECT_FALSE(apart.contains({include.folder, target}))
        << include.file << ':' << include.line << ": " << include.folder << " and " << target
        << " do not include each other";
  }
}

// What is known of one effect by its folder's headers cannot be taken out with the folder.
TEST(House, AnEffectIsKnownOutsideItsFolderByTheInterfaceOnly) {
  for (const Include& include : framework_includes()) {
    const fs::path target(include.target);
    if (!include.target.starts_with("framework/effects/") ||
        std::distance(target.begin(), target.end()) < 4)
      continue;
    EXPECT_EQ(include.folder, "effects")
        << include.file << ':' << include.line << " includes " << include.target;
    EXPECT_NE(room_of(include.file), "") << include.file << ':' << include.line
                                         << ": what all effects share includes " << include.target;
  }
}

TEST(House, FrameworkNamesNoAssignmentAndNoSolution) {
  for (const Include& include : framework_includes())
    EXPECT_FALSE(include.target.starts_with("assignments/") ||
                 include.target.starts_with("solutions_private/"))
        << include.file << ':' << include.line << " includes " << include.target;
}

TEST(House, ThirdPartiesStayInTheirRooms) {
  const std::map<std::string, std::set<std::string>> rooms = {
      {"assimp/", {"geometry"}},  {"valijson/", {"scene"}},
      {"GL/", {"render"}},        {"EGL/", {"render"}},
      {"png.h", {"render"}},      {"libimagequant.h", {"render"}},
      {"boost/pfr", {"modules"}}, {"boost/numeric/odeint", {"dynamics"}},
      {"seccomp.h", {"grading"}}, {"openssl/", {"core"}},
      {"zlib.h", {"core"}},       {"httplib.h", {"live"}},
      {"CLI/", {"cli"}},          {"gtest/", {"grading"}},
  };
  for (const Include& include : framework_includes())
    for (const auto& [prefix, folders] : rooms)
      if (include.target.starts_with(prefix)) {
        EXPECT_TRUE(folders.contains(include.folder))
            << include.file << ':' << include.line << " includes " << include.target;
      }
}

TEST(House, HeavyHeadersStayOutOfOurHeaders) {
  const std::vector<std::string> heavy = {
      "assimp/", "valijson/", "nlohmann/json.hpp", "GL/",         "EGL/",
      "png.h",   "seccomp.h", "openssl/",          "Eigen/Dense", "httplib.h"};
  const std::vector<Include> includes = framework_includes();
  // A header that only its own room includes is a part of that room's .cpp files.
  const auto leaves_its_room = [&](const Include& header) {
    return std::any_of(includes.begin(), includes.end(), [&](const Include& user) {
      return user.target == header.file && user.folder != header.folder;
    });
  };
  for (const Include& include : includes) {
    if (!include.file.ends_with(".h") || !leaves_its_room(include)) continue;
    for (const std::string& prefix : heavy)
      EXPECT_FALSE(include.target.starts_with(prefix))
          << include.file << ':' << include.line << " includes " << include.target;
  }
}

// A released tree, in which a student works.
bool is_students_tree() { return !fs::exists(kRoot / "solutions_private"); }

// Code and comments alike; what a raw string quotes from elsewhere may be longer.
TEST(House, LinesHaveAtMostAHundredColumns) {
  if (is_students_tree()) GTEST_SKIP() << "a student writes as a student likes";
  constexpr std::size_t kColumns = 100;
  std::vector<std::string> too_long;
  for (const char* folder : {"framework", "assignments", "solutions_private"}) {
    for (const fs::path& path : sources_below(kRoot / folder)) {
      std::ifstream in(path);
      int number = 0;
      for (std::string line; std::getline(in, line);) {
        ++number;
        const auto is_continuation = [](unsigned char byte) { return (byte & 0xC0) == 0x80; };
        const auto bytes = static_cast<std::size_t>(
            std::count_if(line.begin(), line.end(), is_continuation));  // of UTF-8: no column
        if (line.size() - bytes > kColumns)
          too_long.push_back(path.lexically_relative(kRoot).string() + ":" +
                             std::to_string(number));
      }
    }
  }
  EXPECT_EQ(too_long, std::vector<std::string>{});
}

// Versions of clang-format disagree in details: asked is the one whose result is committed.
TEST(House, CodeIsFormatted) {
  if (is_students_tree()) GTEST_SKIP() << "a student writes as a student likes";
  if (std::system("clang-format --version 2>/dev/null | grep -q 'version 14\\.'") != 0)
    GTEST_SKIP() << "no clang-format 14 here: apt-get install clang-format";
  std::string folders;
  for (const char* folder :
       {"framework", "assignments", "solutions_private", "tests", "models", "handouts"})
    folders += std::string(" ") + folder;
  const std::string command =
      "cd '" + kRoot.string() + "' && find" + folders +
      R"( \( -name '*.h' -o -name '*.cpp' \) -print0 | xargs -0 -n 100 clang-format --dry-run -Werror)";
  EXPECT_EQ(std::system(command.c_str()), 0)
      << "remedy: clang-format -i on each file that is named above";
}

TEST(House, RootHoldsOnlyTheRoomsOfTheDesign) {
  const std::set<std::string> rooms = {"framework", "assignments", "solutions_private",
                                       "tests",     "models",      "handouts",
                                       "build",     "out"};
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name.starts_with('.') || name.starts_with("build")) continue;
    EXPECT_TRUE(rooms.contains(name))
        << "a folder at the root that the design does not have: " << name;
  }
}

// Files that git does not know are nobody's business: notes, and what an editor leaves.
TEST(House, NoStrayFileIsCommittedAtTheRoot) {
  const std::set<std::string> known = {"CMakeLists.txt", "CMakePresets.json", "LICENSE",
                                       "README.md",      "packages.txt",      "tumble"};
  if (!fs::exists(kRoot / ".git")) GTEST_SKIP() << "this tree is no checkout";
  const std::string command =
      "git -c safe.directory='*' -C '" + kRoot.string() + "' ls-files ':(glob)*'";
  FILE* const said = ::popen(command.c_str(), "r");
  ASSERT_NE(said, nullptr);
  std::string files;
  for (int c = std::fgetc(said); c != EOF; c = std::fgetc(said)) files += static_cast<char>(c);
  ASSERT_EQ(::pclose(said), 0) << command;
  std::istringstream names(files);
  for (std::string name; std::getline(names, name);)
    EXPECT_TRUE(name.starts_with('.') || known.contains(name))
        << "a file at the root that belongs into a room: " << name;
  EXPECT_NE(files.find("packages.txt"), std::string::npos) << "git names no file";
}

}  // namespace
}  // namespace tumble::testing
