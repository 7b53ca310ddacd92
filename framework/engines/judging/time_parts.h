/// What the CPU time of a run goes to, in the same parts whichever engine runs: which of them are physics that every engine pays, and
/// which are its own scheduling.
///
/// Read off samples of the stack (core/stack_samples.h): parts are told by names of functions, and the tests see to it that there are
/// functions of these names.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/core/stack_samples.h"

namespace tumble::engines {

/// Contacts, links and forces, motion, impacts, search for impacts: physics. Who may meet: the broad phase.
const std::vector<StackSamples::Part>& time_parts();
/// Of these as many, from the first, are physics: done by the same functions for all engines.
constexpr std::size_t kPhysicsParts = 5;
/// What comes before a run's first step, and is no part of what an engine costs.
const std::vector<std::string>& set_up_functions();

/// Shares of the time of a run, largest possible sum 1.
struct TimeShares {
  std::vector<std::pair<std::string, double>> parts;   // time_parts() by name, and last what is the engine's own: scheduling
  double physics = 0.0;                                // sum of the first kPhysicsParts
  std::size_t samples = 0;                             // 0: the run was too short to tell
};
TimeShares time_shares(const StackSamples& samples);

/// "search for impacts 64 %, contacts 20 %, ...": the largest parts, at least a twentieth each. Empty where there are no samples.
std::string in_words(const TimeShares& shares);

}  // namespace tumble::engines
