// tumble VERB ...: reads the words, runs the verb, turns errors into exit codes.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "framework/cli/verb.h"
#include "framework/core/not_implemented.h"
#include "framework/grading/test_words.h"

namespace {

using tumble::ExitCode;

// The build tree is where this program lies (build/bin/tumble); the source tree is told by the launcher, else it is the
// build tree's parent.
void find_trees(tumble::cli::Context& context) {
  const auto program = std::filesystem::canonical("/proc/self/exe");
  context.build = program.parent_path().parent_path();
  const char* told = std::getenv("TUMBLE_ROOT");
  context.root = told != nullptr ? std::filesystem::path(told) : context.build.parent_path();
}

// The parser would only say that a verb is missing.
void refuse_unknown_verb(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string known;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == argv[1]) return;
    known += (known.empty() ? "" : ", ") + verb->get_name();
  }
  throw tumble::UserError(argv[1], "there is no such verb", "Known: " + known + ". tumble --help says what each does.");
}

// The parser would only say that a flag was not expected.
void refuse_unknown_flag(const CLI::App& app) {
  for (const CLI::App* verb : app.get_subcommands()) {
    for (const std::string& word : verb->remaining()) {
      const std::string flag = word.substr(0, word.find('='));
      if (!flag.starts_with("-") || flag == "-") continue;
      std::string known, nearest;
      std::size_t least = flag.size();
      for (const CLI::Option* option : verb->get_options()) {
        for (const std::string& name : option->get_lnames()) {
          known += (known.empty() ? "--" : ", --") + name;
          const std::size_t distance = tumble::grading::edit_distance("--" + name, flag);
          if (distance < least) least = distance, nearest = "--" + name;
        }
      }
      const bool is_near = least <= 2 + flag.size() / 4;
      throw tumble::UserError(flag, verb->get_name() + " has no such flag", (is_near ? "Did you mean " + nearest + "? " : "") + "Known: " + known + ".");
    }
  }
}

int run(int argc, char** argv) {
  tumble::cli::Context context;
  find_trees(context);
  for (int i = 0; i < argc; ++i) context.command_line += (i > 0 ? " " : "") + std::string(i > 0 ? argv[i] : "tumble");
  tumble::register_assignments(context.registry);

  CLI::App app{"Tumble: a course on rigid-body simulation that grades itself", "tumble"};
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every verb");
  tumble::cli::add_verbs(app, context);
  refuse_unknown_verb(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    refuse_unknown_flag(app);
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUserError);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUserError);
  }
  return static_cast<int>(context.exit);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const tumble::UserError& error) {
    std::fprintf(stderr, "tumble: %s\n", error.what());
    return static_cast<int>(ExitCode::kUserError);
  } catch (const tumble::NotImplemented& missing) {
    std::fprintf(stderr, "tumble: not attempted: %s\n", missing.what());
    return static_cast<int>(ExitCode::kNotAttempted);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tumble: this is our bug, please report it with the command: %s\n", error.what());
    return static_cast<int>(ExitCode::kOurBug);
  }
}
