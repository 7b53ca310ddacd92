// The list of verbs, in the order in which help shows them.
#include "framework/cli/verb.h"

namespace tumble::cli {

void add_verbs(CLI::App& app, Context& context) {
  (void)app;
  (void)context;
}

}  // namespace tumble::cli
