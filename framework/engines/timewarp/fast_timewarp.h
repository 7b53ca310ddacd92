/// The fast scheduler of timewarp, where this tree has one.
#pragma once

#include "framework/engines/run.h"

namespace tumble::engines {

/// What `--engine tw` is when no module is asked for; empty in a tree without one. Defined once: with the solutions, or in
/// no_fast_timewarp.cpp where there are none.
Engine fast_timewarp();

}  // namespace tumble::engines
