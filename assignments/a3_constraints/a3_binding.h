/// The laws of a world that the a3 module provides.
#pragma once

#include "assignments/a3_constraints/a3_constraints.h"
#include "framework/dynamics/laws.h"

namespace tumble::a3 {

void bind(const Module& module, Laws& laws);

}  // namespace tumble::a3
