/// The calls into a module during one test, kept where the parent process can read them after the test's process died.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <new>
#include <string>

#include "framework/core/not_implemented.h"
#include "framework/grading/verdicts/death.h"
#include "framework/grading/verdicts/verdict.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/show_arguments.h"

namespace tumble::grading {

/// Lies in memory shared between a test's process and its parent. Plain data: it must outlive a crash.
struct CallLog {
  static constexpr std::size_t kStory = 4096;  // bytes: a compiler-made exception text may be long, a story is not
  static constexpr std::size_t kArguments = 8192;   // bytes, as on the wire
  char last_call[96] = "";
  unsigned char arguments[kArguments] = {};
  std::size_t argument_bytes = 0;                   // 0: none kept
  std::size_t describer = 0;                        // makes words of them: see add_describer
  char story[kStory] = "";
  long calls = 0;
  bool in_call = false;
  bool noted = false;
  double timed_out_s = 0.0;   // the limit that a call ran into
  double own_s = 0.0;         // own time of the worker in this test, where there is one
  Verdict verdict = Verdict::kGraderFault;

  void begin(const char* function);
  void end() { in_call = false; }
  void keep(const modules::Bytes& bytes, std::size_t describer);
  /// What the last call was asked, in words; empty where that was not kept.
  std::string asked() const;
  /// The first thing noted stands: what follows from it is not the student's slip.
  void note(Verdict verdict, const std::string& story);
};

/// Of the test that is running in this process.
CallLog& call_log();

namespace detail {

using Describer = std::string (*)(const modules::Bytes&);
/// Known to the parent process too, which trusts no pointer that a crashed one left behind. @return its number
std::size_t add_describer(Describer describer);

// Made before main begins, so in the parent.
template <class... A>
inline const std::size_t describer_of = add_describer(modules::show_written_arguments<A...>);

// A vector of the wrong size ends the call: what would come of it is an assertion somewhere else.
[[noreturn]] inline void end_by_size(const std::string& story) {
  call_log().note(Verdict::kWrong, story);
  throw modules::WrongSize(story);
}

// Functions that are passed to the module are held to be asked with the right sizes; other arguments stay what they are.
template <class T, class... A>
decltype(auto) guarded(T& argument, const char* name, const A&... call) {
  if constexpr (modules::is_function<std::decay_t<T>>::value) return modules::asked_rightly(argument, name, end_by_size, call...);
  else return (argument);
}

template <class Module, class R, class... A>
std::function<R(A...)> observe(std::size_t index, const char* name, std::function<R(A...)> function) {
  return [index, name, function](A... arguments) -> R {
    CallLog& log = call_log();
    log.begin(name);
    thread_local modules::Writer writer;
    writer.bytes.clear();
    modules::write_arguments(writer, arguments...);
    log.keep(writer.bytes, describer_of<A...>);
    try {
      R result = function(guarded(arguments, name, arguments...)...);
      if (const std::string problem = modules::answer_sizes<Module>().problem(index, name, result, arguments...); !problem.empty()) end_by_size(problem);
      log.end();
      return result;
    } catch (const NotImplemented& missing) {
      log.note(Verdict::kNotAttempted, missing.what());
      throw;
    } catch (const std::bad_alloc&) {
      log.note(Verdict::kOutOfResources, std::string(name) + " asked for more memory than it may have");
      throw;
    } catch (const std::exception& error) {
      log.note(Verdict::kCrashed, std::string(name) + " threw an exception: " + error.what() + asked_words(log.asked()));
      throw;
    } catch (...) {
      log.note(Verdict::kCrashed, std::string(name) + " threw something that is not a std::exception" + asked_words(log.asked()));
      throw;
    }
  };
}

}  // namespace detail

/// The same table, each call noted in the log before it runs.
template <class Module>
Module observed(Module module) {
  std::size_t index = 0;
  Module::visit(module, [&](const char* name, auto& field) { field = detail::observe<Module>(index++, name, field); });
  return module;
}

}  // namespace tumble::grading
