/// Truths that the a2 module's functions give directly: single steps and orders of convergence.
#pragma once

#include "framework/modules/registry.h"

namespace tumble::a2 {

/// logistic.
void register_truths(modules::Registry& registry);

}  // namespace tumble::a2
