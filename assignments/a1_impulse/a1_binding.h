/// The laws of a world that the a1 module provides.
#pragma once

#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/dynamics/laws.h"

namespace tumble::a1 {

void bind(const Module& module, Laws& laws);

}  // namespace tumble::a1
