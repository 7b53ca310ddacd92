/// Hostile submissions put through `tumble grade`, with an honest one beside them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/grading/attacks/attack.h"
#include "framework/grading/attacks/compare_results.h"

namespace tumble::grading {

struct AttackOptions {
  std::filesystem::path root;   // of the source tree
  std::filesystem::path build;  // bin/tumble grades
  std::string sandbox;          // name of the kind
  int jobs = 2;                 // submissions at a time
  // called with a sentence before each grading; may be empty
  std::function<void(const std::string&)> progress;
};

struct AttackReport {
  std::vector<AttackResult> attacks;
  // not of one attack, but of all that were graded together: left processes and files, the honest
  // submission's result, secrets in an output
  std::vector<std::string> faults;

  bool is_good() const;
};

/// Grades the attacks, those of each assignment together with an honest right solution, whose
/// results.json must be the same bytes as without them. What each may not do stands in attack.h;
/// attacks that this sandbox or user cannot try are left out.
/// @throws UserError when an attack cannot be made or a program is not built
AttackReport run_attacks(const std::vector<Attack>& attacks, const AttackOptions& options);

}  // namespace tumble::grading
