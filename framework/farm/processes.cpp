#include "framework/farm/processes.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <stdexcept>

namespace tumble::farm {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t ended_by = 0;

// During its lifetime termination signals are only recorded, and this process adopts orphaned
// descendants.
class SignalRecorder {
 public:
  SignalRecorder() {
    ended_by = 0;
    struct sigaction note {};
    note.sa_handler = [](int signal) { ended_by = signal; };  // no SA_RESTART: waiting must end
    for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &note, &before_[i]);
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  }
  ~SignalRecorder() { restore(); }
  void restore() const {
    for (std::size_t i = 0; i < kSignals.size(); ++i)
      ::sigaction(kSignals[i], &before_[i], nullptr);
    ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  }
  static void set_defaults() {
    for (const int signal : kSignals) ::signal(signal, SIG_DFL);
  }

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> before_{};
};

// Kills processes and their descendants: each dies with its parent, and is then reaped here.
void end_all(const std::map<pid_t, std::pair<std::size_t, Clock::time_point>>& running) {
  for (const auto& [child, about] : running) ::kill(child, SIGKILL);
  const auto deadline = Clock::now() + std::chrono::seconds(10);  // for sandboxes to be torn down
  while (Clock::now() < deadline) {
    const pid_t child = ::waitpid(-1, nullptr, WNOHANG);
    if (child < 0 && errno != EINTR) return;
    if (child == 0) ::usleep(1000);
  }
}

pid_t start(const std::function<void(std::size_t)>& work, std::size_t index) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no process can be created");
  if (child > 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  SignalRecorder::set_defaults();
  int code = 0;
  try {
    work(index);
  } catch (...) {
    code = 1;
  }
  std::fflush(nullptr);
  ::_exit(code);
}

}  // namespace

void run_in_processes(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                      const std::function<void(std::size_t, int, double)>& done,
                      const std::function<void()>& cleared) {
  const SignalRecorder recorder;
  std::map<pid_t, std::pair<std::size_t, Clock::time_point>> running;
  std::size_t next = 0;
  while (next < count || !running.empty()) {
    if (ended_by != 0) {
      end_all(running);
      if (cleared) cleared();
      SignalRecorder::set_defaults();
      ::raise(ended_by);
    }
    if (next < count && running.size() < static_cast<std::size_t>(std::max(1, jobs))) {
      const pid_t child = start(work, next);
      running[child] = {next++, Clock::now()};
      continue;
    }
    int status = 0;
    const pid_t child = ::waitpid(-1, &status, WNOHANG);
    // polling: a signal just before a blocking wait would be noticed much later
    if (child == 0) ::usleep(5000);
    if (child == 0 || (child < 0 && errno == EINTR)) continue;
    if (child < 0) throw std::runtime_error("a process was lost");
    const auto it = running.find(child);
    if (it == running.end()) continue;
    const auto [index, since] = it->second;
    running.erase(it);
    try {
      done(index, status, std::chrono::duration<double>(Clock::now() - since).count());
    } catch (...) {
      end_all(running);
      throw;
    }
  }
}

}  // namespace tumble::farm
