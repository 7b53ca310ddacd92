/// The chart of local virtual times in a player's page.
#pragma once

#include "framework/report/player.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::report {

/// @param times  recorded by an engine; the page draws every process, so a few dozen processes and
///   some ten thousand moves are practical
PlayerPanel virtual_times_panel(const VirtualTimes& times);

}  // namespace tumble::report
