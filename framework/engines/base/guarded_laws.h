/// Laws that stop a run, with words, where they fail: an exception, an answer that is not a number,
/// an answer of the wrong size.
#pragma once

#include "framework/dynamics/laws.h"
#include "framework/dynamics/stopped_run.h"

namespace tumble::engines {

using tumble::naming;
using tumble::OutOfTime;
using tumble::StoppedForGood;
using tumble::StoppedRun;

/// The same laws; each throws StoppedRun where it fails, naming itself and its author.
/// `NotImplemented` and `UserError` pass through: a law that is not written is no failure of a run.
/// A time of impact that is nonsense passes too: it is only a hint.
Laws guarded(const Laws& laws);

}  // namespace tumble::engines
