/// How a law is guarded: a failure in it, and an answer that no run can go on with, stop the run
/// with words that name the law and its author.
#pragma once

#include <cmath>
#include <exception>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/dynamics/body.h"
#include "framework/dynamics/constraint.h"
#include "framework/dynamics/stopped_run.h"

namespace tumble {

/// Whether an answer of a law is made of finite numbers. A type of an effect's own has such a
/// function beside it.
template <class Number>
requires std::is_arithmetic_v<Number>
bool is_number(Number answer) {
  if constexpr (std::is_floating_point_v<Number>) return std::isfinite(answer);
  return true;
}
template <class Derived>
bool is_number(const Eigen::DenseBase<Derived>& answer) {
  return answer.allFinite();
}
inline bool is_number(const Quaterniond& answer) { return answer.coeffs().allFinite(); }
inline bool is_number(const Velocity& answer) {
  return answer.linear_world.allFinite() && answer.angular_world.allFinite();
}
inline bool is_number(const Wrench& answer) {
  return answer.force_world.allFinite() && answer.torque_world.allFinite();
}
inline bool is_number(const ConstraintRow& answer) {
  return answer.jacobian_a.allFinite() && answer.jacobian_b.allFinite() &&
         std::isfinite(answer.value) && std::isfinite(answer.rate) &&
         std::isfinite(answer.velocity_product);
}

class LawGuard {
 public:
  /// @param effect  what goes wrong with it: "springs"  @param law  its function: "spring_force"
  /// @param source  which module provides it: "a3 student"
  LawGuard(std::string effect, std::string law, std::string source)
      : effect_(std::move(effect)), law_(std::move(law)), source_(std::move(source)) {}

  /// Does `call`. An exception out of it stops the run; `NotImplemented`, `UserError`, and a run
  /// that is stopped already (in a function that the law was given) pass through.
  template <class Call>
  auto operator()(Call&& call) const {
    try {
      return call();
    } catch (const StoppedRun&) {
      throw;
    } catch (const NotImplemented&) {
      throw;
    } catch (const UserError&) {
      throw;
    } catch (const std::exception& error) {
      fail(error);
    }
  }
  /// @throws StoppedRun "springs (spring_force of a3 student) returned ..."
  [[noreturn]] void refuse(const std::string& returned) const;
  template <class Answer>
  void need_number(const Answer& answer) const {
    if (!is_number(answer)) refuse("a value that is not a number");
  }
  void need_size(Eigen::Index found, Eigen::Index expected) const {
    if (found != expected) refuse_size(found, expected);
  }

 private:
  [[noreturn]] void fail(const std::exception& error) const;
  [[noreturn]] void refuse_size(Eigen::Index found, Eigen::Index expected) const;

  std::string effect_, law_, source_;
};

/// The law under this guard.
/// @param check  called with the guard, each answer, and the arguments that it is an answer to
template <class R, class... A, class Check>
std::function<R(A...)> guarded_function(LawGuard guard, std::function<R(A...)> law, Check check) {
  return [guard = std::move(guard), law = std::move(law), check](A... arguments) -> R {
    R answer = guard([&] { return law(arguments...); });
    check(guard, answer, arguments...);
    return answer;
  };
}

}  // namespace tumble
