/// The third verdict beside right and wrong: a stub that is not filled in yet.
#pragma once

#include <stdexcept>
#include <string>

namespace tumble {

/// Thrown by a stub. Header-only, so that a student's file needs no library to throw it.
class NotImplemented : public std::logic_error {
 public:
  /// @param function  name as in the header, without namespace
  /// @param handout   file with the theory and the hints
  NotImplemented(const std::string& function, const std::string& handout)
      : std::logic_error(function + " is not implemented yet; theory and hints: " + handout),
        function_(function),
        handout_(handout) {}

  const std::string& function() const { return function_; }
  const std::string& handout() const { return handout_; }

 private:
  std::string function_, handout_;
};

}  // namespace tumble
