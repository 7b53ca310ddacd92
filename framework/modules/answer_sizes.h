/// Sizes of the vectors of a call, checked where a call enters a module and where it returns: a
/// wrong size is a wrong answer with its story, never an assertion in the calling program.
///
/// The required size of a returned vector is given in the module's header, one line per function:
///     inline void describe(modules::AnswerSizes<Module>& sizes) {
///       sizes.add(&Module::rk4_step, [](const OdeFunction&, double, const VectorXd& y, double) {
///       return y.size(); });
///     }
/// A callback needs no line: a vector argument of it must have the size of the call's own argument
/// of the same type (a derivative is called with a vector as long as the state).
#pragma once

#include <any>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>

#include "framework/core/error.h"
#include "framework/core/math.h"

namespace tumble::modules {

template <class T>
struct is_function : std::false_type {};
template <class R, class... A>
struct is_function<std::function<R(A...)>> : std::true_type {};

/// Thrown through a module's function that returned a vector of the wrong size, or passed one to a
/// callback. Its message is the story.
class WrongSize : public std::runtime_error, public Final {
 public:
  using std::runtime_error::runtime_error;
};

namespace detail {

template <class T>
inline constexpr bool has_dynamic_size = [] {
  if constexpr (std::is_base_of_v<Eigen::PlainObjectBase<T>, T>)
    return T::SizeAtCompileTime == Eigen::Dynamic;
  else
    return false;
}();

inline std::string numbers(Eigen::Index count) {
  return std::to_string(count) + (count == 1 ? " number" : " numbers");
}

// Size of the first argument of type T; nothing where there is none.
template <class T, class... A>
std::optional<Eigen::Index> size_among(const A&... arguments) {
  std::optional<Eigen::Index> size;
  const auto visit = [&](const auto& a) {
    if constexpr (has_dynamic_size<T> && std::is_same_v<std::decay_t<decltype(a)>, T>)
      if (!size) size = a.size();
  };
  (visit(arguments), ...);
  return size;
}

template <class F>
constexpr const char* word_for() {
  return std::is_same_v<F, std::function<VectorXd(double, const VectorXd&)>>
             ? "the derivative"
             : "its function argument";
}

}  // namespace detail

/// The callback with a check that it is called with vectors as long as those of the call that it is
/// an argument of.
/// @param refuse  called with the story of a wrong size; must throw
/// @param call    all arguments of that call
template <class R, class... P, class Refuse, class... A>
std::function<R(P...)> asked_rightly(const std::function<R(P...)>& function, const char* asker,
                                     Refuse refuse, const A&... call) {
  if constexpr (!(detail::has_dynamic_size<std::decay_t<P>> || ...)) return function;
  // Sizes are stored by type of vector now, because the call may move its own vectors away.
  return
      [&function, asker, refuse,
       needed = std::tuple(detail::size_among<std::decay_t<P>>(call...)...)](P... arguments) -> R {
        const auto check = [&](const auto& argument, const std::optional<Eigen::Index>& size) {
          if constexpr (detail::has_dynamic_size<std::decay_t<decltype(argument)>>)
            if (size && argument.size() != *size)
              refuse(std::string(asker) + ": " + detail::word_for<std::function<R(P...)>>() +
                     " was called with " + detail::numbers(argument.size()) + ", but " +
                     std::to_string(*size) + " are needed" +
                     (argument.size() == 0 ? " (a vector that was never set has none)" : ""));
        };
        std::apply([&](const auto&... size) { (check(arguments, size), ...); }, needed);
        return function(std::forward<P>(arguments)...);
      };
}

/// Required sizes of the answers of a module, by function.
template <class Module>
class AnswerSizes {
 public:
  /// @param needed  computes the size of the answer from the call's arguments
  template <class R, class... A, class Needed>
  void add(std::function<R(A...)> Module::*function, Needed needed) {
    needed_[index_of(function)] = std::function<Eigen::Index(const std::decay_t<A>&...)>(needed);
  }

  /// Why the answer of function number `index` has a wrong size; empty where the size is right.
  template <class R, class... A>
  std::string problem(std::size_t index, const char* name, const R& answer,
                      const A&... arguments) const {
    if constexpr (detail::has_dynamic_size<R>) {
      const auto it = needed_.find(index);
      if (it == needed_.end()) return "";
      const auto* needed =
          std::any_cast<std::function<Eigen::Index(const std::decay_t<A>&...)>>(&it->second);
      const Eigen::Index size = needed == nullptr ? answer.size() : (*needed)(arguments...);
      if (answer.size() != size)
        return std::string(name) + " returned " + detail::numbers(answer.size()) + ", but " +
               std::to_string(size) + " are needed";
    }
    return "";
  }

 private:
  template <class Member>
  static std::size_t index_of(Member Module::*function) {
    Module names;
    std::size_t index = 0, found = 0;
    Module::visit(names, [&](const char*, auto& field) {
      if (static_cast<const void*>(&field) == static_cast<const void*>(&(names.*function)))
        found = index;
      ++index;
    });
    return found;
  }

  std::map<std::size_t, std::any> needed_;
};

/// The sizes that a module's header gives by `describe`, if it has one.
template <class Module>
const AnswerSizes<Module>& answer_sizes() {
  static const AnswerSizes<Module> sizes = [] {
    AnswerSizes<Module> all;
    if constexpr (requires { describe(all); }) describe(all);
    return all;
  }();
  return sizes;
}

}  // namespace tumble::modules
