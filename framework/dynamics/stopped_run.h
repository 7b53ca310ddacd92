/// Why a run cannot go on, as an exception: it ends up in Trajectory::stopped_by, with the time
/// before it.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "framework/core/error.h"

namespace tumble {

class StoppedRun : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// No rollback and no shorter step changes it, where another StoppedRun may be a consequence of
/// what will be undone.
class StoppedForGood : public StoppedRun, public Final {
 public:
  using StoppedRun::StoppedRun;
};

/// The run has used up what it may take: an engine that works ahead stops for it at once.
class OutOfTime : public StoppedForGood {
 public:
  using StoppedForGood::StoppedForGood;
};

/// Does `work`; a StoppedRun out of it is thrown again with the subject in front.
template <class Work>
auto naming(const std::string& subject, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const OutOfTime&) {
    throw;  // has no subject
  } catch (const StoppedForGood& stop) {
    throw StoppedForGood(subject + ": " + stop.what());
  } catch (const StoppedRun& stop) {
    throw StoppedRun(subject + ": " + stop.what());
  }
}

}  // namespace tumble
