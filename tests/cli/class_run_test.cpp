// A class overnight: the same bytes at any number of jobs, nothing lost to kills, nobody lowered
// without a word.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <set>

#include "tests/support/places.h"
#include <fmt/format.h>

#include "framework/core/random.h"
#include "framework/grading/grades/ledger.h"
#include "tests/cli/busy_loops.h"
#include "tests/cli/grading_fixture.h"
#include "tests/support/whole.h"

namespace tumble::grading {
namespace {

// The reference with the impulse's sign lost: some tests are right and some are wrong.
std::string with_wrong_sign() {
  std::string text = text_of(kReference);
  const std::string right = "return -(1.0 + restitution)";
  const auto at = text.rfind(right);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, right.size(), "return (1.0 + restitution)");
}

std::string files_that_differ(const std::map<std::string, std::string>& a,
                              const std::map<std::string, std::string>& b) {
  std::string names;
  for (const auto& [file, text] : a)
    if (!b.contains(file) || b.at(file) != text) names += file + ' ';
  for (const auto& [file, text] : b)
    if (!a.contains(file)) names += file + ' ';
  return names;
}

TEST_F(Grading, AnyNumberOfJobsGivesTheSameBytes) {
  put("ada/a1_impulse.cpp", text_of(kReference));
  put("blaise/a1_impulse.cpp", with_wrong_sign());
  put("carl/a1_impulse.cpp", text_of(kStub));
  put("dora/a1_impulse.cpp", "int x = ;\n");
  const ProgramOutcome one = grade("one", {"--no-media", "--jobs", "1"});
  ASSERT_EQ(one.code, 0) << one.printed;
  ASSERT_EQ(grade("two", {"--no-media", "--jobs", "2"}).code, 0);
  EXPECT_EQ(files_that_differ(files("one"), files("two")), "");
  // Nothing is graded now: what the pages of the class say comes from the records alone.
  const ProgramOutcome again = grade("two");
  EXPECT_TRUE(says(again, "[4/4]") && !says(again, "[3/4]")) << again.printed;
  EXPECT_EQ(files_that_differ(files("one"), files("two")), "");
  EXPECT_NE(files("two").at("class.html").find("blaise"), std::string::npos);
}

// A course whose assignment has one scene, that in which costs are measured: its pictures take
// seconds.
class OneScene : public OtherRubric {
 protected:
  OneScene() {
    fs::create_directory_symlink(fs::path(test::source_dir()) / "models", course / "models");
    std::vector<fs::path> others;
    for (const auto& entry : fs::directory_iterator(scene.parent_path()))
      if (entry.path() != scene) others.push_back(entry.path());
    for (const fs::path& other : others) fs::remove(other);
  }
  const fs::path scene = course / "assignments/a1_impulse/scenes/collide_off_centre_e05.json";
};

TEST_F(OneScene, HasTheSameBytesInResultsPagesPicturesAndVideosBesideAnyLoad) {
  TUMBLE_ONLY_WHOLE();  // without pictures: Grading.AnyNumberOfJobs..., Grading.BusyLoops...
  put("blaise/a1_impulse.cpp", with_wrong_sign());
  put("carl/a1_impulse.cpp", text_of(kStub));
  const ProgramOutcome one = grade("one", {"--jobs", "1"});
  ASSERT_EQ(one.code, 0) << one.printed;
  {
    const BusyLoops loops(2);
    ASSERT_EQ(grade("two", {"--jobs", "2"}).code, 0);
  }
  EXPECT_EQ(files_that_differ(files("one"), files("two")), "");
  std::map<std::string, std::string> example;  // of each kind of file
  for (const auto& [file, text] : files("one")) example[fs::path(file).extension()] = file;
  for (const char* kind : {".html", ".json", ".jsonl", ".csv", ".png", ".mp4"}) {
    ASSERT_TRUE(example.contains(kind)) << kind;
    // the comparison sees a byte of any of them
    auto changed = files("two");
    ++changed[example[kind]].back();
    EXPECT_EQ(files_that_differ(files("one"), changed), example[kind] + ' ');
  }
}

TEST_F(OtherRubric, ABrokenFileOfCausesTakesNoVerdict) {
  put("carl/a1_impulse.cpp", text_of(kStub));
  const fs::path causes = course / "solutions_private/a1_impulse/causes.json";
  write_whole(causes, "{\"slips\": [");
  const ProgramOutcome broken = grade("out");
  EXPECT_EQ(broken.code, 3) << broken.printed;
  EXPECT_TRUE(says(broken, "what to mend first")) << broken.printed;
  EXPECT_EQ(results("carl")["extra_data"]["state"], "judged");
  EXPECT_EQ(results("carl")["score"], 0.0);
  EXPECT_NE(text_of(root / "out/gradebook.csv").find("\ncarl,,carl,,0\n"), std::string::npos);
  EXPECT_NE(text_of(root / "out/carl/index.html").find("causes.json"), std::string::npos);
  EXPECT_NE(text_of(root / "out/carl/student.html").find("what to mend first"), std::string::npos);
  EXPECT_EQ(text_of(root / "out/carl/student.html").find("causes.json"), std::string::npos);
  fs::remove(causes);
  EXPECT_EQ(grade("out").code, 0);
  EXPECT_EQ(text_of(root / "out/carl/index.html").find("the grader failed"), std::string::npos);
}

// As where ffmpeg was not there yet: nothing in the key of a result differs between the two runs.
TEST_F(OneScene, PicturesThatCannotBeMadeTakeNoVerdictAndAreMadeNextTime) {
  if (run_program({"ffmpeg", "-version"}, Output::kDropped).code != 0)
    GTEST_SKIP() << "ffmpeg is not here: apt-get install ffmpeg";
  put("blaise/a1_impulse.cpp", with_wrong_sign());
  const std::vector<std::string> words = {"--jobs", "1", "--code-in-pages", "none"};
  const char* const found = std::getenv("PATH");
  const std::string path = found ? found : "";
  ::setenv("PATH", (root / "no programs").c_str(), 1);
  const ProgramOutcome broken = grade("out", words);
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(broken.code, 3) << broken.printed;
  EXPECT_TRUE(says(broken, "the pictures")) << broken.printed;
  EXPECT_EQ(results("blaise")["extra_data"]["final"], true);
  EXPECT_GT(results("blaise")["score"].get<double>(), 0.0);
  EXPECT_FALSE(fs::exists(root / "out/blaise/media")) << "half of the pictures";
  const ProgramOutcome again = grade("out", words);
  EXPECT_EQ(again.code, 0) << again.printed;
  EXPECT_TRUE(says(again, "[1/1] blaise")) << "a result without its pictures is taken over";
  EXPECT_TRUE(fs::exists(root / "out/blaise/media/collide_off_centre_e05.mp4"));
}

// Without pictures a page has no code either: the pictures that are kept do not make it whole.
TEST_F(OneScene, ARunWithoutPicturesLeavesThePageToBeMadeWholeAgain) {
  put("carl/a1_impulse.cpp", text_of(kStub));
  const fs::path causes = course / "solutions_private/a1_impulse/causes.json";
  write_whole(causes, "{\"slips\": [");
  EXPECT_EQ(grade("out", {"--jobs", "1"}).code, 3);
  fs::remove(causes);
  const ProgramOutcome without = grade("out");
  EXPECT_EQ(without.code, 0) << without.printed;
  EXPECT_TRUE(says(without, "[1/1] carl")) << without.printed;
  EXPECT_FALSE(says(grade("out"), "[1/1] carl")) << "without pictures nothing is missing";
  const ProgramOutcome with = grade("out", {"--jobs", "1"});
  EXPECT_EQ(with.code, 0) << with.printed;
  EXPECT_TRUE(says(with, "[1/1] carl")) << "a page without its code is taken over";
  EXPECT_NE(text_of(root / "out/carl/index.html").find("id=\"try\""), std::string::npos);
}

void kill_children_of(pid_t parent) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string stat = text_of(entry.path() / "stat");
    const auto end = stat.rfind(')');  // of the name: then the state, then the parent
    if (end != std::string::npos && end + 4 < stat.size() &&
        std::atoi(stat.c_str() + end + 4) == parent)
      ::kill(std::atoi(name.c_str()), SIGKILL);
  }
}

// As where a picture takes more memory than there is. The scene is so long that its run and its
// video take minutes: the process that is killed is at them.
TEST_F(OneScene, AProcessThatDiesBehindTheVerdictsLeavesThem) {
  put("blaise/a1_impulse.cpp", with_wrong_sign());
  auto json = nlohmann::ordered_json::parse(text_of(scene));
  json["duration_s"] = 1000;
  write_whole(scene, json.dump(1));
  const pid_t child = start_words(words_for("out", {"--jobs", "1"}));
  const fs::path verdicts = root / "out/.making-blaise/.verdicts/blaise/record.json";
  int status = 0;
  while (!fs::exists(verdicts) && ::waitpid(child, &status, WNOHANG) == 0) ::usleep(2'000);
  ASSERT_TRUE(fs::exists(verdicts)) << "the grading ended before its verdicts, with " << status;
  kill_children_of(child);
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 3) << status;
  EXPECT_EQ(results("blaise")["extra_data"]["state"], "judged");
  EXPECT_GT(results("blaise")["score"].get<double>(), 0.0);
  EXPECT_NE(text_of(root / "out/blaise/index.html").find("signal 9"), std::string::npos);
  EXPECT_FALSE(fs::exists(root / "out/.making-blaise"));
}

class Overnight : public Grading {
 protected:
  pid_t start(const std::string& out) const {
    return start_words(words_for(out, {"--no-media", "--jobs", "2"}));
  }
};

TEST_F(Overnight, KillsLoseNothingAndLeaveTheBytesOfARunWithoutThem) {
  const int submissions = test::is_whole() ? 20 : 8, kills = test::is_whole() ? 5 : 2;
  for (int i = 0; i < submissions; ++i) {
    const std::string mark = "// student " + std::to_string(i) + "\n";
    put("s" + std::to_string(i) + "/a1_impulse.cpp",
        (i % 4 == 0 ? text_of(kStub) : "int x = ;\n") + mark);
  }
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(grade("calm").code, 0);
  const double whole_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  Random random(20);
  for (int kill = 0; kill < kills; ++kill) {
    const pid_t child = start("out");
    ::usleep(static_cast<useconds_t>(1e6 * whole_s * random.between(0.05, 0.4)));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  const ProgramOutcome last = grade("out");
  EXPECT_EQ(last.code, 0) << last.printed;
  EXPECT_EQ(files_that_differ(files("calm"), files("out")), "");
  const ProgramOutcome check = tumble({"ledger", "verify", (root / "out").string()});
  EXPECT_EQ(check.code, 0) << check.printed;
  EXPECT_TRUE(says(check, fmt::format("{0} entries of {0} submissions fit together", submissions)))
      << check.printed;
}

// Rubrics whose points were moved from a test that the submission passes to one that it fails.
class Lowering : public OtherRubric {
 protected:
  Lowering() {
    put("blaise/a1_impulse.cpp", with_wrong_sign());
    put("carl/a1_impulse.cpp", text_of(kStub));
    EXPECT_EQ(grade("out").code, 0);
    before = results("blaise")["score"];
    std::map<std::string, bool> is_right;
    const auto blaise = results("blaise");
    for (const auto& test : blaise["tests"])
      is_right[test["extra_data"]["test"]] = test["status"] == "passed";
    auto json = read();
    bool taken = false, given = false;
    for (auto& test : json["tests"]) {
      bool& moved = is_right[test["test"]] ? taken : given;
      if (moved) continue;
      moved = true;
      test["points"] = test["points"].get<double>() + (&moved == &taken ? -0.5 : 0.5);
    }
    write(json);
  }
  ProgramOutcome regrade(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"regrade", "a1", (root / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    return tumble(words);
  }
  double before = 0.0;
};

TEST_F(Grading, APolicyIsNotDroppedBecauseAWordWasForgotten) {
  put("ada/a1_impulse.cpp", text_of(kStub));
  write_whole(root / "roster.csv", "name,id\nada,7\n");
  write_whole(root / "policy.json",
              R"({"due": {"a1": "2026-10-12T23:59:00+02:00"}, "roster": "roster.csv"})");
  const std::string policy = (root / "policy.json").string();
  const ProgramOutcome first = grade("out", {"--no-media", "--policy", policy});
  ASSERT_TRUE(fs::exists(root / "out/gradebook.csv")) << first.printed;
  const std::string gradebook = text_of(root / "out/gradebook.csv");

  const ProgramOutcome forgotten = grade("out");
  EXPECT_EQ(forgotten.code, 2) << forgotten.printed;
  EXPECT_TRUE(says(forgotten, "--no-policy")) << forgotten.printed;
  EXPECT_EQ(text_of(root / "out/gradebook.csv"), gradebook);

  EXPECT_NE(grade("out", {"--no-media", "--no-policy"}).code, 2);
  EXPECT_NE(text_of(root / "out/gradebook.csv"), gradebook);
  EXPECT_NE(grade("out").code, 2) << "the last grading had none";

  write_whole(root / "out/.tumble-grade.json", "{\"assignment\": ");
  EXPECT_TRUE(says(grade("out"), "--mend-list"));
  const ProgramOutcome unsaid = grade("out", {"--no-media", "--mend-list"});
  EXPECT_EQ(unsaid.code, 2) << "nobody knows whether there was a policy";
  EXPECT_TRUE(says(unsaid, "--no-policy")) << unsaid.printed;
  EXPECT_NE(grade("out", {"--no-media", "--mend-list", "--policy", policy}).code, 2);
  EXPECT_EQ(text_of(root / "out/gradebook.csv"), gradebook);
}

TEST_F(OtherRubric, APageOfTheClassThatFailsHidesNobodyWhoHasNoScore) {
  fs::create_directories(course / "handouts/a1_impulse.md");  // of a folder no page is made
  put("ada/a1_impulse.cpp", "int x = ;\n");
  write_whole(root / "roster.csv", "name,id\nada,7\nbo,8\n");
  write_whole(root / "policy.json",
              R"({"due": {"a1": "2026-10-12T23:59:00+02:00"}, "roster": "roster.csv"})");
  const ProgramOutcome graded =
      grade("out", {"--no-media", "--policy", (root / "policy.json").string()});
  EXPECT_EQ(graded.code, 3) << graded.printed;
  EXPECT_TRUE(says(graded, "the grader failed at handout.html")) << graded.printed;
  EXPECT_TRUE(says(graded, "look: bo: nothing was handed in")) << graded.printed;
}

TEST_F(Grading, EveryStudentsPageIsOneCommandAndOutsideOfTheResults) {
  put("quentin/a1_impulse.cpp", "int x = ;\n");
  put("xaver/a1_impulse.cpp", "int y = ;\n");
  ASSERT_NE(grade("out").code, 2);
  const ProgramOutcome all =
      tumble({"class", "page", (root / "out").string(), "--to", (root / "for_students").string()});
  EXPECT_EQ(all.code, 0) << all.printed;
  EXPECT_TRUE(says(all, "2 pages")) << all.printed;
  for (const char* name : {"quentin", "xaver"}) {
    const std::string page = text_of(root / "for_students" / name / "index.html");
    for (const char* other : {"quentin", "xaver"})
      EXPECT_EQ(page.find(other) != std::string::npos, std::string(other) == name)
          << other << " on the page of " << name;
  }
  EXPECT_EQ(
      tumble({"class", "page", (root / "out").string(), "--to", (root / "out/in").string()}).code,
      2);
}

TEST_F(Lowering, NeedsAYes) {
  const ProgramOutcome again = grade("out");
  EXPECT_TRUE(says(again, "not lowered: blaise")) << again.printed;
  EXPECT_TRUE(says(again, "tumble regrade a1")) << again.printed;
  EXPECT_EQ(results("blaise")["score"], before);

  const ProgramOutcome unasked = regrade();
  EXPECT_EQ(unasked.code, 1) << unasked.printed;
  EXPECT_TRUE(says(unasked, "One score would be lower")) << unasked.printed;
  EXPECT_TRUE(says(unasked, ": the rubric changed")) << unasked.printed;
  EXPECT_EQ(results("blaise")["score"], before);

  const ProgramOutcome agreed = regrade({"--yes"});
  EXPECT_EQ(agreed.code, 0) << agreed.printed;
  EXPECT_EQ(results("blaise")["score"], before - 0.5);
  EXPECT_EQ(ledger().back()["name"], "blaise");
  EXPECT_NE(ledger().back()["change"].get<std::string>().find("the rubric changed"),
            std::string::npos);
  EXPECT_EQ(tumble({"ledger", "verify", (root / "out").string()}).code, 0);
}

TEST_F(Lowering, NeedsAYesAlsoWhereTheResultIsLostOrItsKey) {
  const std::string held = text_of(root / "out/blaise/results.json");
  fs::remove(root / "grader.key");
  const ProgramOutcome without_key = grade("out");
  EXPECT_EQ(without_key.code, 1) << without_key.printed;
  EXPECT_TRUE(says(without_key, "not lowered: blaise")) << without_key.printed;
  EXPECT_TRUE(says(without_key, "the ledger holds")) << without_key.printed;
  EXPECT_TRUE(says(without_key, "tumble regrade a1")) << without_key.printed;
  EXPECT_EQ(text_of(root / "out/blaise/results.json"), held) << "it was touched without a yes";
  const std::string gradebook = text_of(root / "out/gradebook.csv");
  EXPECT_NE(gradebook.find("\nblaise,,blaise,,\n"), std::string::npos) << gradebook;
  EXPECT_EQ(tumble({"ledger", "verify", (root / "out").string()}).code, 0);

  fs::remove_all(root / "out/blaise");
  EXPECT_EQ(regrade().code, 1);
  EXPECT_NE(text_of(root / "out/blaise/index.html").find("This result is missing"),
            std::string::npos);
  EXPECT_EQ(text_of(root / "out/blaise/student.html").find("the ledger's"), std::string::npos);

  const std::size_t entries = ledger().size();
  const ProgramOutcome only_carl = regrade({"--only", "carl"});
  EXPECT_EQ(only_carl.code, 1) << "what is held is no fault of the grader: " << only_carl.printed;
  EXPECT_TRUE(says(only_carl, "blaise: not lowered")) << only_carl.printed;
  EXPECT_EQ(ledger().size(), entries) << "what is held became a result";
  EXPECT_EQ(text_of(root / "out/gradebook.csv"), gradebook);

  const ProgramOutcome agreed = regrade({"--yes"});
  EXPECT_EQ(agreed.code, 0) << agreed.printed;
  EXPECT_EQ(results("blaise")["score"], before - 0.5);
  EXPECT_NE(ledger().back()["change"].get<std::string>().find("the ledger holds"),
            std::string::npos);
  EXPECT_EQ(tumble({"ledger", "verify", (root / "out").string()}).code, 0);
}

// As where a folder of results was put back from an older copy, with its valid record.
TEST_F(Grading, AResultThatIsOlderThanTheLedgerDoesNotLowerIt) {
  put("ada/a1_impulse.cpp", "int x = ;\n");
  ASSERT_EQ(grade("out").code, 0);
  {
    const fs::path file = root / "out" / kLedgerFile;
    LedgerEntry later = read_ledger(file).entries.back();
    later.score = 10.0;
    Ledger(file).append(later);
  }
  const ProgramOutcome again = grade("out");
  EXPECT_EQ(again.code, 1) << again.printed;
  EXPECT_TRUE(says(again, "not lowered: ada (10 -> 0: ")) << again.printed;
  EXPECT_EQ(ledger().back()["score"], 10.0);
  const ProgramOutcome agreed = tumble({"regrade", "a1", (root / "out").string(), "--yes"});
  EXPECT_EQ(agreed.code, 0) << agreed.printed;
  EXPECT_EQ(ledger().back()["score"], 0.0);
  EXPECT_EQ(grade("out").code, 0) << "what was agreed to is asked again";
}

TEST_F(Overnight, OneStudentAgainLeavesTheOthersAndChangesNothing) {
  TUMBLE_ONLY_WHOLE();
  put("ada/a1_impulse.cpp", text_of(kStub));
  put("blaise/a1_impulse.cpp", "int x = ;\n");
  ASSERT_EQ(grade("out").code, 0);
  const auto before = files("out");
  const ProgramOutcome again =
      tumble({"regrade", "a1", (root / "out").string(), "--only", "ada", "--again"});
  EXPECT_EQ(again.code, 0) << again.printed;
  EXPECT_TRUE(says(again, "[2/2] ada")) << again.printed;
  EXPECT_FALSE(says(again, "] blaise")) << again.printed;
  EXPECT_EQ(files_that_differ(before, files("out")), "");
  const ProgramOutcome unknown =
      tumble({"regrade", "a1", (root / "out").string(), "--only", "adda"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(says(unknown, "Did you mean 'ada'?")) << unknown.printed;
}

}  // namespace
}  // namespace tumble::grading
