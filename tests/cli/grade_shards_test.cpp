// A class graded in shards, each as if on another machine, and then taken over.
#include "tests/cli/grading_fixture.h"

namespace tumble::grading {
namespace {

class Shards : public Grading {
 protected:
  Shards() {
    put("ann/a1_impulse.cpp", text_of(kStub));
    for (const char* name : {"bob", "cem", "dee"})  // seconds less than what compiles
      put(std::string(name) + "/a1_impulse.cpp", std::string("int ") + name + " = ;\n");
    put("eve/notes.txt", "I was ill");
  }
  ProgramOutcome shard(const std::string& words) const {
    return grade("out", {"--no-media", "--jobs", "1", "--shard", words});
  }
};

TEST_F(Shards, TogetherGiveTheBytesOfALocalRun) {
  const ProgramOutcome second = shard("2/2");
  EXPECT_EQ(second.code, 0) << second.printed;
  EXPECT_TRUE(says(second, "shard 2/2: 2 submissions")) << second.printed;
  EXPECT_FALSE(fs::exists(root / "out/gradebook.csv")) << "a part has no gradebook";
  EXPECT_EQ(shard("1/2").code, 1) << "somebody's file was not found";
  const ProgramOutcome whole = grade("out");
  EXPECT_FALSE(says(whole, "unchanged since")) << whole.printed;
  EXPECT_TRUE(says(whole, "[5/5]")) << "nothing was left to do: " << whole.printed;
  EXPECT_FALSE(says(whole, "[4/5]")) << "something was graded again: " << whole.printed;
  EXPECT_FALSE(fs::exists(root / "out/.shards"));
  grade("local");
  EXPECT_EQ(files("out"), files("local"));
}

TEST_F(Shards, WhatAShardDidNotFinishIsGradedByTheWhole) {
  shard("1/2");
  const ProgramOutcome whole = grade("out");
  EXPECT_TRUE(says(whole, "[3/5]")) << "three were finished: " << whole.printed;
  grade("local");
  EXPECT_EQ(files("out"), files("local"));
}

// As on machines that cannot draw: the verdicts are there, and grading a class again on one machine
// takes a night.
TEST_F(OtherRubric, VerdictsOfAShardWhoseStageFailedAreTakenOverWithTheFault) {
  put("ann/a1_impulse.cpp", text_of(kStub));
  write_whole(course / "solutions_private/a1_impulse/causes.json", "{\"slips\": [");
  const ProgramOutcome part = grade("out", {"--no-media", "--shard", "1/2"});
  ASSERT_EQ(part.code, 3) << part.printed;
  const ProgramOutcome whole = grade("out");
  EXPECT_EQ(whole.code, 3) << whole.printed;
  EXPECT_TRUE(says(whole, "what to mend first")) << whole.printed;
  EXPECT_FALSE(says(whole, "[1/1] ann")) << "its verdicts were made again: " << whole.printed;
  EXPECT_NE(text_of(root / "out/gradebook.csv").find("\nann,,ann,,0\n"), std::string::npos);
  const ProgramOutcome next = grade("out");
  EXPECT_TRUE(says(next, "[1/1] ann")) << "the stage is not made again: " << next.printed;
  grade("local");
  EXPECT_EQ(ledger().size(), 1u);
  EXPECT_EQ(results("ann"), results("ann", "local"));
}

TEST_F(Shards, AShardStartedAgainGoesOn) {
  shard("1/2");
  const ProgramOutcome again = shard("1/2");
  EXPECT_TRUE(says(again, "unchanged since the last run")) << again.printed;
}

TEST_F(Shards, ChangesSinceTheResultBeforeAreTold) {
  grade("out");
  put("cem/a1_impulse.cpp", text_of(kStub) + "// compiles now\n");
  const ProgramOutcome part = shard("1/2");
  EXPECT_TRUE(says(part, "(unchanged since the last run)")) << part.printed;
  const ProgramOutcome whole = grade("out");
  EXPECT_EQ(results("cem")["extra_data"]["state"], "judged");
  EXPECT_TRUE(says(whole, "the submission changed")) << whole.printed;
}

TEST_F(Shards, AForgedResultIsNotTakenOver) {
  shard("1/2");
  const fs::path forged = root / "out/.shards/1-of-2/ann/results.json";
  ASSERT_TRUE(fs::exists(forged));
  write_whole(forged, "{\"score\": 100}");
  const ProgramOutcome whole = grade("out");
  EXPECT_TRUE(says(whole, "ann: the earlier result is not reused")) << whole.printed;
  EXPECT_EQ(results("ann")["score"], 0.0);
}

TEST_F(Shards, ForeignFilesAmongThemStay) {
  shard("1/2");
  write_whole(root / "out/.shards/1-of-2/notes.txt", "mine");
  write_whole(root / "out/.shards/more.txt", "mine");
  grade("out");
  EXPECT_EQ(text_of(root / "out/.shards/1-of-2/notes.txt"), "mine");
  EXPECT_EQ(text_of(root / "out/.shards/more.txt"), "mine");
}

TEST_F(Shards, WordsThatMeanNothingAreRefused) {
  for (const char* words : {"0/2", "3/2", "1", "a/b", "1/0", "-1/2"}) {
    const ProgramOutcome refused = shard(words);
    EXPECT_EQ(refused.code, 2) << words;
    EXPECT_TRUE(says(refused, "--shard")) << refused.printed;
  }
  EXPECT_EQ(grade("out", {"--shards", "3"}).code, 2);
  EXPECT_EQ(grade("out", {"--on", "slurm", "--hosts", "a"}).code, 2);
  EXPECT_EQ(grade("out", {"--on", "cloud"}).code, 2);
  EXPECT_FALSE(fs::exists(root / "out/gradebook.csv"));
}

TEST_F(Shards, GnuParallelGivesTheBytesOfALocalRun) {
  if (run_program({"parallel", "--version"}, Output::kDropped).code != 0)
    GTEST_SKIP() << "GNU parallel is not here: apt-get install parallel";
  const ProgramOutcome whole = grade("out", {"--no-media", "--on", "parallel", "--shards", "3"});
  EXPECT_EQ(whole.code, 1) << whole.printed;
  EXPECT_FALSE(fs::exists(root / "out/.shards")) << whole.printed;
  EXPECT_FALSE(says(whole, "did not come to")) << whole.printed;
  grade("local");
  EXPECT_EQ(files("out"), files("local"));
}

// Ended before any shard: by a signal, or because nothing runs them here.
TEST_F(Shards, AGradingThatEndsBeforeTheyDoKeepsItsPolicy) {
  write_whole(root / "roster.csv", "name,id\nann,7\n");
  write_whole(root / "policy.json",
              R"({"due": {"a1": "2026-10-12T23:59:00+02:00"}, "roster": "roster.csv"})");
  const std::string policy = (root / "policy.json").string();
  const char* const found = std::getenv("PATH");
  const std::string path = found ? found : "";
  const auto without_programs = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"--no-media", "--on", "parallel", "--shards", "2"});
    ::setenv("PATH", (root / "no programs").c_str(), 1);
    const ProgramOutcome ended = grade("out", words);
    ::setenv("PATH", path.c_str(), 1);
    EXPECT_EQ(ended.code, 2) << ended.printed;
    EXPECT_FALSE(fs::exists(root / "out/gradebook.csv"));
    const ProgramOutcome forgotten = grade("out");
    EXPECT_EQ(forgotten.code, 2) << "the policy was dropped: " << forgotten.printed;
    EXPECT_TRUE(says(forgotten, "--policy " + policy)) << forgotten.printed;
  };
  without_programs({"--policy", policy});
  write_whole(root / "out/.tumble-grade.json", "{");
  without_programs({"--policy", policy, "--mend-list"});
}

TEST_F(Shards, AMachineThatSeesNoCourseIsNamed) {
  if (run_program({"parallel", "--version"}, Output::kDropped).code != 0)
    GTEST_SKIP() << "GNU parallel is not here: apt-get install parallel";
  ::setenv("TUMBLE_GRADER_KEY", "/proc/no/such/folder/key", 1);
  const ProgramOutcome refused = grade("out", {"--no-media", "--on", "parallel", "--shards", "2"});
  EXPECT_EQ(refused.code, 2) << refused.printed;
  EXPECT_TRUE(says(refused, "no shard finished a submission")) << refused.printed;
  EXPECT_TRUE(says(refused, "there is no /proc/no/such/folder/key")) << refused.printed;
}

}  // namespace
}  // namespace tumble::grading
