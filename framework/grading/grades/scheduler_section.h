/// The cost section of a scheduler: it is right or wrong at any step size, and its cost is work.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/cost/scheduler_work.h"
#include "framework/grading/course/course.h"
#include "framework/grading/grades/cost_section.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

/// Measures a submission beside the reference. Empty if the module has no showcase, or there is no
/// reference.
/// @param submission  a shared object; never loaded into this process
CostSection measure_scheduler(const Course& course, const modules::ModuleKind& kind,
                              const std::filesystem::path& submission,
                              const CostSectionOptions& options);

/// Common parts of pages about schedulers: error against work, work against the step and against
/// the number of processes, all runs.
/// @param curves  the reference's last
std::vector<report::Plot> scheduler_plots(const std::vector<cost::SchedulerCurve>& curves);
report::Table scheduler_table(const std::vector<cost::SchedulerCurve>& curves);
/// Explains the measured quantities.
std::string what_a_scheduler_pays();
CostLine line_of(const cost::SchedulerReading& reading);

}  // namespace tumble::grading
