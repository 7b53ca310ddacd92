/// The reason of a figure: the parts of each engine's time, beside the figure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/report/stacked_bars.h"
#include "tests/bench/engine_measures.h"

namespace tumble::testing {

/// One bar per run, in fractions; its name gives its time.
report::StackedBars bars_of(const std::string& title,
                            const std::vector<std::pair<std::string, const Measured*>>& runs,
                            const std::string& caption = "");

/// Of timewarp's run: its parts, and `best` over its time if everything except physics were free:
/// an upper bound for any scheduler with the same searched pairs and solved contacts.
std::string why(const Measured& tw, const Measured& best);

/// The cost of one committed collision: integrations, pair checks, time in each part. Where the
/// counts are constant and times grow, memory latency is the cause.
std::string a_collision_of(const Measured& tw);

/// Of two threads: epochs, concurrent time, sequential time, and the rest of the wall time:
/// waiting.
std::string threads_of(const Measured& two);

}  // namespace tumble::testing
