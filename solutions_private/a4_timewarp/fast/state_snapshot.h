/// What stands in the fast scheduler at one time, as bytes (framework/engines/timewarp/rollback_watch.h).
#pragma once

#include <memory>
#include <vector>

#include "framework/engines/timewarp/rollback_watch.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

namespace tumble::a4 {

/// @param t  to which everybody has gone back: steps of passages beyond it are only worked out ahead, and left out
/// @pre one thread works alone
engines::Standing standing_of(Shared& all, std::vector<std::unique_ptr<Worker>>& workers, double t);

}  // namespace tumble::a4
