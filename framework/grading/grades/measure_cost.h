/// Measures what accuracy costs with a submission's own methods.
#pragma once

#include <filesystem>
#include <string>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/cost_section.h"

namespace tumble::grading {

/// Measures a module where it says that this is done (ModuleKind::cost). Its calls go to the sandbox; what hangs or crashes there ends its
/// own curve, and costs nothing else.
/// @param submission  a shared object; never loaded into this process
CostSection measure_cost(const Course& course, const std::string& id, const std::filesystem::path& submission, const CostSectionOptions& options = {});

}  // namespace tumble::grading
