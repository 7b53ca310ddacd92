/// The chart of local virtual times in a player's page.
#pragma once

#include "framework/report/player.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::report {

/// @param times  recorded by an engine; a page draws every process, so some tens of them and some ten thousand moves are what a reader can use
PlayerPanel virtual_times_panel(const VirtualTimes& times);

}  // namespace tumble::report
