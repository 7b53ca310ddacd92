// Attacks during judging: none gains a point, none outlives its call, each gets its verdict and
// story.
#include <unistd.h>

#include <algorithm>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/worker/crash_place.h"
#include "tests/grading/attack_fixture.h"

namespace tumble::grading {
namespace {

class RunAttack : public Attack {};

Victim in_call() { return Victim(attack_object("in_call.cpp")); }

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// One attack in a new worker; afterwards the judge must be able to continue, and no process may be
// left.
void expect_end(const std::string& what, Verdict verdict, const std::string& story_part) {
  SCOPED_TRACE(what);
  Victim victim(attack_object("in_call.cpp"));
  EXPECT_EQ(victim.attack(what), "");
  EXPECT_STREQ(words(victim.verdict()), words(verdict)) << victim.story();
  EXPECT_TRUE(holds(victim.story(), story_part)) << victim.story();
  EXPECT_TRUE(holds(victim.story(), "attack")) << "the story names the call: " << victim.story();
  EXPECT_TRUE(holds(victim.story(), "called with: \"" + what + '"'))
      << "and its arguments: " << victim.story();
  call_log() = CallLog{};
  EXPECT_EQ(victim.module().twice(21.0), 42.0) << "the next test gets a new worker";
  victim.connection().reset();
  EXPECT_EQ(descendants_left(), 0);
}

// The answer of an attack that returns.
std::string reached(const std::string& what) {
  Victim victim(attack_object("in_call.cpp"));
  const std::string said = victim.attack(what);
  EXPECT_STREQ(words(victim.verdict()), "right") << what << ": " << victim.story();
  victim.connection().reset();
  EXPECT_EQ(descendants_left(), 0) << what;
  return said;
}

// What a worker is answered that opens a file outside: with namespaces there is no such file,
// Landlock refuses it, and without both the call itself is refused.
std::string refusal() {
  switch (chosen_sandbox()) {
    case SandboxKind::kNamespaces: return "No such file or directory";
    case SandboxKind::kLandlock: return "Permission denied";
    case SandboxKind::kBare: break;
  }
  return "Operation not permitted";
}

// The same of a file that namespaces show and protect.
std::string refused_in_sight() {
  return chosen_sandbox() == SandboxKind::kNamespaces ? "Permission denied" : refusal();
}

TEST_F(RunAttack, LeavingEarlyIsACrash) {
  for (const char* way : {"exit", "_exit", "quick_exit"})
    expect_end(way, Verdict::kCrashed, "exit code 0");
}

TEST_F(RunAttack, SignalsAreNamed) {
  expect_end("segmentation fault", Verdict::kCrashed, "SIGSEGV");
  expect_end("stack", Verdict::kCrashed, "SIGSEGV");
  expect_end("abort", Verdict::kCrashed, "SIGABRT");
  expect_end("terminate", Verdict::kCrashed, "SIGABRT");
}

// The attacks are compiled below "#line 1", as a file called waist.cpp.
TEST_F(RunAttack, ACrashHasItsLine) {
  if (traits_of(chosen_sandbox()).links_worker)
    GTEST_SKIP() << "a worker and its submission are one program here: frames are not told apart";
  const std::string source =
      text_of(fs::path(test::source_dir()) / "solutions_private/attacks/calls/in_call.cpp");
  const auto line_of = [&](const char* words) {
    return "waist.cpp:" +
           std::to_string(1 + std::count(source.begin(),
                                         source.begin() + static_cast<long>(source.find(words)),
                                         '\n'));
  };
  expect_end("segmentation fault", Verdict::kCrashed, line_of("volatile int*>(8)").c_str());
  expect_end("abort", Verdict::kCrashed, line_of("std::abort();").c_str());
}

// What a worker printed is a submission's, and so is the debug information of its object.
TEST(CrashPlace, TakesOffsetsAndPlainNamesAlone) {
  EXPECT_EQ(frames_in("frame 00000000000012ab\nframe 12\nframe ; rm -rf / ; 12ab\nhello\n"),
            std::vector<std::string>{"0x00000000000012ab"});
  EXPECT_EQ(own_line("/usr/include/a.h:3\n??:0\n/submission/a1_impulse.cpp:26 (discriminator 2)\n"),
            "a1_impulse.cpp:26");
  EXPECT_EQ(own_line("/submission/./a1.cpp:7"), "a1.cpp:7");
  for (const char* forged :
       {"/submission/<b>.cpp:26", "/submission/../key:1", "/submission/a.cpp:x",
        "/submission/a.cpp:?", "/submission/:3", "a.cpp:3"})
    EXPECT_EQ(own_line(forged), "") << forged;
}

TEST_F(RunAttack, ExceptionsAreQuoted) {
  expect_end("throw", Verdict::kCrashed, "I give up");
  expect_end("throw int", Verdict::kCrashed, "not a std::exception");
}

TEST_F(RunAttack, EndlessCallsAreOutOfTime) {
  for (const char* what : {"loop", "sleep"})
    expect_end(what, Verdict::kOutOfResources, "no answer within 1.5 s");
}

TEST_F(RunAttack, ForkBombIsOutOfTimeAndLeavesNoProcess) {
  expect_end("fork bomb", Verdict::kOutOfResources, "no answer");
}

TEST_F(RunAttack, ProcessesAreFew) {
  // Only process 1 and the worker, independent of other processes of this user. Memory is limited
  // per process, so this limits the sum; and a second process would delay the worker like a busy
  // machine.
  EXPECT_EQ(reached("children"), "0");
}

TEST_F(RunAttack, WorkerCannotSlowItselfDown) {
  // Waiting for a core is not charged, so a worker must not be able to choose it.
  for (const char* what : {"own core", "idle class", "nice"})
    EXPECT_EQ(reached(what), "Operation not permitted") << what;
}

TEST_F(RunAttack, WaitingForAWorkerThatHungUpIsCharged) {
  Victim victim(attack_object("in_call.cpp"));
  victim.attack("hang up");
  EXPECT_STREQ(words(victim.verdict()), "crashed") << victim.story();
  EXPECT_TRUE(holds(victim.story(), "closed its channel")) << victim.story();
  EXPECT_GE(call_log().own_s, 1.9);  // s: the grace period of a dying process is 2 s
}

TEST_F(RunAttack, ExcessiveMemoryIsOutOfMemory) {
  for (const char* what : {"100 GB by new", "memory in pieces"})
    expect_end(what, Verdict::kOutOfResources, "more memory");
}

TEST_F(RunAttack, FloodOfOutputIsCutOff) {
  expect_end("flood", Verdict::kOutOfResources, "printed more than");
}

TEST_F(RunAttack, TooLongAnswerIsRefused) {
  expect_end("long answer", Verdict::kCrashed, "an argument or answer of 6710");
}

TEST_F(RunAttack, ForgedFramesAreAnswersOrRefused) {
  for (const char* what : {"kind", "size", "callback", "count"})
    expect_end(std::string("forge:") + what, Verdict::kCrashed, "answered");
  expect_end("forge:half", Verdict::kOutOfResources, "no answer within");
}

TEST_F(RunAttack, ForgedStubIsAStub) {
  Victim victim = in_call();
  EXPECT_EQ(victim.attack("forge:stub"), "");
  EXPECT_EQ(victim.verdict(), Verdict::kNotAttempted) << victim.story();
}

TEST_F(RunAttack, AfterACallbackThatThrowsTheNextCallGetsANewWorker) {
  Victim victim = in_call();
  EXPECT_THROW(victim.module().call_back(
                   [](double) -> double { throw std::runtime_error("judge's own"); }, 1),
               std::runtime_error);
  EXPECT_EQ(victim.module().twice(1.0), 2.0);
}

TEST_F(RunAttack, CallInsideACallbackDiesWithItsStory) {
  // An integrator's derivative is a function of the same submission: if it crashes, both calls end.
  Victim victim = in_call();
  EXPECT_THROW(
      victim.module().call_back(
          [&](double) { return static_cast<double>(victim.module().attack("abort").size()); }, 2),
      CallEnded);
  EXPECT_EQ(victim.verdict(), Verdict::kCrashed);
  EXPECT_TRUE(holds(victim.story(), "SIGABRT") && holds(victim.story(), "attack"))
      << victim.story();
  call_log() = CallLog{};
  EXPECT_EQ(victim.module().call_back([&](double x) { return victim.module().twice(x); }, 3), 6.0);
  EXPECT_STREQ(call_log().last_call, "call_back");
  EXPECT_EQ(call_log().calls, 4);
}

TEST_F(RunAttack, ForgedAnswerIsWorthNoMoreThanAnAnswer) {
  // A forged frame with 42, then the process ends: the caller gets 42, which is compared with the
  // expected value like any answer.
  Victim victim = in_call();
  EXPECT_EQ(victim.module().missing(1.0), 42.0);
  EXPECT_EQ(victim.attack("fake lines"), "");
  EXPECT_EQ(victim.verdict(), Verdict::kCrashed) << victim.story();
}

TEST_F(RunAttack, PrintedResultsDoNotCount) { EXPECT_EQ(reached("fake lines"), "answer"); }

TEST_F(RunAttack, ThreadsAndChildrenDieWithTheWorker) {
  expect_end("thread left", Verdict::kCrashed, "Resource temporarily unavailable");
  EXPECT_EQ(reached("child left"), "answer");
}

TEST_F(RunAttack, NothingOfTheProjectIsVisible) {
  const std::string source = test::source_dir(), build = test::binary_dir();
  for (const std::string& path :
       {source, source + "/solutions_private", source + "/assignments/a1_impulse/a1_impulse.cpp",
        build, build + "/modules/waist_right.so", std::string("/etc/passwd"), std::string("/root"),
        std::string("/home"), std::string("/proc/1/root/etc"), std::string("/run"),
        std::string("/var/log"), std::string("/sys")}) {
    // a tree that students get has no solutions_private: Landlock tells what does not exist
    std::error_code error;
    if (!std::filesystem::exists(path, error) && !error) continue;
    EXPECT_EQ(reached("open:" + path),
              path.starts_with("/proc/1/") ? refused_in_sight() : refusal())
        << path;
  }
}

TEST_F(RunAttack, ProcessOneIsNotAccessible) {
  for (const char* file : {"environ", "maps", "mem", "fd/4"})
    EXPECT_EQ(reached(std::string("open:/proc/1/") + file), refused_in_sight()) << file;
}

TEST_F(RunAttack, OtherProcessesCannotBeSeenOrTouched) {
  EXPECT_EQ(reached("processes"),
            chosen_sandbox() == SandboxKind::kNamespaces ? "1 2 " : refusal());
  EXPECT_EQ(reached("trace parent"), "Operation not permitted");
  // Process 1 of a namespace receives no signal from inside without a handler for it; it only
  // matters that the judge continues.
  for (const char* what : {"kill all", "kill parent", "stop parent"}) reached(what);
}

TEST_F(RunAttack, NothingIsInherited) {
  ::setenv("TUMBLE_SECRET", "judge's own", 1);
  EXPECT_FALSE(holds(reached("environment"), "SECRET"));
  EXPECT_EQ(reached("descriptors"), "0 1 2 3 ");
}

TEST_F(RunAttack, KernelObjectsOutsideTheLimitsAreRefused) {
  for (const char* what :
       {"connect", "memfd", "shared memory", "link", "pipe by name", "more processes"})
    EXPECT_EQ(reached(what), "Operation not permitted") << what;
}

TEST_F(RunAttack, NothingCanBeWrittenToDisk) {
  // A worker has no folder to write to.
  for (const char* folder :
       {"/tmp/x", "/dev/shm/x", "/var/tmp/x", "/dev/x", "/x", "/usr/x", "/usr/local/x", "x"})
    EXPECT_EQ(reached(std::string("write:") + folder), "0") << folder;
}

TEST_F(RunAttack, EndlessCallbacksAreStopped) {
  Victim victim = in_call();
  EXPECT_THROW(victim.module().call_back([](double x) { return x; }, -1), CallEnded);
  EXPECT_EQ(victim.verdict(), Verdict::kOutOfResources);
  EXPECT_TRUE(holds(victim.story(), "more than 1000 times")) << victim.story();
}

TEST_F(RunAttack, WrongSizesAreWrongAnswersAndTheJudgeContinues) {
  for (const std::string what : {"ask 0", "ask 14", "answer 0", "answer 100000"}) {
    Victim victim = in_call();
    EXPECT_THROW(victim.module().step([](double, const VectorXd& y) { return VectorXd(-y); },
                                      VectorXd::Ones(13), what),
                 CallEnded)
        << what;
    EXPECT_EQ(victim.verdict(), Verdict::kWrong) << victim.story();
    EXPECT_TRUE(
        holds(victim.story(), what.substr(what.find(' ') + 1) + " numbers, but 13 are needed"))
        << victim.story();
    call_log() = CallLog{};
    EXPECT_EQ(victim.module().twice(21.0), 42.0) << "the next test gets a new worker";
  }
}

TEST_F(RunAttack, ExcessiveSizesAreRefused) {
  for (const std::string what :
       {"ask 10000000", "answer 10000000", "ask 10000000000", "answer -1"}) {
    Victim victim = in_call();
    EXPECT_THROW(victim.module().step([](double, const VectorXd& y) { return VectorXd(-y); },
                                      VectorXd::Ones(13), what),
                 CallEnded)
        << what;
    EXPECT_TRUE(victim.verdict() == Verdict::kCrashed ||
                victim.verdict() == Verdict::kOutOfResources)
        << victim.story();
  }
}

TEST_F(RunAttack, OwnTimeOfTheWorkerIsMeasured) {
  Victim victim(attack_object("in_call.cpp"));
  EXPECT_EQ(victim.attack("nap"), "0.4 s");
  EXPECT_GT(call_log().own_s, 0.3) << "sleep is charged";
  EXPECT_LT(call_log().own_s, 2.0);
}

TEST_F(RunAttack, TimeOfCallbacksIsNotChargedToTheWorker) {
  Victim victim = in_call();
  // 2 s of the judge's own time, within a limit of 1.5 s for a call.
  EXPECT_EQ(victim.module().call_back(
                [](double) {
                  ::usleep(500'000);
                  return 1.0;
                },
                4),
            4.0);
  EXPECT_LT(call_log().own_s, 1.0);
}

TEST_F(RunAttack, ExitFromAStaticInitialiserIsACrash) {
  Victim victim(attack_object("at_start.cpp"));
  EXPECT_EQ(victim.attack("hello"), "");
  EXPECT_EQ(victim.verdict(), Verdict::kCrashed) << victim.story();
  EXPECT_TRUE(holds(victim.story(), "exit code 0")) << victim.story();
}

TEST_F(RunAttack, WaitingInAStaticInitialiserIsOutOfTime) {
  Victim victim(attack_object("at_start.cpp", "#define LOOP"));
  EXPECT_EQ(victim.attack("hello"), "");
  EXPECT_EQ(victim.verdict(), Verdict::kOutOfResources) << victim.story();
}

TEST_F(RunAttack, OwnMainAndMallocChangeNothingOutside) {
  Victim victim(attack_object("at_start.cpp", "#define OWN_MAIN"));
  const std::string said = victim.attack("hello");
  EXPECT_TRUE(said == "hello" || victim.verdict() == Verdict::kCrashed) << victim.story();
}

TEST_F(RunAttack, OwnOperatorNewChangesNothingOutside) {
  Victim victim(attack_object("at_start.cpp", "#define OWN_NEW"));
  const std::string said = victim.attack("hello");
  EXPECT_TRUE(said == "hello" || victim.verdict() == Verdict::kCrashed) << victim.story();
}

}  // namespace
}  // namespace tumble::grading
