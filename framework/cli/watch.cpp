// tumble watch a1 [FILE] [PATTERN...]: the student's loop on every save, until Ctrl-C.
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/check_program.h"
#include "framework/core/save_watch.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

void watch(Command& command, const CheckWords& words) {
  const fs::path file = checked_file(command, words);
  SaveWatch saves({file});
  const bool screen = ::isatty(STDOUT_FILENO) == 1;
  for (;;) {
    if (screen) fmt::print("\033[2J\033[3J\033[H");
    // The test program and the compiler have exit codes of their own; errors of the loop itself are
    // reported and do not end it.
    try {
      check_once(command, words);
    } catch (const UserError& error) {
      fmt::print("{}\n", error.what());
    }
    const std::time_t now = std::time(nullptr);
    char clock[16];
    std::strftime(clock, sizeof clock, "%H:%M:%S", std::localtime(&now));
    fmt::print("\n{}  waiting for {} to be saved; Ctrl-C ends\n", clock, file.filename().string());
    std::fflush(stdout);
    saves.wait();
  }
}

}  // namespace

void add_watch(CLI::App& app, Command& command) {
  auto id = std::make_shared<std::string>();
  auto rest = std::make_shared<std::vector<std::string>>();
  Verb verb(app, "watch", "The same as check, on every save");
  add_check_words(verb, *rest, *id);
  verb.runs([&command, id, rest] { watch(command, read_check_words(*id, *rest)); });
}

}  // namespace tumble::cli
