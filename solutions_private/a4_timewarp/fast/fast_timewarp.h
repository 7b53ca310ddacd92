/// The fast timewarp: every body is a logical process with its own local virtual time. This folder
/// is an engine, not a solution of the assignment: it must not be handed out.
///
/// A process advances optimistically: its flight is checked against all bodies that it may meet up
/// to its horizon, which is its local virtual time, without a message to them. Invariant: for every
/// two bodies, all impacts up to the lesser of their local virtual times are known. A process that
/// reaches a place and time later finds there the other's motion; where it finds an impact in the
/// other's past, the other is rolled back. Safe times need no storage per pair: the safe time of a
/// pair is the lesser of its local virtual times.
///
/// The effect of a body on another is stored in its flights: the partner of the event that began
/// the flight, and the version of the partner's flight that began with it. A dropped flight
/// therefore names its anti-message. Events on dropped flights are recognised by their versions
/// when their turn comes.
///
/// The committed trace does not depend on the order of execution: two flights determine their
/// impact to the last bit, and of a body's impacts the first in the total order is the only one
/// that no other impact can cancel.
#pragma once

#include "framework/engines/base/run_options.h"
#include "framework/engines/timewarp/rollback_check.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::a4 {

/// @pre `laws` has every law that the scene needs
/// @param record  receives changes of local virtual times; null: none
/// @param watch   rolls everything back repeatedly; null: never
/// @throws UserError where the scene has an effect that flights do not model
void run_fast_timewarp(const scene::Scene& scene, const Laws& laws,
                       const engines::RunOptions& options, TrajectorySink& sink,
                       VirtualTimes* record = nullptr,
                       const engines::RollbackCheck* watch = nullptr);

}  // namespace tumble::a4
