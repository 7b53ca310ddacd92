/// Measures the cost of accuracy with a submission's methods.
#pragma once

#include <filesystem>
#include <string>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/cost_section.h"

namespace tumble::grading {

/// Measures a module that has a showcase (cost::CostShowcase). Its calls run in the sandbox; a
/// hang or crash there ends only its own curve.
/// @param submission  a shared object; never loaded into this process
CostSection measure_cost(const Course& course, const std::string& id,
                         const std::filesystem::path& submission,
                         const CostSectionOptions& options = {});

}  // namespace tumble::grading
