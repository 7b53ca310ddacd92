/// The scheduling of a world that the a4 module provides.
#pragma once

#include "assignments/a4_timewarp/a4_timewarp.h"
#include "framework/dynamics/laws.h"

namespace tumble::a4 {

void bind(const Module& module, Laws& laws);

}  // namespace tumble::a4
