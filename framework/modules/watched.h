/// A module's table whose calls are reported to a watcher: when each begins, and how it ends.
#pragma once

#include <exception>
#include <functional>
#include <type_traits>
#include <utility>

namespace tumble::modules {

/// Is notified of every call. Calls nest: an integrator's derivative may be a function of the same
/// module.
class CallWatcher {
 public:
  virtual ~CallWatcher() = default;
  /// @return the argument of the matching end(): the enclosing call
  virtual const char* begin(const char* function) = 0;
  virtual void end(const char* outer) = 0;
  /// An exception left the function; it may come from a callback. May throw another one in its
  /// place.
  virtual void threw(const char* function, const std::exception& error) = 0;
};

namespace detail {

/// Ends the call in its destructor, whether the function returns or throws.
class WatchedCall {
 public:
  WatchedCall(CallWatcher& watcher, const char* function)
      : watcher_(watcher), outer_(watcher.begin(function)) {}
  ~WatchedCall() { watcher_.end(outer_); }
  WatchedCall(const WatchedCall&) = delete;
  WatchedCall& operator=(const WatchedCall&) = delete;

 private:
  CallWatcher& watcher_;
  const char* outer_;
};

template <class R, class... A>
std::function<R(A...)> watched_function(CallWatcher& watcher, const char* name,
                                        std::function<R(A...)> function) {
  return [&watcher, name, function = std::move(function)](A... arguments) -> R {
    const WatchedCall call(watcher, name);
    try {
      return function(std::forward<A>(arguments)...);
    } catch (const std::exception& error) {
      watcher.threw(name, error);
      throw;
    }
  };
}

}  // namespace detail

/// @param watcher  must outlive the table and every copy of its functions
template <class Module>
Module watched(Module module, CallWatcher& watcher) {
  Module::visit(module, [&](const char* name, auto& field) {
    field = detail::watched_function(watcher, name, field);
  });
  return module;
}

}  // namespace tumble::modules
