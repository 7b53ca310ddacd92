/// The laws of a world that the a2 module provides.
#pragma once

#include "assignments/a2_integration/a2_integration.h"
#include "framework/dynamics/laws.h"

namespace tumble::a2 {

void bind(const Module& module, Laws& laws);

}  // namespace tumble::a2
