// The user's own module in this process: a call that ends without an answer ends the program with a
// message.
#include <stdexcept>

#include <gtest/gtest.h>

#include "framework/grading/worker/guarded_calls.h"
#include "framework/grading/worker/worker_connection.h"
#include "tests/modules/waist.h"

namespace tumble::grading {
namespace {

using waist::Module;

// endless recursion: no stack is left for the signal handler
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Winfinite-recursion"
void fall(const volatile char* deeper) {
  volatile char room[4096];
  room[0] = deeper[0];
  fall(room);
}
#pragma GCC diagnostic pop

Module faulty() {
  Module module;
  module.twice = [](double x) { return 2 * x; };
  module.call_back = [](const std::function<double(double)>& f, int) { return f(1.0); };
  module.attack = [](const std::string& what) -> std::string {
    if (what == "null") *static_cast<volatile int*>(nullptr) = 1;
    if (what == "deep") fall("");
    if (what == "size") std::abort();  // like a failed assertion of Eigen
    if (what == "loop")
      for (volatile int i = 0;;) i = i + 1;
    if (what == "throw") throw std::out_of_range("index 7");
    return what;
  };
  return module;
}

const Module& guarded_module() {
  static modules::ModuleKind kind;
  kind.watched = [](const modules::AnyModule& module,
                    modules::CallWatcher& watcher) -> modules::AnyModule {
    return std::make_shared<const Module>(
        modules::watched(*static_cast<const Module*>(module.get()), watcher));
  };
  static const modules::AnyModule any =
      guarded(kind, std::make_shared<const Module>(faulty()), "mine.cpp");
  return *static_cast<const Module*>(any.get());
}

TEST(GuardedCalls, RightCallsPass) {
  EXPECT_EQ(guarded_module().twice(21.0), 42.0);
  EXPECT_EQ(guarded_module().call_back([](double x) { return guarded_module().twice(x); }, 1), 2.0);
  EXPECT_EQ(guarded_module().attack("nothing"), "nothing");
}

TEST(GuardedCalls, CrashEndsWithItsSignalFileAndFunction) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(guarded_module().attack("null"), ::testing::ExitedWithCode(1),
              "mine.cpp: SIGSEGV.*in attack");
  EXPECT_EXIT(guarded_module().attack("deep"), ::testing::ExitedWithCode(1),
              "mine.cpp: SIGSEGV.*endless recursion.*in attack");
  EXPECT_EXIT(guarded_module().attack("size"), ::testing::ExitedWithCode(1),
              "mine.cpp: SIGABRT.*in attack");
}

TEST(GuardedCalls, EndlessLoopEndsWithAMessage) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(guarded_module().attack("loop"), ::testing::ExitedWithCode(1),
              "mine.cpp: out of time: no answer within 10 s.*in attack");
}

TEST(GuardedCalls, CrashElsewhereIsNotTheModules) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(
      {
        guarded_module().twice(1.0);
        std::abort();
      },
      ::testing::KilledBySignal(SIGABRT), "");
}

TEST(GuardedCalls, ExceptionOfTheModuleStopsARunWithItsReason) {
  try {
    guarded_module().attack("throw");
    FAIL() << "nothing was thrown";
  } catch (const CallEnded& ended) {
    EXPECT_STREQ(ended.what(), "mine.cpp: attack threw an exception: index 7");
  }
}

// Exceptions thrown by a callback are not the module's.
TEST(GuardedCalls, ExceptionsOfCallbacksPassThroughAModule) {
  EXPECT_THROW(
      guarded_module().call_back([](double) -> double { throw UserError("scene", "odd"); }, 1),
      UserError);
  EXPECT_THROW(
      guarded_module().call_back([](double) -> double { throw NotImplemented("f", "handout"); }, 1),
      NotImplemented);
}

TEST(GuardedCalls, CrashOfAStaticInitialiserIsNamed) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(guarded_load("mine.cpp", []() -> modules::AnyModule { std::abort(); }),
              ::testing::ExitedWithCode(1),
              "mine.cpp: SIGABRT.*in its global and static variables");
}

}  // namespace
}  // namespace tumble::grading
