/// The calls into a module during one test, stored where the parent process can read them after the
/// test's process has died.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/grading/verdicts/death.h"
#include "framework/grading/verdicts/parameter_names.h"
#include "framework/grading/verdicts/verdict.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/show_arguments.h"

namespace tumble::grading {

/// In memory shared between a test's process and its parent. Plain data, which survives a crash.
struct CallLog {
  static constexpr std::size_t kStory = 4096;      // bytes: longer exception texts are cut
  static constexpr std::size_t kArguments = 8192;  // bytes in the wire format
  char last_call[96] = "";
  char failed_call[96] = "";  // the last one before the test's first failure; empty: none
  unsigned char arguments[kArguments] = {};
  std::size_t argument_bytes = 0;  // 0: none kept
  // converts the arguments to words: see add_describer
  std::size_t describer = 0;
  char story[kStory] = "";
  long calls = 0;
  bool in_call = false;
  bool noted = false;
  double timed_out_s = 0.0;  // the limit that a call exceeded
  double own_s = 0.0;        // own time of the worker in this test, where there is one
  Verdict verdict = Verdict::kGraderFault;

  void begin(const char* function);
  void end() { in_call = false; }
  void keep(const modules::Bytes& bytes, std::size_t describer);
  /// The test has failed: what was called last is what it failed in. Later calls change nothing.
  void failed();
  /// The arguments of the last call in words, and where its function's hints are; empty where they
  /// were not kept.
  std::string asked() const;
  /// Only the first note is kept: later ones are its consequences.
  void note(Verdict verdict, const std::string& story);
};

/// The log of the test that runs in this process, or of this thread where it has its own.
CallLog& call_log();

/// A log of its own for the calls of this thread while it lives: for scenes that run at one time.
class OwnCallLog {
 public:
  OwnCallLog();
  ~OwnCallLog();
  OwnCallLog(const OwnCallLog&) = delete;
  OwnCallLog& operator=(const OwnCallLog&) = delete;

 private:
  CallLog log_;
  CallLog* before_;
};

namespace detail {

using Describer = std::string (*)(const std::string& function, const modules::Bytes&);
/// Registers a describer in the parent process, which uses its number and trusts no pointer from a
/// crashed process. @return the number
std::size_t add_describer(Describer describer);

template <class Module, class... A>
std::string described(const std::string& function, const modules::Bytes& arguments) {
  return with_names(modules::show_written_arguments<A...>(arguments),
                    parameter_names(Module::kId, function)) +
         hints_to_read(Module::kId, function);
}

// Initialised before main, and so in the parent.
template <class Module, class... A>
inline const std::size_t describer_of = add_describer(described<Module, A...>);

/// The call that another one is within: the log is about it again when the inner one has returned.
class OuterCall {
 public:
  explicit OuterCall(const CallLog& log) {
    if (!log.in_call) return;
    function_ = log.last_call;
    arguments_.assign(log.arguments, log.arguments + log.argument_bytes);
    describer_ = log.describer;
  }
  void goes_on(CallLog& log) const {
    if (function_.empty()) return;
    log.begin(function_.c_str());
    --log.calls;  // it was counted when it began
    log.keep(arguments_, describer_);
  }

 private:
  std::string function_;  // empty: there is none
  modules::Bytes arguments_;
  std::size_t describer_ = 0;
};

// A vector of the wrong size ends the call: otherwise an assertion would fail elsewhere.
[[noreturn]] inline void end_by_size(const std::string& story) {
  call_log().note(Verdict::kWrong, story);
  throw modules::WrongSize(story);
}

// Adds checks of sizes to callbacks; other arguments stay unchanged.
template <class T, class... A>
decltype(auto) guarded(T& argument, const char* name, const A&... call) {
  if constexpr (modules::is_function<std::decay_t<T>>::value)
    return modules::asked_rightly(argument, name, end_by_size, call...);
  else
    return (argument);
}

template <class Module, class R, class... A>
std::function<R(A...)> observe(std::size_t index, const char* name,
                               std::function<R(A...)> function) {
  return [index, name, function](A... arguments) -> R {
    CallLog& log = call_log();
    const OuterCall outer(log);
    log.begin(name);
    thread_local modules::Writer writer;
    writer.bytes.clear();
    modules::write_arguments(writer, arguments...);
    log.keep(writer.bytes, describer_of<Module, A...>);
    try {
      R result = function(guarded(arguments, name, arguments...)...);
      if (const std::string problem =
              modules::answer_sizes<Module>().problem(index, name, result, arguments...);
          !problem.empty())
        end_by_size(problem);
      log.end();
      outer.goes_on(log);
      return result;
    } catch (const NotImplemented& missing) {
      log.note(Verdict::kNotAttempted, missing.what());
      throw;
    } catch (const std::bad_alloc&) {
      log.note(Verdict::kOutOfResources, std::string(name) + " needed more memory than its limit");
      throw;
    } catch (const std::exception& error) {
      log.note(Verdict::kCrashed, std::string(name) + " threw an exception: " + error.what() +
                                      asked_words(log.asked()));
      throw;
    } catch (...) {
      log.note(Verdict::kCrashed, std::string(name) +
                                      " threw an object that is not a std::exception" +
                                      asked_words(log.asked()));
      throw;
    }
  };
}

}  // namespace detail

/// The same table, with each call noted in the log before it runs.
template <class Module>
Module observed(Module module) {
  std::size_t index = 0;
  Module::visit(module, [&](const char* name, auto& field) {
    field = detail::observe<Module>(index++, name, field);
  });
  return module;
}

}  // namespace tumble::grading
