/// The judge's side of a boundary to another process, and the table whose functions run there.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "framework/modules/channel.h"
#include "framework/modules/wire.h"

namespace tumble::modules {

/// The interface that a proxy needs to the owner of the other process.
class Connection {
 public:
  virtual ~Connection() = default;
  /// The channel to a running worker; starts one where none runs. Called once per call, before
  /// anything is sent. A callback may call the module again: such calls nest.
  virtual Channel& begin_call(const char* function) = 0;
  /// The worker has answered: it waits for the next call.
  virtual void end_call() {}
  /// A call before it is sent, a question to a function argument with what it was answered, and the
  /// call's answer, as they travel. Arguments begin behind the number of the function; functions
  /// among them are numbers.
  virtual void note_call(const char*, const Bytes& /*call*/) {}
  virtual void note_callback(const Bytes& /*question*/, const Bytes& /*answer*/) {}
  virtual void note_answer(const Bytes& /*answer*/) {}
  /// The call ends without its answer because a callback threw; the worker still waits inside the
  /// call.
  virtual void abandon_call() {}
  /// Called before each callback runs. False: a budget is used up (of evaluations, or of time), and
  /// the call ends by end_at_budget().
  virtual bool count_callback() = 0;
  /// Must throw; the call is over.
  [[noreturn]] virtual void end_at_budget(const char* function) {
    refuse(function, "used up its budget");
    throw std::runtime_error(function);  // unreachable: refuse throws
  }
  /// A callback has run, and its answer is sent next: the worker resumes the call.
  virtual void resume_call() {}
  virtual Channel::Clock::time_point deadline() const = 0;
  /// The arguments of the call that is about to fail, each in words.
  virtual void note_arguments(const char* /*function*/, const std::vector<std::string>&) {}
  /// The worker gave no answer: turn the transport error into a verdict. Must throw; the call is
  /// over.
  [[noreturn]] virtual void fail(const char* function, std::exception_ptr transport_error) = 0;
  /// The worker answered with an exception, or with bytes that are not a valid answer.
  [[noreturn]] virtual void refuse(const char* function, const std::string& what) = 0;
  [[noreturn]] virtual void not_implemented(const char* function, const std::string& handout) = 0;
  /// The worker returned a vector of the wrong size, or passed one to a callback; the call is over.
  /// `story` says which one, and the size needed.
  [[noreturn]] virtual void wrong_size(const char* function, const std::string& story) {
    refuse(function, story);
    throw WrongSize(story);  // unreachable: refuse throws
  }
};

/// A table whose functions run at the other end of `connection`, which must outlive it. Defined in
/// modules/proxy.h, and compiled once for each assignment (aN_proxy of assignments/CMakeLists.txt):
/// it takes seconds.
template <class Module>
Module make_proxy(Connection& connection);

}  // namespace tumble::modules
