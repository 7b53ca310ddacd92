/// The run before the one that is shown, compared with it as far as both have come.
#pragma once

#include <chrono>
#include <string>

#include "framework/live/history.h"
#include "framework/live/pages.h"

namespace tumble::live {

class FormerRun {
 public:
  explicit FormerRun(Pages& pages) : pages_(pages) {}

  bool is_there() const { return !run_.frames().empty(); }
  void clear();
  /// A run that another one takes the place of; left alone where it has not moved.
  void keep(History& run, bool has_ended);
  /// Another run is shown, or the same one goes on in another way from this time on. [s]
  void compare_anew(double from_s);
  /// Tells pages what has come since the last look, which is not long ago in most cases.
  void compare(const History& shown, bool has_ended);
  /// What was told last, for a page that opens: JSON; empty: nothing.
  const std::string& told() const { return told_; }

 private:
  Pages& pages_;
  History run_;
  bool has_ended_ = false;  // it was not replaced while it went
  double compared_until_ = 0.0;
  bool has_difference_ = false;
  std::chrono::steady_clock::time_point compared_at_ = std::chrono::steady_clock::now();
  std::string told_;
};

}  // namespace tumble::live
