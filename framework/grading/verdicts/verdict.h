/// What can be said of one test of one submission, and the record that carries it from a test program to a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/error.h"

namespace tumble::grading {

enum class Verdict {
  kRight,
  kWrong,           // answered, and the answer is not right
  kNotAttempted,    // the stub is still there
  kCrashed,         // a signal, an exit, or an exception where an answer was due
  kOutOfResources,  // out of time or memory
  kGraderFault,     // ours: never counted against a submission
  kMachineBusy,     // so little of the machine was left that nothing can be said: to be run again
};

/// "right", "wrong", "not attempted", "crashed", "out of time or memory", "fault of the grader", "machine too busy"
const char* words(Verdict verdict);
/// The inverse of words(). @return empty for anything else
std::optional<Verdict> verdict_from_words(const std::string& text);

/// It says something about the submission. What is not final is no lost point: it is run again.
inline bool is_final_verdict(Verdict verdict) { return verdict != Verdict::kGraderFault && verdict != Verdict::kMachineBusy; }

struct TestResult {
  std::string test;                                // "Suite.Name"
  Verdict verdict = Verdict::kGraderFault;         // fail-closed: only a seen answer makes it anything else
  std::string story;                               // what went wrong, for the student; empty when right
  std::string last_call;                           // the last function of the module that was called
  long calls = 0;                                  // of the module's functions
  std::string printed;                             // what the student's code wrote to stdout and stderr, cut short
  double timed_out_s = 0.0;                        // the limit that it ran into; 0: none
  double charged_s = 0.0;                          // time that the submission's code took (own_time.h); kept out of everything that is compared
  bool not_run = false;                            // the budget of all tests together was used up before
  double wall_s = 0.0;                             // kept out of everything that is compared
};

/// What a program says with its exit code: 3 for a fault of ours or a machine too busy, 1 when something is wrong, 4 when all that is missing is
/// not attempted, else 0.
ExitCode exit_code(const std::vector<TestResult>& results);

/// Writes and reads the record of a test program (JSON).
/// @throws UserError when the file cannot be written, read or understood
void write_results(const std::string& file, const std::vector<TestResult>& results);
std::vector<TestResult> read_results(const std::string& file);

}  // namespace tumble::grading
