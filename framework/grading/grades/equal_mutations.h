/// Changes of a reference that make no difference, each with the reason: solutions_private/aN_name/
/// equal_mutations.json, a list of {"before": line, "after": line, "because": words}. Lines are
/// compared without the blanks around them, so that they may move in the file.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/audit.h"

namespace tumble::grading {

struct EqualMutation {
  std::string before, after, because;
};
using EqualMutations = std::vector<EqualMutation>;

/// Empty where the assignment has no such file.
/// @throws UserError when it cannot be read, or an entry lacks a word
EqualMutations read_equal_mutations(const Course& course, const std::string& id);

/// Why a proposed slip (extend/mutations.h) is no slip; empty where no reason is recorded.
std::string why_equal(const Candidate& candidate, const EqualMutations& known);

}  // namespace tumble::grading
