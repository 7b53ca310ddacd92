// What a tree without solutions links: no scheduler but the one that a student writes.
#include "framework/engines/timewarp/fast_timewarp.h"

namespace tumble::engines {

Engine fast_timewarp(VirtualTimes*, const RollbackWatch*) { return {}; }

}  // namespace tumble::engines
