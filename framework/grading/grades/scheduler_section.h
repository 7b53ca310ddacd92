/// What accuracy costs where a module decides the order of things: a scheduler is right or wrong at any step, and pays in work.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/engines/cost/scheduler_work.h"
#include "framework/grading/course/course.h"
#include "framework/grading/grades/cost_section.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

/// Of a submission, beside the reference. Nothing where the module does not show its cost, or there is no reference.
/// @param submission  a shared object; never loaded into this process
CostSection measure_scheduler(const Course& course, const modules::ModuleKind& kind, const std::filesystem::path& submission, const CostSectionOptions& options);

/// Parts that every page about schedulers has: error against work, work against the step and against the number of processes, all runs.
/// @param curves  the reference's last
std::vector<report::Plot> scheduler_plots(const std::vector<engines::SchedulerCurve>& curves);
report::Table scheduler_table(const std::vector<engines::SchedulerCurve>& curves);
/// What is measured and how, in sentences.
std::string what_a_scheduler_pays();
CostLine line_of(const engines::SchedulerReading& reading);

}  // namespace tumble::grading
