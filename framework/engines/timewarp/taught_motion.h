/// How processes of the teaching timewarp advance, go back and forget: each move is counted and
/// recorded for the chart, and the checks of pairs follow the swept boxes.
#pragma once

#include <optional>
#include <string>

#include "framework/engines/timewarp/taught_checks.h"
#include "framework/engines/timewarp/taught_moves.h"
#include "framework/engines/timewarp/taught_processes.h"

namespace tumble::engines {

class TaughtMotion {
 public:
  TaughtMotion(FlightRun& run, const Scheduling& decide, TaughtProcesses& processes,
               TaughtPairChecks& pairs, TaughtMoves& moves)
      : run_(run), decide_(decide), processes_(processes), pairs_(pairs), moves_(moves) {}

  /// By whole steps, past t where they do not fit: optimistic execution.
  void integrate(int body, double t);
  /// To the time of an event that ends the body's flight: it must have been rolled back to it, and
  /// stand on the flight that was checked where that is known.
  /// @param why  the event, for messages  @throws StoppedRun where it has not been
  void go_to(int body, double t, std::optional<std::uint32_t> version, const std::string& why);
  /// Drops the states after the rollback's stamp, and restores the one at its time. Checks of pairs
  /// stay.
  /// @pre the process has advanced to that time  @throws StoppedRun where no state would be left
  void go_back(const Rollback& rollback, const std::string& why);
  /// Discards what lies behind global virtual time, as the scheduler says.
  void purge();

 private:
  void step_to(int body, double to);

  FlightRun& run_;
  const Scheduling& decide_;
  TaughtProcesses& processes_;
  TaughtPairChecks& pairs_;
  TaughtMoves& moves_;
};

}  // namespace tumble::engines
