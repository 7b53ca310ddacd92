/// What to mend in a submission: a group of failing tests with one likely reason.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/grading/verdicts/parameter_names.h"

namespace tumble::grading {

/// What to mend, and what it costs.
struct Cause {
  enum class Kind { kSlip, kCrash, kOutOfResources, kNotWritten, kUnknown };
  Kind kind = Kind::kUnknown;
  std::string says;                  // what is wrong, in words for the student
  std::vector<std::string> or_else;  // other known slips that fit as well
  std::vector<std::string> functions;
  std::vector<std::string> places;  // by function: "a1_impulse.cpp:97"; empty where not found
  // by function: its lines, with their numbers; around the line of a crash; empty where not found
  std::vector<std::string> code;
  std::vector<std::string> tests;  // that it explains, in the rubric's order
  std::size_t same_numbers = 0;    // of these
  // whose functions ask one of these, and give wrong answers that no other cause explains
  std::vector<std::string> following = {};
  // that were not run because this used up the time of all tests together
  std::vector<std::string> not_run = {};
  // of two mistakes whose answers come together: the second; empty: one explains all
  std::string and_also = {};
  std::size_t by_both = 0;  // of same_numbers, where neither of the two alone gives that answer
  std::size_t alone[2] = {0, 0};  // of the tests, how many either of the two fails alone
  // by function: what the module's header says of it; empty: nobody has looked
  std::vector<FunctionInHeader> told = {};
  // other causes, by their places, and how many of the tests they fail, too: these need both mended
  std::vector<std::pair<std::size_t, std::size_t>> also_needed = {};
  // where no mistake is known to give its answers: other causes, by their places, and in how many
  // of its tests the mistake of that cause gives the answer that came
  std::vector<std::pair<std::size_t, std::size_t>> may_follow = {};

  /// Whether its tests fail with answers that none of the known mistakes of it gives.
  bool has_no_known_answer() const {
    return kind == Kind::kUnknown || (kind == Kind::kSlip && same_numbers == 0);
  }
  /// Whether the code of a function is that around the line of a crash, which has an arrow.
  bool is_marked(std::size_t function) const {
    return function < code.size() &&
           (code[function].starts_with("->") || code[function].find("\n->") != std::string::npos);
  }
};

}  // namespace tumble::grading
