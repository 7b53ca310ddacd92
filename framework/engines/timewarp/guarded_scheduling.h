/// A scheduler's decisions that stop a run, with words, where an answer cannot be followed at all.
#pragma once

#include <string>

#include "framework/dynamics/scheduling.h"

namespace tumble::engines {

/// The same decisions; each throws StoppedRun where it fails, or answers what is no time and no body. What is merely wrong passes: it
/// shows in what is committed.
/// @param source  who wrote them, for the words
Scheduling guarded(const Scheduling& scheduling, const std::string& source);

}  // namespace tumble::engines
