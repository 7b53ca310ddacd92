// A submission's result does not depend on the load of the machine; but the time that it sleeps
// counts.
#include "tests/support/places.h"
#include "tests/cli/busy_loops.h"
#include "tests/cli/grading_fixture.h"
#include "tests/support/whole.h"

namespace tumble::grading {
namespace {

TEST_F(Grading, BusyLoopsBesideItChangeNoByte) {
  TUMBLE_ONLY_WHOLE();
  id = "a2";
  put("reference/a2_integration.cpp",
      text_of(fs::path(test::source_dir()) /
              "solutions_private/a2_integration/a2_integration.cpp"));
  EXPECT_EQ(grade("calm").code, 0);
  const BusyLoops loops(4);
  const ProgramOutcome busy = grade("busy");
  EXPECT_EQ(busy.code, 0) << busy.printed;
  EXPECT_EQ(results("reference", "busy")["score"], 100.0) << busy.printed;
  EXPECT_EQ(text_of(root / "busy/reference/results.json"),
            text_of(root / "calm/reference/results.json"));
}

TEST_F(Grading, SleepIsCharged) {
  put("sleeper/a1_impulse.cpp", "#include <unistd.h>\n" + stub_that("::usleep(900'000);"));
  const ProgramOutcome outcome = grade("out", {"--no-media", "--budget-s", "3"});
  EXPECT_EQ(outcome.code, 0) << outcome.printed;
  EXPECT_TRUE(says(outcome, "the time budget of 3 s was used up")) << outcome.printed;
  const auto tests = results("sleeper")["tests"];
  EXPECT_EQ(tests[0]["extra_data"]["verdict"], "not attempted")
      << "a test that answers is judged by its answer";
  EXPECT_EQ(tests.back()["extra_data"]["verdict"], "out of time or memory");
}

}  // namespace
}  // namespace tumble::grading
