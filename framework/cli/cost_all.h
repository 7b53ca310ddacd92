/// tumble cost all: every scene measured, with one table of the cost of an error of 1e-3, 1e-6,
/// 1e-9 m in each, beside that of the best peer.
#pragma once

#include "framework/cli/cost_methods.h"
#include "framework/cli/kept_at_stop.h"

namespace tumble::cli {

inline constexpr const char* kAllWord = "all";

/// Writes OUT/SCENE/index.html of every scene and OUT/index.html with the table, and prints the
/// tables. Peers are included where tests/bench/peers/run.sh has left rows in out/peers/rows. A
/// scene that fails gives a line with its error, and exit code 1.
/// @param stop  keeps OUT/index.html after each scene
void cost_of_all(Context& context, const CostWords& words, KeptAtStop& stop);

}  // namespace tumble::cli
