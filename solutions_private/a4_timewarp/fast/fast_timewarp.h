/// Timewarp, made to be fast: every body a process with a local virtual time of its own.
///
/// A process goes on optimistically: its flight is checked against whoever it may meet up to a horizon of its own, its local virtual
/// time, and it says so to nobody. What is true at any moment: of every two bodies all impacts up to the lesser of their two local
/// virtual times are known. So whichever process comes later to a place and a time finds there what the other was doing, and where an
/// impact with it is found in its past, the other is rolled back. Safe times therefore need no bookkeeping a pair: the safe time of a
/// pair is the lesser of its local virtual times.
///
/// What a body did to another stands in its flights: with whom the flight began, and which flight of the other began with it. Dropping
/// a flight therefore names its anti-message. Events that speak of dropped flights are recognised by serial numbers when their turn comes.
///
/// Whatever order processes work in, the committed trace is the same: two flights determine their impact to the last bit, and of the
/// impacts of any body the first in the total order is the only one that no other can take back.
#pragma once

#include "framework/engines/base/run_options.h"
#include "framework/engines/timewarp/rollback_watch.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::a4 {

/// @pre `laws` has every law that the scene needs
/// @param record  where moves of local virtual times are written; null: nowhere
/// @param watch   rolls everything back on trial; null: never
/// @throws UserError where the scene has what no flight follows
void run_fast_timewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record = nullptr, const engines::RollbackWatch* watch = nullptr);

}  // namespace tumble::a4
