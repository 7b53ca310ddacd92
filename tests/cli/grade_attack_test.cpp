// Attacks on the grader from outside the sandbox: results planted, folders that overlap, names,
// rubrics, two at once, a kill at any time.
#include <algorithm>
#include <chrono>
#include <set>

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>

#include "tests/support/places.h"
#include "tests/cli/grading_fixture.h"
#include "tests/support/whole.h"

namespace tumble::grading {
namespace {

class GradeAttack : public Grading {
 protected:
  // Starts a grading that takes long; the caller ends it.
  pid_t start_grading(const std::string& out) const {
    return start_words(words_for(out, {"--no-media", "--jobs", "1"}));
  }
  static void wait_for(const fs::path& file) {
    for (int i = 0; i < 30'000 && !fs::exists(file); ++i) ::usleep(10'000);
    EXPECT_TRUE(fs::exists(file)) << file;
  }
};

TEST_F(GradeAttack, ResultsPlantedAmongSubmissionsDestroyNothingAndEarnNothing) {
  put("alice/a1_impulse.cpp", text_of(kStub));
  put("bob/a1_impulse.cpp", text_of(kStub));
  // The best forgery: another student's perfect record, with everything that makes it look
  // complete.
  put("alice/record.json",
      R"({"assignment": "a1", "folder": "alice", "name": "alice", "state": "judged", "score": 100,
        "possible": 100, "mac": ""})");
  put("alice/results.json", R"({"score": 100})");
  put(".tumble-grade.json", R"({"assignment": "a1", "folders": ["alice", "bob"]})");
  const auto before = files("in");
  for (const std::string out : {"in", "in/.", "in/alice", "in/../in", "in/new"}) {
    const ProgramOutcome outcome = grade(out);
    EXPECT_EQ(outcome.code, 2) << out << ": " << outcome.printed;
    EXPECT_TRUE(says(outcome, "folder of the submissions")) << outcome.printed;
  }
  EXPECT_EQ(files("in"), before);
  EXPECT_EQ(grade("out").code, 0);
  EXPECT_EQ(results("alice")["score"], 0.0);
}

TEST_F(GradeAttack, ARecordThatThisMachineDidNotSignIsGradedAgainAndSaidSo) {
  put("alice/a1_impulse.cpp", text_of(kStub));
  grade("out");
  const auto before = files("out");
  // Forged in place, as by a process that may write there: all fields, the digests of files too,
  // but not the code.
  auto record = nlohmann::ordered_json::parse(text_of(root / "out/alice/record.json"));
  record["score"] = 100.0;
  write_whole(root / "out/alice/record.json", record.dump());
  const ProgramOutcome again = grade("out");
  EXPECT_TRUE(says(again,
                   "alice: the earlier result is not reused, because its record is not signed by "
                   "this machine's key; graded again"))
      << again.printed;
  EXPECT_EQ(files("out"), before);
  // The key is lost: no earlier result is trusted, which is reported; the results are the same.
  fs::remove(root / "grader.key");
  const ProgramOutcome keyless = grade("out");
  EXPECT_EQ(keyless.code, 0) << keyless.printed;
  EXPECT_TRUE(says(keyless, "a new key of this machine was made")) << keyless.printed;
  EXPECT_TRUE(says(keyless, "graded again")) << keyless.printed;
  EXPECT_EQ(results("alice")["score"], 0.0);
  const ProgramOutcome calm = grade("out");
  EXPECT_TRUE(says(calm, "unchanged since the last run")) << calm.printed;
}

TEST_F(GradeAttack, TheKeyDoesNotLieAmongResults) {
  put("alice/a1_impulse.cpp", text_of(kStub));
  ::setenv("TUMBLE_GRADER_KEY", (root / "out/grader.key").c_str(), 1);
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 2) << outcome.printed;
  EXPECT_TRUE(says(outcome, "is the key of this machine")) << outcome.printed;
}

TEST_F(GradeAttack, AnyNameOfASubmissionIsGraded) {
  const std::vector<std::string> names = {"o'brien \"x\"",
                                          "new\nline",
                                          "tab\tbell\x07",
                                          "\xff\xfe",
                                          "\u202eevil",
                                          "$(touch pwned)",
                                          "-rf",
                                          ".hidden",
                                          "index.html",
                                          ".making-x",
                                          "_plain-0123456789abcdef",
                                          "\u5f20\u4f1f",
                                          std::string(250, 'n')};
  // not compiled: seconds for all of them
  for (const std::string& name : names) put(name + "/a1_impulse.cpp", "int x = ;\n");
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 0) << outcome.printed;
  const auto entries = ledger();
  EXPECT_EQ(entries.size(), names.size());
  std::set<std::string> folders;
  for (const auto& entry : entries) {
    const std::string folder = entry["folder"];
    EXPECT_TRUE(folders.insert(folder).second) << folder << " twice";
    EXPECT_TRUE(fs::exists(root / "out" / folder / "results.json")) << folder;
    EXPECT_FALSE(folder.starts_with('.') || folder.find('/') != std::string::npos) << folder;
  }
  EXPECT_TRUE(says(grade("out"), "unchanged since the last run"));
}

TEST_F(GradeAttack, LinksAmongSubmissionsLeadNowhere) {
  put("alice/a1_impulse.cpp", text_of(kStub));
  fs::create_directory_symlink(root / "in/alice", root / "in/bob");
  fs::create_directories(root / "in/eve");
  fs::create_symlink(kReference, root / "in/eve/a1_impulse.cpp");
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 1) << "two are to be mended by hand: " << outcome.printed;
  EXPECT_NE(text_of(root / "out/gradebook.csv").find("alice,,alice,,0\nbob,,bob,,\neve,,eve,,\n"),
            std::string::npos)
      << text_of(root / "out/gradebook.csv");
}

TEST_F(GradeAttack, EqualFilesAreRemarkedForTheGraderAlone) {
  put("alice/a1_impulse.cpp", text_of(kStub) + "// mine\n");
  put("bob/a1_impulse.cpp", text_of(kStub) + "// mine\n");
  const ProgramOutcome outcome = grade("out");
  EXPECT_TRUE(says(outcome, "the same file, byte for byte, as that of bob")) << outcome.printed;
  EXPECT_EQ(text_of(root / "out/alice/results.json").find("bob"), std::string::npos);
  EXPECT_EQ(text_of(root / "out/alice/index.html").find("bob"), std::string::npos);
}

TEST_F(OtherRubric, AnEntryWithoutATestAndATestWithoutAnEntryAreNamedBeforeAnythingIsGraded) {
  put("alice/a1_impulse.cpp", text_of(kStub));
  auto json = read();
  const std::string name = json["tests"][0]["test"];
  json["tests"][0]["test"] = name + "s";
  write(json);
  ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 2) << outcome.printed;
  EXPECT_TRUE(says(outcome, "names test '" + name + "s', which judge_a1 does not have"))
      << outcome.printed;
  EXPECT_TRUE(says(outcome, "Did you mean '" + name + "'?")) << outcome.printed;

  const double points = json["tests"][0]["points"];
  json["tests"].erase(0);
  json["tests"][0]["points"] = json["tests"][0]["points"].get<double>() + points;
  write(json);
  outcome = grade("out");
  EXPECT_EQ(outcome.code, 2) << outcome.printed;
  EXPECT_TRUE(says(outcome, "has no entry for test '" + name + "'")) << outcome.printed;
  EXPECT_FALSE(fs::exists(root / "out"));
}

TEST_F(OtherRubric, AJudgeThatCannotReadItsTruthsCostsNobodyPoints) {
  put("alice/a1_impulse.cpp", text_of(kReference));
  fs::remove(course / "tests/truths");
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 3) << outcome.printed;
  const auto alices = results("alice");
  EXPECT_FALSE(alices.contains("score"));
  std::map<std::string, int> verdicts;
  for (const auto& test : alices.at("tests"))
    ++verdicts[test["extra_data"]["verdict"].get<std::string>()];
  EXPECT_GT(verdicts["fault of the grader"], 0);
  EXPECT_EQ(verdicts["wrong"], 0);
  EXPECT_GT(verdicts["right"], 10) << "tests that read no file are judged";
}

TEST_F(OtherRubric, PointsAloneAreAddedUpAgainAndEveryChangedTestIsNamed) {
  // A stub except for one test: a test between which points can be moved.
  put("alice/a1_impulse.cpp", text_of(kReference));
  EXPECT_EQ(grade("out").code, 0);
  EXPECT_EQ(results("alice")["score"], 100.0);
  auto json = read();
  json["tests"][0]["points"] = json["tests"][0]["points"].get<double>() + 0.5;
  json["tests"][1]["points"] = json["tests"][1]["points"].get<double>() - 0.5;
  write(json);
  const auto start = std::chrono::steady_clock::now();
  const ProgramOutcome again = grade("out");
  const double took_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(again.code, 0) << again.printed;
  EXPECT_TRUE(says(again, json["tests"][0]["test"].get<std::string>() + ": right"))
      << again.printed;
  EXPECT_TRUE(says(again, "(the rubric changed)")) << again.printed;
  EXPECT_EQ(results("alice")["score"], 100.0);
  EXPECT_EQ(results("alice")["tests"][0]["max_score"], json["tests"][0]["points"]);
  const auto times = nlohmann::json::parse(text_of(root / "out/times.json"));
  EXPECT_LT(times["seconds"].value("alice", 0.0), std::max(2.0, 0.5 * took_s))
      << "it was run again";
}

TEST_F(GradeAttack, TwoGradingsDoNotMeetInOneFolderAndAKilledOneLeavesItFree) {
  put("alice/a1_impulse.cpp", stub_that("for (volatile int never = 0; !never;) {}"));
  const pid_t first = start_grading("out");
  wait_for(root / "out/.making-alice/alice");
  const ProgramOutcome second = grade("out");
  EXPECT_EQ(second.code, 2) << second.printed;
  EXPECT_TRUE(says(second, "another grading writes there")) << second.printed;
  ::kill(first, SIGKILL);
  ::waitpid(first, nullptr, 0);
  put("alice/a1_impulse.cpp", text_of(kStub));
  const ProgramOutcome third = grade("out");
  EXPECT_EQ(third.code, 0) << third.printed;
  EXPECT_FALSE(fs::exists(root / "out/.making-alice"));
}

TEST_F(GradeAttack, ChildrenOfAKilledGradingThatDieSlowlyAreWaitedFor) {
  TUMBLE_ONLY_WHOLE();
  put("alice/a1_impulse.cpp", text_of(kStub));
  EXPECT_EQ(grade("out").code, 0);
  // A process that holds the lock of a finished run, for longer than a live one is waited for.
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ::waitpid(gone, nullptr, 0);
  const fs::path file = root / "out/.tumble-lock";
  write_whole(file, std::to_string(gone) + "\n");
  const int lock = ::open(file.c_str(), O_RDWR);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::sleep(5);
    ::_exit(0);
  }
  ::close(lock);
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 0) << outcome.printed;
  ::waitpid(child, nullptr, 0);
}

TEST_F(GradeAttack, AFileThatChangesMeanwhileIsGradedAsItWas) {
  TUMBLE_ONLY_WHOLE();
  // takes a while
  put("alice/a1_impulse.cpp", stub_that("for (volatile int never = 0; !never;) {}"));
  put("bob/a1_impulse.cpp", "int x = ;\n");
  const pid_t grading = start_grading("out");
  wait_for(root / "out/.making-alice/alice");
  put("bob/a1_impulse.cpp", text_of(kStub));
  int status = 0;
  ::waitpid(grading, &status, 0);
  EXPECT_EQ(results("bob")["extra_data"]["state"], "does not compile");
  put("bob/a1_impulse.cpp", "int x = ;\n");
  const ProgramOutcome again = grade("out");
  EXPECT_TRUE(says(again, "unchanged since the last run")) << again.printed;
}

TEST_F(GradeAttack, TwoSubmissionsOfOneNameAreSaid) {
  put("alice/a1_impulse.cpp", "int x = ;\n");
  put("alice.cpp", "int x = ;\n");
  put("Points Possible/a1_impulse.cpp", "int x = ;\n");
  const ProgramOutcome outcome = grade("out");
  EXPECT_TRUE(says(outcome, "alice: 2 submissions of that name")) << outcome.printed;
  const std::string book = text_of(root / "out/gradebook.csv");
  EXPECT_NE(book.find("\nfolder Points Possible,"), std::string::npos) << book;
}

TEST_F(GradeAttack, MediaMadeBeforeStayWithoutMedia) {
  TUMBLE_ONLY_WHOLE();
  put("alice/a1_impulse.cpp", text_of(kStub));
  grade("out");
  // Pictures of an earlier run: signed, so made by the grader; one file suffices.
  fs::create_directories(root / "out/alice/media");
  write_whole(root / "out/alice/media/pong.png", "picture");
  put("alice/a1_impulse.cpp", text_of(kStub) + "// changed\n");
  EXPECT_EQ(grade("out").code, 0);
  EXPECT_EQ(text_of(root / "out/alice/media/pong.png"), "picture");
}

TEST_F(GradeAttack, ABuildThatTakesTheProgramsAwayDisturbsNoGrading) {
  TUMBLE_ONLY_WHOLE();
  // The programs are copied first; here the build tree consists of links whose judge is deleted
  // during the grading.
  const fs::path build = root / "build";
  fs::create_directories(build / "bin");
  for (const char* program : {"judge_a1", "worker_a1", "sandbox_init", "tumble"})
    fs::copy_file(fs::path(test::binary_dir()) / "bin" / program, build / "bin" / program);
  fs::create_directory_symlink(fs::path(test::binary_dir()) / "submission_sdk",
                               build / "submission_sdk");
  put("alice/a1_impulse.cpp", text_of(kStub));
  put("bob/a1_impulse.cpp", text_of(kStub) + "// bob\n");
  const std::vector<std::string> words = {(build / "bin/tumble").string(),
                                          "grade",
                                          "a1",
                                          (root / "in").string(),
                                          "--out",
                                          (root / "out").string(),
                                          "--no-media",
                                          "--jobs",
                                          "1"};
  const pid_t child = ::fork();
  if (child == 0) ::_exit(run_program(words, Output::kDropped, 580.0).code);
  wait_for(root / "out/.making-alice");
  for (const char* program : {"judge_a1", "worker_a1", "sandbox_init"})
    write_whole(build / "bin" / program, "half a program");
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  for (const char* name : {"alice", "bob"})
    EXPECT_EQ(results(name)["extra_data"]["final"], true) << name;
  const ProgramOutcome half = run_program(words, Output::kCaptured, 580.0);
  EXPECT_EQ(half.code, 2) << half.printed;
  // the first of them that it tries
  EXPECT_TRUE(says(half, "sandbox_init: 1: half")) << half.printed;
}

}  // namespace
}  // namespace tumble::grading
