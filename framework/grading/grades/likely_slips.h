/// Failing tests matched to slips that an audit has judged: those which fail the same tests with
/// the same numbers. Pure functions of data.
///
/// A slip is evidence, not proof: another mistake may fail the same tests. So a match says which of
/// the failures it explains, and in how many of them the numbers agree.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// A test that is not passed, as far as two runs can be compared.
struct Failure {
  std::string test;
  Verdict verdict = Verdict::kWrong;
  std::string found;          // the wrong answer in the story's words; empty: the story has none
  std::string function;       // that the test called last
  std::string expected = {};  // the right answer in the story's words; empty: the story has none
};

/// A known-wrong solution, and what an audit found of it (causes_file.h).
struct AuditedSlip {
  std::string name;      // of its file, without the extension
  std::string says;      // what is wrong. The only part that a student may see
  std::string function;  // of the module, where the slip is inside one; else empty
  std::vector<Failure> fails;
};

/// A slip that explains failures which no slip before it explains, or two of them together.
struct LikelySlip {
  std::string name;
  // other slips that explain the same as well; of two slips: that may stand in place of the second
  std::vector<std::string> equals;
  std::vector<std::string> tests;  // that it explains
  // of these tests: the slip's own first, then those that most of them called last
  std::vector<std::string> functions;
  std::size_t same_numbers = 0;   // of these tests, in how many the same answer came
  std::string with = {};          // the second of two slips; empty: one slip explains all
  std::size_t by_both = 0;        // of same_numbers, where neither alone gives that answer
  std::size_t alone[2] = {0, 0};  // of these tests, how many either of the two fails alone
};

/// Slips that explain failures, the strongest evidence first: greedily, first those whose numbers
/// came, then those whose tests fail without a number that agrees. Two slips in one expression give
/// answers that neither gives; where the answers that came are those of both (two_slips.h), the two
/// are named together.
///
/// Evidence is weighed function by function: a slip in what several functions share may be made in
/// one of them alone. There a test that is passed, but would fail with the slip, weighs against it.
/// @param passed  tests that are right, with the function that each called last; tests in neither
///   are not known
std::vector<LikelySlip> likely_slips(const std::vector<Failure>& failures,
                                     const std::map<std::string, std::string>& passed,
                                     const std::vector<AuditedSlip>& slips);

/// The answer that a story gives after "found:", or what ended the call.
Failure failure_of(const TestResult& result);

/// Whether two answers are the same: the same words, and numbers that agree to a millionth.
bool is_same_answer(const std::string& a, const std::string& b);

}  // namespace tumble::grading
