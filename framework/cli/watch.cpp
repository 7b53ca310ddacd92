// tumble watch a1 [FILE] [PATTERN...]: the student's loop on every save, until Ctrl-C.
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/check_program.h"
#include "framework/core/files.h"
#include "framework/grading/verdicts/what_changed.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

/// Detects when a file was saved, whether an editor writes it in place or renames a new file over
/// it. It watches the folder, not the file, because the second way gives the old name to a new
/// file.
class SaveWatch {
 public:
  explicit SaveWatch(const fs::path& file)
      : name_(file.filename().string()), fd_(::inotify_init1(IN_CLOEXEC)) {
    const fs::path folder = file.parent_path();
    if (fd_ < 0 || ::inotify_add_watch(fd_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO) < 0)
      throw UserError(folder.string(), std::string("cannot be watched: ") + std::strerror(errno),
                      "Use ./tumble check after each change.");
  }
  ~SaveWatch() { ::close(fd_); }
  SaveWatch(const SaveWatch&) = delete;
  SaveWatch& operator=(const SaveWatch&) = delete;

  /// Waits for a save, then until the file has not changed for a moment: some editors write twice.
  void wait() {
    constexpr int kForever = -1, kQuietMs = 60;
    while (!saved(kForever)) {
    }
    while (saved(kQuietMs)) {
    }
  }

 private:
  bool saved(int timeout_ms) {
    pollfd waiting{fd_, POLLIN, 0};
    if (::poll(&waiting, 1, timeout_ms) <= 0) return false;
    alignas(inotify_event) char buffer[4096];
    const ssize_t size = ::read(fd_, buffer, sizeof buffer);
    bool is_ours = false;
    for (ssize_t at = 0; at < size;) {
      const auto* event = reinterpret_cast<const inotify_event*>(buffer + at);
      if (event->len > 0 && name_ == event->name) is_ours = true;
      at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
    }
    return is_ours;
  }

  std::string name_;
  int fd_;
};

/// What the last save changed, and what comes next, in two lines below the table.
class Progress {
 public:
  explicit Progress(const grading::Rubric& rubric) : rubric_(rubric) {}

  /// @param file  the verdicts of this check; not there where no test ran
  void print(const fs::path& file) {
    if (!fs::exists(file)) return;
    const std::vector<grading::TestResult> now = grading::read_results(file.string());
    if (!before_.empty())
      fmt::print("\nsince the last save: {}\n", grading::what_changed(before_, now, rubric_));
    const std::string next = grading::what_comes_next(now, rubric_);
    fmt::print("{}{}\n", before_.empty() ? "\n" : "",
               next.empty() ? "every public test is right" : "next: " + next);
    before_ = now;
  }

 private:
  grading::Rubric rubric_;
  std::vector<grading::TestResult> before_;
};

void watch(Command& command, CheckWords words) {
  const fs::path file = checked_file(command, words);
  const PrivateFolder folder;
  words.results = folder.path() / "verdicts.json";
  Progress progress(grading::read_rubric(public_rubric(command, words)));
  SaveWatch saves(file);
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
  auto id = std::make_shared<std::string>();
  auto rest = std::make_shared<std::vector<std::string>>();
  Verb verb(app, "watch", "The same as check, on every save");
  add_check_words(verb, *rest, *id);
  verb.runs([&command, id, rest] { watch(command, read_check_words(*id, *rest)); });
}

}  // namespace tumble::cli
