// tumble VERB ...: every verb.
#include "framework/cli/verb.h"

int main(int argc, char** argv) {
  tumble::cli::Context context;
  return tumble::cli::run_verbs(argc, argv, context, [&](CLI::App& app) {
    tumble::register_assignments(context.registry);
    tumble::cli::add_verbs(app, context);
  });
}
