// tumble grade and tumble audit of the scheduler's assignment, as on the command line, on one
// submission and one known-wrong solution.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

const fs::path kSolutions = fs::path(test::source_dir()) / "solutions_private/a4_timewarp";

class GradingOfTimewarp : public ::testing::Test {
 protected:
  GradingOfTimewarp() { ::setenv("TUMBLE_ROOT", test::source_dir().c_str(), 1); }
  ProgramOutcome type(std::vector<std::string> words) const {
    words.insert(words.begin(), test::binary_dir() + "/bin/tumble");
    return run_program(words, Output::kCaptured, 200.0);
  }
  PrivateFolder scratch_;
  fs::path root = scratch_.path();
};

// Partly right: some points and not all; each lost point comes from a test whose story is kept.
TEST_F(GradingOfTimewarp, AFlawedSubmissionGetsPartOfThePointsAndAStoryForEachItLoses) {
  fs::create_directories(root / "in/flawed");
  fs::copy_file(kSolutions / "flawed_submission/a4_timewarp.cpp",
                root / "in/flawed/a4_timewarp.cpp");
  const ProgramOutcome outcome = type({"grade", "a4", (root / "in").string(), "--out",
                                       (root / "out").string(), "--no-media", "--jobs", "1"});
  ASSERT_EQ(outcome.code, 0) << outcome.printed;
  std::ifstream file(root / "out/flawed/results.json");
  const nlohmann::json page = nlohmann::json::parse(file);
  EXPECT_EQ(page.at("extra_data").at("state"), "judged");
  double sum = 0.0, possible = 0.0;
  for (const nlohmann::json& test : page.at("tests")) {
    sum += test.at("score").get<double>();
    possible += test.at("max_score").get<double>();
    const bool is_right = test.at("extra_data").at("verdict") == "right";
    EXPECT_EQ(is_right, test.at("score") == test.at("max_score")) << test.at("name");
    EXPECT_TRUE(is_right || !test.at("output").get<std::string>().empty()) << test.at("name");
  }
  EXPECT_EQ(possible, 100.0);
  EXPECT_EQ(page.at("score").get<double>(), sum);
  EXPECT_GT(sum, 20.0);
  EXPECT_LT(sum, 80.0);
}

// One slip is caught, by a story that names it; every right solution is accepted.
TEST_F(GradingOfTimewarp, AnAuditCatchesASlipByNameAndAcceptsAllOthers) {
  fs::create_directories(root / "wrong");
  std::vector<fs::path> slips;  // the first by name suffices
  for (const auto& entry : fs::directory_iterator(kSolutions / "mutants"))
    slips.push_back(entry.path());
  ASSERT_FALSE(slips.empty());
  const fs::path slip = *std::min_element(slips.begin(), slips.end());
  fs::copy_file(slip, root / "wrong" / slip.filename());
  const ProgramOutcome outcome =
      type({"audit", "a4", "--mutants", (root / "wrong").string(), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.printed;
  const nlohmann::json page =
      nlohmann::json::parse(outcome.printed.substr(outcome.printed.find("[\n")));
  int wrong = 0, right = 0;
  for (const nlohmann::json& result : page) {
    (result.at("right").get<bool>() ? right : wrong) += 1;
    EXPECT_EQ(result.at("fault"), "") << result;
    EXPECT_TRUE(result.at("as_it_should").get<bool>()) << result;
    if (result.at("right").get<bool>()) {
      EXPECT_EQ(result.at("score"), result.at("possible")) << result;
      continue;
    }
    EXPECT_TRUE(result.at("named").get<bool>()) << result;
    EXPECT_FALSE(result.at("caught_by").empty()) << result;
    EXPECT_LT(result.at("score"), result.at("possible")) << result;
  }
  EXPECT_EQ(wrong, 1);
  EXPECT_GE(right, 2);  // the reference, and another right solution
}

// The first slip by name, with the first line of a block that starts with `mark` replaced: its
// text, and the number of that line.
std::pair<std::string, int> spoilt_slip(char mark, const std::string& line) {
  std::vector<fs::path> slips;
  for (const auto& entry : fs::directory_iterator(kSolutions / "mutants"))
    if (entry.path().extension() == ".slip") slips.push_back(entry.path());
  std::ifstream in(*std::min_element(slips.begin(), slips.end()));
  std::string text;
  int number = 0, spoilt = 0;
  for (std::string read; std::getline(in, read);) {
    ++number;
    if (spoilt == 0 && number > 3 && read.starts_with(mark)) spoilt = number;
    text += (spoilt == number ? mark + line : read) + '\n';
  }
  return {text, spoilt};
}

// A slip that does not compile, and one whose base has changed, are reported at their own lines.
TEST_F(GradingOfTimewarp, AnAuditReportsTheWrongLineOfASlip) {
  const auto [broken, at] = spoilt_slip('+', "  undeclared;");
  write_whole(root / "wrong/s.slip", broken);
  const ProgramOutcome refused =
      type({"audit", "a4", "--mutants", (root / "wrong").string(), "--only", "s"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.printed.find("does not compile: s.slip:" + std::to_string(at) + ":3: error: "),
            std::string::npos)
      << refused.printed;

  const auto [stale, gone] = spoilt_slip('-', "  what the base does not hold;");
  write_whole(root / "wrong/s.slip", stale);
  const ProgramOutcome left_behind =
      type({"audit", "a4", "--mutants", (root / "wrong").string(), "--only", "s"});
  EXPECT_EQ(left_behind.code, 2);
  EXPECT_NE(
      left_behind.printed.find("s.slip:" + std::to_string(gone) + ": this line stands nowhere in "),
      std::string::npos)
      << left_behind.printed;
}

}  // namespace
}  // namespace tumble::grading
