#include "framework/grading/worker_connection.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "framework/grading/call_log.h"
#include "framework/grading/death.h"
#include "framework/grading/sandbox_wire.h"

namespace tumble::grading {
namespace {

using modules::Channel;
using Ending = SandboxOutcome::Ending;

constexpr const char* kModuleInside = "/module.so";
constexpr const char* kWorkerInside = "/worker";

Channel::Clock::duration seconds(double s) { return std::chrono::duration_cast<Channel::Clock::duration>(std::chrono::duration<double>(s)); }

// A worker without a sandbox, for code of our own. Dies with us.
pid_t start_plain(const std::filesystem::path& worker, const WorkerOptions& options, int socket) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit memory{options.memory_bytes, options.memory_bytes}, core{0, 0};
  ::setrlimit(RLIMIT_AS, &memory);
  ::setrlimit(RLIMIT_CORE, &core);
  const int moved = ::fcntl(socket, F_DUPFD, 100);
  const int nothing = ::open("/dev/null", O_RDWR);
  for (int fd = 0; fd <= 2; ++fd) ::dup2(nothing, fd);
  ::dup2(moved, kChannelFd);
  ::close_range(kChannelFd + 1, ~0u, 0);
  ::execl(worker.c_str(), worker.c_str(), options.module.c_str(), nullptr);
  ::_exit(127);
}

SandboxOutcome stop_plain(pid_t child, double grace_s) {
  SandboxOutcome outcome;
  outcome.ending = Ending::kStopped;
  int status = 0;
  for (double waited_s = 0.0; waited_s <= grace_s; waited_s += 1e-3) {
    if (::waitpid(child, &status, WNOHANG) == child) {
      outcome.ending = WIFSIGNALED(status) ? Ending::kSignal : Ending::kExited;
      outcome.code = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
      return outcome;
    }
    if (grace_s > 0.0) ::usleep(1000);
  }
  ::kill(child, SIGKILL);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return outcome;
}

}  // namespace

WorkerPrograms worker_programs(const std::string& id) {
  const auto bin = std::filesystem::canonical("/proc/self/exe").parent_path();
  WorkerPrograms programs{bin / ("worker_" + id), bin / "sandbox_init"};
  for (const auto& program : {programs.worker, programs.init})
    if (!std::filesystem::exists(program)) throw UserError(program.string(), "is not built", "Build the targets worker_" + id + " and sandbox_init.");
  return programs;
}

WorkerConnection::WorkerConnection(WorkerOptions options) : options_(std::move(options)), user_(SandboxUser::lease()), stage_(&user_) {
  const WorkerPrograms programs = worker_programs(options_.id);
  options_.module = std::filesystem::absolute(options_.module);
  if (!options_.sandboxed) return;
  job_.init = stage_.add_file(programs.init, "init", true);
  job_.binds = {{stage_.add_file(programs.worker, "worker", true), kWorkerInside}, {stage_.add_file(options_.module, "module.so", true), kModuleInside}};
  job_.command = {kWorkerInside, kModuleInside};
  job_.uid = user_.uid();
  job_.limits.wall_s = options_.session_wall_s + 5.0;  // the deadlines of calls come first; this one is for a judge that died
  job_.limits.cpu_s = static_cast<std::uint64_t>(options_.session_wall_s);
  job_.limits.memory_bytes = options_.memory_bytes;
  // Process 1, the worker, and two that it may make: memory is limited for each of them, so that few bound the sum.
  job_.limits.processes = 4;
}

WorkerConnection::~WorkerConnection() { reset(); }

void WorkerConnection::reset() {
  if (socket_ >= 0) stop(0.0);
}

void WorkerConnection::start() {
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) end(Verdict::kGraderFault, "no descriptor left for a worker");
  socket_ = pair[0];
  if (options_.sandboxed) {
    job_.channel = pair[1];
    sandbox_.emplace(Sandbox::start(job_));
  } else {
    plain_ = start_plain(worker_programs(options_.id).worker, options_, pair[1]);
  }
  ::close(pair[1]);
  channel_ = std::make_unique<Channel>(socket_, socket_);
  session_end_ = Channel::Clock::now() + seconds(options_.session_wall_s);
  callbacks_ = 0;
}

SandboxOutcome WorkerConnection::stop(double grace_s) {
  channel_.reset();
  ::close(socket_);
  socket_ = -1;
  calls_.clear();
  SandboxOutcome outcome;
  if (sandbox_) {
    outcome = sandbox_->stop(grace_s);
    sandbox_.reset();
  } else if (plain_ > 0) {
    outcome = stop_plain(plain_, grace_s);
    plain_ = -1;
  }
  return outcome;
}

Channel& WorkerConnection::begin_call(const char* function) {
  CallLog& log = call_log();
  if (log.noted) throw CallEnded("the test has its verdict already");
  log.begin(function);
  if (socket_ < 0) start();
  calls_.push_back(function);
  deadline_ = std::min(session_end_, Channel::Clock::now() + seconds(call_limit(function)));
  return *channel_;
}

void WorkerConnection::end_call() {
  calls_.pop_back();
  CallLog& log = call_log();
  log.end();
  if (calls_.empty()) return;
  log.begin(calls_.back().c_str());  // the one around it goes on; it was counted when it began
  --log.calls;
}

void WorkerConnection::count_callback() {
  if (++callbacks_ <= options_.callback_budget) return;
  const std::string function = calls_.back();
  stop(0.0);
  end(Verdict::kOutOfResources, function + " evaluated the functions it was given more than " + std::to_string(options_.callback_budget) + " times");
}

double WorkerConnection::call_limit(const std::string& function) const {
  const auto own = options_.suspects.find(function);
  return own == options_.suspects.end() ? options_.call_wall_s : std::min(own->second, options_.call_wall_s);
}

void WorkerConnection::end_out_of_time(const char* function, double limit_s) {
  call_log().timed_out_s = limit_s;
  end(Verdict::kOutOfResources, timeout_story(limit_s, function, true));
}

void WorkerConnection::end(Verdict verdict, const std::string& story) {
  call_log().note(verdict, story);
  throw CallEnded(story);
}

void WorkerConnection::explain_death(const char* function) {
  constexpr double kGrace = 5.0;  // s: for a process that closed its line by dying, to be seen dead, on a loaded machine too
  const SandboxOutcome outcome = stop(kGrace);
  switch (outcome.ending) {
    case Ending::kSignal:
      if (outcome.code == SIGXCPU || (outcome.code == SIGKILL && outcome.cpu_s >= options_.session_wall_s - 1.0))
        end_out_of_time(function, options_.session_wall_s);
      end(Verdict::kCrashed, signal_story(outcome.code, function, true));
    case Ending::kExited: {
      const std::string said = outcome.printed.empty() ? "" : "; it printed: " + outcome.printed.substr(0, 400);
      end(Verdict::kCrashed, exit_story(outcome.code, function, true) + said);
    }
    case Ending::kWallLimit:
      end_out_of_time(function, options_.session_wall_s);
    case Ending::kOutputLimit:
      end(Verdict::kOutOfResources, "printed more than " + std::to_string(job_.limits.output_bytes / 1024) + " KiB, in " + function);
    case Ending::kStopped:
      end(Verdict::kCrashed, std::string("closed its line to the judge instead of returning from ") + function);
    case Ending::kNotStarted: break;
  }
  end(Verdict::kGraderFault, "the sandbox did not start: " + outcome.printed);
}

void WorkerConnection::fail(const char* function, std::exception_ptr transport_error) {
  try {
    std::rethrow_exception(transport_error);
  } catch (const modules::ChannelTimeout&) {
    stop(0.0);
    end_out_of_time(function, deadline_ == session_end_ ? options_.session_wall_s : call_limit(function));
  } catch (const std::exception&) {
    explain_death(function);
  }
}

void WorkerConnection::refuse(const char* function, const std::string& what) {
  stop(0.0);
  if (what.find("std::bad_alloc") != std::string::npos)
    end(Verdict::kOutOfResources, std::string(function) + " asked for more memory than it may have");
  end(Verdict::kCrashed, std::string(function) + ' ' + what);
}

void WorkerConnection::not_implemented(const char* function, const std::string& handout) {
  end_call();
  const NotImplemented missing(function, handout);
  call_log().note(Verdict::kNotAttempted, missing.what());
  throw missing;
}

}  // namespace tumble::grading
