/// Comparisons of the a2 module's functions with reference values: single steps and orders of
/// convergence.
#pragma once

#include "framework/modules/registry.h"

namespace tumble::a2 {

/// logistic.
void register_truths(modules::Registry& registry);

}  // namespace tumble::a2
