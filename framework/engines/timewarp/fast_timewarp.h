/// The fast scheduler of timewarp, where this tree has one.
#pragma once

#include "framework/engines/base/run_options.h"
#include "framework/engines/timewarp/rollback_watch.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::engines {

/// What `--engine tw` is when no module is asked for; empty in a tree without one. Defined once: with the solutions, or in
/// no_fast_timewarp.cpp where there are none.
/// @param record  where every move of a local virtual time is written, if it is not null; kept by the caller as long as the engine runs.
///                A long run is written as far as `kMostMoves` go
/// @param watch   a test's: rolls everything back on trial, if it is not null; kept by the caller likewise
Engine fast_timewarp(VirtualTimes* record = nullptr, const RollbackWatch* watch = nullptr);

constexpr std::size_t kMostMoves = 200'000;

}  // namespace tumble::engines
