// Makes the fast scheduler the engine of `--engine tw`.
#include "framework/engines/timewarp/fast_timewarp.h"
#include "solutions_private/a4_timewarp/fast/fast_timewarp.h"

namespace tumble::engines {

Engine fast_timewarp(VirtualTimes* record, const RollbackCheck* watch) {
  return [record, watch](const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                         TrajectorySink& sink) {
    a4::run_fast_timewarp(scene, laws, options, sink, record, watch);
  };
}

}  // namespace tumble::engines
