// Input and output of grading: odd folders, hostile names, results for Gradescope and Canvas,
// records.
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/grades/stages.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/core/run_program.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

class Folder : public ::testing::Test {
 protected:
  Folder() {
    kind.id = "a9";
    kind.folder = "a9_thing";
    kind.title = "Thing";
  }
  void put(const std::string& file, const std::string& text = "int x;\n") const {
    write_whole(root / file, text);
  }
  Submission only() const {
    const auto all = find_submissions(root, kind).all;
    EXPECT_EQ(all.size(), 1u);
    return all.at(0);
  }
  PrivateFolder scratch_;
  fs::path root = scratch_.path();
  modules::ModuleKind kind;
};
using FindSubmissions = Folder;

TEST_F(FindSubmissions, AreSortedByNameAndFilesBesideThemAreNone) {
  put("zoe/a9_thing.cpp");
  put("adam/a9_thing.cpp");
  put("roster.csv");
  put(".git/a9_thing.cpp");
  const auto all = find_submissions(root, kind).all;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "adam");
  EXPECT_EQ(all[1].name, "zoe");
  EXPECT_EQ(all[0].source, root / "adam/a9_thing.cpp");
}

TEST_F(FindSubmissions, NothingIsPassedOverInSilence) {
  put("adam/a9_thing.cpp");
  put(".zoe/a9_thing.cpp");
  put(".git/config");
  put("roster.csv");
  put("__MACOSX/._adam");
  const FoundSubmissions found = find_submissions(root, kind);
  ASSERT_EQ(found.all.size(), 2u);
  EXPECT_EQ(found.all[0].name, ".zoe");  // a dot before a name hides no submission
  EXPECT_EQ(found.all[0].source, root / ".zoe/a9_thing.cpp");
  EXPECT_EQ(found.passed_over,
            (std::vector<std::string>{".git (a folder of a tool)",
                                      "roster.csv (neither a folder nor a source)"}));
}

TEST_F(FindSubmissions, FilesOfCanvasAreSubmissionsWithTheStudentsNumber) {
  put("doejane_12345_678_a9_thing.cpp", "int a;\n");
  put("roejohn_LATE_222_679_a9_thing-1.cpp", "int b;\n");
  put("poeann_333_680_report.pdf");
  put("moejo_444_681_work.zip");
  const auto all = find_submissions(root, kind).all;
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].name, "doejane_12345");
  EXPECT_EQ(all[0].student_id, "12345");
  EXPECT_EQ(all[0].source, root / "doejane_12345_678_a9_thing.cpp");
  EXPECT_TRUE(all[0].notes.empty()) << all[0].notes[0];
  EXPECT_NE(all[1].problem.find("not a whole zip archive"), std::string::npos) << all[1].problem;
  EXPECT_NE(all[2].problem.find("Holds no a9_thing.cpp"), std::string::npos) << all[2].problem;
  EXPECT_EQ(all[3].name, "roejohn_222");
  EXPECT_EQ(all[3].source, root / "roejohn_LATE_222_679_a9_thing-1.cpp");
}

TEST_F(FindSubmissions, ALooseFileAndALooseArchiveAreSubmissionsToo) {
  put("alice.cpp");
  put("bob.zip");
  const auto all = find_submissions(root, kind).all;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].source, root / "alice.cpp");
  EXPECT_NE(all[1].problem.find("not a whole zip archive"), std::string::npos) << all[1].problem;
}

TEST_F(FindSubmissions, AShardLooksIntoItsOwnAndKnowsTheNamesOfAll) {
  for (const char* name : {"d", "b", "e", "a"}) put(name + std::string("/a9_thing.cpp"));
  put("c_1_2_a9_thing.cpp", "int c;\n");
  const auto whole = find_submissions(root, kind).all;
  ASSERT_EQ(whole.size(), 5u);
  for (const int number : {1, 2}) {
    const Shard shard{number, 2};
    const auto part = find_submissions(root, kind, shard).all;
    ASSERT_EQ(part.size(), whole.size());
    for (std::size_t i = 0; i < whole.size(); ++i) {
      EXPECT_EQ(part[i].name, whole[i].name);
      EXPECT_EQ(part[i].source, shard.holds(i) ? whole[i].source : fs::path()) << whole[i].name;
    }
  }
}

TEST_F(FindSubmissions, CopiesThatAreEqualByteForByteAreOneFile) {
  put("adam/a9_thing.cpp");
  put("adam/backup/a9_thing.cpp");
  EXPECT_EQ(only().source, root / "adam/a9_thing.cpp");
  EXPECT_NE(only().notes.at(0).find("byte for byte"), std::string::npos);
}

TEST_F(FindSubmissions, CapitalsDoNotHideAFile) {
  put("adam/A9_Thing.CPP");
  EXPECT_EQ(only().source, root / "adam/A9_Thing.CPP");
  EXPECT_NE(only().notes.at(0).find("A9_Thing.CPP"), std::string::npos);
}

TEST_F(FindSubmissions, AHeaderBesideTheFileIsSaidNotToCount) {
  put("adam/a9_thing.cpp");
  put("adam/a9_thing.h", "#pragma once\n");
  EXPECT_EQ(only().source, root / "adam/a9_thing.cpp");
  EXPECT_NE(only().notes.at(0).find("a9_thing.h"), std::string::npos);
  EXPECT_NE(only().notes.at(0).find("course's own headers"), std::string::npos);
}

TEST_F(FindSubmissions, SourceMayLieDeeper) {
  put("adam/upload/src/a9_thing.cpp");
  EXPECT_EQ(only().source, root / "adam/upload/src/a9_thing.cpp");
}

TEST_F(FindSubmissions, AnOnlySourceOfAnotherNameIsTakenWithANote) {
  put("adam/solution.cpp");
  EXPECT_EQ(only().source, root / "adam/solution.cpp");
  EXPECT_NE(only().notes.at(0).find("solution.cpp"), std::string::npos);
}

TEST_F(FindSubmissions, TwoOfTheRightNameAreNotGuessedBetween) {
  put("adam/a9_thing.cpp");
  put("adam/old/a9_thing.cpp", "int other;\n");
  EXPECT_TRUE(only().source.empty());
  EXPECT_NE(only().problem.find("2 times"), std::string::npos) << only().problem;
}

TEST_F(FindSubmissions, NoSourceSaysWhatIsMissing) {
  put("adam/notes.txt");
  EXPECT_NE(only().problem.find("Holds no a9_thing.cpp"), std::string::npos) << only().problem;
}

TEST_F(FindSubmissions, AnArchiveOfAnotherKindIsToBeUnpacked) {
  put("adam/hw.tar.gz");
  EXPECT_NE(only().problem.find("Unpack"), std::string::npos) << only().problem;
}

TEST_F(FindSubmissions, LinksAreNotFollowed) {
  fs::create_directory(root / "adam");
  fs::create_symlink("/etc/passwd", root / "adam/a9_thing.cpp");
  EXPECT_TRUE(only().source.empty());
  EXPECT_NE(only().problem.find("symbolic link"), std::string::npos) << only().problem;
}

TEST_F(FindSubmissions, AFileWithASecondNameElsewhereIsNotTaken) {
  // As from an archive that root unpacked: the other name is a file that its author may not read,
  // and a compiler's message would show it.
  put("adam/a9_thing.cpp");
  fs::create_directory(root / "eve");
  fs::create_hard_link(root / "adam/a9_thing.cpp", root / "eve/a9_thing.cpp");
  fs::remove_all(root / "adam");
  EXPECT_FALSE(only().source.empty()) << "it has one name now";
  fs::create_hard_link(root / "eve/a9_thing.cpp", root / "eve/secret.txt");
  EXPECT_TRUE(only().source.empty());
  EXPECT_NE(only().problem.find("hard link"), std::string::npos) << only().problem;
}

TEST_F(FindSubmissions, AFolderThatIsALinkToItsParentEnds) {
  put("adam/a9_thing.cpp");
  fs::create_directory_symlink(root, root / "adam/again");
  EXPECT_EQ(only().source, root / "adam/a9_thing.cpp");
}

TEST_F(FindSubmissions, APipeIsNotWaitedFor) {
  fs::create_directory(root / "adam");
  ASSERT_EQ(::mkfifo((root / "adam/a9_thing.cpp").c_str(), 0600), 0);
  EXPECT_NE(only().problem.find("not an ordinary file"), std::string::npos) << only().problem;
}

TEST_F(FindSubmissions, HugeAndEmptySourcesAreRefused) {
  put("big/a9_thing.cpp", std::string(2 << 20, 'x'));
  put("none/a9_thing.cpp", "");
  const auto all = find_submissions(root, kind).all;
  EXPECT_NE(all.at(0).problem.find("2097152 bytes"), std::string::npos) << all[0].problem;
  EXPECT_NE(all.at(1).problem.find("empty"), std::string::npos) << all[1].problem;
}

TEST_F(FindSubmissions, AFolderThatCannotBeReadIsNamedWithWhatToDo) {
  put("adam/upload/a9_thing.cpp");
  fs::permissions(root / "adam/upload", fs::perms::none);
  fs::permissions(root, fs::perms::owner_all | fs::perms::group_all | fs::perms::others_all);
  const bool is_root = ::geteuid() == 0;  // root may read everything: drop its rights for a moment
  if (is_root) {
    ASSERT_EQ(::seteuid(65534), 0);
  }
  const Submission found = only();
  if (is_root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  fs::permissions(root / "adam/upload", fs::perms::owner_all);
  EXPECT_TRUE(found.source.empty());
  EXPECT_NE(found.problem.find("adam/upload cannot be read (Permission denied)"), std::string::npos)
      << found.problem;
  EXPECT_NE(found.problem.find("chmod -R u+rX '" + (root / "adam").string() + "'"),
            std::string::npos)
      << found.problem;
}

TEST_F(FindSubmissions, NoFolderIsAUserError) {
  EXPECT_THROW(find_submissions(root / "gone", kind), UserError);
}

TEST(FolderOf, PlainNamesStayAndOthersCannotLeaveTheFolder) {
  EXPECT_EQ(folder_of("alice_b-2.x"), "alice_b-2.x");
  // A name like one made by the grader is replaced, so that no submission takes another's folder.
  EXPECT_NE(folder_of(folder_of("a b")), folder_of("a b"));
  for (const std::string name :
       {"..", ".", "-rf", "a b", "<i>", "index.html", "a\nb", "\xff", "gr\u00fcn", ""}) {
    const std::string folder = folder_of(name);
    EXPECT_NE(folder, name);
    EXPECT_TRUE(folder.starts_with("_")) << folder;
    EXPECT_EQ(folder.find_first_of("/ <>\n"), std::string::npos) << folder;
  }
  EXPECT_NE(folder_of("a b"), folder_of("a_b"));
  EXPECT_NE(folder_of("a b"), folder_of("a\tb"));
}

Rubric two_items() {
  return {"a9",
          "Thing",
          {{"S.Open", 60.0, "basic", "Open one", false},
           {"S.Shut", 40.0, "advanced", "Shut one", true}}};
}

TestResult result(const std::string& test, Verdict verdict, const std::string& story = "") {
  TestResult r;
  r.test = test;
  r.verdict = verdict;
  r.story = story;
  return r;
}

Grade graded(const std::string& name, const Judgement& judgement) {
  Grade grade;
  grade.name = name;
  grade.folder = folder_of(name);
  grade.state = GradeState::kJudged;
  grade.tests = score_tests(two_items(), judgement);
  add_up(grade);
  return grade;
}

TEST(Scoring, ATestThatTheJudgeDidNotAnswerForIsAFaultAndEarnsNothing) {
  const Grade grade = graded("a", {{result("S.Open", Verdict::kRight)}, ""});
  EXPECT_EQ(grade.score, 60.0);
  EXPECT_EQ(grade.tests[1].result.verdict, Verdict::kGraderFault);
  EXPECT_FALSE(grade.is_final());
}

TEST(Scoring, OnlyRightEarns) {
  for (const Verdict v : {Verdict::kWrong, Verdict::kNotAttempted, Verdict::kCrashed,
                          Verdict::kOutOfResources, Verdict::kGraderFault})
    EXPECT_EQ(graded("a", {{result("S.Open", v), result("S.Shut", v)}, ""}).score, 0.0) << words(v);
}

TEST(Scoring, ATestThatNoRubricNamesEarnsNothing) {
  const Grade grade =
      graded("a", {{result("S.Open", Verdict::kRight), result("S.Shut", Verdict::kRight),
                    result("S.Extra", Verdict::kRight)},
                   ""});
  EXPECT_EQ(grade.score, 100.0);
  EXPECT_EQ(grade.tests.size(), 3u);
}

TEST(Gradescope, TestsCarryScoreAndWhoSeesThem) {
  const Grade grade = graded("a", {{result("S.Open", Verdict::kRight),
                                    result("S.Shut", Verdict::kWrong, "off by \xff <b>")},
                                   ""});
  const auto json = nlohmann::json::parse(gradescope_json(grade));
  EXPECT_EQ(json.at("score"), 60.0);
  ASSERT_EQ(json.at("tests").size(), 2u);
  EXPECT_EQ(json["tests"][0].at("visibility"), "visible");
  EXPECT_EQ(json["tests"][0].at("status"), "passed");
  EXPECT_EQ(json["tests"][1].at("visibility"), "hidden");
  EXPECT_EQ(json["tests"][1].at("score"), 0.0);
  EXPECT_EQ(json["tests"][1].at("max_score"), 40.0);
  EXPECT_EQ(json["tests"][1].at("output"), "wrong\noff by \\xFF <b>");
  EXPECT_FALSE(json.contains("execution_time"));  // equal runs give equal bytes
}

TEST(Gradebook, IsCanvasFormatAndAFaultIsNoScore) {
  const Judgement all = {{result("S.Open", Verdict::kRight), result("S.Shut", Verdict::kRight)},
                         ""};
  const std::string csv =
      gradebook_csv("Thing", {graded("alice", all), graded("bob", {{}, "the judge died"})});
  EXPECT_EQ(csv,
            "Student,ID,SIS Login ID,Section,Thing\n    Points "
            "Possible,,,,100\nalice,,alice,,100\nbob,,bob,,\n");
}

TEST(Gradebook, ANameIsNeverAFormulaNorASecondCell) {
  const std::string csv = gradebook_csv(
      "Thing", {graded("=HYPERLINK(\"x\")", {}), graded("a,b\nc", {}), graded("@x", {})});
  EXPECT_NE(csv.find("\n\"'=HYPERLINK(\"\"x\"\")\",,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\n\"a,b\\x0Ac\",,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\n'@x,,"), std::string::npos) << csv;
}

TEST(Gradebook, NeitherSpaceNorTabNorAWideSignHidesAFormula) {
  for (const std::string name : {" =cmd", "\t=1+1", "\r=1", "\uff1d1+1", "\uff0b1", "\uff0d1",
                                 "\uff20x", "\u3000=1", "\u200b=1", "+1", "-1", "\n@x"}) {
    const std::string csv = gradebook_csv("Thing", {graded(name, {})});
    std::string cell = csv.substr(csv.find("100\n") + 4);
    if (cell.starts_with('"')) cell.erase(0, 1);
    // Either marked as text, or starting with text of the grader.
    EXPECT_TRUE(cell.starts_with("'") || cell.starts_with("\\")) << csv;
    EXPECT_EQ(csv.find('\t'), std::string::npos);
  }
}

TEST(Gradebook, NamesThatAreNotUtf8StayApart) {
  const std::string csv = gradebook_csv(
      "Thing", {graded("ann\xff", {}), graded("ann\xfe", {}), graded("ann\\xFF", {})});
  EXPECT_NE(csv.find("\nann\\xFF,,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\nann\\xFE,,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\nann\\\\xFF,,"), std::string::npos) << csv;
}

TEST(PlainText, WhatHidesOrReordersIsWrittenOut) {
  EXPECT_EQ(plain_name("a\u202eb"), "a\\u{202E}b");
  EXPECT_EQ(plain_name("a\x1b[31mb\x07\x7f"), "a\\x1B[31mb\\x07\\x7F");
  EXPECT_EQ(plain_name("\u2066x\u2069\u200f\ufeff"), "\\u{2066}x\\u{2069}\\u{200F}\\u{FEFF}");
  EXPECT_EQ(plain_name(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(plain_text("line\n\ttab \x1b[31mred\x1b[0m \u202e C:\\x"),
            "line\n\ttab red \\u{202E} C:\\x");
  for (const std::string name :
       {"Zo\u00eb \u0141ukasz", "\u5f20\u4f1f", "O'Brien-Smith", "\u0645\u062d\u0645\u062f"})
    EXPECT_EQ(plain_name(name), name);
}

TEST(Gradebook, AFileThatWasNotFoundIsBlankAndNoZeroIsWritten) {
  Grade grade = graded("ann", {});
  grade.state = GradeState::kNothingToCompile;
  grade.tests = score_nothing(two_items(), Verdict::kNotAttempted, "nothing to compile");
  grade.student_id = "77";
  EXPECT_TRUE(grade.is_final());
  EXPECT_FALSE(grade.has_score());
  EXPECT_NE(gradebook_csv("Thing", {grade}).find("\nann,77,ann,,\n"), std::string::npos)
      << gradebook_csv("Thing", {grade});
  EXPECT_FALSE(nlohmann::json::parse(gradescope_json(grade)).contains("score"));
}

TEST(Grades, AMachineTooBusyIsNotFinalAndNoLostPoint) {
  const Grade grade = graded("ann", {{result("S.Open", Verdict::kRight),
                                      result("S.Shut", Verdict::kMachineBusy, "too busy")},
                                     ""});
  EXPECT_FALSE(grade.is_final());
  EXPECT_NE(summary_of(grade).find("not final: machine too busy"), std::string::npos)
      << summary_of(grade);
  EXPECT_EQ(exit_code({result("S.Shut", Verdict::kMachineBusy)}), ExitCode::kOurBug);
}

TEST(Stages, AFailureBehindTheVerdictsIsNotedAndTakesNothingAway) {
  Grade grade;
  grade.state = GradeState::kJudged;
  grade.score = 80.0;
  EXPECT_TRUE(run_stage(grade, "the costs", [] {}));
  EXPECT_TRUE(grade.notes.empty() && grade.faults.empty());
  EXPECT_FALSE(run_stage(grade, "the pictures", [] { throw std::runtime_error("/private: no"); }));
  EXPECT_TRUE(grade.has_score());
  EXPECT_EQ(grade.score, 80.0);
  ASSERT_EQ(grade.notes.size(), 1u);
  EXPECT_NE(grade.notes[0].find("the pictures"), std::string::npos) << grade.notes[0];
  EXPECT_EQ(grade.notes[0].find("/private"), std::string::npos) << "students read notes";
  EXPECT_EQ(grade.faults, std::vector<std::string>{"the pictures: /private: no"});
}

TEST(ShellWord, WhateverANameHoldsStaysOneWord) {
  for (const std::string name :
       {"plain", "two words", "it's", "$(touch x)", "`id`", "-rf", "a;b", "\"", "back\\slash",
        "line\nbreak", "\xff", "a\u202eb", "'; rm -rf /; '"}) {
    const std::string command = "printf %s " + shell_word(name);
    const ProgramOutcome outcome = run_program({"/bin/bash", "-c", command}, Output::kCaptured);
    EXPECT_EQ(outcome.printed, name) << command;
    EXPECT_EQ(command.find('\n'), std::string::npos) << "shown as one line: " << command;
  }
}

TEST(Gradescope, WhatASubmissionSaysIsShownPlain) {
  Grade grade = graded("x", {{result("S.Open", Verdict::kCrashed, "it said \x1b[2J\u202egnp\x01"),
                              result("S.Shut", Verdict::kRight)},
                             ""});
  grade.story = "a\u202eb";
  grade.notes = {"c\x07"};
  const auto json = nlohmann::json::parse(gradescope_json(grade));
  EXPECT_EQ(json["tests"][0].at("output"), "crashed\nit said \\u{202E}gnp\\x01");
  EXPECT_EQ(json.at("output"), "a\\u{202E}b\nnote: c\\x07");
}

TEST_F(Folder, PagesWriteOutWhatHidesInANameOrAStory) {
  Grade grade = graded(
      "an\u202en",
      {{result("S.Open", Verdict::kWrong, "s\u202et"), result("S.Shut", Verdict::kRight)}, ""});
  const std::string html = submission_page(kind, grade, "").html();
  EXPECT_NE(html.find("an\\u{202E}n"), std::string::npos);
  EXPECT_NE(html.find("s\\u{202E}t"), std::string::npos);
  EXPECT_NE(index_page(kind, {grade}).html().find("an\\u{202E}n"), std::string::npos);
}

// 24 slips in one sentence are not read.
TEST_F(Folder, APageListsTheSlipsOfOwnTestsForTheGraderOneByOne) {
  Grade grade = graded("ada", {{result("S.Open", Verdict::kRight)}, ""});
  grade.own_tests = {.is_there = true,
                     .score = 1.5,
                     .possible = 5,
                     .story = "2 tests",
                     .names = "slip 1 is sign, caught by Mine.A, Mine.B; slip 2 is <half>"};
  const std::string html = submission_page(kind, grade, "").html();
  EXPECT_NE(html.find("<li>slip 1 is sign, caught by Mine.A, Mine.B</li>"), std::string::npos)
      << html;
  EXPECT_NE(html.find("<li>slip 2 is &lt;half&gt;</li>"), std::string::npos);
  EXPECT_NE(html.find("href=\"#own-tests\""), std::string::npos);
  EXPECT_EQ(submission_page(kind, for_student(grade), "").html().find("slip 2"), std::string::npos);
}

TEST_F(Folder, PagesCountTheRightNumbersOfASceneInEnglish) {
  Grade grade = graded("ada", {{result("S.Open", Verdict::kRight)}, ""});
  grade.media = {{"s", "title", "about", "", "", "", true, {}}};
  engines::CheckResult right;
  right.passed = true;
  for (const auto& [checks, words] :
       {std::pair<std::size_t, const char*>{1, "Its number is right."},
        {2, "Both of its numbers are right."},
        {3, "All 3 of its numbers are right."}}) {
    grade.media[0].checks.assign(checks, right);
    EXPECT_NE(submission_page(kind, grade, "").html().find(words), std::string::npos) << checks;
  }
}

TEST_F(Folder, PagesDoNotBreakANumberNorPartItFromItsUnit) {
  Grade grade = graded("ada", {{result("S.Open", Verdict::kRight)}, ""});
  grade.media = {{"s", "title", "about", "", "", "", true, {}}};
  engines::CheckResult check;
  check.kind = "angular_momentum";
  check.value = 2e-13;
  check.threshold = 1e-9;
  check.unit = "kg m^2/s";
  check.passed = true;
  grade.media[0].checks = {check};
  const std::string html = submission_page(kind, grade, "").html(), unit = "\u00a0kg\u00a0m^2/s";
  EXPECT_NE(html.find("<span class=\"unbroken\">2e-13</span>" + unit +
                      ", allowed at most <span class=\"unbroken\">1e-9</span>" + unit),
            std::string::npos)
      << html;
}

TEST_F(Folder, PagesShowHostileNamesAndStoriesAsText) {
  const std::string evil = "<script>alert(1)</script>";
  Grade grade = graded(evil, {{result("S.Open", Verdict::kWrong, evil),
                               result("S.Shut", Verdict::kNotAttempted, evil)},
                              ""});
  grade.notes = {evil};
  grade.media = {{"s", evil, evil, "s.png", "s.mp4", evil, true, {}}};
  for (const std::string& html :
       {submission_page(kind, grade, evil).html(), index_page(kind, {grade}).html()}) {
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
  }
}

TEST(CompilerStory, AFailureOfTheCompilerItselfSaysWhatToDo) {
  const std::string story = compiler_story(
      "a9_thing.cpp:7:3: internal compiler error: in foo, at cp/bar.cc:1\nPlease submit a full bug "
      "report\n",
      "/elsewhere/a9_thing.cpp");
  EXPECT_NE(story.find("a9_thing.cpp:7:3: internal compiler error"), std::string::npos) << story;
  EXPECT_NE(story.find("your code may be right"), std::string::npos) << story;
}

TEST(CompilerStory, AHeaderOfOnesOwnIsSaidNotToBeThere) {
  const std::string story =
      compiler_story("a9_thing.cpp:1:10: fatal error: a9_thing.h: No such file or directory\n",
                     "/elsewhere/a9_thing.cpp");
  EXPECT_NE(story.find("Only this one file is compiled"), std::string::npos) << story;
}

TEST(CompilerStory, KeepsTheErrorsAndNoFolderOfThisMachine) {
  const std::string said =
      "In file included from /build/x/a9_thing.cpp:1:\n/build/x/a9_thing.cpp:3:7: warning: unused\n"
      "/build/x/a9_thing.cpp:12:5: error: expected ';'\n   12 | int x\n      |     "
      "^\n/build/x/a9_thing.cpp:13:1: note: here\n";
  EXPECT_EQ(compiler_story(said, "/elsewhere/a9_thing.cpp"),
            "a9_thing.cpp:12:5: error: expected ';'\n   12 | int x\n      |     ^\n");
}

}  // namespace
}  // namespace tumble::grading
