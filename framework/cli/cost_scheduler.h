/// tumble cost a4: what a scheduler pays for each event that it commits, over its step and over the number of processes, beside the
/// reference and the other engines.
#pragma once

#include "framework/cli/cost_ways.h"
#include "framework/modules/registry.h"

namespace tumble::cli {

/// Writes OUT/a4/index.html and prints the sentences and the counts. @throws UserError as find_subject
void cost_of_scheduler(Context& context, const modules::ModuleKind& kind, const CostWords& words);

}  // namespace tumble::cli
