/// The fast scheduler of timewarp, in a tree that has one.
#pragma once

#include "framework/engines/base/run_options.h"
#include "framework/engines/timewarp/rollback_check.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::engines {

/// The engine of `--engine tw` where no module provides a scheduler; empty in a tree without one.
/// Defined once: with the solutions, or in no_fast_timewarp.cpp.
/// @param record  receives every change of a local virtual time, the first `kMostMoves` of them
///   where there are more; null: none. Outlives the engine
/// @param watch   for tests: rolls everything back repeatedly (rollback_check.h); null: never.
///   Outlives the engine
Engine fast_timewarp(VirtualTimes* record = nullptr, const RollbackCheck* watch = nullptr);

constexpr std::size_t kMostMoves = 200'000;

}  // namespace tumble::engines
