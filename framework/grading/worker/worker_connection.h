/// The judge's connection to a submission: a worker process, started at the first call, discarded
/// after any error.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/grading/verdicts/own_time.h"
#include "framework/grading/sandbox/sandbox.h"
#include "framework/grading/verdicts/verdict.h"
#include "framework/modules/connection.h"

namespace tumble::grading {

/// The programs of a build tree that run submissions.
struct WorkerPrograms {
  std::filesystem::path worker;  // worker_a1, built from worker_program.h
  std::filesystem::path init;    // sandbox_init
};
/// @param folder  of the programs; empty: that of the running program
/// @throws UserError when they are not built
WorkerPrograms worker_programs(const std::string& id, const std::filesystem::path& folder = {});

struct WorkerOptions {
  std::string id;  // of the module, "a1"
  // what compile_submission made: a shared object, or a worker that is linked with the submission
  std::filesystem::path module;
  // false: a plain process, for trusted code (known-wrong solutions)
  bool sandboxed = true;
  // folder of worker_ID and sandbox_init; empty: that of this program
  std::filesystem::path programs;
  // Own time of the worker (own_time.h), without the time that it waits for a core or for a
  // callback's answer.
  // a longer call counts as an endless loop; right calls take microseconds
  double call_own_s = 5.0;
  std::map<std::string, double> suspects;  // shorter limits [s], by function: see TimeBudget
  double session_own_s = 10.0;             // of all calls until reset()
  long callback_budget = 2'000'000;  // per session: hundreds of times more than any module needs
  std::uint64_t memory_bytes = 1ull << 30;
};

/// Thrown out of a call without an answer. The verdict is already in call_log().
class CallEnded : public std::runtime_error, public Final {
 public:
  using std::runtime_error::runtime_error;
};

class WorkerConnection : public modules::Connection {
 public:
  /// Copies the needed files to a folder that the sandbox's user can read. Starts no process yet.
  explicit WorkerConnection(WorkerOptions options);
  ~WorkerConnection() override;

  /// Sets shorter limits for these functions, from the next call on.
  void suspect(std::map<std::string, double> limits) { options_.suspects = std::move(limits); }
  /// Ends the worker, so that the next call starts a new one.
  void reset();

  modules::Channel& begin_call(const char* function) override;
  void end_call() override;
  void abandon_call() override { reset(); }
  void note_arguments(const char* function, const std::vector<std::string>& words) override;
  void note_call(const char* function, const modules::Bytes& call) override;
  void note_answer(const modules::Bytes& answer) override;
  void note_callback(const modules::Bytes& question, const modules::Bytes& answer) override;
  bool count_callback() override;
  [[noreturn]] void end_at_budget(const char* function) override;
  void resume_call() override;
  modules::Channel::Clock::time_point deadline() const override { return calls_.back().next_check; }
  [[noreturn]] void fail(const char* function, std::exception_ptr transport_error) override;
  [[noreturn]] void refuse(const char* function, const std::string& what) override;
  [[noreturn]] void not_implemented(const char* function, const std::string& handout) override;
  [[noreturn]] void wrong_size(const char* function, const std::string& story) override;

 private:
  using TimePoint = modules::Channel::Clock::time_point;

  // A reading of the times of both processes, and the total wall time of the worker's turns until
  // then.
  struct Account {
    ProcessTimes worker, judge;
    double turns_s = 0.0;
    TimePoint when{};
  };
  struct Call {
    std::string function;
    TimePoint next_check{};  // of its own time
    Account start;
  };

  void begin_turn() { turn_ = modules::Channel::Clock::now(); }
  void end_turn();
  double turns_s() const;
  pid_t worker();
  Account account();
  double own_s(const Account& from, const Account& to) const;
  TimePoint check_time(TimePoint passed);
  void start();
  SandboxOutcome stop(double grace_s);
  void charge_wait(double wait_s);
  std::string place_words(const std::string& printed) const;
  [[noreturn]] void explain_death(const char* function);
  [[noreturn]] void end(Verdict verdict, const std::string& story);
  [[noreturn]] void end_out_of_time(const char* function);
  [[noreturn]] void end_at_limit(const char* function, double limit_s);
  double call_limit(const std::string& function) const;

  WorkerOptions options_;
  SandboxUser user_;
  Stage stage_;
  SandboxJob job_;
  std::optional<Sandbox> sandbox_;
  pid_t plain_ = -1;
  int socket_ = -1;
  std::unique_ptr<modules::Channel> channel_;
  std::string arguments_;    // of the failed call, in words
  std::vector<Call> calls_;  // active calls, the outermost first
  Account session_, last_;   // at the worker's start, and at the last reading
  // start of the worker's turn; nothing: it is the judge's turn
  std::optional<TimePoint> turn_;
  double past_turns_s_ = 0.0;
  double own_before_s_ = 0.0;  // of earlier workers in this test
  double timed_out_s_ = 0.0;   // the limit that the last check found exceeded; 0: none
  pid_t worker_ = -1;
  long callbacks_ = 0;
};

}  // namespace tumble::grading
