// tumble grade and tumble check on the command line.
#include <cstring>
#include <set>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>

#include "tests/cli/grading_fixture.h"

namespace tumble::grading {
namespace {

TEST_F(Grading, OddFoldersAreGradedOnceAndTakenOverAfterwards) {
  put("al <b>/a1_impulse.cpp", text_of(kStub));
  put("crash/a1_impulse.cpp", stub_that("__builtin_trap();"));
  put("typo/a1_impulse.cpp", "int x = ;\n");
  put("none/readme.txt", "I was ill");
  const ProgramOutcome first = grade("out", {"--no-media", "--jobs", "1"});
  EXPECT_EQ(first.code, 1) << "somebody's file was not found: " << first.printed;
  EXPECT_NE(first.printed.find("does not compile"), std::string::npos) << first.printed;
  EXPECT_NE(first.printed.find("Holds no a1_impulse.cpp"), std::string::npos) << first.printed;
  EXPECT_EQ(text_of(root / "out/gradebook.csv"),
            "Student,ID,SIS Login ID,Section,Impulse\n    Points Possible,,,,100\nal <b>,,al "
            "<b>,,0\ncrash,,crash,,0\nnone,,none,,\ntypo,,typo,,0\n");
  const auto crash = nlohmann::json::parse(text_of(root / "out/crash/results.json"));
  EXPECT_EQ(crash["tests"][0]["extra_data"]["verdict"], "crashed") << crash["tests"][0];
  EXPECT_NE(text_of(root / "out/typo/index.html").find("a1_impulse.cpp:1:"), std::string::npos);

  // Again: nothing is run. In another folder with two jobs: the same bytes.
  const auto before = files("out");
  const ProgramOutcome second = grade("out");
  EXPECT_NE(second.printed.find("unchanged since the last run"), std::string::npos)
      << second.printed;
  EXPECT_EQ(files("out"), before);
  grade("other", {"--no-media", "--jobs", "2"});
  EXPECT_EQ(files("other"), before);

  // A forged result and a corrected submission are graded again; the rest is not.
  write_whole(root / "out/crash/results.json", "{\"score\": 100}");
  put("typo/a1_impulse.cpp", text_of(kStub));
  const ProgramOutcome third = grade("out");
  EXPECT_NE(third.printed.find("[2/4]"), std::string::npos) << third.printed;
  EXPECT_EQ(nlohmann::json::parse(text_of(root / "out/crash/results.json"))["score"], 0.0);
  EXPECT_EQ(nlohmann::json::parse(text_of(root / "out/typo/results.json"))["extra_data"]["state"],
            "judged");
}

TEST_F(Grading, ARunThatIsKilledLeavesNothingHalfWrittenAndGoesOn) {
  for (const char* name : {"a", "b", "c"})
    put(std::string(name) + "/a1_impulse.cpp", text_of(kStub));
  const pid_t child = ::fork();
  if (child == 0) {
    const int nothing = ::open("/dev/null", 2);
    ::dup2(nothing, 1);
    ::dup2(nothing, 2);
    const std::string in = (root / "in").string(), out = (root / "out").string();
    ::execl(kProgram.c_str(), "tumble", "grade", "a1", in.c_str(), "--out", out.c_str(),
            "--no-media", "--jobs", "1", nullptr);
    ::_exit(127);
  }
  // Killed when the first result is complete, so in the middle of the second.
  for (int i = 0; i < 6000 && !fs::exists(root / "out/a/record.json"); ++i) ::usleep(10'000);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_FALSE(fs::exists(root / "out/c"));
  const ProgramOutcome again = grade("out");
  EXPECT_EQ(again.code, 0) << again.printed;
  EXPECT_NE(again.printed.find("unchanged since the last run"), std::string::npos) << again.printed;
  for (const auto& [file, text] : files("out"))
    EXPECT_EQ(file.find(".making"), std::string::npos) << file;
  EXPECT_TRUE(fs::exists(root / "out/c/record.json"));
}

TEST_F(Grading, ARunThatIsAskedToEndLeavesNothingBehind) {
  for (const char* name : {"a", "b", "c"})
    put(std::string(name) + "/a1_impulse.cpp",
        stub_that("for (volatile int never = 0; !never;) {}"));
  for (const int signal : {SIGTERM, SIGINT}) {
    const fs::path said = root / "said";
    const pid_t child = ::fork();
    if (child == 0) {
      const int file = ::open(said.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
      ::dup2(file, 1);
      ::dup2(file, 2);
      const std::string in = (root / "in").string(), out = (root / "out").string();
      ::execl(kProgram.c_str(), "tumble", "grade", "a1", in.c_str(), "--out", out.c_str(),
              "--no-media", "--jobs", "2", nullptr);
      ::_exit(127);
    }
    const auto stages = [] {  // of running and finished processes
      std::set<std::string> names;
      for (const auto& entry : fs::directory_iterator("/tmp"))
        if (entry.path().filename().string().starts_with("tumble-stage-"))
          names.insert(entry.path().filename());
      return names;
    };
    const auto before = stages();
    // In the middle of judging: the worker of the endless loop is in its sandbox then.
    for (int i = 0; i < 3000 && !fs::exists(root / "out/.making-a/a/.a1.so"); ++i) ::usleep(10'000);
    ::usleep(1'500'000);
    ::kill(child, signal);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_NE(text_of(said).find("stopped: 0 of 3"), std::string::npos) << text_of(said);
    for (const auto& entry : fs::directory_iterator(root / "out"))
      if (!entry.path().filename().string().starts_with(".tumble-"))
        ADD_FAILURE() << "left behind: " << entry.path();
    for (const std::string& stage : stages()) {
      const pid_t maker =
          static_cast<pid_t>(std::atol(stage.c_str() + std::strlen("tumble-stage-")));
      EXPECT_TRUE(before.contains(stage) || ::kill(maker, 0) == 0) << "left behind: " << stage;
    }
    // No process is left: none has this folder among its arguments.
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const bool is_process =
          entry.path().filename().string().find_first_not_of("0123456789") == std::string::npos;
      if (!is_process) continue;
      EXPECT_EQ(text_of(entry.path() / "cmdline").find(root.string()), std::string::npos)
          << entry.path();
    }
  }
}

TEST_F(Grading, EndlessLoopsUseUpABudgetAndNoMore) {
  // without side effects: the compiler may not drop it
  put("loops/a1_impulse.cpp", stub_that("for (;;) {}"));
  const ProgramOutcome outcome = grade("out", {"--no-media", "--budget-s", "6"});
  EXPECT_NE(outcome.printed.find("the time budget of 6 s was used up"), std::string::npos)
      << outcome.printed;
  const auto results = nlohmann::json::parse(text_of(root / "out/loops/results.json"));
  EXPECT_EQ(results["tests"][0]["extra_data"]["verdict"], "out of time or memory");
  EXPECT_NE(results["tests"][0]["output"].get<std::string>().find(
                "no answer within 5 s, in intersect_ray_triangle"),
            std::string::npos)
      << results["tests"][0];
  const auto& last = results["tests"].back();
  EXPECT_EQ(last["extra_data"]["verdict"], "out of time or memory");
  EXPECT_NE(last["output"].get<std::string>().find(
                "not run: the time budget of all tests together, 6 s, was used up"),
            std::string::npos)
      << last;
  EXPECT_NE(results["output"].get<std::string>().find("tests were not run"), std::string::npos)
      << results["output"];
  EXPECT_NE(text_of(root / "out/loops/index.html").find("tests were not run"), std::string::npos);
}

TEST_F(Grading, AMissingFolderIsReportedWithTheRemedy) {
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.printed.find("one sub-folder per submission"), std::string::npos)
      << outcome.printed;
}

}  // namespace
}  // namespace tumble::grading
