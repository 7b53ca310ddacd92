// A vector of the wrong size fails the tests of its own function only: the judge survives and
// reports the right size.
#include "tests/support/places.h"
#include "tests/cli/grading_fixture.h"
#include "tests/support/whole.h"

namespace tumble::grading {
namespace {

class GradeSizes : public Grading {
 protected:
  static fs::path solution(const std::string& folder) {
    return fs::path(test::source_dir()) / "solutions_private" / folder / (folder + ".cpp");
  }
  // The text with `does` as the first statement of the function's definition.
  static std::string with_slip(std::string text, const std::string& head, const std::string& does) {
    const auto at = text.find('{', text.find("VectorXd " + head + "("));
    EXPECT_NE(at, std::string::npos) << head;
    return text.insert(at + 1, "\n  " + does + "\n");
  }
  // Every test of these suites fails with its story, every other test passes, and none is a fault
  // of the grader.
  void expect_wrong(const std::map<std::string, std::string>& stories) const {
    const auto all = results("ann");
    EXPECT_EQ(all["extra_data"]["final"], true);
    std::map<std::string, int> seen;
    for (const auto& test : all["tests"]) {
      const std::string name = test["extra_data"]["test"], verdict = test["extra_data"]["verdict"],
                        output = test["output"];
      EXPECT_NE(verdict, "fault of the grader") << name << ": " << output;
      for (const auto& [suite, story] : stories)
        if (name.starts_with(suite) && output.find(story) != std::string::npos) ++seen[suite];
    }
    for (const auto& [suite, story] : stories)
      EXPECT_GT(seen[suite], 0) << suite << " nowhere says: " << story;
    EXPECT_GT(all["score"].get<double>(), 0.0) << "what has no slip keeps its points";
  }
};

TEST_F(GradeSizes, OfStatesAndDerivativesOfA2) {
  id = "a2";
  std::string text = text_of(solution("a2_integration"));
  // a common mistake: declared and not set
  text = with_slip(text, "rk4_step", "{ VectorXd unset; f(t, unset); }");
  text = with_slip(text, "euler_step", "return VectorXd();");
  text = with_slip(text, "rigid_body_derivative", "return VectorXd::Zero(1'000'000);");
  put("ann/a2_integration.cpp", text);
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 0) << outcome.printed;
  expect_wrong({{"Rk4Step.", "the derivative was called with 0 numbers"},
                {"EulerStep.", "euler_step returned 0 numbers, but 2 are needed"},
                {"RigidBodyDerivative.",
                 "rigid_body_derivative returned 1000000 numbers, but 13 are needed"}});
  int right = 0;
  const auto all = results("ann");  // named: a range over a part of a temporary would outlive it
  for (const auto& test : all["tests"]) right += test["extra_data"]["verdict"] == "right";
  EXPECT_GT(right, 10);
}

TEST_F(GradeSizes, AskedForTooMuchOfMemoryAreRefusedBeforeItIsTaken) {
  TUMBLE_ONLY_WHOLE();
  id = "a2";
  // 80 MB
  put("ann/a2_integration.cpp", with_slip(text_of(solution("a2_integration")), "rk4_step",
                                          "f(t, VectorXd::Zero(10'000'000));"));
  EXPECT_EQ(grade("out").code, 0);
  expect_wrong({{"Rk4Step.", "an argument or answer of 80000"}});
}

TEST_F(GradeSizes, OfMultipliersAndForcesOfA3) {
  TUMBLE_ONLY_WHOLE();
  id = "a3";
  std::string text = text_of(solution("a3_constraints"));
  text = with_slip(text, "constraint_multipliers", "return VectorXd();");
  text = with_slip(text, "constraint_correction", "return VectorXd::Zero(5);");
  text = with_slip(text, "contact_forces", "return VectorXd::Zero(100'000);");
  put("ann/a3_constraints.cpp", text);
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 0) << outcome.printed;
  expect_wrong(
      {{"ConstraintMultipliers.", "constraint_multipliers returned 0 numbers"},
       {"ConstraintCorrection.", "constraint_correction returned 5 numbers, but 12 are needed"},
       {"ContactForces.", "contact_forces returned 100000 numbers"}});
}

TEST_F(GradeSizes, AreSaidByCheckToo) {
  put("a2_integration.cpp", with_slip(text_of(solution("a2_integration")), "rk4_step",
                                      "{ VectorXd unset; f(t, unset); }"));
  const ProgramOutcome outcome = run_program(
      {kProgram.string(), "check", "a2", (root / "in/a2_integration.cpp").string(), "Rk4Step.*"},
      Output::kCaptured, 580.0);
  EXPECT_EQ(outcome.code, 1) << outcome.printed;
  EXPECT_TRUE(says(outcome, "the derivative was called with 0 numbers")) << outcome.printed;
  EXPECT_FALSE(says(outcome, "crashed")) << outcome.printed;
}

}  // namespace
}  // namespace tumble::grading
