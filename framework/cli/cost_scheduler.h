/// tumble cost a4: the work of a scheduler per committed event, over its step and over the number
/// of processes, beside the reference and the other engines.
#pragma once

#include "framework/cli/cost_methods.h"
#include "framework/modules/registry.h"

namespace tumble::cli {

/// Writes OUT/a4/index.html and prints the sentences and the counts. @throws UserError as
/// find_subject
void cost_of_scheduler(Context& context, const modules::ModuleKind& kind, const CostWords& words);

}  // namespace tumble::cli
