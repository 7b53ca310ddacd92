/// The judge's line to a submission: a worker process, started when first called, thrown away when anything goes wrong.
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
#include "framework/modules/proxy.h"

namespace tumble::grading {

/// The programs of a build tree that run submissions.
struct WorkerPrograms {
  std::filesystem::path worker;   // worker_a1, made from worker_program.h
  std::filesystem::path init;     // sandbox_init
};
/// @param folder  where they lie; empty: beside the running program
/// @throws UserError when they are not built
WorkerPrograms worker_programs(const std::string& id, const std::filesystem::path& folder = {});

struct WorkerOptions {
  std::string id;                       // of the module, "a1"
  std::filesystem::path module;         // the shared object
  bool sandboxed = true;                // false: a plain process, for code that is our own (known-wrong solutions)
  std::filesystem::path programs;       // folder of worker_ID and sandbox_init; empty: that of this program
  // Own time of the worker (own_time.h): what it computes and sleeps, without what it waits for a core or for a callback's answer.
  double call_own_s = 5.0;              // a call that takes longer is a loop without end; correct ones take microseconds
  std::map<std::string, double> suspects;   // functions whose calls may take less [s]: see TimeBudget
  double session_own_s = 10.0;          // of all calls until reset()
  long callback_budget = 2'000'000;     // in a session: beyond what any module needs by a factor of hundreds
  std::uint64_t memory_bytes = 1ull << 30;
};

/// Thrown out of a call that has no answer. The verdict is in call_log() already.
class CallEnded : public std::runtime_error, public Final {
 public:
  using std::runtime_error::runtime_error;
};

class WorkerConnection : public modules::Connection {
 public:
  /// Copies what is needed to where the sandbox's user can read it. Starts nothing yet.
  explicit WorkerConnection(WorkerOptions options);
  ~WorkerConnection() override;

  /// Calls to these functions may take less, from the next one on.
  void suspect(std::map<std::string, double> limits) { options_.suspects = std::move(limits); }
  /// Ends the worker, so that the next call meets a fresh one.
  void reset();

  modules::Channel& begin_call(const char* function) override;
  void end_call() override;
  void abandon_call() override { reset(); }
  void note_arguments(const std::string& words) override { asked_ = words; }
  void count_callback() override;
  void resume_call() override;
  modules::Channel::Clock::time_point deadline() const override { return calls_.back().look; }
  [[noreturn]] void fail(const char* function, std::exception_ptr transport_error) override;
  [[noreturn]] void refuse(const char* function, const std::string& what) override;
  [[noreturn]] void not_implemented(const char* function, const std::string& handout) override;
  [[noreturn]] void wrong_size(const char* function, const std::string& story) override;

 private:
  using TimePoint = modules::Channel::Clock::time_point;

  // Where the worker's account stands: the kernel's numbers of both processes, and the wall time of its turns until then.
  struct Account {
    ProcessTimes worker, judge;
    double turns_s = 0.0;
    TimePoint when{};
  };
  struct Call {
    std::string function;
    TimePoint look{};           // when its own time is looked at next
    Account start;
  };

  void begin_turn() { turn_ = modules::Channel::Clock::now(); }
  void end_turn();
  double turns_s() const;
  pid_t worker();
  Account account();
  double own_s(const Account& from, const Account& to) const;
  TimePoint look_at_time(TimePoint passed);
  void start();
  SandboxOutcome stop(double grace_s);
  void charge_wait(double wait_s);
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
  std::string asked_;                   // by the call that failed, in words
  std::vector<Call> calls_;             // that have begun and not ended, the outermost first
  Account session_, last_;              // at the worker's start, and when it was looked at last
  std::optional<TimePoint> turn_;       // since when the worker has the word; nothing: the judge has it
  double past_turns_s_ = 0.0;
  double own_before_s_ = 0.0;           // of workers before this one in this test
  double timed_out_s_ = 0.0;            // the limit that the last look found passed; 0: none
  pid_t worker_ = -1;
  long callbacks_ = 0;
};

}  // namespace tumble::grading
