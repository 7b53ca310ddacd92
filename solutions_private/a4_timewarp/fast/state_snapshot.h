/// The state of the fast scheduler at one time, as bytes
/// (framework/engines/timewarp/rollback_check.h).
#pragma once

#include <memory>
#include <vector>

#include "framework/engines/timewarp/rollback_check.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

namespace tumble::a4 {

/// @param t  the time to which all processes have been rolled back: steps of segments beyond it are
///   only computed ahead, and left out
/// @pre one thread runs alone
engines::StateSnapshot snapshot_of(Shared& all, std::vector<std::unique_ptr<Worker>>& workers,
                                   double t);

}  // namespace tumble::a4
