/// The laws of a world that the a1 module provides, and its registration.
#pragma once

#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::a1 {

void bind(const Module& module, Laws& laws);

/// What register_assignments() calls of each assignment.
void register_module(modules::Registry& registry);

}  // namespace tumble::a1
