/// A program at a terminal of its own.
#pragma once

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <utility>

#include "tests/cli/command_line.h"
#include "tests/support/places.h"

namespace tumble::testing {

/// A program at a terminal of its own, which sends SIGINT where Ctrl-C is typed.
class Terminal {
 public:
  Terminal(const fs::path& folder, const std::string& words) {
    child_ = ::forkpty(&screen_, nullptr, nullptr, nullptr);
    if (child_ != 0) return;
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    ::setenv("TUMBLE_ROOT", test::source_dir().c_str(), 1);
    ::execl("/bin/sh", "sh", "-c",
            ("exec '" + test::binary_dir() + "/bin/tumble' " + words).c_str(),
            static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ~Terminal() {
    if (child_ > 0) ::kill(child_, SIGKILL);
    if (child_ > 0) ::waitpid(child_, nullptr, 0);
    ::close(screen_);
  }
  void press(const std::string& keys) const {
    EXPECT_EQ(::write(screen_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  /// Reads until the text stands on the screen, or nothing comes for a minute.
  bool shows(const std::string& text) {
    while (!holds(said, text)) {
      pollfd ready{screen_, POLLIN, 0};
      char buffer[4096];
      const ssize_t n = ::poll(&ready, 1, 60'000) > 0 ? ::read(screen_, buffer, sizeof buffer) : -1;
      if (n <= 0) return false;
      said.append(buffer, static_cast<std::size_t>(n));
    }
    return true;
  }
  int exit_code() {
    int status = 0;
    ::waitpid(std::exchange(child_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string said;

 private:
  int screen_ = -1;
  pid_t child_ = 0;
};

}  // namespace tumble::testing
