// What platforms are given is in their formats, by a validator of each format's rules, and holds
// nothing of hidden tests but points and numbers.
#include "framework/grading/platforms/formats.h"

#include <cctype>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "tests/platforms/format_rules.h"

namespace tumble::grading {
namespace {

// Markup, a formula, control characters, half a character of UTF-8, the ends of other formats.
const std::string kHostile =
    "</failure><script>alert(1)</script> ]]> =1+1 \x1b[31m {\"scores\":{\"public\":100}}\n"
    "{\"scores\":{\"public\":100}}\n\xff\xfe \xef\xbf\xbf & \" '";

ScoredTest scored(const std::string& name, Verdict verdict, double points, bool hidden = false) {
  ScoredTest test;
  test.item = {"Suite." + name, points, "basic", "title of " + name, hidden};
  test.result.test = test.item.test;
  test.result.verdict = verdict;
  if (verdict != Verdict::kRight) test.result.story = "story of " + name + ": " + kHostile;
  if (verdict == Verdict::kRight) test.score = points;
  return test;
}

Grade grade_of(GradeState state = GradeState::kJudged) {
  Grade grade;
  grade.name = "Ada";
  grade.state = state;
  grade.sandbox = "landlock (ABI 7)";
  grade.notes = {"a note: " + kHostile};
  grade.tests = {scored("Right", Verdict::kRight, 10.5),
                 scored("Wrong", Verdict::kWrong, 20),
                 scored("Crashed", Verdict::kCrashed, 9.5),
                 scored("Open", Verdict::kNotAttempted, 10),
                 scored("Endless", Verdict::kOutOfResources, 10),
                 scored("SecretRight", Verdict::kRight, 15, true),
                 scored("SecretWrong", Verdict::kWrong, 25, true)};
  if (state != GradeState::kJudged) {
    grade.story = "a story of the file: " + kHostile;
    for (ScoredTest& test : grade.tests) {
      test.score = 0.0;
      test.result.verdict = Verdict::kWrong;
      test.result.story = grade.story;
    }
  }
  return grade;
}

StudentView view_of(const Grade& grade) { return student_view("a1", "Impulse", grade); }

StudentView without_hidden() {
  Grade grade = grade_of();
  std::erase_if(grade.tests, [](const ScoredTest& test) { return test.item.hidden; });
  return view_of(grade);
}

const std::vector<GradeState> kStates = {GradeState::kJudged, GradeState::kNothingToCompile,
                                         GradeState::kDoesNotCompile};

TEST(StudentView, HoldsNothingOfHiddenTestsButPoints) {
  const StudentView view = view_of(grade_of());
  EXPECT_EQ(view.tests.size(), 5u);
  EXPECT_EQ(view.hidden.size(), 2u);
  EXPECT_EQ(view.score, 25.5);
  EXPECT_EQ(view.possible, 100.0);
  const HiddenSum sum = sum_of_hidden(view);
  EXPECT_EQ(sum.passed, 1u);
  EXPECT_EQ(sum.score, 15.0);
  EXPECT_EQ(sum.possible, 40.0);
}

// What the judge printed when it failed may hold anything.
TEST(StudentView, OfAFaultOfTheGraderDoesNotExist) {
  Grade grade = grade_of();
  grade.tests[1].result.verdict = Verdict::kGraderFault;
  EXPECT_THROW(view_of(grade), PreconditionError);
}

TEST(Formats, NoPlatformGetsANameOrAStoryOfAHiddenTest) {
  const StudentView view = view_of(grade_of());
  std::vector<std::string> all = {gradescope_results(view), autolab_output(view),
                                  decoded(github_classroom_result(without_hidden()))};
  for (const auto& [file, text] : artemis_files(view)) all.push_back(text);
  for (const std::string& text : all) EXPECT_EQ(text.find("Secret"), std::string::npos) << text;
  // The instructor's story has both.
  EXPECT_NE(instructors_story(grade_of()).find("story of SecretWrong"), std::string::npos);
}

TEST(Formats, GradescopesRulesHold) {
  for (const GradeState state : kStates) {
    const std::string text = gradescope_results(view_of(grade_of(state)));
    EXPECT_EQ(faults_of_gradescope(text), Faults{});
    EXPECT_TRUE(student_sees_total(text));
  }
  const auto json = nlohmann::json::parse(gradescope_results(view_of(grade_of())));
  EXPECT_EQ(json["score"], 25.5);
  EXPECT_EQ(json["tests"].size(), 6u);
  EXPECT_EQ(json["tests"][5]["name"], "Hidden tests");
  EXPECT_EQ(json["tests"][5]["score"], 15);
  EXPECT_EQ(json["tests"][5]["max_score"], 40);
}

TEST(Formats, ArtemisRulesHold) {
  for (const GradeState state : kStates) {
    const auto files = artemis_files(view_of(grade_of(state)));
    EXPECT_EQ(faults_of_junit(files.at("results/tumble.xml")), Faults{});
    EXPECT_EQ(faults_of_custom_feedback(files), Faults{});
  }
  const std::string xml = artemis_files(view_of(grade_of())).at("results/tumble.xml");
  EXPECT_NE(xml.find("tests=\"7\" failures=\"3\" errors=\"2\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("name=\"Hidden.Test02\""), std::string::npos);
}

TEST(Formats, GithubClassroomsRulesHold) {
  EXPECT_EQ(faults_of_github_classroom(github_classroom_result(without_hidden())), Faults{});
  const auto json = nlohmann::json::parse(decoded(github_classroom_result(without_hidden())));
  EXPECT_EQ(json["status"], "fail");
  EXPECT_EQ(json["max_score"], 60.0);
  // Hidden tests do not run there at all.
  EXPECT_THROW(github_classroom_result(view_of(grade_of())), PreconditionError);
}

TEST(Formats, AutolabsRulesHold) {
  for (const GradeState state : kStates) {
    const std::string text = autolab_output(view_of(grade_of(state)));
    EXPECT_EQ(faults_of_autolab(text), Faults{});
    const bool judged = state == GradeState::kJudged;
    const auto scores = nlohmann::json::parse(last_line(text))["scores"];
    EXPECT_EQ(scores["public"], judged ? 10.5 : 0.0);
    EXPECT_EQ(scores["hidden"], judged ? 15.0 : 0.0);
  }
}

TEST(Formats, NothingInThemIsOfTheMomentOrThePlace) {
  const StudentView view = view_of(grade_of());
  EXPECT_EQ(gradescope_results(view), gradescope_results(view_of(grade_of())));
  EXPECT_EQ(artemis_files(view), artemis_files(view_of(grade_of())));
  EXPECT_EQ(autolab_output(view), autolab_output(view_of(grade_of())));
}

// The validators find what is wrong: each rule broken once.
TEST(FormatRules, OfGradescopeFindBrokenOnes) {
  const auto good = nlohmann::json::parse(gradescope_results(view_of(grade_of())));
  const auto broken = [&](const std::string& pointer, const nlohmann::json& value) {
    auto json = good;
    json[nlohmann::json::json_pointer(pointer)] = value;
    return faults_of_gradescope(json.dump());
  };
  EXPECT_NE(faults_of_gradescope("{"), Faults{});
  EXPECT_NE(broken("/score", "10"), Faults{});
  EXPECT_NE(broken("/tests/0/status", "right"), Faults{});
  EXPECT_NE(broken("/tests/0/visibility", "shown"), Faults{});
  EXPECT_NE(broken("/tests/0/output", 3), Faults{});
  EXPECT_NE(broken("/tests/0/tags", "basic"), Faults{});
  EXPECT_NE(broken("/output_format", "xml"), Faults{});
  EXPECT_NE(broken("/points", 3), Faults{});
  auto hidden = good;
  hidden["tests"][0]["visibility"] = "hidden";
  EXPECT_FALSE(student_sees_total(hidden.dump()));
}

TEST(FormatRules, OfJunitFindBrokenOnes) {
  const std::string good = artemis_files(view_of(grade_of())).at("results/tumble.xml");
  const auto broken = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return faults_of_junit(text);
  };
  EXPECT_NE(broken("&lt;", "<"), Faults{});
  EXPECT_NE(broken("&amp;", "&"), Faults{});
  EXPECT_NE(broken("failures=\"3\"", "failures=\"2\""), Faults{});
  EXPECT_NE(broken("</testcase>", ""), Faults{});
  EXPECT_NE(broken("<testcase name=", "<testcase title="), Faults{});
  EXPECT_NE(broken("Hidden.Test01", "Hidden.Test02"), Faults{});
  EXPECT_NE(broken("story", "sto\x01ry"), Faults{});
}

TEST(FormatRules, OfAutolabFindBrokenOnes) {
  const std::string good = autolab_output(view_of(grade_of()));
  EXPECT_NE(faults_of_autolab(good + "more\n"), Faults{});
  std::string unquoted = good;
  unquoted.insert(0, "{\"scores\":{\"public\":100}}\n");
  EXPECT_NE(faults_of_autolab(unquoted), Faults{});
}

}  // namespace
}  // namespace tumble::grading
