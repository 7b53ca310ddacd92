/// In which order the failing functions of a submission are to be mended. Pure functions of data.
///
/// A function that asks another of the same file is wrong where that one is wrong. So where both
/// fail, the failures of the first probably follow from the second, and are no mistake of its own.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// By function that fails a test and probably only because of another: that other, which fails
/// tests of its own (a quarter of them at least) and follows from none.
/// @param source  text of the submission
std::map<std::string, std::string> what_follows(const std::vector<TestResult>& results,
                                                const std::string& source);

/// The function that used up the time or memory of all tests together, where tests were not run
/// for it; empty: none, or it cannot be told.
std::string what_used_the_time(const std::vector<TestResult>& results);

/// "a1_impulse.cpp:108", the line in which a call ended, where the story names it; else empty.
std::string exact_place_of(const TestResult& result);

/// What a story says after "likely:", as "mistake: what is right".
struct MistakeParts {
  std::string mistake, cure;  // cure: empty where the words name the mistake alone
};
MistakeParts parts_of_mistake(const std::string& words);

/// What a test stands under, in words for its author: one heading for all that one function
/// explains, with the slip that its stories call likely (of several the two that most tests name).
/// Empty for a test that is right, or is not judged.
///   "out of time or memory in linear_acceleration (which begins in line 53): mend this first"
std::vector<std::string> headings_of(const std::vector<TestResult>& results,
                                     const std::string& source);

/// All that stands under one heading.
struct HeadingGroup {
  std::string heading;
  // places in the list of results: what names a slip first; last what fails for any mistake
  std::vector<std::size_t> tests;
  double points = 0.0;
  bool is_attempted = true;
};

/// The headings in the order in which they are to be mended: before all what kept tests from
/// running, then what costs most, where one slip is named under several headings by what it costs
/// in all of them; last what is not attempted.
/// @param headings  of headings_of()
/// @param points    of each result
std::vector<HeadingGroup> in_order_of_mending(const std::vector<TestResult>& results,
                                              const std::vector<std::string>& headings,
                                              const std::vector<double>& points);

}  // namespace tumble::grading
