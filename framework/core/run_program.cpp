#include "framework/core/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>

namespace tumble {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void become(const std::vector<std::string>& words, Output output, int pipe_end) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, STDIN_FILENO);
  if (output != Output::kOurs) {
    ::dup2(output == Output::kCaptured ? pipe_end : nothing, STDOUT_FILENO);
    ::dup2(output == Output::kCaptured ? pipe_end : nothing, STDERR_FILENO);
  }
  std::vector<char*> argv;
  for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  ::execvp(argv[0], argv.data());
  ::_exit(127);
}

// Reads until all writers have closed the pipe or the time is up.
bool drain(int fd, Clock::time_point deadline, std::string& text) {
  constexpr std::size_t kKept = 4u << 20;  // bytes: more than any of these programs prints
  char buffer[1 << 14];
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    pollfd waiting{fd, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 1000))) <= 0) continue;
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    if (text.size() < kKept) text.append(buffer, static_cast<std::size_t>(n));
  }
}

}  // namespace

ProgramOutcome run_program(const std::vector<std::string>& words, Output output, double wall_s) {
  // A pipe even where nothing is captured: its closing shows that the program has ended, without a
  // race or a signal.
  int ends[2], alive[2];
  if (::pipe2(ends, O_CLOEXEC) != 0 || ::pipe2(alive, 0) != 0)
    throw std::runtime_error("no descriptor left");
  ::fcntl(alive[0], F_SETFD, FD_CLOEXEC);
  const pid_t child = ::fork();
  if (child == 0) become(words, output, ends[1]);
  ::close(ends[1]);
  ::close(alive[1]);
  if (child < 0) throw std::runtime_error("no process can be created");
  ProgramOutcome outcome;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(wall_s));
  std::string unused;
  outcome.in_time = output == Output::kCaptured ? drain(ends[0], deadline, outcome.printed)
                                                : drain(alive[0], deadline, unused);
  if (!outcome.in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  outcome.code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  ::close(ends[0]);
  ::close(alive[0]);
  return outcome;
}

}  // namespace tumble
