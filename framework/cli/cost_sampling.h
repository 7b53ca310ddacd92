/// tumble cost a5: the error of a chain's answers over the CPU time that it took, by each kind of
/// proposal, beside brute force from the prior.
#pragma once

#include "framework/cli/cost_methods.h"
#include "framework/modules/registry.h"

namespace tumble::cli {

/// Writes OUT/a5/index.html and prints the sentences and the table.
/// @param kind  a module that registered functions of a chain (sampling::Sampler)
/// @throws UserError for words that change nothing here, and for a scene without "sampling"
void cost_of_sampling(Context& context, const modules::ModuleKind& kind, const CostWords& words);

}  // namespace tumble::cli
