#include "framework/grading/worker/worker_connection.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/verdicts/death.h"
#include "framework/grading/verdicts/parameter_names.h"
#include "framework/grading/verdicts/xray.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/worker/crash_place.h"

namespace tumble::grading {
namespace {

using modules::Channel;
using Ending = SandboxOutcome::Ending;

constexpr const char* kModuleInside = "/module.so";
constexpr const char* kWorkerInside = "/worker";

// age up to which a reading of the times is reused
constexpr auto kFresh = std::chrono::milliseconds(50);

double seconds_of(Channel::Clock::duration d) { return std::chrono::duration<double>(d).count(); }

Channel::Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Channel::Clock::duration>(std::chrono::duration<double>(s));
}

// A worker without a sandbox, for trusted code. It dies with this process.
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
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return outcome;
}

}  // namespace

WorkerPrograms worker_programs(const std::string& id, const std::filesystem::path& folder) {
  const auto bin =
      folder.empty() ? std::filesystem::canonical("/proc/self/exe").parent_path() : folder;
  WorkerPrograms programs{bin / ("worker_" + id), bin / "sandbox_init"};
  for (const auto& program : {programs.worker, programs.init})
    if (!std::filesystem::exists(program))
      throw UserError(program.string(), "is not built",
                      "Build the targets worker_" + id + " and sandbox_init.");
  return programs;
}

WorkerConnection::WorkerConnection(WorkerOptions options)
    : options_(std::move(options)), user_(SandboxUser::lease()), stage_(&user_) {
  const WorkerPrograms programs = worker_programs(options_.id, options_.programs);
  options_.module = std::filesystem::absolute(options_.module);
  if (!options_.sandboxed) return;
  job_.kind = chosen_sandbox();
  if (traits_of(job_.kind).needs_init) job_.init = stage_.add_file(programs.init, "init", true);
  if (traits_of(job_.kind).links_worker) {
    job_.binds = {{stage_.add_file(options_.module, "worker", true), kWorkerInside}};
    job_.command = {kWorkerInside};
  } else {
    job_.binds = {{stage_.add_file(programs.worker, "worker", true), kWorkerInside},
                  {stage_.add_file(options_.module, "module.so", true), kModuleInside}};
    job_.command = {kWorkerInside, kModuleInside};
  }
  job_.uid = user_.uid();
  // the limits of calls are shorter; this one is for a judge that has died
  job_.limits.wall_s = kPatience * options_.session_own_s + 5.0;
  job_.limits.cpu_s = static_cast<std::uint64_t>(std::ceil(options_.session_own_s));
  job_.limits.memory_bytes = options_.memory_bytes;
  job_.limits.tmp_bytes = 0;
  // Memory is limited per process, and a second process or thread would delay the worker like a
  // busy machine (own_time.h).
  job_.is_alone = true;
}

WorkerConnection::~WorkerConnection() { reset(); }

void WorkerConnection::reset() {
  if (socket_ >= 0) stop(0.0);
}

void WorkerConnection::start() {
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    end(Verdict::kGraderFault, "no descriptor left for a worker");
  socket_ = pair[0];
  if (options_.sandboxed) {
    job_.channel = pair[1];
    sandbox_.emplace(Sandbox::start(job_));
  } else {
    plain_ = start_plain(worker_programs(options_.id, options_.programs).worker, options_, pair[1]);
  }
  ::close(pair[1]);
  channel_ = std::make_unique<Channel>(Channel::End::kAsks, socket_, socket_);
  channel_->extend_by([this](TimePoint passed) { return check_time(passed); });
  callbacks_ = 0;
  worker_ = plain_;
  past_turns_s_ = 0.0;
  turn_.reset();
  session_ = {};
  session_.when = Channel::Clock::now();
  session_.judge = process_times(::getpid());
  last_ = session_;
}

SandboxOutcome WorkerConnection::stop(double grace_s) {
  end_turn();
  own_before_s_ += own_s(session_, account());
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
  arguments_.clear();
  if (socket_ < 0) start();
  // Reading the times costs as much as a call, so a recent reading is reused.
  if (calls_.empty() && Channel::Clock::now() - last_.when > kFresh) last_ = account();
  Call call{function, Channel::Clock::now() + seconds(call_limit(function)), last_};
  call.start.turns_s = turns_s();
  call.start.when = Channel::Clock::now();
  calls_.push_back(std::move(call));
  begin_turn();
  return *channel_;
}

void WorkerConnection::end_call() {
  end_turn();
  calls_.pop_back();
  CallLog& log = call_log();
  log.end();
  if (calls_.empty()) {
    if (turns_s() - last_.turns_s > seconds_of(kFresh)) last_ = account();
    return;
  }
  // the enclosing call continues; it was counted when it began
  log.begin(calls_.back().function.c_str());
  --log.calls;
}

void WorkerConnection::note_arguments(const char* function, const std::vector<std::string>& words) {
  arguments_ = with_names(words, parameter_names(options_.id, function)) +
               hints_to_read(options_.id, function);
}

// For the story of a wrong answer, or of none. Long ones are not kept: nobody reads a thousand
// terms.
// Of calls within calls the outer one is kept.
void WorkerConnection::note_call(const char* function, const modules::Bytes& call) {
  constexpr std::size_t kLongest = 1u << 14, kNumber = sizeof(std::uint32_t);
  if (calls_.size() > 1) return;
  begin_call_to_show();
  if (call.size() > kLongest) return;
  LastCall& last = last_call();
  last.function = function;
  last.arguments.assign(call.begin() + kNumber, call.end());
}

void WorkerConnection::note_answer(const modules::Bytes& answer) {
  if (calls_.size() == 1) last_call().answer = answer;
}

void WorkerConnection::note_callback(const modules::Bytes& question, const modules::Bytes& answer) {
  // the stages of a step, the first looks of a search
  constexpr std::size_t kMost = 16, kLongest = 1u << 12;
  auto& asked = last_call().asked;
  if (calls_.size() == 1 && asked.size() < kMost && question.size() <= kLongest &&
      answer.size() <= kLongest)
    asked.emplace_back(question, answer);
}

bool WorkerConnection::count_callback() {
  end_turn();
  if (++callbacks_ > options_.callback_budget) return false;
  // A worker that sends callbacks without pause is checked here.
  const Call& call = calls_.back();
  const auto now = Channel::Clock::now();
  return now < call.next_check || check_time(call.next_check) > now;
}

void WorkerConnection::end_at_budget(const char* function) {
  const bool is_by_count = callbacks_ > options_.callback_budget;
  stop(0.0);
  if (is_by_count)
    end(Verdict::kOutOfResources,
        std::string(function) + " called its function arguments more than " +
            std::to_string(options_.callback_budget) + " times" + asked_words(arguments_));
  end_out_of_time(function);
}

void WorkerConnection::resume_call() { begin_turn(); }

void WorkerConnection::end_turn() {
  if (turn_) past_turns_s_ += seconds_of(Channel::Clock::now() - *turn_);
  turn_.reset();
}

double WorkerConnection::turns_s() const {
  return past_turns_s_ + (turn_ ? seconds_of(Channel::Clock::now() - *turn_) : 0.0);
}

void WorkerConnection::charge_wait(double wait_s) {
  own_before_s_ += wait_s;
  call_log().own_s = own_before_s_;
}

pid_t WorkerConnection::worker() {
  if (worker_ < 0 && sandbox_) worker_ = sandbox_->program();
  return worker_;
}

WorkerConnection::Account WorkerConnection::account() {
  Account now{process_times(worker()), process_times(::getpid()), turns_s(), Channel::Clock::now()};
  // For the test's budget: own time of all its calls, readable after this process has ended.
  call_log().own_s = own_before_s_ + own_s(session_, now);
  return now;
}

// The judge waits during the worker's turns; its own run delay is not time of the worker either.
double WorkerConnection::own_s(const Account& from, const Account& to) const {
  // the sandbox is still starting
  if (sandbox_ && !to.worker.is_known && shows_children()) return 0.0;
  return own_time(from.worker, to.worker,
                  to.turns_s - from.turns_s - (to.judge.delay_s - from.judge.delay_s));
}

WorkerConnection::TimePoint WorkerConnection::check_time(TimePoint passed) {
  Call& call = calls_.back();
  // already checked, and not due again
  if (call.next_check > passed && call.next_check > Channel::Clock::now()) return call.next_check;
  last_ = account();
  const double call_left_s = call_limit(call.function) - own_s(call.start, last_),
               session_left_s = options_.session_own_s - own_s(session_, last_);
  const double left_s = std::min(call_left_s, session_left_s);
  timed_out_s_ = left_s > 0.0                    ? 0.0
                 : call_left_s <= session_left_s ? call_limit(call.function)
                                                 : options_.session_own_s;
  const bool is_hopeless =
      seconds_of(last_.when - call.start.when) > kPatience * call_limit(call.function) ||
      seconds_of(last_.when - session_.when) > kPatience * options_.session_own_s;
  if (left_s <= 0.0 || is_hopeless) return passed;
  constexpr double kLeast = 1e-3, kMost = 1.0;  // s until the next check
  return call.next_check = last_.when + seconds(std::clamp(left_s, kLeast, kMost));
}

double WorkerConnection::call_limit(const std::string& function) const {
  const auto own = options_.suspects.find(function);
  return own == options_.suspects.end() ? options_.call_own_s
                                        : std::min(own->second, options_.call_own_s);
}

// After the check that ended the wait: a limit on own time was exceeded, or the machine is too
// busy.
void WorkerConnection::end_out_of_time(const char* function) {
  if (timed_out_s_ > 0.0) end_at_limit(function, timed_out_s_);
  end(Verdict::kMachineBusy, busy_story(function));
}

void WorkerConnection::end_at_limit(const char* function, double limit_s) {
  call_log().timed_out_s = limit_s;
  end(Verdict::kOutOfResources, timeout_story(limit_s, function, true) + asked_words(arguments_));
}

void WorkerConnection::end(Verdict verdict, const std::string& story) {
  call_log().note(verdict, story);
  throw CallEnded(story);
}

// Where a worker is one program with its submission, no frames are told apart.
std::string WorkerConnection::place_words(const std::string& printed) const {
  if (!options_.sandboxed || traits_of(job_.kind).links_worker) return "";
  const std::string place = crash_place(job_, kModuleInside, printed);
  return place.empty() ? "" : ", " + place;
}

void WorkerConnection::explain_death(const char* function) {
  // s: after the channel has closed, for a dying process to be reaped, also on a loaded machine
  constexpr double kGrace = 2.0;
  const auto before = Channel::Clock::now();
  const SandboxOutcome outcome = stop(kGrace);
  // it continued without its channel
  if (outcome.ending == Ending::kStopped) charge_wait(seconds_of(Channel::Clock::now() - before));
  switch (outcome.ending) {
    case Ending::kSignal:
      if (outcome.code == SIGXCPU ||
          (outcome.code == SIGKILL && outcome.cpu_s >= options_.session_own_s - 1.0))
        end_at_limit(function, options_.session_own_s);
      end(Verdict::kCrashed, signal_story(outcome.code, function, true) +
                                 place_words(outcome.printed) + asked_words(arguments_) +
                                 xray_of_last_call());
    case Ending::kExited: {
      const std::string said =
          outcome.printed.empty() ? "" : "; it printed: " + outcome.printed.substr(0, 400);
      end(Verdict::kCrashed,
          exit_story(outcome.code, function, true) + said + asked_words(arguments_));
    }
    case Ending::kStalled:
    case Ending::kWallLimit: end(Verdict::kMachineBusy, busy_story(function));
    case Ending::kDiskLimit:  // impossible: it has no folder to write to
      end(Verdict::kGraderFault,
          std::string("a worker without a folder wrote files, in ") + function);
    case Ending::kOutputLimit:
      end(Verdict::kOutOfResources, "printed more than " +
                                        std::to_string(job_.limits.output_bytes / 1024) +
                                        " KiB, in " + function + asked_words(arguments_));
    case Ending::kStopped:
      end(Verdict::kCrashed,
          std::string("closed its channel to the judge instead of returning from ") + function +
              asked_words(arguments_));
    case Ending::kNotStarted: break;
  }
  end(Verdict::kGraderFault, "the sandbox did not start: " + outcome.printed);
}

void WorkerConnection::fail(const char* function, std::exception_ptr transport_error) {
  try {
    std::rethrow_exception(transport_error);
  } catch (const modules::ChannelTimeout&) {
    stop(0.0);
    end_out_of_time(function);
  } catch (const std::exception&) {
    explain_death(function);
  }
}

void WorkerConnection::refuse(const char* function, const std::string& what) {
  stop(0.0);
  if (what.find("std::bad_alloc") != std::string::npos)
    end(Verdict::kOutOfResources,
        std::string(function) + " needed more memory than its limit" + asked_words(arguments_));
  end(Verdict::kCrashed, std::string(function) + ' ' + what + asked_words(arguments_));
}

void WorkerConnection::wrong_size(const char*, const std::string& story) {
  stop(0.0);  // it may still wait inside the call
  end(Verdict::kWrong, story);
}

void WorkerConnection::not_implemented(const char* function, const std::string& handout) {
  end_call();
  const NotImplemented missing(function, handout);
  call_log().note(Verdict::kNotAttempted, missing.what());
  throw missing;
}

}  // namespace tumble::grading
