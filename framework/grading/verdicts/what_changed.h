/// What a student did between two saves: verdicts that changed, and the test to look at next.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// "now right: TITLE, TITLE; no longer right: TITLE (crashed)", or "no verdict has changed".
/// Tests that only one of the two runs has are left out: another choice of tests changes nothing.
/// Cost: O(n log n)
std::string what_changed(const std::vector<TestResult>& before, const std::vector<TestResult>& now,
                         const Rubric& rubric);

/// The test to look at next, "TITLE [Suite.Name]: VERDICT": the first of the lowest level that is
/// wrong, crashed or out of time, since what is written comes before what is not; else the first
/// one not attempted. Empty where every test is right.
std::string what_comes_next(const std::vector<TestResult>& results, const Rubric& rubric);

}  // namespace tumble::grading
