/// The laws of a world that the a5 module provides, and its registration.
#pragma once

#include "assignments/a5_plausible/a5_plausible.h"
#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::a5 {

void bind(const Module& module, Laws& laws);

/// What register_assignments() calls of each assignment.
void register_module(modules::Registry& registry);

}  // namespace tumble::a5
