// The rules of a course: late days, penalties with a cap, attempts, groups, and nobody's silent 0.
#include <algorithm>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/random.h"
#include "framework/grading/grades/batch_work.h"
#include "framework/grading/grades/class_facts.h"
#include "framework/grading/grades/class_files.h"
#include "framework/grading/grades/class_page.h"
#include "framework/grading/grades/policy_file.h"

namespace tumble::grading::policy_test {
namespace {

constexpr std::int64_t kDay = 24 * 60 * 60;

Policy rules() {
  Policy policy;
  policy.due_s = 1000 * kDay;
  policy.grace_s = 900;
  policy.free_late_days = 1;
  return policy;
}

Grade scored(const std::string& name, double score, const std::string& id = "") {
  Grade grade;
  grade.name = grade.folder = name;
  grade.student_id = id;
  grade.state = GradeState::kJudged;
  grade.score = score;
  grade.possible = 100.0;
  return grade;
}

Standing only(const std::vector<Standing>& standings) {
  EXPECT_EQ(standings.size(), 1u);
  return standings.at(0);
}

TEST(LateDays, BeginWhenGraceEndsAndCountFromTheDueDate) {
  const Policy policy = rules();
  for (const auto& [late_s, days] : std::vector<std::pair<std::int64_t, int>>{
           {-5 * kDay, 0}, {0, 0}, {900, 0}, {901, 1}, {kDay, 1}, {kDay + 1, 2}, {7 * kDay, 7}})
    EXPECT_EQ(late_days(policy, policy.due_s + late_s), days) << late_s;
}

TEST(Penalty, IsTheShareADayUpToTheCapAfterFreeDays) {
  const Policy policy = rules();  // 10 % a day, at most 50 %
  EXPECT_EQ(penalty_percent(policy, 0, 0), 0.0);
  EXPECT_EQ(penalty_percent(policy, 1, 1), 0.0);
  EXPECT_EQ(penalty_percent(policy, 3, 1), 20.0);
  EXPECT_EQ(penalty_percent(policy, 9, 0), 50.0);
  EXPECT_EQ(points_after(80.0, 20.0), 64.0);
}

TEST(Penalty, IsMonotoneInLatenessAndWithinItsBoundsForAnyRules) {
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    Policy policy = rules();
    policy.grace_s = static_cast<std::int64_t>(random.below(3 * kDay));
    policy.percent_a_day = random.between(0.0, 100.0);
    policy.cap_percent = random.between(0.0, 100.0);
    const int free = static_cast<int>(random.below(5));
    const auto early = policy.due_s + static_cast<std::int64_t>(random.below(20 * kDay)) - 3 * kDay;
    const auto later = early + static_cast<std::int64_t>(random.below(10 * kDay));
    const double points = random.between(0.0, 100.0);
    const double a = penalty_percent(policy, late_days(policy, early), free);
    const double b = penalty_percent(policy, late_days(policy, later), free);
    ASSERT_LE(0.0, a);
    ASSERT_LE(a, b);
    ASSERT_LE(b, policy.cap_percent);
    ASSERT_LE(penalty_percent(policy, late_days(policy, later), free + 1), b);
    ASSERT_GE(points_after(points, a), points_after(points, b));
    ASSERT_GE(points_after(points, b), 0.0);
    ASSERT_LE(points_after(points, a), points);
  }
}

TEST(Standing, HasPointsBeforeAndAfterAndWhy) {
  const Policy policy = rules();
  const Standing ada =
      only(apply_policy(policy, {{"ada", "7", "", {}}}, {{"ada", "", policy.due_s + 3 * kDay}},
                        {scored("ada", 80.0)}));
  EXPECT_EQ(ada.before, 80.0);
  EXPECT_EQ(ada.after, 64.0);
  EXPECT_EQ(ada.why, "3 days late, 1 of them free: -20 %");
}

TEST(Standing, BestOfAttemptsIsBestAfterThePenalty) {
  Policy policy = rules();
  const std::vector<HandIn> times = {{"first", "ada", policy.due_s},
                                     {"second", "ada", policy.due_s + 4 * kDay}};
  const std::vector<Grade> grades = {scored("first", 70.0), scored("second", 90.0)};
  const Standing best = only(apply_policy(policy, {{"ada", "7", "", {}}}, times, grades));
  EXPECT_EQ(best.submission, "first");  // 70 against 90 - 30 % = 63
  EXPECT_EQ(best.attempts, 2u);
  policy.attempt = AttemptThatCounts::kLast;
  const Standing last = only(apply_policy(policy, {{"ada", "7", "", {}}}, times, grades));
  EXPECT_EQ(last.submission, "second");
  EXPECT_NEAR(*last.after, 63.0, 1e-12);
  // Which is the last is unknown where a time is missing; nobody is to guess.
  const Standing unknown =
      only(apply_policy(policy, {{"ada", "7", "", {}}}, {times[0], {"else", "bo", policy.due_s}},
                        {scored("first", 70.0), scored("ada", 90.0)}));
  EXPECT_FALSE(unknown.after);
  EXPECT_NE(unknown.why.find("ada has no time"), std::string::npos) << unknown.why;
}

TEST(Standing, AGroupSharesItsSubmissionOnlyWhereGroupsAreOn) {
  Policy policy = rules();
  const std::vector<Person> roster = {
      {"ada", "1", "x", {}}, {"bo", "2", "x", {}}, {"cy", "3", "", {}}};
  const std::vector<Grade> grades = {scored("ada", 80.0)};
  EXPECT_FALSE(apply_policy(policy, roster, {}, grades)[1].after);
  policy.groups = true;
  const auto shared = apply_policy(policy, roster, {}, grades);
  EXPECT_EQ(shared[1].after, 80.0);
  EXPECT_FALSE(shared[2].after) << "an empty group is no group";
}

TEST(Standing, NobodyGetsASilentZero) {
  Grade fault = scored("dan", 0.0), without = scored("eve", 0.0);
  fault.tests.resize(1);  // its verdict is a fault of the grader until somebody answers
  without.state = GradeState::kNothingToCompile;
  const auto all = apply_policy(
      rules(),
      {{"ada", "1", "", {}}, {"bo", "2", "", {}}, {"dan", "4", "", {}}, {"eve", "5", "", {}}}, {},
      {scored("ada", 80.0), fault, without, scored("zoe", 90.0)});
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[0].after, 80.0);
  EXPECT_EQ(all[0].why, "the time of handing in is unknown: no penalty");
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_FALSE(all[i].after) << all[i].why;
  EXPECT_EQ(all[1].why, "nothing was handed in: no score, somebody has to decide");
  EXPECT_EQ(all[2].why, "dan has no final result: grade it again");
  EXPECT_FALSE(all[4].is_in_roster);
  EXPECT_EQ(what_needs_a_look(all).size(), 5u);
  const std::string csv = gradebook_csv("Thing", all, 100.0, true);
  EXPECT_NE(csv.find("\nbo,2,bo,,,,\"nothing was handed in"), std::string::npos)
      << csv;  // cells with commas are quoted
  EXPECT_EQ(csv.find(",0,"), std::string::npos) << csv;
}

TEST(Standing, AScoreThatWaitsForAnAnswerIsBlankAndSaysSo) {
  Grade held = scored("ada", 75.0);
  held.is_held = true;
  held.tests.resize(1);  // as on the page that is in place of a missing result
  const Standing ada = only(apply_policy(rules(), {{"ada", "7", "", {}}}, {}, {held}));
  EXPECT_FALSE(ada.before);
  EXPECT_FALSE(ada.after);
  EXPECT_NE(ada.why.find("no score until tumble regrade is answered"), std::string::npos)
      << ada.why;
}

TEST(Standing, IsReadAsItWasWritten) {
  const PrivateFolder folder;
  const auto all = apply_policy(rules(), {{"ada", "7", "x", {}}, {"bo", "8", "", {}}},
                                {{"ada", "", rules().due_s + 3 * kDay}}, {scored("ada", 80.0)});
  write_whole(folder.path() / "s.json", standing_json(all));
  EXPECT_EQ(standing_json(read_standings(folder.path() / "s.json")), standing_json(all));
}

TEST(TimeOf, ReadsAnOffsetAndRefusesWhatIsNoTime) {
  EXPECT_EQ(time_of("1970-01-02T00:00:00Z"), kDay);
  EXPECT_EQ(time_of("1970-01-02T01:30:00+01:30"), kDay);
  EXPECT_EQ(time_of("1970-01-01T19:00:00-05:00"), kDay);
  for (const char* text : {"", "1970-01-02", "1970-01-02T00:00:00", "1970-02-30T00:00:00Z",
                           "1970-01-02T25:00:00Z", "1970-01-02T00:00:00+1:00", "soon"})
    EXPECT_FALSE(time_of(text)) << text;
}

class PolicyFolder : public ::testing::Test {
 protected:
  PolicyFolder() {
    put("roster.csv", "name,id,group,late_days\n\"Lovelace, Ada\",7,x,3\nbo,8,,\n");
    put("handed_in.csv", "submission,student,time\nada,7,2026-10-13T00:30:00+02:00\n");
  }
  void put(const char* file, const std::string& text) const {
    write_whole(folder_.path() / file, text);
  }
  PolicyFile read(const std::string& json) const {
    put("policy.json", json);
    return read_policy(folder_.path() / "policy.json", "a1");
  }
  std::string refusal(const std::string& json) const {
    try {
      read(json);
    } catch (const UserError& error) {
      return error.what();
    }
    return "not refused";
  }
  const std::string due_ = R"("due": {"a1": "2026-10-12T23:59:00+02:00"}, "roster": "roster.csv")";
  PrivateFolder folder_;
};

TEST_F(PolicyFolder, IsReadWithItsTables) {
  const PolicyFile file = read("{" + due_ + R"(, "handed_in": "handed_in.csv", "attempt": "last",
      "penalty_percent_a_day": 20, "penalty_cap_percent": 40, "grace_minutes": 1})");
  EXPECT_EQ(file.policy.percent_a_day, 20.0);
  EXPECT_EQ(file.policy.cap_percent, 40.0);
  EXPECT_EQ(file.policy.grace_s, 60);
  ASSERT_EQ(file.roster.size(), 2u);
  EXPECT_EQ(file.roster[0].name, "Lovelace, Ada");
  EXPECT_EQ(file.roster[0].free_late_days, 3);
  EXPECT_FALSE(file.roster[1].free_late_days);
  ASSERT_EQ(file.hand_ins.size(), 1u);
  EXPECT_EQ(file.hand_ins[0].time_s - file.policy.due_s, 31 * 60);
}

// Of two keys with one name a parser keeps the last, and the first student's extension is lost.
TEST_F(PolicyFolder, AKeyThatStandsTwiceIsRefusedWithItsLine) {
  const std::string said = refusal("{" + due_ + R"(,
      "extensions": {"a1": {"7": "2026-10-19T23:59:00+02:00"},
                     "a1": {"bo": "2026-10-19T23:59:00+02:00"}}})");
  EXPECT_NE(said.find("policy.json:2: /extensions/a1"), std::string::npos) << said;
  EXPECT_NE(said.find("twice"), std::string::npos) << said;
}

TEST_F(PolicyFolder, AMistakeIsSaidWithItsPlaceInPlainWords) {
  const std::string json = refusal("{" + due_ + ",}");
  EXPECT_NE(json.find("policy.json:1"), std::string::npos) << json;
  EXPECT_EQ(json.find("exception"), std::string::npos) << json;
  const std::string table = refusal("{" + due_ + R"(, "handed_in": "none.csv"})");
  EXPECT_NE(table.find("none.csv: does not exist"), std::string::npos) << table;
}

// As a spreadsheet writes it where numbers have a decimal comma.
TEST_F(PolicyFolder, ATableMayHaveSemicolonsBetweenItsCells) {
  put("roster.csv", "\xef\xbb\xbfname;id\r\nLovelace, Ada;7\r\nbo;8\r\n");
  const PolicyFile file = read("{" + due_ + "}");
  ASSERT_EQ(file.roster.size(), 2u);
  EXPECT_EQ(file.roster[0].name, "Lovelace, Ada");
  EXPECT_EQ(file.roster[1].id, "8");
}

// 2026-10-13T00:30 is 31 minutes after a1 is due.
TEST_F(PolicyFolder, AnExtensionIsOneStudentsAndOneAssignments) {
  const std::string times = R"(, "handed_in": "handed_in.csv", "free_late_days": 0)";
  put("roster.csv", "name,id\n\"Lovelace, Ada\",7\nbo,8\n");
  put("handed_in.csv",
      "submission,student,time\nada,7,2026-10-13T00:30:00+02:00\n"
      "bo,8,2026-10-13T00:30:00+02:00\n");
  const auto standings = [&](const std::string& more) {
    const PolicyFile file = read("{" + due_ + times + more + "}");
    return apply_policy(file.policy, file.roster, file.hand_ins,
                        {scored("ada", 80.0), scored("bo", 80.0)});
  };
  for (const char* more : {"", R"(, "extensions": {"a2": {"7": "2026-10-19T23:59:00+02:00"}})"}) {
    EXPECT_EQ(standings(more)[0].after, 72.0) << more;
    EXPECT_EQ(standings(more)[1].after, 72.0) << more;
  }
  for (const char* name : {"7", "Lovelace, Ada"}) {
    const auto extended = standings(std::string(R"(, "extensions": {"a1": {")") + name +
                                    R"(": "2026-10-13T00:30:00+02:00"}})");
    EXPECT_EQ(extended[0].after, 80.0);
    EXPECT_NE(extended[0].why.find("by an extension"), std::string::npos) << extended[0].why;
    EXPECT_EQ(extended[1].after, 72.0) << "the other's due date stays";
  }
  EXPECT_EQ(standings(R"(, "extensions": {"a1": {"7": "2026-10-13T00:29:59+02:00"}})")[0].after,
            72.0)
      << "a second after it";
}

TEST_F(PolicyFolder, PointsByHandAreWhatIsLeftAfterAllRulesAndSayWhy) {
  const PolicyFile file = read(
      "{" + due_ + R"(, "by_hand": {"a1": {"bo": {"points": 66.5, "why": "talked it through"}}}})");
  const auto judged = apply_policy(file.policy, file.roster, {}, {scored("bo", 80.0)});
  ASSERT_EQ(judged.size(), 2u);
  EXPECT_FALSE(judged[0].after);
  EXPECT_EQ(judged[1].after, 66.5);
  EXPECT_EQ(judged[1].before, 80.0);
  for (const char* word : {"66.5 points by hand", "talked it through", "80"})
    EXPECT_NE(judged[1].why.find(word), std::string::npos) << judged[1].why;
  const auto nothing = apply_policy(file.policy, file.roster, {}, {});
  EXPECT_EQ(nothing[1].after, 66.5) << "nothing was handed in, and somebody has decided";
}

TEST_F(PolicyFolder, WhatItCannotMeanIsNamed) {
  const auto refused_for = [&](const std::string& more, const char* word) {
    const std::string said = refusal("{" + due_ + ", " + more + "}");
    EXPECT_NE(said.find(word), std::string::npos) << said;
  };
  refused_for(R"("extensions": {"a1": {"boo": "2026-10-19T23:59:00+02:00"}})", "mean 'bo'");
  refused_for(R"("extensions": {"bo": "2026-10-19T23:59:00+02:00"}, "by_hand": {"a1": 3})",
              "by_hand does not name");
  refused_for(R"("extensions": {"a1": {"bo": "2026-10-11T23:59:00+02:00"}})", "before a1 is due");
  refused_for(R"("extensions": {"a1": {"bo": "Monday"}})", "no time");
  refused_for(R"("extensions": {"a1": {"bo": "2026-10-19T23:59:00Z",
                                       "8": "2026-10-19T23:59:00Z"}})",
              "twice");
  refused_for(R"("by_hand": {"a1": {"bo": {"points": 80}}})", "no reason");
  refused_for(R"("by_hand": {"a1": {"bo": {"points": -1, "why": "late"}}})", "from 0 to");
  EXPECT_NE(refusal("{" + due_ + R"(, "penalty_cap": 40})").find("penalty_cap_percent"),
            std::string::npos);
  EXPECT_NE(refusal("{" + due_ + R"(, "penalty_cap_percent": 140})").find("from 0 to 100"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"roster": "roster.csv"})").find("does not say when a1 is due"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"due": {"a1": "tomorrow"}, "roster": "roster.csv"})").find("is no time"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"due": {"a1": "2026-10-12T23:59:00Z"}})").find("names no roster"),
            std::string::npos);
  put("roster.csv", "name,id\nada,7\nbo,7\n");
  EXPECT_NE(refusal("{" + due_ + "}").find("another person"), std::string::npos);
  put("roster.csv", "name,number\nada,7\n");
  EXPECT_NE(refusal("{" + due_ + "}").find("unknown column 'number'"), std::string::npos);
}

TEST(ForStudent, HiddenTestsKeepPointsAndLoseNameAndStory) {
  Grade grade = scored("ada", 3.0);
  ScoredTest hidden;
  hidden.item = {"Secret.Seam", 5.0, "advanced", "The seam", true};
  hidden.result.test = "Secret.Seam";
  hidden.result.verdict = Verdict::kWrong;
  hidden.result.story = "the seam leaks";
  hidden.score = 2.0;
  grade.tests = {hidden};
  grade.changes = {{"Secret.Seam", "The seam", "right, 5 of 5", "wrong, 2 of 5", "run again"}};
  const Grade shown = for_student(grade);
  const std::string all = gradescope_json(shown);
  for (const char* word : {"Secret", "seam"}) EXPECT_EQ(all.find(word), std::string::npos) << all;
  EXPECT_EQ(shown.tests[0].score, 2.0);
  EXPECT_EQ(shown.tests[0].result.verdict, Verdict::kWrong);
  EXPECT_TRUE(shown.changes.empty());
}

TEST(SlipsMadeMost, CountSubmissionsAndNotStories) {
  const auto with = [](const std::string& name, std::vector<std::string> slips) {
    Grade grade = scored(name, 0.0);
    for (const std::string& slip : slips) {
      ScoredTest test;
      test.result.verdict = Verdict::kWrong;
      test.result.story = "\n  scene:    x\n  likely:   " + slip + "\n  read:     y";
      grade.tests.push_back(test);
    }
    return grade;
  };
  SlipTally tally({});
  for (const Grade& grade : {with("b", {"unit", "sign"}), with("a", {"sign", "sign"})})
    tally.add(grade);
  const auto slips = tally.made_most();
  ASSERT_EQ(slips.size(), 2u);
  EXPECT_EQ(slips[0].slip, "sign");
  EXPECT_EQ(slips[0].names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(slips[1].names, std::vector<std::string>{"b"});
}

// A submission whose tests of these names fail, with these stories.
Grade failing(const std::map<std::string, std::string>& stories) {
  Grade grade = scored("a", 0.0);
  for (const auto& [name, story] : stories) {
    ScoredTest test;
    test.item.test = name;
    test.result.verdict = Verdict::kWrong;
    test.result.story = "\n  likely:   " + story;
    grade.tests.push_back(test);
  }
  return grade;
}

TEST(SlipsOf, AreThoseWhoseTestsAllFailAndWhoseKeywordIsSaid) {
  const std::vector<KnownSlip> known = {{"the sign of j", "THE SIGN", {"J.A", "J.B"}},
                                        {"no rotation", "rotation", {"J.A", "J.B"}},
                                        {"one test of the sign", "the sign", {"J.A"}},
                                        {"mass for its inverse", "mass", {"M.A"}},
                                        {"another scene", "the sign", {"J.A", "J.C"}}};
  using Slips = std::set<std::string>;
  EXPECT_EQ(slips_of(failing({{"J.A", "the sign of j"}, {"J.B", "see J.A"}}), known),
            Slips{"the sign of j"});
  EXPECT_EQ(slips_of(failing({{"J.A", "rotation"}, {"J.B", "x"}, {"M.A", "mass"}}), known),
            (Slips{"no rotation", "mass for its inverse"}));
  EXPECT_EQ(slips_of(failing({{"J.B", "of a kind not known"}}), known),
            Slips{"of a kind not known"});
  EXPECT_EQ(slips_of(failing({}), known), Slips{});
}

// A remark for each of the others would fill the page where a class hands in the starter.
TEST(EqualFiles, AreNamedInOneRemarkAndTheFirstOfMany) {
  const PrivateFolder folder;
  write_whole(folder.path() / "a9_thing.cpp", "int x;\n");
  const auto remarks_of = [&](std::vector<Submission> submissions) {
    std::vector<GradedWork> all(submissions.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      submissions[i].source = folder.path() / "a9_thing.cpp";
      all[i].submission = &submissions[i];
    }
    remark_equal_files(all);
    return all[0].remarks;
  };
  std::vector<Submission> submissions;
  for (const char* name : {"ada", "bo", "cy", "dee", "eve", "fay", "gus", "hal"})
    submissions.emplace_back().name = name;
  const auto first = [&](std::size_t n) {
    return remarks_of({submissions.begin(), submissions.begin() + static_cast<long>(n)});
  };
  const std::string same = "the same file, byte for byte, as ";
  EXPECT_TRUE(first(1).empty());
  EXPECT_EQ(first(2), std::vector<std::string>{same + "that of bo"});
  EXPECT_EQ(first(4), std::vector<std::string>{same + "those of bo, cy and dee"});
  EXPECT_EQ(first(8), std::vector<std::string>{same + "those of bo, cy, dee, eve, fay and 2 more"});
}

// Of 26 tests a block of 25 and one of a single column would stand below each other; and what all
// pass is said by the table.
TEST(ClassPage, DividesTheMatrixEvenlyAndNamesNoLongListOfTests) {
  Grade grade = scored("ada", 100.0);
  for (int i = 1; i <= 26; ++i) {
    ScoredTest test;
    test.item.test = "S.T" + std::to_string(i);
    test.item.title = "title " + std::to_string(i);
    test.result.test = test.item.test;
    test.result.verdict = Verdict::kRight;
    grade.tests.push_back(test);
  }
  modules::ModuleKind kind;
  const std::string html = class_page(kind, {grade}, SlipTally({}), {}).html();
  EXPECT_NE(html.find("Tests 1 to 13"), std::string::npos);
  EXPECT_NE(html.find("Tests 14 to 26"), std::string::npos);
  EXPECT_NE(html.find("Tests that nobody fails: 26 of the 26 tests, which the remarks below name."),
            std::string::npos);
  grade.tests.resize(1);
  const std::string of_one = class_page(kind, {grade}, SlipTally({}), {}).html();
  EXPECT_NE(of_one.find("Tests that nobody fails: 1 title 1."), std::string::npos);
  EXPECT_EQ(of_one.find("Tests 1 to 1"), std::string::npos);
}

// The submissions may have been moved away while they were graded.
TEST(ClassFiles, APageThatCannotBeMadeSaysSoAndTheOthersAreMade) {
  const PrivateFolder out;
  modules::ModuleKind kind;
  kind.id = "a9";
  kind.title = "Thing";
  std::vector<std::string> failed;
  GradeOptions options;
  options.failed = [&](const std::string& what, const std::string& why) {
    failed.push_back(what);
    EXPECT_NE(why.find("gone"), std::string::npos) << why;
  };
  PolicyFile policy;
  policy.policy = rules();
  policy.roster = {{"ada", "7", "", {}}, {"bo", "8", "", {}}};
  write_class_files({}, kind, out.path() / "gone", &policy, out.path(), {scored("ada", 80.0)},
                    SlipTally({}), options);
  EXPECT_EQ(failed, std::vector<std::string>{"similar.html"});
  EXPECT_EQ(read_standings(out.path() / kStandingFile).size(), 2u);
  EXPECT_NE(text_of(out.path() / "similar.html").find("The grader failed at this page"),
            std::string::npos);
  for (const char* file : {"class.html", "pictures.html"}) {
    EXPECT_FALSE(text_of(out.path() / file).empty()) << file;
    EXPECT_EQ(text_of(out.path() / file).find("The grader failed"), std::string::npos) << file;
  }
}

// A gradebook of an earlier run would be taken for this one's.
TEST(ClassFiles, AGradebookThatCannotBeWrittenEndsTheGrading) {
  const PrivateFolder out;
  write_whole(out.path() / "gradebook.csv" / "full", "a folder lies in its place");
  GradeOptions options;
  options.failed = [](const std::string& what, const std::string&) { ADD_FAILURE() << what; };
  PolicyFile policy;
  policy.policy = rules();
  EXPECT_THROW(write_class_files({}, {}, out.path() / "gone", &policy, out.path(),
                                 {scored("ada", 80.0)}, SlipTally({}), options),
               UserError);
  EXPECT_FALSE(std::filesystem::exists(out.path() / kStandingFile));
}

TEST(ClassFiles, APageThatCannotBeWrittenIsSaidAndTheOthersAreMade) {
  const PrivateFolder out;
  write_whole(out.path() / "class.html" / "full", "a folder lies in its place");
  std::set<std::string> failed;
  GradeOptions options;
  options.failed = [&](const std::string& what, const std::string&) { failed.insert(what); };
  write_class_files({}, {}, out.path() / "gone", nullptr, out.path(), {scored("ada", 80.0)},
                    SlipTally({}), options);
  EXPECT_EQ(failed, (std::set<std::string>{"class.html", "similar.html"}));
  EXPECT_TRUE(std::filesystem::is_regular_file(out.path() / "pictures.html"));
}

// One file that sim_c++ cannot read must not make each night's grading a fault of the grader.
TEST(ClassFiles, SourcesThatCannotBeComparedAreANoticeAndNoFault) {
  std::string said;
  const auto compare = []() -> std::vector<SimilarPair> {
    throw SourcesNotCompared("sim_c++ failed: <odd>");
  };
  const report::Page page = page_of_similar({}, {{"ada", "int x;"}, {"bo", "int y;"}}, compare,
                                            [&](const std::string& sentence) { said += sentence; });
  EXPECT_NE(said.find("Nothing was compared: sim_c++ failed: <odd>"), std::string::npos) << said;
  const PrivateFolder out;
  page.write(out.path() / "similar.html");
  const std::string text = text_of(out.path() / "similar.html");
  EXPECT_NE(text.find("Nothing was compared"), std::string::npos);
  EXPECT_EQ(text.find("No two of them are alike"), std::string::npos);
  const auto break_down = []() -> std::vector<SimilarPair> { throw std::runtime_error("no disk"); };
  EXPECT_THROW(page_of_similar({}, {}, break_down, {}), std::runtime_error);
}

TEST(LetGoOfDetails, KeepsWhatThePagesOfAClassShow) {
  GradeRecord record;
  record.grade = failing({{"J.A", std::string(100'000, 'x')}});
  record.grade.media.emplace_back().title = "a ball";
  record.grade.media[0].story = "it falls";
  record.grade.change = "80 -> 75: the tests changed";
  record.files["results.json"] = "digest";
  GradeRecord other = record;
  MarksOfClass marks;
  marks.let_go_of_details(record);
  marks.let_go_of_details(other);
  EXPECT_EQ(record.grade.marks.items->at(0).test, "J.A");
  EXPECT_EQ(record.grade.count(Verdict::kWrong), 1u);
  EXPECT_EQ(record.grade.marks.items, other.grade.marks.items) << "one list for a class";
  EXPECT_EQ(record.grade.tests.capacity(), 0u) << "its memory is given back";
  EXPECT_EQ(test_counts({record.grade, other.grade}).at(0).judged, 2u);
  EXPECT_EQ(record.grade.media[0].title, "a ball");
  EXPECT_EQ(record.grade.change, "80 -> 75: the tests changed");
  EXPECT_TRUE(record.grade.has_score());
  EXPECT_TRUE(record.grade.media[0].story.empty());
  EXPECT_TRUE(record.files.empty());
}

TEST(SimilarPairs, FindACopyWithOtherNamesAndLeaveOutTheStarter) {
  if (!can_compare_sources()) GTEST_SKIP() << "needs the Debian package similarity-tester";
  std::string starter, work;
  for (int i = 0; i < 40; ++i)
    starter += "double given_" + std::to_string(i) + "(double x) { return x + 1.0; }\n";
  for (int i = 0; i < 12; ++i)
    work += "double f(double a, int n) {\n  for (int i = 0; i < n; ++i)\n    a = a * (a + " +
            std::to_string(i) + ") - a / 2.0;\n  return a;\n}\n";
  std::string renamed = work;
  for (auto at = renamed.find("int i"); at != std::string::npos; at = renamed.find("int i", at + 1))
    renamed.replace(at, 5, "int k");
  const auto pairs = similar_pairs({{"ada", starter + work},
                                    {"bo", starter + "struct Other { int a[3]; };\n"},
                                    {"cy", starter + renamed}},
                                   starter);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].a, 0u);
  EXPECT_EQ(pairs[0].b, 2u);
  EXPECT_GT(pairs[0].percent, 90);
  ASSERT_FALSE(pairs[0].runs.empty());
  EXPECT_GT(pairs[0].runs[0].a_first, 40u) << "line numbers are those of the whole file";
}

// A long part is cut, and pairs behind the first ones have no part of the page: it says so.
TEST(SimilarPage, SaysWhatItDoesNotShow) {
  std::string text;
  for (int i = 0; i < 90; ++i) text += "line\n";
  const std::vector<NamedSource> sources = {{"ada", text}, {"bo", text}, {"cid", text}};
  SimilarPair pair{0, 1, 90, {{1, 80, 3, 82, 500}}};
  const std::string html = similar_page({}, sources, {pair, {1, 2, 40, {}}}, "").html();
  EXPECT_NE(html.find("40 more lines of this part are not shown: it ends in line 80 of ada and in "
                      "line 82 of bo."),
            std::string::npos)
      << html;
  EXPECT_NE(html.find("Only the pair that is most alike is shown."), std::string::npos) << html;
  pair.runs = {{1, 5, 3, 7, 50}};
  const std::string whole = similar_page({}, sources, {pair}, "").html();
  EXPECT_EQ(whole.find("not shown"), std::string::npos);
}

}  // namespace
}  // namespace tumble::grading::policy_test
