/// Shared by benchmarks of the engines: one run of a scene with a size, its counters and its time.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "framework/scene/scene.h"
#include "framework/engines/judging/time_parts.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::testing {

/// Keeps counters, and counts events without storing them.
class Tally final : public TrajectorySink {
 public:
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame& frame) override;
  void event(const Event& event) override {
    collisions += event.kind == EventKind::kCollision ? 1 : 0;
  }
  void end(const Counters& counters, const std::string& stopped) override;

  std::map<std::string, std::uint64_t> counts;
  std::map<std::string, double> stages;  // [s]
  std::string stopped_by;
  std::uint64_t collisions = 0;
  double energy_at_0 = 0.0, energy_error = 0.0;  // [J]; of the first
};

struct Measured {
  // of the run without its set-up; CPU of all threads [s]
  double seconds = 0.0, cpu = 0.0;
  // the parts of its time, of all runs that were made
  engines::TimeShares shares;
  // of the run; of a run that ends before its first step
  Tally tally, building;
  int bodies = 0;                      // movable
  double simulated = 0.0, step = 0.0;  // [s]

  double count(const char* what) const;
  double undone() const;  // fraction of all integrations
  // discontinuities per body and largest step, each counted for its two bodies
  double w_h() const;
  double a_body_second(double amount) const { return amount / bodies / simulated; }
};

// CPU time is independent of other programs on the machine; threads are compared by wall time
enum class Clock { kCpu, kWall };

/// A scene in its state at a later time, by timewarp: a pile needs time to form, which is not part
/// of the comparison. Bodies, links and all else are kept.
/// @param at  [s]
scene::Scene at_a_later_time(const scene::Scene& scene, double at);

/// A scene by one engine: the fastest of several runs where they are short. Without pictures.
/// @param engine    rd, rd_auto (in closed form, as the others are), ca, tw, or tw2, tw4, ...
///   (threads)
/// @param duration  [s]
Measured measure(const scene::Scene& scene, const std::string& engine, double duration,
                 Clock clock = Clock::kCpu);
/// The same for a scene with a size.
Measured measure(const std::string& scene, int n, const std::string& engine, double duration,
                 Clock clock = Clock::kCpu);

}  // namespace tumble::testing
