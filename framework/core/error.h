/// Errors of the framework, by where they can be repaired (see the table in framework/README.md).
#pragma once

#include <stdexcept>
#include <string>

namespace tumble {

/// The user can repair it: a file, a flag, a scene. Ends a command with exit code 2.
class UserError : public std::runtime_error {
 public:
  /// @param where    file, place in it, or flag
  /// @param problem  what was found there, and what was expected
  /// @param remedy   what to do about it (may be empty)
  UserError(std::string where, std::string problem, std::string remedy = "");

  const std::string& where() const { return where_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }

 private:
  std::string where_, problem_, remedy_;
};

/// A caller broke a stated precondition: a bug in code, ours or a student's.
class PreconditionError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Second base of an exception: trying again, with any step size, cannot succeed (time is up, a
/// module is gone).
class Final {
 public:
  virtual ~Final() = default;
};

/// Always-on check of a stated precondition.
/// @throws PreconditionError with `message` when `holds` is false
inline void require(bool holds, const char* message) {
  if (!holds) throw PreconditionError(message);
}
inline void require(bool holds, const std::string& message) {
  if (!holds) throw PreconditionError(message);
}

/// Exit codes of every command.
enum class ExitCode { kFine = 0, kCheckFailed = 1, kUserError = 2, kOurBug = 3, kNotAttempted = 4 };

}  // namespace tumble
