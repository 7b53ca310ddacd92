/// The scheduling of a world that the a4 module provides, and its registration.
#pragma once

#include "assignments/a4_timewarp/a4_timewarp.h"
#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::a4 {

void bind(const Module& module, Laws& laws);

/// What register_assignments() calls of each assignment.
void register_module(modules::Registry& registry);

}  // namespace tumble::a4
