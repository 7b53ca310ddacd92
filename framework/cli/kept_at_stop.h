/// Ctrl-C in a verb that makes one page from many pieces (cost, engines, battery): the page is
/// written again after each piece, so that at Ctrl-C nothing is left to do but to say what is kept,
/// and where. No engine needs to know of it, and none is waited for.
#pragma once

#include <signal.h>

#include <functional>
#include <string>

namespace tumble::cli {

/// Exit code of a program that Ctrl-C has ended, as shells have it.
inline constexpr int kStoppedByHand = 130;

class KeptAtStop {
 public:
  /// From here on Ctrl-C ends the program with one line. One at a time.
  /// @param pieces  what is finished one by one: "methods", "scenes"
  explicit KeptAtStop(std::string pieces);
  ~KeptAtStop();
  KeptAtStop(const KeptAtStop&) = delete;
  KeptAtStop& operator=(const KeptAtStop&) = delete;

  /// Writes by `write`, during which Ctrl-C waits: no file is half written. Afterwards `done` of
  /// `all` pieces are kept in `place`.
  void keep(std::size_t done, std::size_t all, const std::string& place,
            const std::function<void()>& write);

 private:
  std::string pieces_;
  struct sigaction before_ {};
};

}  // namespace tumble::cli
