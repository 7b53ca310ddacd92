#include "framework/grading/test_program/test_runner.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

#include <gtest/gtest.h>

#include "framework/grading/test_program/crash_line.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/verdicts/death.h"
#include "framework/grading/verdicts/own_time.h"
#include "framework/grading/verdicts/xray.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TUMBLE_SANITIZED \
  1  // sanitizers reserve terabytes of address space, so it cannot be limited
#else
#define TUMBLE_SANITIZED 0
#endif

namespace tumble::grading {
namespace {

using Clock = std::chrono::steady_clock;

CallLog* shared_log = nullptr;
thread_local CallLog* own_log = nullptr;
DyingPlaces* shared_places = nullptr;

// s of CPU time: the judge's part of a test takes at most a few
constexpr double kFreeJudging = 10.0;
std::string fmt_seconds(double s) { return std::to_string(std::lround(s)) + " s"; }

constexpr std::size_t kPrinted = 4000;  // bytes kept of a test's output
// bytes of a failure message, and of all together: a huge answer is not printed whole
constexpr std::size_t kStory = 16'000;
constexpr rlim_t kPrintedFile = 1u << 20;  // bytes that a test may print

// The report of a test's process to its parent at a normal end: one byte of outcome, then the
// failures.
enum class Outcome : char { kPassed = 'p', kFailed = 'f', kSkipped = 's' };

class FailureCollector : public ::testing::EmptyTestEventListener {
 public:
  std::string text;
  bool skipped = false;

  void OnTestPartResult(const ::testing::TestPartResult& part) override {
    if (part.skipped()) skipped = true;
    if (!part.failed()) return;
    call_log().failed();
    // A story (tests/support/story.h) starts a new line. A plain EXPECT has no story: its file and
    // line are added.
    std::string message = part.message();
    const bool bare = message.find("\n  expected:") == std::string::npos;
    if (bare && part.file_name() != nullptr)
      message +=
          std::string("\n(") + part.file_name() + ":" + std::to_string(part.line_number()) + ")";
    constexpr const char* kFailed = "Failed\n";
    if (message.starts_with(kFailed)) message.erase(0, std::strlen(kFailed));
    // the first failure is about the last answer, in nearly all tests
    if (text.empty() && !bare) message += xray_of_last_call(message);
    if (message.size() > kStory) message.replace(kStory, std::string::npos, "\n[cut here]");
    if (text.size() <= kStory) text += (text.empty() ? "" : "\n") + message;
  }
};

void write_all(int fd, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = ::write(fd, text.data() + sent, text.size() - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    sent += static_cast<std::size_t>(n);
  }
}

[[noreturn]] void run_in_child(const std::string& test, const TestLimits& limits, int answer_fd,
                               int printed_fd) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::dup2(printed_fd, STDOUT_FILENO);
  ::dup2(printed_fd, STDERR_FILENO);
  ::signal(SIGXFSZ, SIG_IGN);  // excessive output ends in failed writes, not in a signal
  const rlimit file{kPrintedFile, kPrintedFile}, core{0, 0},
      memory{limits.memory_bytes, limits.memory_bytes};
  ::setrlimit(RLIMIT_FSIZE, &file);
  ::setrlimit(RLIMIT_CORE, &core);
  if (!TUMBLE_SANITIZED) ::setrlimit(RLIMIT_AS, &memory);
  if (!TUMBLE_SANITIZED && !limits.source.empty()) note_places_when_dying(*shared_places);

  auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
  delete listeners.Release(listeners.default_result_printer());
  auto* collector = new FailureCollector;
  listeners.Append(collector);
  ::testing::GTEST_FLAG(filter) = test;
  ::testing::GTEST_FLAG(catch_exceptions) = true;
  ::testing::GTEST_FLAG(also_run_disabled_tests) = false;
  const bool passed =
      RUN_ALL_TESTS() == 0 && ::testing::UnitTest::GetInstance()->test_to_run_count() == 1;
  const Outcome outcome = collector->skipped ? Outcome::kSkipped
                          : passed           ? Outcome::kPassed
                                             : Outcome::kFailed;
  std::fflush(nullptr);
  write_all(answer_fd, static_cast<char>(outcome) + collector->text);
  ::_exit(0);
}

struct Answer {
  std::string text;
  double timed_out_s = 0.0;  // the limit that was exceeded
  // no limit was exceeded, but the test did not end: the machine is too busy
  bool is_hopeless = false;
  ProcessTimes times;  // of the test's process, at its end
};

// Measures from outside the own time of a test's process, and of its current call where that has a
// limit.
class TestWatch {
 public:
  TestWatch(pid_t child, Process owner, const CallLog& log, const TestLimits& limits)
      : child_(child), owner_(owner), log_(log), limits_(limits) {}

  /// @return whether the test must end now
  bool is_over(Answer& answer) {
    const auto now = Clock::now();
    const ProcessTimes times = process_times(child_);
    answer.timed_out_s = passed(now, times);
    answer.is_hopeless =
        answer.timed_out_s == 0.0 && seconds(now - start_) > kPatience * limits_.own_s;
    return answer.timed_out_s > 0.0 || answer.is_hopeless;
  }

 private:
  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  double passed(Clock::time_point now, const ProcessTimes& times) {
    // A judge waits for its worker, which has its own limits: only the judge's CPU time counts.
    const double own_s = owner_ == Process::kGraders && times.is_known
                             ? times.cpu_s
                             : own_time({}, times, seconds(now - start_));
    if (own_s > limits_.own_s) return limits_.own_s;
    const long call = log_.in_call ? log_.calls : 0;
    if (call != call_) call_ = call, since_ = now, at_start_ = times;
    const auto limit = limits_.call_own_s.find(log_.last_call);
    if (call == 0 || owner_ == Process::kGraders || limit == limits_.call_own_s.end()) return 0.0;
    return own_time(at_start_, times, seconds(now - since_)) > limit->second ? limit->second : 0.0;
  }

  const pid_t child_;
  const Process owner_;
  const CallLog& log_;
  const TestLimits& limits_;
  const Clock::time_point start_ = Clock::now();
  long call_ = 0;
  Clock::time_point since_;
  ProcessTimes at_start_;
};

Answer read_answer(int fd, pid_t child, Process owner, const CallLog& log,
                   const TestLimits& limits) {
  constexpr int kPeriod = 20;  // ms between two checks
  TestWatch watch(child, owner, log, limits);
  Answer answer;
  char buffer[4096];
  for (;;) {
    pollfd waiting{fd, POLLIN, 0};
    if (::poll(&waiting, 1, kPeriod) <= 0) {
      if (watch.is_over(answer)) return answer;
      continue;
    }
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    answer.text.append(buffer, static_cast<std::size_t>(n));
  }
  answer.times = process_times(child);  // ended, but not yet reaped
  return answer;
}

// Waits for a child that has closed its pipe, and so should end; after a second it is killed.
int reap(pid_t child) {
  constexpr int kTries = 1000;
  int status = 0;
  for (int i = 0; i < kTries; ++i) {
    if (::waitpid(child, &status, WNOHANG) != 0) return status;
    ::usleep(i < 10 ? 50 : 1000);
  }
  ::kill(child, SIGKILL);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::string read_printed(int fd) {
  std::string text(kPrinted + 1, '\0');
  const ssize_t n = ::pread(fd, text.data(), text.size(), 0);
  text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  if (text.size() > kPrinted) text.resize(kPrinted), text += "\n[cut here]";
  return text;
}

// The verdict on a test whose process gave no normal report.
void judge_death(TestResult& result, const CallLog& log, int status, const Answer& answer,
                 const std::string& source) {
  if (log.noted) {
    result.verdict = log.verdict;
    result.story = log.story;
  } else if (answer.timed_out_s > 0.0) {
    result.verdict = Verdict::kOutOfResources;
    result.story = timeout_story(answer.timed_out_s, log.last_call, log.in_call) +
                   (log.in_call ? asked_words(log.asked()) : "");
  } else if (answer.is_hopeless) {
    result.verdict = Verdict::kMachineBusy;
    result.story = busy_story(log.last_call);
  } else {
    result.verdict = Verdict::kCrashed;
    result.story = WIFSIGNALED(status)
                       ? signal_story(WTERMSIG(status), log.last_call, log.in_call)
                       : exit_story(WEXITSTATUS(status), log.last_call, log.in_call);
    const std::string line = log.in_call ? line_of_crash(*shared_places, source) : "";
    if (!line.empty()) result.story += ", " + line;
    if (log.in_call) result.story += asked_words(log.asked());
  }
}

void judge_answer(TestResult& result, const CallLog& log, const std::string& answer) {
  const auto outcome = static_cast<Outcome>(answer[0]);
  if (log.noted) {
    result.verdict = log.verdict;
    result.story = log.story;
  } else if (outcome == Outcome::kPassed) {
    result.verdict = Verdict::kRight;
  } else if (outcome == Outcome::kFailed) {
    result.verdict = Verdict::kWrong;
    result.story = answer.substr(1);
  } else {
    result.story = "the test was skipped, so there is no verdict";
  }
}

}  // namespace

void CallLog::begin(const char* function) {
  std::snprintf(last_call, sizeof last_call, "%s", function);
  ++calls;
  in_call = true;
  argument_bytes = 0;
}

void CallLog::failed() {
  if (failed_call[0] == '\0') std::snprintf(failed_call, sizeof failed_call, "%s", last_call);
}

namespace {

std::vector<detail::Describer>& describers() {
  static std::vector<detail::Describer> all;
  return all;
}

}  // namespace

std::size_t detail::add_describer(Describer describer) {
  describers().push_back(describer);
  return describers().size() - 1;
}

void CallLog::keep(const modules::Bytes& bytes, std::size_t number) {
  if (bytes.size() > kArguments) return;
  std::copy(bytes.begin(), bytes.end(), arguments);
  describer = number;
  argument_bytes = bytes.size();
}

std::string CallLog::asked() const {
  if (argument_bytes == 0 || describer >= describers().size()) return "";
  try {
    return describers()[describer](
        last_call, modules::Bytes(arguments, arguments + std::min(argument_bytes, kArguments)));
  } catch (const std::exception&) {  // damaged by the process that wrote them
    return "";
  }
}

void CallLog::note(Verdict what, const std::string& text) {
  in_call = false;
  if (noted) return;
  noted = true;
  verdict = what;
  std::snprintf(story, sizeof story, "%s", text.c_str());
}

OwnCallLog::OwnCallLog() : before_(std::exchange(own_log, &log_)) {}
OwnCallLog::~OwnCallLog() { own_log = before_; }

CallLog& call_log() {
  static CallLog outside_of_tests;
  if (own_log != nullptr) return *own_log;
  return shared_log != nullptr ? *shared_log : outside_of_tests;
}

std::vector<std::string> linked_tests() {
  std::vector<std::string> names;
  const auto* all = ::testing::UnitTest::GetInstance();
  for (int i = 0; i < all->total_test_suite_count(); ++i) {
    const auto* suite = all->GetTestSuite(i);
    for (int k = 0; k < suite->total_test_count(); ++k)
      names.push_back(std::string(suite->name()) + "." + suite->GetTestInfo(k)->name());
  }
  return names;
}

TestResult run_isolated(const std::string& test, const TestLimits& limits, Process owner) {
  TestResult result;
  result.test = test;
  if (shared_log == nullptr) {
    void* page =
        ::mmap(nullptr, sizeof(CallLog), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    void* places = ::mmap(nullptr, sizeof(DyingPlaces), PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED || places == MAP_FAILED)
      return result.story = "no memory for the log of calls", result;
    shared_log = static_cast<CallLog*>(page);
    shared_places = static_cast<DyingPlaces*>(places);
  }
  new (shared_places) DyingPlaces;
  CallLog& log = *new (shared_log) CallLog;
  const auto start = Clock::now();
  int answer_pipe[2];
  const int printed = ::memfd_create("printed", MFD_CLOEXEC);
  if (printed < 0 || ::pipe2(answer_pipe, O_CLOEXEC) != 0)
    return result.story = "no descriptor left", result;
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(answer_pipe[0]);
    run_in_child(test, limits, answer_pipe[1], printed);
  }
  ::close(answer_pipe[1]);
  if (child < 0) {
    result.story = "no process could be started";
  } else {
    const Answer answer = read_answer(answer_pipe[0], child, owner, log, limits);
    const bool in_time = answer.timed_out_s == 0.0 && !answer.is_hopeless;
    if (!in_time) ::kill(child, SIGKILL);
    const int status = reap(child);
    if (in_time && !answer.text.empty() && WIFEXITED(status) && WEXITSTATUS(status) == 0)
      judge_answer(result, log, answer.text);
    else
      judge_death(result, log, status, answer, limits.source);
    result.timed_out_s = log.noted ? log.timed_out_s : answer.timed_out_s;
    const double wall_s = std::chrono::duration<double>(Clock::now() - start).count();
    // The judge's own CPU time is charged where it exceeds the cost of right answers.
    const double judges_s = std::max(0.0, answer.times.cpu_s - kFreeJudging);
    result.charged_s =
        owner == Process::kGraders ? log.own_s + judges_s : own_time({}, answer.times, wall_s);
    const bool is_judged = result.verdict == Verdict::kRight || result.verdict == Verdict::kWrong ||
                           result.verdict == Verdict::kMachineBusy;
    if (owner == Process::kGraders && !log.noted && answer.timed_out_s > 0.0) {
      // With right answers the judge's part of a test takes at most a few seconds.
      result.verdict = Verdict::kOutOfResources;
      result.story = "the judge could not process this submission's answers in " +
                     fmt_seconds(answer.timed_out_s) + " of its own work, the last from " +
                     log.last_call + ": they cause too much work";
    } else if (owner == Process::kGraders && !log.noted && !is_judged) {
      result.verdict = Verdict::kGraderFault;
      result.story = "the judge's own test process ended without a verdict: " + result.story;
    }
    // The judge cannot read its reference values, say.
    if (owner == Process::kGraders && result.verdict == Verdict::kWrong && log.calls == 0) {
      result.verdict = Verdict::kGraderFault;
      result.story = "the judge's test failed before it called the submission: " + result.story;
    }
    if (owner == Process::kStudents) result.printed = read_printed(printed);
  }
  const bool is_wrong = result.verdict == Verdict::kWrong && !log.noted;
  result.last_call = is_wrong && log.failed_call[0] != '\0' ? log.failed_call : log.last_call;
  result.calls = log.calls;
  ::close(answer_pipe[0]);
  ::close(printed);
  result.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace tumble::grading
