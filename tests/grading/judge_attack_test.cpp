// Attacks on a judge with real tests, from a submission's static initialisers, observed in the
// record of results.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/places.h"
#include "framework/grading/verdicts/verdict.h"
#include "tests/grading/attack_fixture.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

class JudgeAttack : public Attack {
 protected:
  void SetUp() override {
    Attack::SetUp();
    if (!fs::exists(judge_)) GTEST_SKIP() << "this tree has no hidden tests, so no judge";
    folder_ = fs::temp_directory_path() / ("tumble-judge-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Results of the assignment's starter file with `evil` before it.
  std::vector<TestResult> judged(const std::string& evil) {
    const fs::path root = test::source_dir(),
                   starter = root / "assignments/a1_impulse/a1_impulse.cpp";
    std::ifstream in(starter);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    std::ofstream(folder_ / "a1_impulse.cpp") << evil << "\n" << text;
    const fs::path object = folder_ / "a1.so", record = folder_ / "record.json";
    const Compiled compiled = compile_submission({root,
                                                  "assignments/a1_impulse/a1_impulse.h",
                                                  folder_ / "a1_impulse.cpp",
                                                  object,
                                                  {},
                                                  "a1"});
    EXPECT_EQ(compiled.outcome, Compiled::Outcome::kBuilt) << compiled.said;
    const std::string words = judge_.string() + " --submission " + object.string() + " --json " +
                              record.string() + " 'Ray*' > " + (folder_ / "said").string();
    code_ = WEXITSTATUS(std::system(words.c_str()));
    return read_results(record.string());
  }
  static bool all(const std::vector<TestResult>& results, Verdict verdict) {
    return !results.empty() &&
           std::all_of(results.begin(), results.end(),
                       [&](const TestResult& r) { return r.verdict == verdict; });
  }

  const fs::path judge_ = fs::path(test::binary_dir()) / "bin/judge_a1";
  fs::path folder_;
  int code_ = -1;
};

TEST_F(JudgeAttack, ExitAndFakeLinesFromAStaticInitialiserEarnNothing) {
  const auto results = judged(
      "#include <cstdio>\n#include <cstdlib>\nstatic const int early = [] { std::puts(\"[  PASSED  "
      "] 81 tests.\"); std::exit(0); return 0; }();");
  EXPECT_TRUE(all(results, Verdict::kCrashed));
  EXPECT_NE(results.front().story.find("exit code 0"), std::string::npos) << results.front().story;
  EXPECT_EQ(code_, 1);
}

TEST_F(JudgeAttack, OwnMainAndOperatorNewEarnNothing) {
  // The stub's throw allocates memory too: a submission that damages its own process can lose only
  // its own verdicts.
  const auto results = judged(
      "#include <cstdlib>\n#include <new>\nint main() { std::exit(0); }\nvoid* operator "
      "new(std::size_t n) { return std::malloc(n); }");
  EXPECT_TRUE(all(results, Verdict::kNotAttempted));
  EXPECT_EQ(code_, 4);
}

TEST_F(JudgeAttack, StarterIsNotAttempted) { EXPECT_TRUE(all(judged(""), Verdict::kNotAttempted)); }

}  // namespace
}  // namespace tumble::grading
