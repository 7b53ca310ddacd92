/// The laws of a world that the a3 module provides, and its registration.
#pragma once

#include "assignments/a3_constraints/a3_constraints.h"
#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::a3 {

void bind(const Module& module, Laws& laws);

/// What register_assignments() calls of each assignment.
void register_module(modules::Registry& registry);

}  // namespace tumble::a3
