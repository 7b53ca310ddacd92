/// The laws of a world that the a2 module provides, and its registration.
#pragma once

#include "assignments/a2_integration/a2_integration.h"
#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::a2 {

void bind(const Module& module, Laws& laws);

/// What register_assignments() calls of each assignment.
void register_module(modules::Registry& registry);

}  // namespace tumble::a2
