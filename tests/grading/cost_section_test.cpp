// The cost section of a graded report: sentences, counts, and the time for a module that hangs.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/grading/course/build_submission.h"
#include "framework/grading/grades/cost_section.h"
#include "framework/grading/grades/measure_cost.h"
#include "framework/grading/grades/scheduler_section.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

class CostInAReport : public ::testing::Test {
 protected:
  CostInAReport() {
    register_assignments(registry_);
    course_ = {test::source_dir(), test::binary_dir(), &registry_, "test"};
  }

  /// The stub with one of its functions replaced.
  CostSection of_stub(const std::string& function = "", const std::string& body = "") const {
    std::ifstream in(fs::path(test::source_dir()) /
                     "assignments/a2_integration/a2_integration.cpp");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!function.empty()) {
      const auto begin = text.find("VectorXd " + function + "("), end = text.find("\n}\n", begin);
      text.replace(begin, end + 3 - begin,
                   "VectorXd " + function +
                       "(const OdeFunction& f, double t, const VectorXd& y, double h) {\n" + body +
                       "\n}\n");
    }
    const fs::path source = folder_ / "a2_integration.cpp", object = folder_ / "a2.so";
    std::ofstream(source) << text;
    const BuiltSubmission built = build_submission(course_, "a2", source, object);
    EXPECT_EQ(built.outcome, BuiltSubmission::Outcome::kBuilt) << built.said;
    return measure_cost(course_, "a2", object);
  }

  PrivateFolder scratch_;
  fs::path folder_ = scratch_.path();
  modules::Registry registry_;
  Course course_;
};

TEST_F(CostInAReport, StubIsReportedAndNotJudged) {
  const CostSection section = of_stub();
  ASSERT_EQ(section.lines.size(), 3u);  // Euler, RK4, the module as a whole
  for (const CostLine& line : section.lines) {
    EXPECT_FALSE(line.is_attempted) << line.reading;
    EXPECT_NE(line.reading.find("not written yet"), std::string::npos) << line.reading;
  }
}

TEST_F(CostInAReport, ModuleThatHangsLosesOnlyItsCurveAndTakesLittleTime) {
  const auto begun = std::chrono::steady_clock::now();
  const CostSection section =
      of_stub("rk4_step", "for (volatile int k = 0; k < 1;) {}\n  return y + h * f(t, y);");
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  ASSERT_EQ(section.lines.size(), 3u);
  EXPECT_NE(section.lines[1].reading.find("no answer within"), std::string::npos)
      << section.lines[1].reading;
  EXPECT_FALSE(section.lines[1].is_right);
  // earlier curves are kept
  EXPECT_FALSE(section.lines[0].is_attempted) << section.lines[0].reading;
  // two curves of 3 s, the compiler and the reference; without a limit it would not end
  EXPECT_LT(seconds, 60.0);
}

TEST_F(CostInAReport, StubOfASchedulerIsReportedAndNotJudged) {
  if (!fs::exists(fs::path(test::binary_dir()) / "modules" / "a4_reference.so"))
    GTEST_SKIP() << "measured beside the reference, which this tree does not have";
  const fs::path stub = folder_ / "a4.so";
  const BuiltSubmission built = build_submission(
      course_, "a4", fs::path(test::source_dir()) / "assignments/a4_timewarp/a4_timewarp.cpp",
      stub);
  ASSERT_EQ(built.outcome, BuiltSubmission::Outcome::kBuilt) << built.said;
  const CostSection section = measure_cost(course_, "a4", stub);
  ASSERT_EQ(section.lines.size(), 1u);
  EXPECT_NE(section.lines[0].reading.find("not written yet"), std::string::npos)
      << section.lines[0].reading;
  EXPECT_FALSE(section.lines[0].is_attempted);
}

TEST_F(CostInAReport, SchedulerIsMeasuredByWorkPerCommittedEvent) {
  const fs::path reference = fs::path(test::binary_dir()) / "modules" / "a4_reference.so";
  if (!fs::exists(reference))
    GTEST_SKIP() << "measured beside the reference, which this tree does not have";
  const CostSection section = measure_cost(course_, "a4", reference);
  ASSERT_EQ(section.lines.size(), 2u);
  for (const CostLine& line : section.lines)
    EXPECT_TRUE(line.is_right && !line.is_wasteful) << line.reading;
  EXPECT_NE(section.lines[1].reading.find("pays what the reference pays"), std::string::npos)
      << section.lines[1].reading;
  // error against work, work against the step, work against the number of processes
  EXPECT_EQ(section.plots.size(), 3u);
  ASSERT_EQ(section.tables.size(), 1u);
  // of the submission, then of the reference: the same decisions, in the sandbox and in this
  // process
  const auto& rows = section.tables[0].rows;
  ASSERT_EQ(rows.size() % 2, 0u);
  for (std::size_t k = 0; k < rows.size() / 2; ++k)
    for (std::size_t cell = 1; cell < rows[k].size(); ++cell)
      EXPECT_EQ(rows[k][cell].text, rows[k + rows.size() / 2][cell].text)
          << "row " << k << ", column " << section.tables[0].columns[cell].name;
}

TEST_F(CostInAReport, LawsOfImpactAreMeasuredAsAWhole) {
  const fs::path modules = fs::path(test::binary_dir()) / "modules",
                 reference = modules / "a1_reference.so";
  if (!fs::exists(reference))
    GTEST_SKIP() << "measured beside the reference, which this tree does not have";
  const CostSection right = measure_cost(course_, "a1", reference),
                    stub = measure_cost(course_, "a1", modules / "a1_student.so");
  ASSERT_EQ(right.lines.size(), 1u);
  ASSERT_EQ(stub.lines.size(), 1u);
  EXPECT_TRUE(right.lines[0].is_right) << right.lines[0].reading;
  // whether it is attempted depends on the student's file
  EXPECT_FALSE(stub.lines[0].is_right) << stub.lines[0].reading;
}

TEST_F(CostInAReport, StepOfHalfTheLengthIsNotEulerAndReadsTheSameTwice) {
  const std::string half = "return y + 0.5 * h * f(t, y);";
  const CostSection one = of_stub("euler_step", half), two = of_stub("euler_step", half);
  EXPECT_FALSE(one.lines[0].is_right) << one.lines[0].reading;
  EXPECT_TRUE(one.lines[0].is_attempted);
  ASSERT_EQ(one.plots.size(), two.plots.size());
  for (std::size_t k = 0; k < one.plots.size(); ++k)
    EXPECT_EQ(report::svg_of(one.plots[k]), report::svg_of(two.plots[k]));
  EXPECT_EQ(one.lines[0].reading, two.lines[0].reading);
}

TEST_F(CostInAReport, EulerStepHasOrderOne) {  // the lecture's formula, which is not secret
  const CostSection section = of_stub("euler_step", "return y + h * f(t, y);");
  EXPECT_TRUE(section.lines[0].is_right) << section.lines[0].reading;
  EXPECT_NE(section.lines[0].reading.find("as it should (1)"), std::string::npos)
      << section.lines[0].reading;
}

// The work of a wrong scheduler goes up and down with the step: its curve does not go back and
// forth with it.
TEST(CostOfASchedulerInAReport, CurvesGoFromLeftToRight) {
  cost::SchedulerCurve yours{"your scheduler", false, {}, {}};
  for (const std::uint64_t integrations : {17u, 52u, 30u, 41u}) {
    cost::SchedulerRun run;
    run.due = 2;
    run.committed = 1;
    run.integrations = integrations;
    run.step_s = 0.1;
    yours.by_step.push_back(run);
  }
  const std::vector<report::Plot> plots = scheduler_plots({yours});
  const report::Curve& curve = plots.at(0).curves.at(0);
  ASSERT_EQ(curve.x.size(), 4u);
  EXPECT_TRUE(std::is_sorted(curve.x.begin(), curve.x.end()));
}

}  // namespace
}  // namespace tumble::grading
