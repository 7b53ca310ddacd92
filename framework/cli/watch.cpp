// tumble watch a1 [FILE] [TEST...]: the student's loop on every save, until Ctrl-C.
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/check_program.h"
#include "framework/core/files.h"
#include "framework/core/save_watch.h"
#include "framework/core/terminal.h"
#include "framework/grading/verdicts/what_changed.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

/// What the last save changed, and what comes next, in two lines below the table.
class Progress {
 public:
  explicit Progress(const grading::Rubric& rubric) : rubric_(rubric) {}

  /// @param file  the verdicts of this check; not there where no test ran
  void print(const fs::path& file) {
    if (!fs::exists(file)) return;
    const std::vector<grading::TestResult> now = grading::read_results(file.string());
    if (!before_.empty())
      print("\nsince the last save: " + grading::what_changed(before_, now, rubric_));
    const std::string next = grading::what_comes_next(now, rubric_);
    print((before_.empty() ? "\n" : "") +
          (next.empty() ? "every public test is right" : "next: " + next));
    before_ = now;
  }

 private:
  static void print(const std::string& text) {
    fmt::print("{}\n", wrapped(text, terminal_columns(STDOUT_FILENO), 4));
  }

  grading::Rubric rubric_;
  std::vector<grading::TestResult> before_;
};

void watch(Command& command, CheckWords words) {
  const fs::path file = checked_file(command, words);
  const PrivateFolder folder;
  words.results = folder.path() / "verdicts.json";
  Progress progress(grading::read_rubric(public_rubric(command, words)));
  SaveWatch saves({file});
  const bool screen = ::isatty(STDOUT_FILENO) == 1;
  for (;;) {
    if (screen) fmt::print("\033[2J\033[3J\033[H");
    // The test program and the compiler have exit codes of their own; errors of the loop itself are
    // reported and do not end it.
    try {
      fs::remove(words.results);
      check_once(command, words);
      progress.print(words.results);
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
  auto given = std::make_shared<GivenWords>();
  Verb verb(app, "watch", "The same as check, on every save; Ctrl-C ends it");
  add_check_words(verb, *given);
  verb.footer(
      "It runs until Ctrl-C. Below the verdicts stand what the last save has changed, and what "
      "comes next.");
  verb.runs([&command, given] { watch(command, read_check_words(*given)); });
}

}  // namespace tumble::cli
