// The keeper: a process between the owner and bubblewrap (see sandbox.h).
#include "framework/grading/sandbox/sandbox.h"

#include <fcntl.h>
#include <grp.h>
#include <linux/close_range.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "framework/grading/sandbox/bubblewrap.h"
#include "framework/grading/verdicts/own_time.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/sandbox/seccomp_filter.h"

namespace tumble::grading {
namespace {

using Clock = std::chrono::steady_clock;
using Ending = SandboxOutcome::Ending;

struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no descriptor left for a sandbox");
    read_end = ends[0];
    write_end = ends[1];
  }
};

void limit(int what, std::uint64_t value) {
  const rlimit both{value, value};
  ::setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

// stdin, stdout, stderr and the descriptors of sandbox_wire.h at their agreed numbers; everything
// else is closed.
void arrange_descriptors(int printed, int channel, int status, int filter) {
  // First to high numbers, then to the agreed ones.
  constexpr int kHigh = 100;
  const int nothing = ::fcntl(::open("/dev/null", O_RDONLY), F_DUPFD, kHigh);
  const int high[] = {nothing, ::fcntl(printed, F_DUPFD, kHigh), ::fcntl(printed, F_DUPFD, kHigh),
                      channel >= 0 ? ::fcntl(channel, F_DUPFD, kHigh) : -1, ::fcntl(status, F_DUPFD, kHigh), ::fcntl(filter, F_DUPFD, kHigh)};
  for (int wanted = 0; wanted <= kFilterFd; ++wanted) {
    if (high[wanted] >= 0) ::dup2(high[wanted], wanted);
    else ::close(wanted);
  }
  ::close_range(kFilterFd + 1, ~0u, 0);
}

[[noreturn]] void become_bubblewrap(const SandboxJob& job, int printed, int status, int filter) {
  constexpr int kNotStarted = 126;
  arrange_descriptors(printed, job.channel, status, filter);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, job.limits.cpu_s);
  limit(RLIMIT_AS, job.limits.memory_bytes);
  limit(RLIMIT_FSIZE, job.limits.file_bytes);
  limit(RLIMIT_NOFILE, job.limits.open_files);
  if (job.uid && (::setgroups(0, nullptr) != 0 || ::setgid(*job.uid) != 0 || ::setuid(*job.uid) != 0)) ::_exit(kNotStarted);
  std::vector<std::string> words = bubblewrap_command(job);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  char* const no_environment[] = {nullptr};  // it would be visible inside as /proc/1/environ
  ::execve(arguments[0], arguments.data(), no_environment);
  constexpr char kMissing[] = "bubblewrap (/usr/bin/bwrap) cannot be started";
  [[maybe_unused]] const auto told = ::write(STDERR_FILENO, kMissing, sizeof kMissing - 1);
  ::_exit(kNotStarted);
}

// The keeper's view of one sandbox.
class Keeper {
 public:
  Keeper(const SandboxJob& job, int hang_up, int result) : job_(job), hang_up_(hang_up), result_(result) {}

  void run() {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // this process adopts orphans of bubblewrap, instead of the machine's process 1
    const int filter = make_seccomp_filter();
    Pipe printed, status;
    child_ = ::fork();
    if (child_ == 0) become_bubblewrap(job_, printed.write_end, status.write_end, filter);
    ::close(filter);
    ::close(printed.write_end);
    ::close(status.write_end);
    if (job_.channel >= 0) ::close(job_.channel);
    if (child_ > 0) watch(printed.read_end, status.read_end);
    kill_and_reap();
    while (read_printed(printed.read_end)) {}
    while (read_status(status.read_end)) {}
    conclude();
    send_outcome();
  }

 private:
  void watch(int printed, int status) {
    const int pid_fd = static_cast<int>(::syscall(SYS_pidfd_open, child_, 0));
    const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(job_.limits.wall_s));
    pollfd waiting[] = {{hang_up_, POLLIN, 0}, {pid_fd, POLLIN, 0}, {printed, POLLIN, 0}, {status, POLLIN, 0}};
    for (;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (left < 0) return void(forced_ = Ending::kWallLimit);
      constexpr long long kPeriod = 1000;   // ms between two checks of the activity inside
      ::poll(waiting, 4, static_cast<int>(job_.limits.stall_s > 0.0 ? std::min<long long>(left + 1, kPeriod) : left + 1));
      if (has_stalled()) return void(forced_ = Ending::kStalled);
      if (waiting[0].revents != 0) return void(forced_ = Ending::kStopped);
      if (waiting[2].revents != 0 && !read_printed(printed)) waiting[2].fd = -1;
      if (waiting[3].revents != 0 && !read_status(status)) waiting[3].fd = -1;
      if (outcome_.printed.size() > job_.limits.output_bytes) return void(forced_ = Ending::kOutputLimit);
      if (waiting[1].revents != 0) return;
    }
  }

  bool has_stalled() {
    if (job_.limits.stall_s <= 0.0 || !shows_children()) return false;
    constexpr double kTick = 0.01;   // s: the kernel's resolution of CPU time
    const double activity = activity_below(child_);
    if (std::abs(activity - activity_) > kTick) activity_ = activity, active_ = Clock::now();
    return Clock::now() - active_ > std::chrono::duration<double>(job_.limits.stall_s);
  }

  bool read_printed(int fd) {
    char buffer[16384];
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    // One byte above the limit is kept: it shows that the limit was exceeded.
    const std::size_t room = job_.limits.output_bytes + 1 - std::min<std::size_t>(outcome_.printed.size(), job_.limits.output_bytes + 1);
    if (n > 0) outcome_.printed.append(buffer, std::min(static_cast<std::size_t>(n), room));
    return n > 0 || (n < 0 && errno == EINTR);
  }

  bool read_status(int fd) {
    InitReport report{};
    const ssize_t n = ::read(fd, &report, sizeof report);
    if (n != sizeof report) return n < 0 && errno == EINTR;
    if (report.what == InitReport::kStarted) started_ = true;
    if (report.what == InitReport::kEnded) ended_ = report, has_ended_ = true;
    return true;
  }

  // When bubblewrap dies, process 1 of its namespace dies too (--die-with-parent), and with it
  // everything inside. But if it dies during the set-up of the sandbox, it leaves a process 1 that
  // waits forever: this process has adopted that one, and kills it.
  void kill_and_reap() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    constexpr useconds_t kPauseUs = 100;
    for (;;) {
      const pid_t gone = ::waitpid(-1, nullptr, WNOHANG);
      if (gone < 0 && errno != EINTR) return;
      if (gone != 0) continue;
      for (const pid_t child : children_of(::getpid())) ::kill(child, SIGKILL);
      ::usleep(kPauseUs);
    }
  }

  void conclude() {
    if (has_ended_) {
      outcome_.ending = WIFSIGNALED(ended_.status) ? Ending::kSignal : Ending::kExited;
      outcome_.code = WIFSIGNALED(ended_.status) ? WTERMSIG(ended_.status) : WEXITSTATUS(ended_.status);
      outcome_.peak_memory_kb = ended_.peak_memory_kb;
      outcome_.cpu_s = ended_.cpu_s;
    } else if (forced_ != Ending::kNotStarted) {
      outcome_.ending = forced_;
    } else if (started_) {
      outcome_.ending = Ending::kSignal;
      outcome_.code = SIGKILL;
    }
    if (forced_ == Ending::kOutputLimit) outcome_.ending = forced_;
    if (outcome_.printed.size() > job_.limits.output_bytes) outcome_.printed.resize(job_.limits.output_bytes);
  }

  void send_outcome() {
    const std::string head(reinterpret_cast<const char*>(&outcome_.ending), sizeof outcome_.ending);
    std::string message = head;
    const auto add = [&](const auto& value) { message.append(reinterpret_cast<const char*>(&value), sizeof value); };
    add(outcome_.code);
    add(outcome_.peak_memory_kb);
    add(outcome_.cpu_s);
    message += outcome_.printed;
    ::signal(SIGPIPE, SIG_IGN);  // the owner may have ended
    for (std::size_t sent = 0; sent < message.size();) {
      const ssize_t n = ::write(result_, message.data() + sent, message.size() - sent);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return;
      sent += static_cast<std::size_t>(n);
    }
  }

  const SandboxJob& job_;
  int hang_up_, result_;
  pid_t child_ = -1;
  bool started_ = false, has_ended_ = false;
  double activity_ = 0.0;                     // s of CPU time and delay of all processes inside, when it last grew
  Clock::time_point active_ = Clock::now();
  InitReport ended_{};
  Ending forced_ = Ending::kNotStarted;
  SandboxOutcome outcome_;
};

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
  while (::open("/dev/null", O_RDWR) < STDERR_FILENO) {}  // 0, 1 and 2 stay occupied
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
      Keeper(job, hang_up.read_end, result.write_end).run();
    } catch (const std::exception& error) {
      SandboxOutcome{};  // no message means: not started
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
  return sandbox;
}

Sandbox::Sandbox(Sandbox&& other) noexcept : keeper_(other.keeper_), hang_up_(other.hang_up_), result_(other.result_) {
  other.keeper_ = other.hang_up_ = other.result_ = -1;
}

Sandbox::~Sandbox() {
  if (keeper_ > 0) stop();
}

// The chain of children below the keeper: bubblewrap, process 1 of its namespace, and the program.
pid_t Sandbox::program() const { return first_descendant(keeper_, 3); }

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
  while (::waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) {}
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

std::optional<std::string> why_no_sandbox(const std::filesystem::path& init) {
  const SandboxUser user = SandboxUser::lease();
  Stage stage(&user);
  SandboxJob job;
  job.command = {"/usr/bin/true"};
  job.init = stage.add_file(init, "init", true);
  job.uid = user.uid();
  const SandboxOutcome outcome = Sandbox::start(job).wait();
  if (outcome.ending == Ending::kExited && outcome.code == 0) return std::nullopt;
  return outcome.printed.empty() ? "the sandbox does not start" : outcome.printed;
}

}  // namespace tumble::grading
