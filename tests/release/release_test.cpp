// What students get gives nothing away: the released tree is searched, byte for byte, for what only
// instructors may know.
#include <algorithm>
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
#include <unistd.h>

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::source_dir();
const fs::path kPrivate = kRoot / "solutions_private";

std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// One release, made by the program itself, for all tests of this file.
class Release : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("tumble-release-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    ASSERT_EQ(run("release '" + folder_.string() + "' --no-build > /dev/null"), 0);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static int run(const std::string& words) {
    const std::string command =
        "TUMBLE_ROOT='" + kRoot.string() + "' '" + test::binary_dir() + "/bin/tumble' " + words;
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// Where `text` stands in the release: "file:line", or empty.
  static std::string where(const std::string& text) {
    for (const fs::path& file : files_below(folder_)) {
      const std::string& bytes = cached(file);
      const std::size_t at = bytes.find(text);
      if (at != std::string::npos)
        return file.lexically_relative(folder_).string() + ":" +
               std::to_string(
                   1 + std::count(bytes.begin(), bytes.begin() + static_cast<long>(at), '\n'));
    }
    return "";
  }

  static const std::string& cached(const fs::path& file) {
    static std::map<fs::path, std::string> cache;
    const auto it = cache.find(file);
    return it != cache.end() ? it->second : cache.emplace(file, contents_of(file)).first->second;
  }

  inline static fs::path folder_;
};

// Names of hidden tests, as `TEST(Suite, Name)` and as the runner prints them.
std::set<std::string> hidden_tests() {
  static const std::regex test_line(R"(TEST(?:_F)?\(\s*(\w+)\s*,\s*(\w+)\s*\))");
  std::set<std::string> names;
  for (const fs::path& file : files_below(kPrivate)) {
    if (file.extension() != ".cpp" || file.parent_path().filename() != "tests") continue;
    const std::string text = contents_of(file);
    for (std::sregex_iterator it(text.begin(), text.end(), test_line), end; it != end; ++it) {
      names.insert((*it)[1].str() + "." + (*it)[2].str());
      names.insert((*it)[1].str() + ", " + (*it)[2].str());
    }
  }
  return names;
}

TEST_F(Release, NamesNoHiddenTest) {
  const std::set<std::string> names = hidden_tests();
  ASSERT_GT(names.size(), 20u)
      << "hidden tests were not found: this test would pass whatever a release holds";
  for (const std::string& name : names) EXPECT_EQ(where(name), "") << name;
}

// A known-wrong solution, whole or a slip, says in its first line `// mutant: NAME - slip`: neither
// the line nor the file's name is for students.
TEST_F(Release, NamesNoKnownWrongSolution) {
  int count = 0;
  for (const fs::path& file : files_below(kPrivate)) {
    if (file.parent_path().filename() != "mutants") continue;
    ++count;
    const std::string text = contents_of(file);
    EXPECT_EQ(where(text.substr(0, text.find('\n'))), "") << file;
    EXPECT_EQ(where("mutants/" + file.filename().string()), "") << file;
  }
  EXPECT_GE(count, 16);
}

// Lines that carry code, without indentation. Braces alone, comments and includes say nothing about
// a solution.
std::vector<std::string> code_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t first = text.find_first_not_of(" \t", begin);
    if (first < end) {
      const std::string line = text.substr(first, end - first);
      if (line.size() > 2 && !line.starts_with("//") && !line.starts_with("#") &&
          !line.starts_with("}  // namespace"))
        lines.push_back(line);
    }
    begin = end + 1;
  }
  return lines;
}

// Three lines of code in a row are somebody's work; fewer are the idiom of a language. Shorter than
// a line of text they may be anybody's.
std::vector<std::string> passages(const std::string& text) {
  constexpr std::size_t kLines = 3, kCharacters = 80;
  const std::vector<std::string> lines = code_lines(text);
  std::vector<std::string> found;
  for (std::size_t i = 0; i + kLines <= lines.size(); ++i) {
    const std::string passage = lines[i] + "\n" + lines[i + 1] + "\n" + lines[i + 2];
    if (passage.size() >= kCharacters) found.push_back(passage);
  }
  return found;
}

// What a slip (NAME.slip) puts in, with the lines around it: its first column is a mark, and what
// it takes out is its base's.
std::string put_in(const std::string& slip) {
  std::istringstream in(slip);
  std::string text;
  bool in_block = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("@@"))
      in_block = true;
    else if (in_block && !line.empty() && line.front() != '-')
      text += line.substr(1) + '\n';
  }
  return text;
}

// A declaration of a module's header is what its solution begins with, too.
bool is_signature(const std::string& passage, const std::string& released_file) {
  return released_file.starts_with("assignments/") && released_file.ends_with(".h") &&
         passage.find(';') == std::string::npos;
}

TEST_F(Release, HoldsNoPassageOfASolution) {
  std::map<std::string, std::string> released;  // passage, file
  for (const fs::path& file : files_below(folder_))
    for (const std::string& passage : passages(cached(file)))
      released.emplace(passage, file.lexically_relative(folder_).string());
  ASSERT_GT(released.size(), 1000u);
  int searched = 0;
  for (const fs::path& file : files_below(kPrivate)) {
    // The flawed submission is a student's file: what it left of the stub is the stub. Attacks
    // hold no solution, but the same system calls as the sandbox.
    const bool is_slip = file.extension() == ".slip";
    if ((file.extension() != ".cpp" && !is_slip) ||
        file.string().find("/flawed_submission/") != std::string::npos ||
        *file.lexically_relative(kPrivate).begin() == "attacks" ||
        file.parent_path().filename() == "tests")
      continue;
    for (const std::string& passage :
         passages(is_slip ? put_in(contents_of(file)) : contents_of(file))) {
      ++searched;
      const auto it = released.find(passage);
      if (it != released.end() && !is_signature(passage, it->second))
        ADD_FAILURE() << it->second << " holds, from " << file.lexically_relative(kRoot) << ":\n"
                      << passage;
    }
  }
  EXPECT_GT(searched, 1000);
}

TEST_F(Release, HoldsNoPrivateFolderAndNoBuild) {
  for (const fs::path& file : files_below(folder_)) {
    const std::string first = file.lexically_relative(folder_).begin()->string();
    EXPECT_TRUE(first != "solutions_private" && first != ".git" && first != "out" &&
                !first.starts_with("build"))
        << file;
  }
  EXPECT_TRUE(fs::exists(folder_ / "assignments/a1_impulse/a1_impulse.cpp"));
  EXPECT_TRUE(fs::exists(folder_ / "handouts/a1_impulse.md"));
}

TEST_F(Release, TheReadmeIsTheStudents) {
  const std::string readme = contents_of(folder_ / "README.md");
  EXPECT_EQ(readme, contents_of(kRoot / "assignments/README.md"));
  EXPECT_FALSE(fs::exists(folder_ / "assignments/README.md"));
  EXPECT_LT(readme.find("./tumble check a1"), 800u) << "what to type first does not come first";
  for (const char* of_others : {"./tumble demo", "./tumble grade", "./tumble audit",
                                "./tumble release", "reference,", "=reference"})
    EXPECT_EQ(readme.find(of_others), std::string::npos) << of_others;
}

// Every command of the README names a verb, and what it names is there.
TEST_F(Release, TheReadmesCommandsAreKnown) {
  static const std::regex command(R"(\n\./tumble (\w+)(?: ([\w./]+))?)");
  const std::string readme = contents_of(folder_ / "README.md");
  int count = 0;
  for (std::sregex_iterator it(readme.begin(), readme.end(), command), end; it != end;
       ++it, ++count) {
    const std::string verb = (*it)[1], what = (*it)[2];
    EXPECT_TRUE(verb == "test" || fs::exists(folder_ / "framework/cli/help" / (verb + ".txt")))
        << verb;
    if (what.find('/') != std::string::npos) {
      EXPECT_TRUE(fs::exists(folder_ / what)) << what;
    }
  }
  EXPECT_GT(count, 15);
}

TEST_F(Release, PublishPutsTheReferenceWhereTheStubWas) {
  const fs::path published = folder_.string() + "-published";
  fs::remove_all(published);
  ASSERT_EQ(run("release '" + published.string() + "' --publish a1 --no-build > /dev/null"), 0);
  EXPECT_EQ(contents_of(published / "assignments/a1_impulse/a1_impulse.cpp"),
            contents_of(kPrivate / "a1_impulse/a1_impulse.cpp"));
  EXPECT_EQ(contents_of(published / "assignments/a2_integration/a2_integration.cpp"),
            contents_of(kRoot / "assignments/a2_integration/a2_integration.cpp"));
  fs::remove_all(published);
}

TEST_F(Release, NeverOverwrites) {
  const auto before = fs::last_write_time(folder_ / "README.md");
  EXPECT_EQ(run("release '" + folder_.string() + "' --no-build 2> /dev/null"), 2);
  EXPECT_EQ(fs::last_write_time(folder_ / "README.md"), before);
  EXPECT_FALSE(fs::exists(folder_.string() + ".partial"));
}

}  // namespace
}  // namespace tumble::testing
