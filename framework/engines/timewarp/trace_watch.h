/// The judge of a scheduler: compares what it commits with the ordered reference at each commit, to
/// the last bit.
#pragma once

#include <string>

#include "framework/trajectory/passing_sink.h"

namespace tumble::engines {

/// Passes a run on, and stops it (StoppedRun) at the first event or frame that differs from the
/// reference's, with expected, found, and the likely error.
class TraceWatch final : public PassingSink {
 public:
  /// @param reference  the ordered run of the scene; times that it did not reach are not judged.
  ///   Must outlive this
  TraceWatch(TrajectorySink& sink, const Trajectory& reference)
      : PassingSink(sink), reference_(reference) {}

  void frame(const Frame& frame) override;
  void event(const Event& event) override;

  /// Why the run is incomplete although it ended: an event of the reference is missing. Empty: none
  /// is.
  std::string missing() const;
  /// Why the reference ended before the end of the run, so that what came later was compared with
  /// nothing. Empty: it did not.
  const std::string& stop_of_reference() const { return reference_.stopped_by; }
  std::size_t events() const { return events_; }

 private:
  std::string in_words(const Event& event) const;
  std::string likely(const Event& expected, const Event& found) const;

  const Trajectory& reference_;
  std::size_t events_ = 0, frames_ = 0;  // passed on
};

}  // namespace tumble::engines
