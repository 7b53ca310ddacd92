#include "framework/grading/sandbox/keeper.h"

#include <fcntl.h>
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
#include <memory>
#include <stdexcept>

#include "framework/grading/sandbox/make_body.h"
#include "framework/grading/sandbox/pipe.h"
#include "framework/grading/sandbox/sandbox_outcome.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/verdicts/own_time.h"

namespace tumble::grading {
namespace {

using Clock = std::chrono::steady_clock;
using Ending = SandboxOutcome::Ending;

// stdin, stdout, stderr and the descriptors of sandbox_wire.h at their agreed numbers; everything
// else is closed.
void arrange_descriptors(int printed, int channel, int status, int bodys) {
  // First to high numbers, then to the agreed ones.
  constexpr int kHigh = 100;
  const int nothing = ::fcntl(::open("/dev/null", O_RDONLY), F_DUPFD, kHigh);
  const int high[] = {nothing,
                      ::fcntl(printed, F_DUPFD, kHigh),
                      ::fcntl(printed, F_DUPFD, kHigh),
                      channel >= 0 ? ::fcntl(channel, F_DUPFD, kHigh) : -1,
                      ::fcntl(status, F_DUPFD, kHigh),
                      bodys >= 0 ? ::fcntl(bodys, F_DUPFD, kHigh) : -1};
  for (int wanted = 0; wanted <= kBodyFd; ++wanted) {
    if (high[wanted] >= 0)
      ::dup2(high[wanted], wanted);
    else
      ::close(wanted);
  }
  ::close_range(kBodyFd + 1, ~0u, 0);
}

[[noreturn]] void become(SandboxBody& body, const SandboxJob& job, int printed, int status) {
  constexpr int kNotStarted = 126;
  arrange_descriptors(printed, job.channel, status, body.descriptor());
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  try {
    body.become();
  } catch (const std::exception& error) {
    [[maybe_unused]] const auto told =
        ::write(STDERR_FILENO, error.what(), std::strlen(error.what()));
  }
  ::_exit(kNotStarted);
}

// The keeper's view of one sandbox.
class Keeper {
 public:
  Keeper(const SandboxJob& job, int hang_up, int result)
      : job_(job), hang_up_(hang_up), result_(result) {}

  void run() {
    // this process adopts orphans inside, instead of the machine's process 1
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
    Pipe printed, status;
    try {
      body_ = make_body(job_);
    } catch (const std::exception& error) {
      outcome_.printed = error.what();
      return send_outcome();
    }
    child_ = ::fork();
    if (child_ == 0) become(*body_, job_, printed.write_end, status.write_end);
    ::close(printed.write_end);
    ::close(status.write_end);
    if (job_.channel >= 0) ::close(job_.channel);
    if (child_ > 0) {
      body_->attend();
      watch(printed.read_end, status.read_end);
    }
    kill_and_reap();
    while (read_printed(printed.read_end)) {
    }
    while (read_status(status.read_end)) {
    }
    note_end_of_child();
    conclude();
    body_.reset();
    send_outcome();
  }

 private:
  void watch(int printed, int status) {
    const int pid_fd = static_cast<int>(::syscall(SYS_pidfd_open, child_, 0));
    const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                             std::chrono::duration<double>(job_.limits.wall_s));
    pollfd waiting[] = {
        {hang_up_, POLLIN, 0}, {pid_fd, POLLIN, 0}, {printed, POLLIN, 0}, {status, POLLIN, 0}};
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (left < 0) return void(forced_ = Ending::kWallLimit);
      constexpr long long kPeriod = 1000;  // ms between two checks of the activity inside
      // ms between two of the disk: 30 MB where it writes 600 MB/s
      constexpr long long kDiskPeriod = 50;
      const auto on_disk = body_->bytes_on_disk();
      if (on_disk && *on_disk > job_.limits.tmp_bytes) return void(forced_ = Ending::kDiskLimit);
      long long pause = left + 1;
      if (job_.limits.stall_s > 0.0) pause = std::min(pause, kPeriod);
      if (on_disk) pause = std::min(pause, kDiskPeriod);
      ::poll(waiting, 4, static_cast<int>(pause));
      if (has_stalled()) return void(forced_ = Ending::kStalled);
      if (waiting[0].revents != 0) return void(forced_ = Ending::kStopped);
      if (waiting[2].revents != 0 && !read_printed(printed)) waiting[2].fd = -1;
      if (waiting[3].revents != 0 && !read_status(status)) waiting[3].fd = -1;
      if (outcome_.printed.size() > job_.limits.output_bytes)
        return void(forced_ = Ending::kOutputLimit);
      if (waiting[1].revents != 0) return;
    }
  }

  bool has_stalled() {
    if (job_.limits.stall_s <= 0.0 || !shows_children()) return false;
    constexpr double kTick = 0.01;  // s: the kernel's resolution of CPU time
    const double activity = activity_below(child_);
    const auto now = Clock::now();
    idle_s_ += std::max(0.0, std::chrono::duration<double>(now - looked_).count() -
                                 std::max(0.0, activity - seen_));
    looked_ = now, seen_ = activity;
    if (job_.limits.idle_s > 0.0 && idle_s_ > job_.limits.idle_s) return true;
    if (std::abs(activity - activity_) > kTick) activity_ = activity, active_ = now;
    return now - active_ > std::chrono::duration<double>(job_.limits.stall_s);
  }

  bool read_printed(int fd) {
    char buffer[16384];
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    // One byte above the limit is kept: it shows that the limit was exceeded.
    const std::size_t room =
        job_.limits.output_bytes + 1 -
        std::min<std::size_t>(outcome_.printed.size(), job_.limits.output_bytes + 1);
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

  // With namespaces, when bubblewrap dies, process 1 of its namespace dies too (--die-with-parent),
  // and with it everything inside. But if it dies during the set-up of the sandbox, it leaves a
  // process 1 that waits forever: this process has adopted that one, and kills it.
  void kill_and_reap() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    body_->kill_rest();
    // A process becomes this one's child only when its parent has ended, which a wait shows.
    for (;;) {
      int status = 0;
      rusage usage{};
      const pid_t gone = ::wait4(-1, &status, 0, &usage);
      if (gone == child_) child_status_ = status, child_usage_ = usage;
      if (gone < 0 && errno != EINTR) return;
      for (const pid_t child : children_of(::getpid())) ::kill(child, SIGKILL);
    }
  }

  // Where the child is the program itself, its end needs no report: unless it was killed here.
  void note_end_of_child() {
    const bool is_killed = forced_ != Ending::kNotStarted && WIFSIGNALED(child_status_) &&
                           WTERMSIG(child_status_) == SIGKILL;
    if (traits_of(job_.kind).generations > 1 || !started_ || is_killed) return;
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    ended_ = {InitReport::kEnded, child_status_, child_usage_.ru_maxrss,
              seconds(child_usage_.ru_utime) + seconds(child_usage_.ru_stime)};
    has_ended_ = true;
  }

  void conclude() {
    outcome_.printed = body_->as_inside(std::move(outcome_.printed));
    if (has_ended_) {
      outcome_.ending = WIFSIGNALED(ended_.status) ? Ending::kSignal : Ending::kExited;
      outcome_.code =
          WIFSIGNALED(ended_.status) ? WTERMSIG(ended_.status) : WEXITSTATUS(ended_.status);
      outcome_.peak_memory_kb = ended_.peak_memory_kb;
      outcome_.cpu_s = ended_.cpu_s;
    } else if (forced_ != Ending::kNotStarted) {
      outcome_.ending = forced_;
    } else if (started_) {
      outcome_.ending = Ending::kSignal;
      outcome_.code = SIGKILL;
    }
    if (forced_ == Ending::kOutputLimit || forced_ == Ending::kDiskLimit) outcome_.ending = forced_;
    if (outcome_.printed.size() > job_.limits.output_bytes)
      outcome_.printed.resize(job_.limits.output_bytes);
  }

  void send_outcome() {
    const std::string head(reinterpret_cast<const char*>(&outcome_.ending), sizeof outcome_.ending);
    std::string message = head;
    const auto add = [&](const auto& value) {
      message.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
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
  std::unique_ptr<SandboxBody> body_;
  int hang_up_, result_;
  pid_t child_ = -1;
  int child_status_ = 0;
  rusage child_usage_{};
  bool started_ = false, has_ended_ = false;
  // s of CPU time and delay of all processes inside, when it last grew
  double activity_ = 0.0;
  Clock::time_point active_ = Clock::now();
  // of all looks: how long in all nothing inside has computed or waited for a core
  Clock::time_point looked_ = Clock::now();
  double seen_ = 0.0, idle_s_ = 0.0;
  InitReport ended_{};
  Ending forced_ = Ending::kNotStarted;
  SandboxOutcome outcome_;
};

}  // namespace

void keep_sandbox(const SandboxJob& job, int hang_up, int result) {
  Keeper(job, hang_up, result).run();
}

}  // namespace tumble::grading
