/// The module that provides the functions of a chain.
#pragma once

#include <functional>

#include "framework/dynamics/sampling.h"
#include "framework/modules/load.h"

namespace tumble::sampling {

/// Noted in the registration of a module (Registry::set_note): its functions as parts of a chain.
struct Sampler {
  std::function<Sampling(const modules::AnyModule&)> functions;  // empty: it is no sampler
};

}  // namespace tumble::sampling
