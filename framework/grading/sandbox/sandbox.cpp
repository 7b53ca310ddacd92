#include "framework/grading/sandbox/sandbox.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "framework/grading/sandbox/keeper.h"
#include "framework/grading/sandbox/pipe.h"
#include "framework/grading/verdicts/own_time.h"

namespace tumble::grading {
namespace {

// Keeps only these descriptors: an inherited hang-up pipe of another sandbox would keep that
// sandbox alive.
void close_all_but(std::vector<int> kept) {
  kept.push_back(STDERR_FILENO);
  std::sort(kept.begin(), kept.end());
  unsigned from = 0;
  for (const int fd : kept) {
    if (fd < 0) continue;
    if (static_cast<unsigned>(fd) > from) ::close_range(from, static_cast<unsigned>(fd) - 1, 0);
    from = static_cast<unsigned>(fd) + 1;
  }
  ::close_range(from, ~0u, 0);
  while (::open("/dev/null", O_RDWR) < STDERR_FILENO) {
  }  // 0, 1 and 2 stay occupied
}

}  // namespace

Sandbox Sandbox::start(const SandboxJob& job) {
  Pipe hang_up, result;
  const pid_t keeper = ::fork();
  if (keeper == 0) {
    ::setsid();  // Ctrl-C is for the owner; the keeper ends when the owner's pipe closes
    // Among others this closes the owner's file locks of uid leases.
    close_all_but({hang_up.read_end, result.write_end, job.channel});
    try {
      keep_sandbox(job, hang_up.read_end, result.write_end);
    } catch (const std::exception&) {
      ::_exit(1);  // no message means: not started
    }
    ::_exit(0);
  }
  ::close(hang_up.read_end);
  ::close(result.write_end);
  if (keeper < 0) {
    ::close(hang_up.write_end);
    ::close(result.read_end);
    throw std::runtime_error("no process can be created for a sandbox");
  }
  Sandbox sandbox;
  sandbox.keeper_ = keeper;
  sandbox.hang_up_ = hang_up.write_end;
  sandbox.result_ = result.read_end;
  sandbox.generations_ = traits_of(job.kind).generations;
  return sandbox;
}

Sandbox::Sandbox(Sandbox&& other) noexcept
    : keeper_(other.keeper_),
      hang_up_(other.hang_up_),
      result_(other.result_),
      generations_(other.generations_) {
  other.keeper_ = other.hang_up_ = other.result_ = -1;
}

Sandbox::~Sandbox() {
  if (keeper_ > 0) stop();
}

// The last of a chain of first children: with namespaces below bubblewrap and its process 1.
pid_t Sandbox::program() const { return first_descendant(keeper_, generations_); }

SandboxOutcome Sandbox::wait() {
  std::string message;
  char buffer[16384];
  for (;;) {
    const ssize_t n = ::read(result_, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    message.append(buffer, static_cast<std::size_t>(n));
  }
  ::close(result_);
  if (hang_up_ >= 0) ::close(hang_up_);
  while (::waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) {
  }
  keeper_ = hang_up_ = result_ = -1;

  SandboxOutcome outcome;
  std::size_t at = 0;
  const auto take = [&](auto& value) {
    if (message.size() - at < sizeof value) return;
    std::memcpy(&value, message.data() + at, sizeof value);
    at += sizeof value;
  };
  take(outcome.ending);
  take(outcome.code);
  take(outcome.peak_memory_kb);
  take(outcome.cpu_s);
  outcome.printed = message.substr(at);
  return outcome;
}

SandboxOutcome Sandbox::stop(double grace_s) {
  pollfd waiting{result_, POLLIN, 0};
  if (grace_s > 0.0) ::poll(&waiting, 1, static_cast<int>(grace_s * 1000.0));
  ::close(hang_up_);
  hang_up_ = -1;
  return wait();
}

}  // namespace tumble::grading
