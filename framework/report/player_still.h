/// The static part of a player's page, for browsers without scripts and for print: plots and a
/// table of events. Internal to framework/report.
#pragma once

#include <string>
#include <vector>

#include "framework/report/packed_run.h"

namespace tumble::report {

std::string player_still(const std::vector<PlayedRun>& runs, const std::vector<PackedRun>& packed);

}  // namespace tumble::report
