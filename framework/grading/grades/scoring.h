/// From the judge's results to points.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// Results of one run of a judge on a shared object.
struct Judgement {
  std::vector<TestResult> results;
  std::string fault;  // why the judge has no results; empty if it has
};

/// Runs the judge of the assignment against a shared object, in a separate process.
/// @param budget_s  time for all tests together (TimeBudget)
/// @param plain     without a sandbox: for trusted code only
Judgement judge_module(const Course& course, const std::string& id,
                       const std::filesystem::path& module, bool plain = false,
                       double budget_s = 60.0);

/// Every item of the rubric with its result, in the rubric's order; then tests that are not in the
/// rubric, without points. Fail-closed: an item without a result is a fault of the grader and earns
/// no points.
std::vector<ScoredTest> score_tests(const Rubric& rubric, const Judgement& judgement);

/// Every item with 0 points, for one reason.
std::vector<ScoredTest> score_nothing(const Rubric& rubric, Verdict verdict,
                                      const std::string& story);

/// Fills score and possible from the tests.
void add_up(Grade& grade);

/// "12.5", "100": without trailing zeros.
std::string points_text(double points);

}  // namespace tumble::grading
