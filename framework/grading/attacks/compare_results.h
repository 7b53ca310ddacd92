/// An attack's results.json against that of the harmless submission.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/attacks/attack.h"

namespace tumble::grading {

struct AttackResult {
  std::string attack, sandbox;
  std::string found;     // state or verdicts, in words
  double score = 0.0;    // points
  double seconds = 0.0;  // of its grading; 0: not known
  std::vector<std::string> faults;
};

/// No test may score more than the harmless submission's; those with another verdict have one that
/// the attack names.
/// @param results, record  texts of results.json and record.json
void compare_results(const Attack& attack, const std::string& results, const std::string& record,
                     const std::string& harmless, AttackResult& result);

}  // namespace tumble::grading
