/// What every verb is given, and the main() that verbs share.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "framework/core/error.h"

namespace CLI {
class App;
}  // namespace CLI

namespace tumble::cli {

struct Command {
  std::filesystem::path root;       // of the source tree
  std::filesystem::path build;      // of the build tree that this program is from
  bool is_installed = false;        // from a package: the student's file is in the working folder
  std::string command_line;         // as typed, for records
  ExitCode exit = ExitCode::kFine;  // what the verb that ran says
};

/// The student's file of an assignment: below assignments/ of a source tree; in the working folder
/// where the course is installed.
std::filesystem::path own_file(const Command& command, const std::string& folder);
/// That it is not there.
UserError missing_file(const Command& command, const std::string& id,
                       const std::filesystem::path& file);

/// main() of a program of verbs: finds the trees, reads the words, runs the verb, turns errors into
/// exit codes.
/// @param declare  declares the verbs, which keep what they are given of `command`
int run_verbs(int argc, char** argv, Command& command,
              const std::function<void(CLI::App&)>& declare);

// Verbs that need no scene, no engine and no module's header: programs of their own hold them too
// (CMakeLists.txt), so that who checks a file or inspects a mesh does not wait for all that
// `tumble` is made of.
void add_check(CLI::App& app, Command& command);
void add_handouts(CLI::App& app, Command& command);
void add_inspect(CLI::App& app, Command& command);
void add_new(CLI::App& app, Command& command);
void add_plots(CLI::App& app, Command& command);
void add_start(CLI::App& app, Command& command);
void add_watch(CLI::App& app, Command& command);

}  // namespace tumble::cli
