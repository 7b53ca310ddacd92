/// The judge's line to a submission: a worker process, started when first called, thrown away when anything goes wrong.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/grading/sandbox.h"
#include "framework/grading/verdict.h"
#include "framework/modules/proxy.h"

namespace tumble::grading {

/// The programs of a build tree that run submissions.
struct WorkerPrograms {
  std::filesystem::path worker;   // worker_a1, made from worker_program.h
  std::filesystem::path init;     // sandbox_init
};
/// Those beside the running program. @throws UserError when they are not built
WorkerPrograms worker_programs(const std::string& id);

struct WorkerOptions {
  std::string id;                       // of the module, "a1"
  std::filesystem::path module;         // the shared object
  bool sandboxed = true;                // false: a plain process, for code that is our own (known-wrong solutions)
  double call_wall_s = 5.0;             // a call that takes longer is a loop without end; correct ones take microseconds
  std::map<std::string, double> suspects;   // functions whose calls may take less [s]: see TimeBudget
  double session_wall_s = 10.0;         // of all calls until reset()
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
  void count_callback() override;
  modules::Channel::Clock::time_point deadline() const override { return deadline_; }
  [[noreturn]] void fail(const char* function, std::exception_ptr transport_error) override;
  [[noreturn]] void refuse(const char* function, const std::string& what) override;
  [[noreturn]] void not_implemented(const char* function, const std::string& handout) override;

 private:
  void start();
  SandboxOutcome stop(double grace_s);
  [[noreturn]] void explain_death(const char* function);
  [[noreturn]] void end(Verdict verdict, const std::string& story);
  [[noreturn]] void end_out_of_time(const char* function, double limit_s);
  double call_limit(const std::string& function) const;

  WorkerOptions options_;
  SandboxUser user_;
  Stage stage_;
  SandboxJob job_;
  std::optional<Sandbox> sandbox_;
  pid_t plain_ = -1;
  int socket_ = -1;
  std::unique_ptr<modules::Channel> channel_;
  modules::Channel::Clock::time_point session_end_, deadline_;
  std::vector<std::string> calls_;   // that have begun and not ended, the outermost first
  long callbacks_ = 0;
};

}  // namespace tumble::grading
