/// The result of one test of one submission, and its record from a test program to a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/error.h"

namespace tumble::grading {

enum class Verdict {
  kRight,
  kWrong,           // a wrong answer
  kNotAttempted,    // the stub is not filled in
  kCrashed,         // a signal, an exit, or an exception instead of an answer
  kOutOfResources,  // out of time or memory
  kGraderFault,     // never counted against a submission
  kMachineBusy,     // too little CPU time for a verdict: to be run again
};

/// "right", "wrong", "not attempted", "crashed", "out of time or memory", "fault of the grader",
/// "machine too busy"
const char* words(Verdict verdict);
/// The inverse of words(). @return empty for anything else
std::optional<Verdict> verdict_from_words(const std::string& text);

/// Whether the verdict is about the submission. A verdict that is not final costs no points: the
/// test is run again.
inline bool is_final_verdict(Verdict verdict) {
  return verdict != Verdict::kGraderFault && verdict != Verdict::kMachineBusy;
}

struct TestResult {
  std::string test;  // "Suite.Name"
  // fail-closed: only an observed answer changes it
  Verdict verdict = Verdict::kGraderFault;
  // what went wrong, for the student; empty when right
  std::string story;
  // the last function of the module that was called; of a wrong answer: before the first failure
  std::string last_call;
  long calls = 0;  // of the module's functions
  // output of the student's code to stdout and stderr, cut short
  std::string printed;
  double timed_out_s = 0.0;  // the limit that it exceeded; 0: none
  // own time of the submission's code (own_time.h); never part of compared output
  double charged_s = 0.0;
  bool not_run = false;  // the budget of all tests together was used up
  double wall_s = 0.0;   // never part of compared output
};

/// Whether the test was not run because the time of all tests together was used up before it. It
/// counts as out of time; but nothing is known of what it asks.
inline bool is_cut_off(const TestResult& result) {
  return result.not_run && result.verdict == Verdict::kOutOfResources;
}

/// Exit code of a test program: 3 for a fault of the grader or a machine too busy, 1 when something
/// is wrong, 4 when some tests are not attempted and the others right, else 0.
ExitCode exit_code(const std::vector<TestResult>& results);

/// Writes and reads the record of a test program (JSON).
/// @throws UserError when the file cannot be written, read or understood
void write_results(const std::string& file, const std::vector<TestResult>& results);
std::vector<TestResult> read_results(const std::string& file);

}  // namespace tumble::grading
