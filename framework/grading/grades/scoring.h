/// From what the judge saw to points.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// What one run of a judge says of a shared object.
struct Judgement {
  std::vector<TestResult> results;
  std::string fault;   // why the judge has no results; empty where it has
};

/// Runs the judge of the assignment against a shared object, in a process of its own.
/// @param budget_s  time for all tests together (TimeBudget)
/// @param plain  without a sandbox: for code of our own only
Judgement judge_module(const Course& course, const std::string& id, const std::filesystem::path& module, bool plain = false,
                       double budget_s = 60.0);

/// Every item of the rubric with its result, in the rubric's order; then tests that the rubric does not name, for no points.
/// Fail-closed: an item that the judge did not answer for is a fault of the grader and earns nothing.
std::vector<ScoredTest> score_tests(const Rubric& rubric, const Judgement& judgement);

/// Every item unearned, for one reason.
std::vector<ScoredTest> score_nothing(const Rubric& rubric, Verdict verdict, const std::string& story);

/// Fills score and possible from the tests.
void add_up(Grade& grade);

/// "12.5", "100": no digits that say nothing.
std::string points_text(double points);

}  // namespace tumble::grading
