#include "framework/cli/command.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <regex>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "framework/cli/help_format.h"
#include "framework/core/keep_memory.h"
#include "framework/core/nearest_word.h"
#include "framework/core/not_implemented.h"
#include "framework/core/program_trees.h"
#include "framework/core/terminal.h"
#include "framework/core/version.h"

namespace tumble::cli {
namespace {

// Programs that a verb starts find the same root.
void set_trees(Command& command) {
  const ProgramTrees trees = find_trees();
  command.root = trees.root;
  command.build = trees.build;
  command.is_installed = trees.is_installed;
  ::setenv("TUMBLE_ROOT", trees.root.c_str(), 1);
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

// The parser would only report a missing verb.
void refuse_unknown_verb(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> known;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    known.push_back(verb->get_name());
  if (std::find(known.begin(), known.end(), argv[1]) != known.end()) return;
  throw UserError(argv[1], "there is no such verb." + did_you_mean(argv[1], known),
                  "Known: " + joined(known) + ". tumble --help says what each does.");
}

// The parser would only report an unexpected flag.
void refuse_unknown_flag(const CLI::App& app) {
  for (const CLI::App* verb : app.get_subcommands()) {
    std::vector<std::string> known;
    for (const CLI::Option* option : verb->get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const std::string& word : verb->remaining()) {
      const std::string flag = word.substr(0, word.find('='));
      if (!flag.starts_with("-") || flag == "-") continue;
      throw UserError(flag, verb->get_name() + " has no such flag." + did_you_mean(flag, known),
                      "Known: " + joined(known) + ".");
    }
  }
}

// The parser's complaints in the words of the others here.
std::string in_our_words(const std::string& told) {
  // a range of 309 digits where a number has to be positive: to the largest double
  static const std::vector<std::pair<std::regex, std::string>> said = {
      {std::regex(" not in range 0\\.000000 to 1797.*"), " is not a number above 0"},
      {std::regex("(.*): \\d+ required .* missing"), "$1: its value is missing"},
      {std::regex("(.*): At Most 1 required but received (\\d+)"), "$1: is given $2 times"},
      {std::regex("Could not convert: (.*) = (.*)"), "$1: Value $2 is not what it takes"},
      {std::regex("The following arguments? w\\w+ not expected: (.*)"), "$1: more than it takes"}};
  for (const auto& [theirs, ours] : said)
    if (std::regex_search(told, theirs)) return std::regex_replace(told, theirs, ours);
  return told;
}

// On a terminal broken at words to its width; a file or a pipe keeps the line, to be searched.
void complain(const std::string& text) {
  const bool is_terminal = ::isatty(STDERR_FILENO) == 1;
  const std::string shown = is_terminal ? wrapped(text, terminal_columns(STDERR_FILENO), 2) : text;
  std::fprintf(stderr, "%s\n", shown.c_str());
}

int run(int argc, char** argv, Command& command, const std::function<void(CLI::App&)>& declare) {
  set_trees(command);
  for (int i = 0; i < argc; ++i)
    command.command_line += (i > 0 ? " " : "") + std::string(i > 0 ? argv[i] : "tumble");

  CLI::App app{"Tumble: a course on rigid-body simulation that grades itself", "tumble"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("Tumble ") + kProgramVersion);
  app.set_help_all_flag("--help-all", "Help of every verb");
  app.set_help_flag("-h,--help", "This text");
  lay_out_help(app);
  declare(app);
  app.footer(
      "./tumble test  (in the source tree) builds and passes every test (the longest draw a "
      "sample, with --whole all of it); words of ctest may follow.\n"
      "Colours: none where NO_COLOR is set. A word that is not known is answered with the "
      "nearest.");
  refuse_unknown_verb(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::vector<CLI::App*> verbs = app.get_subcommands();
    if (error.get_exit_code() == 0 || verbs.empty())  // a call for help; or of the program alone
      return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUserError);
    refuse_unknown_flag(app);  // likely what is missing, mistyped
    const std::string verb = "tumble " + verbs.front()->get_name();
    throw UserError(verb, in_our_words(error.what()),
                    verb + " --help says what it takes, with an example.");
  }
  return static_cast<int>(command.exit);
}

}  // namespace

std::filesystem::path own_file(const Command& command, const std::string& folder) {
  const std::string name = folder + ".cpp";
  return command.is_installed ? std::filesystem::current_path() / name
                              : command.root / "assignments" / folder / name;
}

UserError missing_file(const Command& command, const std::string& id,
                       const std::filesystem::path& file) {
  return command.is_installed
             ? UserError(file.string(), "is not there",
                         "Begin with: tumble start " + id + " FOLDER; then run it in that folder.")
             : UserError(file.string(), "is not there",
                         "Put your file back, or take it from the starter tree.");
}

int run_verbs(int argc, char** argv, Command& command,
              const std::function<void(CLI::App&)>& declare) {
  keep_freed_memory();
  try {
    return run(argc, argv, command, declare);
  } catch (const UserError& error) {
    complain(std::string("tumble: ") + error.what());
    return static_cast<int>(ExitCode::kUserError);
  } catch (const NotImplemented& missing) {
    complain(std::string("tumble: not attempted: ") + missing.what());
    return static_cast<int>(ExitCode::kNotAttempted);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tumble: this is our bug, please report it with the command: %s\n",
                 error.what());
    return static_cast<int>(ExitCode::kOurBug);
  }
}

}  // namespace tumble::cli
