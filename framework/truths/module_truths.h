/// Cases whose outputs a module's own functions give directly, noted in its registration.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>

#include "framework/truths/comparison.h"
#include "framework/truths/truth_case.h"
#include "framework/modules/registry.h"

namespace tumble::truths {

struct ModuleTruths {
  /// By family: computes a case with the module and compares all its outputs.
  std::map<std::string, std::function<void(const modules::AnyModule&, const Case&, Comparison&)>>
      families;
};

/// @param compare  as above, for the module's own type
template <class Module>
std::function<void(const modules::AnyModule&, const Case&, Comparison&)> for_module(
    void (*compare)(const Module&, const Case&, Comparison&)) {
  return [compare](const modules::AnyModule& module, const Case& truth, Comparison& comparison) {
    compare(*static_cast<const Module*>(module.get()), truth, comparison);
  };
}

}  // namespace tumble::truths
