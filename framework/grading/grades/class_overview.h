/// What a grading leaves beside the folders of its submissions: gradebook, index, handout, times.
#pragma once

#include <vector>

#include "framework/grading/grades/one_grading.h"

namespace tumble::grading {

/// Writes them and hands the grades to the options' overview. A page that cannot be made is told
/// (GradeOptions::failed): no grade depends on it.
/// @param all  settled; their grades are moved out
/// @return the grades of all that have one, in this order
std::vector<Grade> write_overview(const GradingTerms& terms, std::vector<GradedWork>& all);

}  // namespace tumble::grading
