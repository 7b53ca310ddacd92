// Makes the fast scheduler what `--engine tw` is.
#include "framework/engines/timewarp/fast_timewarp.h"
#include "solutions_private/a4_timewarp/fast/fast_timewarp.h"

namespace tumble::engines {

Engine fast_timewarp() { return a4::run_fast_timewarp; }

}  // namespace tumble::engines
