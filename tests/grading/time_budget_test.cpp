// The time account of a submission: charges, functions with shorter limits, results of the
// remaining tests. And words that choose tests, and the line of a crash.
#include <dlfcn.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <new>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/grading/test_program/crash_line.h"
#include "framework/grading/test_program/test_words.h"
#include "framework/grading/test_program/time_budget.h"

namespace tumble::grading {
namespace {

TestResult timed_out(const std::string& function, double limit_s) {
  TestResult result;
  result.verdict = Verdict::kOutOfResources;
  result.last_call = function;
  result.timed_out_s = limit_s;
  result.charged_s = limit_s + 0.7;  // measured on a loaded machine
  return result;
}

TEST(TimeBudget, TimeOutIsChargedItsLimitHoweverLongItTook) {
  TimeBudget budget({.budget_s = 10.0});
  budget.charge(timed_out("f", 5.0));
  EXPECT_FALSE(budget.is_used_up());
  budget.charge(timed_out("f", 4.0));  // 10.4 s measured
  EXPECT_FALSE(budget.is_used_up());
  budget.charge(timed_out("f", 1.0));
  EXPECT_TRUE(budget.is_used_up());
}

TEST(TimeBudget, QuickAnswersAreFreeAndSlowOnesAreCharged) {
  TimeBudget budget({.budget_s = 4.0});
  TestResult answered;
  answered.verdict = Verdict::kRight;
  answered.charged_s = 0.09;
  for (int i = 0; i < 1000; ++i) budget.charge(answered);
  EXPECT_FALSE(budget.is_used_up());
  answered.charged_s = 4.2;
  budget.charge(answered);
  EXPECT_TRUE(budget.is_used_up());
}

TEST(TimeBudget, ShortSleepInEachTestAddsUp) {
  TimeBudget budget({.budget_s = 60.0});
  TestResult answered;
  answered.verdict = Verdict::kRight;
  answered.charged_s = 0.9;
  for (int i = 0; i < 81; ++i) budget.charge(answered);
  EXPECT_TRUE(budget.is_used_up());
}

TEST(TimeBudget, BusyMachineIsNotCharged) {
  TimeBudget budget({.budget_s = 4.0});
  TestResult busy = timed_out("f", 0.0);
  busy.verdict = Verdict::kMachineBusy;
  busy.charged_s = 100.0;
  budget.charge(busy);
  EXPECT_FALSE(budget.is_used_up());
}

TEST(TimeBudget, FunctionThatTimedOutTwiceGetsAShorterLimit) {
  TimeBudget budget({.budget_s = 60.0, .full_timeouts = 2, .suspect_own_s = 1.0});
  budget.charge(timed_out("f", 5.0));
  budget.charge(timed_out("g", 5.0));
  EXPECT_TRUE(budget.suspects().empty());
  budget.charge(timed_out("f", 5.0));
  EXPECT_EQ(budget.suspects(), (std::map<std::string, double>{{"f", 1.0}}));
}

TEST(TimeBudget, TestThatIsNotRunHasAReason) {
  TimeBudget budget({.budget_s = 5.0});
  budget.charge(timed_out("f", 5.0));
  const TestResult result = budget.not_run("S.T");
  EXPECT_EQ(result.verdict, Verdict::kOutOfResources);
  EXPECT_TRUE(result.not_run);
  EXPECT_EQ(result.story,
            "not run: the time budget of all tests together, 5 s, was used up by the tests before "
            "it; functions that ran out of time: f (1 test)");
}

class TestWords : public ::testing::Test {
 protected:
  TestChoice choice(const std::vector<std::string>& words) const {
    return {words, tests, rubric, {"intersect_ray", "collision_impulse"}};
  }
  std::string refusal(const std::string& word) const {
    try {
      choice({word});
    } catch (const UserError& error) {
      return error.what();
    }
    return "selected tests";
  }

  const std::vector<std::string> tests = {"RayTriangle.Hits", "CollisionImpulse.Central",
                                          "CollisionImpulse.Walls", "ApplyImpulse.Turns"};
  const Rubric rubric{"a9",
                      "Things",
                      {{"RayTriangle.Hits", 1, "basic", "A ray: inside"},
                       {"CollisionImpulse.Central", 1, "basic", "A central hit"},
                       {"CollisionImpulse.Walls", 1, "basic", "Two walls"}}};
};

TEST_F(TestWords, ArePatternsOfNamesOrPartsOfTitlesInAnyCase) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(choice({}).to_run(), tests);
  EXPECT_EQ(choice({"Ray*"}).to_run(), Names{"RayTriangle.Hits"});
  EXPECT_EQ(choice({"Ray*:Apply*"}).to_run(), (Names{"RayTriangle.Hits", "ApplyImpulse.Turns"}));
  EXPECT_EQ(choice({"two WALLS"}).to_run(), Names{"CollisionImpulse.Walls"});
  EXPECT_EQ(choice({"ray: in"}).to_run(), Names{"RayTriangle.Hits"}) << "a title may have a colon";
  EXPECT_EQ(choice({"Two", "walls"}).to_run(), Names{"CollisionImpulse.Walls"});
  EXPECT_EQ(choice({"hit", "applyimpulse"}).to_run(),
            (Names{"RayTriangle.Hits", "CollisionImpulse.Central", "ApplyImpulse.Turns"}));
}

TEST_F(TestWords, AFunctionHasTheTestsThatEndInIt) {
  const TestChoice chosen = choice({"collision_impulse", "Ray*"});
  EXPECT_EQ(chosen.to_run(), tests) << "only a run says which these are";
  TestResult result;
  result.test = "ApplyImpulse.Turns";
  result.last_call = "apply_impulse";
  EXPECT_FALSE(chosen.has(result));
  result.last_call = "collision_impulse";
  EXPECT_TRUE(chosen.has(result));
  result.test = "RayTriangle.Hits";
  result.last_call = "intersect_ray";
  EXPECT_TRUE(chosen.has(result)) << "chosen by its name";
  TestResult not_run;
  not_run.verdict = Verdict::kOutOfResources;
  not_run.not_run = true;
  EXPECT_TRUE(chosen.has(not_run)) << "it may be one";
}

TEST_F(TestWords, AWordThatChoosesNothingIsAnsweredWithTheNearest) {
  EXPECT_NE(refusal("ColisionImpulse.*").find("Nearest: 'A central hit' (CollisionImpulse.Centr"),
            std::string::npos)
      << refusal("ColisionImpulse.*");
  EXPECT_NE(refusal("two wals").find("Nearest: 'Two walls' (CollisionImpulse.Walls). A pattern"),
            std::string::npos)
      << refusal("two wals");
  EXPECT_NE(refusal("colision_impulse").find("Nearest: collision_impulse. "), std::string::npos)
      << refusal("colision_impulse");
  EXPECT_THROW(choice({"Ray*", "nothing like it"}), UserError) << "each word chooses something";
}

TEST(CrashLine, IsTheInnermostOfTheUsersFile) {
  const std::string told =
      "/usr/include/eigen3/Eigen/Core:7\n/x/mine.cpp:0\n/x/mine.cpp:12\n/x/mine.cpp:30\n??:0\n";
  EXPECT_EQ(line_in_source(told, "/x/mine.cpp"), "mine.cpp:12");
  EXPECT_EQ(line_in_source(told, "/x/../x/mine.cpp"), "mine.cpp:12");
  EXPECT_EQ(line_in_source(told, "/y/mine.cpp"), "");
}

// As a student's function does it, in a program that holds its code.
[[gnu::noinline]] int read_at(const volatile int* place) { return *place; }

TEST(CrashLine, IsFoundInTheProgramItself) {
  void* page = ::mmap(nullptr, sizeof(DyingPlaces), PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(page, MAP_FAILED);
  auto& places = *new (page) DyingPlaces;
  const ::pid_t child = ::fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    note_places_when_dying(places);
    ::_exit(read_at(nullptr));
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the signal ends it as before";
  EXPECT_EQ(WTERMSIG(status), SIGSEGV);
  ASSERT_GT(places.count.load(), 1u);
  Dl_info found{}, own{};
  ASSERT_NE(::dladdr(reinterpret_cast<void*>(places.places[0]), &found), 0);
  ASSERT_NE(::dladdr(reinterpret_cast<void*>(&note_places_when_dying), &own), 0);
  EXPECT_EQ(found.dli_fbase, own.dli_fbase) << "the place is in this program";
}

}  // namespace
}  // namespace tumble::grading
