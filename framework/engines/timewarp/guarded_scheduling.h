/// A scheduler's decisions with checks that stop a run, with a message, at an unusable answer.
#pragma once

#include <string>

#include "framework/dynamics/scheduling.h"

namespace tumble::engines {

/// The same decisions; each throws StoppedRun where it fails or answers with an invalid time or
/// body. An answer that is only wrong passes: it shows in the committed trace.
/// @param source  the author, for messages
Scheduling guarded(const Scheduling& scheduling, const std::string& source);

}  // namespace tumble::engines
