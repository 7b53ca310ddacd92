// The house rules of the design, read off the sources: knowledge runs one way, third parties stay in their rooms, the
// framework names no assignment, and nothing outside solutions_private names what students must not get.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = TUMBLE_SOURCE_DIR;

// Top to bottom: a folder includes only what stands above it (or itself).
const std::vector<std::string> kFolders = {"core",    "geometry", "scene",  "dynamics", "collision", "trajectory",
                                           "modules", "engines",  "render", "report",   "grading",   "cli"};

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
    if (entry.is_regular_file() && (extension == ".h" || extension == ".cpp")) files.push_back(entry.path());
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
        includes.push_back({relative.string(), std::next(relative.begin())->string(), line, match[1]});
    }
  }
  return includes;
}

TEST(House, KnowledgeRunsDownTheTable) {
  for (const Include& include : framework_includes()) {
    if (!include.target.starts_with("framework/")) continue;
    const std::string target = std::next(fs::path(include.target).begin())->string();
    const int from = rank_of(include.folder), to = rank_of(target);
    EXPECT_TRUE(to >= 0 && to <= from) << include.file << ':' << include.line << ": " << include.folder << " includes "
                                       << include.target << ", which stands below it in the design's table";
  }
}

TEST(House, NeighboursDoNotIncludeEachOther) {
  const std::set<std::pair<std::string, std::string>> apart = {
      {"dynamics", "collision"}, {"collision", "dynamics"}, {"render", "report"}, {"report", "render"},
      {"render", "engines"},     {"report", "engines"}};
  for (const Include& include : framework_includes()) {
    if (!include.target.starts_with("framework/")) continue;
    const std::string target = std::next(fs::path(include.target).begin())->string();
    EXPECT_FALSE(apart.contains({include.folder, target}))
        << include.file << ':' << include.line << ": " << include.folder << " and " << target << " do not include each other";
  }
}

TEST(House, FrameworkNamesNoAssignmentAndNoSolution) {
  for (const Include& include : framework_includes())
    EXPECT_FALSE(include.target.starts_with("assignments/") || include.target.starts_with("solutions_private/"))
        << include.file << ':' << include.line << " includes " << include.target;
}

TEST(House, ThirdPartiesStayInTheirRooms) {
  const std::map<std::string, std::set<std::string>> rooms = {
      {"assimp/", {"geometry"}},
      {"fcl/", {"collision"}},
      {"valijson/", {"scene"}},
      {"GL/", {"render"}},
      {"EGL/", {"render"}},
      {"png.h", {"render"}},
      {"boost/pfr", {"modules"}},
      {"boost/numeric/odeint", {"dynamics"}},
      {"seccomp.h", {"grading"}},
      {"openssl/", {"grading"}},
      {"zlib.h", {"report"}},
      {"CLI/", {"cli"}},
      {"gtest/", {"grading"}},
  };
  for (const Include& include : framework_includes())
    for (const auto& [prefix, folders] : rooms)
      if (include.target.starts_with(prefix)) {
        EXPECT_TRUE(folders.contains(include.folder)) << include.file << ':' << include.line << " includes " << include.target;
      }
}

TEST(House, HeavyHeadersStayOutOfOurHeaders) {
  const std::vector<std::string> heavy = {"assimp/", "fcl/", "valijson/", "nlohmann/", "GL/", "EGL/", "png.h", "seccomp.h", "openssl/", "Eigen/Dense"};
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
      EXPECT_FALSE(include.target.starts_with(prefix)) << include.file << ':' << include.line << " includes " << include.target;
  }
}

TEST(House, RootHoldsOnlyTheRoomsOfTheDesign) {
  const std::set<std::string> rooms = {"framework", "assignments", "solutions_private", "tests", "models", "handouts", "build", "out"};
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name.starts_with('.') || name.starts_with("build")) continue;
    EXPECT_TRUE(rooms.contains(name)) << "a folder at the root that the design does not have: " << name;
  }
}

}  // namespace
}  // namespace tumble::testing
