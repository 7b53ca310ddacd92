/// Fractions of a run's CPU time, in the same parts for every engine: physics, which every engine
/// computes, and its own scheduling.
///
/// Computed from samples of the stack (core/stack_samples.h): parts are recognised by the names of
/// functions; tests check that functions of these names exist.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/core/stack_samples.h"

namespace tumble::engines {

/// Contacts, links and forces, motion, impacts, search for impacts: physics. Broad phase: "who may
/// meet".
const std::vector<StackSamples::Part>& time_parts();
/// The first this many are physics: the same functions in all engines.
constexpr std::size_t kPhysicsParts = 5;
/// Set-up before a run's first step, which is not part of an engine's cost.
const std::vector<std::string>& set_up_functions();

/// Fractions of the time of a run; their sum is at most 1.
struct TimeShares {
  // time_parts() by name; last the engine's own: scheduling
  std::vector<std::pair<std::string, double>> parts;
  double physics = 0.0;     // sum of the first kPhysicsParts
  std::size_t samples = 0;  // 0: the run was too short
};
TimeShares time_shares(const StackSamples& samples);

/// "search for impacts 64 %, contacts 20 %, ...": the largest parts, at least 5 % each. Empty
/// without samples.
std::string in_words(const TimeShares& shares);

}  // namespace tumble::engines
