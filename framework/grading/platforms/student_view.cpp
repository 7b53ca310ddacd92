#include "framework/grading/platforms/student_view.h"

#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

// Points have few decimals: rounding removes the round-off of their sum.
double rounded(double points) {
  constexpr double kGrain = 1e6;
  return std::round(points * kGrain) / kGrain;
}

std::string said_of(const Grade& grade) {
  std::string said = grade.state == GradeState::kDoesNotCompile
                         ? "The file does not compile, so no test ran.\n" + grade.story
                         : grade.story;
  for (const std::string& note : grade.notes)
    said += (said.empty() ? "" : "\n") + ("note: " + note);
  return plain_text(said);
}

}  // namespace

StudentView student_view(const std::string& assignment, const std::string& title,
                         const Grade& grade) {
  require(grade.is_final(), "platforms: a grade that is not final has no view for its student");
  StudentView view;
  view.assignment = assignment;
  view.title = title;
  view.state = grade.state;
  view.said = said_of(grade);
  view.sandbox = grade.sandbox;
  view.is_official = grade.is_official;
  for (const ScoredTest& test : grade.tests) {
    view.score += test.score;
    view.possible += test.item.points;
    if (test.item.hidden) {
      view.hidden.push_back({test.score, test.item.points});
      continue;
    }
    std::string text = words(test.result.verdict);
    if (!test.result.story.empty()) text += "\n" + plain_text(test.result.story);
    view.tests.push_back({test.item.test, plain_name(test.item.title), test.item.level, test.score,
                          test.item.points, test.result.verdict, text});
  }
  if (const OwnTestsGrade& own = grade.own_tests; own.is_there) {
    view.score += own.score;
    view.tests.push_back({"OwnTests.ExtraPoints", kOwnTestsTitle, "", own.score, 0.0,
                          own.score == own.possible ? Verdict::kRight : Verdict::kWrong,
                          plain_text(own.story)});
  }
  view.score = rounded(view.score);
  view.possible = rounded(view.possible);
  return view;
}

HiddenSum sum_of_hidden(const StudentView& view) {
  HiddenSum sum;
  for (const HiddenTest& test : view.hidden) {
    ++sum.count;
    sum.passed += test.score == test.possible;
    sum.score += test.score;
    sum.possible += test.possible;
  }
  sum.score = rounded(sum.score);
  sum.possible = rounded(sum.possible);
  sum.text = fmt::format("{} of {} passed. Names and details of hidden tests are not shown.",
                         sum.passed, sum.count);
  return sum;
}

std::string instructors_story(const Grade& grade) {
  std::string text = fmt::format("{} of {} points; sandbox: {}\n", points_text(grade.score),
                                 points_text(grade.possible), grade.sandbox);
  if (!grade.story.empty()) text += plain_text(grade.story) + "\n";
  for (const std::string& note : grade.notes) text += "note: " + plain_text(note) + "\n";
  for (const std::string& fault : grade.faults)
    text += "the grader failed, at " + plain_text(fault) + "\n";
  for (const ScoredTest& test : grade.tests) {
    if (test.result.verdict == Verdict::kRight) continue;
    text += fmt::format("\n{}{}: {}, {} of {} points\n{}\n", test.item.test,
                        test.item.hidden ? " (hidden)" : "", words(test.result.verdict),
                        points_text(test.score), points_text(test.item.points),
                        plain_text(test.result.story));
  }
  return text;
}

}  // namespace tumble::grading
