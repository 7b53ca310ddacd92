/// What a run counts while it goes. Plain integers in the hot path; named when the run ends.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/collision/first_impact.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

struct RunCounters {
  std::uint64_t steps = 0, synchronisations = 0, shortened_steps = 0, integrations = 0, undone_integrations = 0, derivative_evaluations = 0;
  std::uint64_t candidate_pairs = 0, rollbacks = 0, impacts = 0, impulses = 0, nudges = 0, micro_impacts = 0;
  std::uint64_t bodies_put_to_rest = 0, bodies_woken = 0, gravity_calls = 0, point_force_calls = 0;
  std::uint64_t spring_calls = 0, rod_calls = 0, joint_calls = 0, drag_calls = 0, motor_calls = 0, callback_calls = 0;
  std::uint64_t constraint_solves = 0, constraint_corrections = 0;
  std::uint64_t contact_solves = 0, contact_points = 0, contact_sweeps = 0, contact_factorisations = 0, contact_unsolved = 0, contacts_begun = 0, contacts_ended = 0, contact_landings = 0, friction_points = 0;
  std::uint64_t pair_checks = 0, anti_messages = 0, states_kept = 0, discontinuities = 0;   // states_kept: the most at any time
  std::uint64_t bodies_put_to_sleep = 0, body_steps_asleep = 0;
  std::uint64_t rounds = 0, held_back = 0, most_states = 0;   // of threads; events that had to wait for global virtual time; of one body at any time
  collision::ImpactCost collision;
  std::vector<std::string> notices;   // once each
  double integration_seconds = 0.0, collision_seconds = 0.0, impact_seconds = 0.0, record_seconds = 0.0;
  double constraint_seconds = 0.0, contact_seconds = 0.0, control_seconds = 0.0, force_seconds = 0.0, sleep_seconds = 0.0;
  double together_seconds = 0.0, alone_seconds = 0.0;   // of threads, CPU: the busiest of each round, and what one does while the others wait

  /// Adds what another has counted: a thread, or a part of the world.
  void add(const RunCounters& other);

  /// Effects that no entry called for are reported as 0 calls, so that a reader sees that they did not run.
  Counters named() const;
};

/// Adds the time of its scope to a stage.
class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(seconds), start_(Clock::now()) {}
  ~StageTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_;
};

}  // namespace tumble::engines
