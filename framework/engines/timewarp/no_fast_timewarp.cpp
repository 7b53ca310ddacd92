// For a tree without solutions: the only scheduler is a student's.
#include "framework/engines/timewarp/fast_timewarp.h"

namespace tumble::engines {

Engine fast_timewarp(VirtualTimes*, const RollbackCheck*) { return {}; }

}  // namespace tumble::engines
