/// Why a figure is what it is: where each engine's time went, beside the figure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/report/stacked_bars.h"
#include "tests/bench/engine_measures.h"

namespace tumble::testing {

/// A bar a run, in shares; its name says how long it took.
report::StackedBars bars_of(const std::string& title, const std::vector<std::pair<std::string, const Measured*>>& runs, const std::string& caption = "");

/// Of timewarp's run: its parts, and what `best` over its time would be if all that is not physics
/// cost nothing: what no scheduler can exceed that has the same pairs searched and the same
/// contacts solved.
std::string why(const Measured& tw, const Measured& best);

/// What one committed collision takes: integrations, pair checks, time in each part. Where the
/// counts stay and times grow, they wait for memory.
std::string a_collision_of(const Measured& tw);

/// Of two threads: rounds, time together, time of one alone, and what is left of the time by the
/// clock: waiting.
std::string threads_of(const Measured& two);

}  // namespace tumble::testing
