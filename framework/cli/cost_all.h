/// tumble cost all: every scene measured, one table of what an error of 1e-3, 1e-6, 1e-9 m costs in each, and what the best peer pays.
#pragma once

#include "framework/cli/cost_ways.h"

namespace tumble::cli {

inline constexpr const char* kAllWord = "all";

/// Writes OUT/SCENE/index.html of every scene and OUT/index.html over them, and prints the tables. Peers are in it where
/// tests/bench/peers/run.sh has left rows in out/peers/rows. A scene that fails costs its own line, and exit code 1.
void cost_of_all(Context& context, const CostWords& words);

}  // namespace tumble::cli
