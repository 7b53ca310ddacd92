/// What a run counts while it goes. Plain integers in the hot path; named when the run ends.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "framework/collision/first_impact.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/run_watch.h"
#include "framework/trajectory/passing_sink.h"

namespace tumble::engines {

struct RunCounters {
  std::uint64_t steps = 0, synchronisations = 0, shortened_steps = 0, integrations = 0,
                undone_integrations = 0, derivative_evaluations = 0;
  std::uint64_t candidate_pairs = 0, rollbacks = 0, impacts = 0, impulses = 0,
                position_corrections = 0, micro_impacts = 0;
  std::uint64_t bodies_put_to_rest = 0, bodies_woken = 0;
  std::uint64_t callback_calls = 0;
  std::array<std::uint64_t, effects::kMost> effect_calls{};  // by place in effects::all()
  std::uint64_t constraint_solves = 0, constraint_corrections = 0;
  std::uint64_t contact_solves = 0, contact_points = 0, contact_sweeps = 0,
                contact_factorisations = 0, contact_unsolved = 0, contacts_begun = 0,
                contacts_ended = 0, contact_activations = 0, large_island_steps = 0,
                friction_points = 0;
  // anti_messages: one for each receiver of a cancelled message. The first process that rolls an
  // event back sends them to the others that it changed, so an event of k processes has k - 1, in
  // both timewarps. states_kept: the most at any time
  std::uint64_t pair_checks = 0, anti_messages = 0, states_kept = 0;
  std::uint64_t bodies_put_to_sleep = 0, body_steps_asleep = 0;
  // island segments of processes; fewer are let go where the run ends on some
  std::uint64_t passages_begun = 0, passages_let_go = 0;
  // of threads, each with a region of its own (at home): see named()
  std::uint64_t impacts_at_home = 0, impacts_across = 0, least_of_a_thread = 0;
  // of threads; events that had to wait for global virtual time; of one body at any time
  std::uint64_t rounds = 0, held_back = 0, most_states = 0;
  collision::ImpactCost collision;
  std::vector<std::string> notices;  // once each, before the run begins; later ones: the watch's
  RunWatch watch;                    // what is not to be trusted, or a reader is to know
  double integration_seconds = 0.0, collision_seconds = 0.0, impact_seconds = 0.0,
         record_seconds = 0.0;
  double constraint_seconds = 0.0, contact_seconds = 0.0, control_seconds = 0.0,
         force_seconds = 0.0, sleep_seconds = 0.0;
  // of threads, CPU: the busiest of each round, and what one does while the others wait
  double together_seconds = 0.0, alone_seconds = 0.0;

  /// Adds what another has counted: a thread, or a part of the world.
  void add(const RunCounters& other);

  /// Effects that no entry called for are reported as 0 calls, so that a reader sees that they did
  /// not run. Of threads: impacts that one worked at in its own territory; impacts of two bodies
  /// that were last at home in two threads' territories; and how many events the least busy one
  /// worked at at home.
  Counters named() const;
};

/// Counts discontinuities where every engine's events pass, so that all engines count the same:
/// "discontinuities" among the counts that end() is given. One is an instant at which something
/// happens to a body or a pair: an impact, however many impulses it takes, a contact that begins or
/// opens, a force that is switched, a callback, rest. What lies in contact when a run begins is
/// none, nor is sleep. A change between sliding and sticking or rolling is a discontinuity, too, by
/// the lecture's definition (it changes the equations of motion). It is counted apart, as
/// "sliding_changes": only retroactive detection reports it (and ends its step there, where it
/// locates it), so one sum of both would differ from engine to engine in the same motion.
class DiscontinuityCount final : public PassingSink {
 public:
  explicit DiscontinuityCount(TrajectorySink& sink) : PassingSink(sink) {}

  void event(const Event& event) override;
  void end(const Counters& counters, const std::string& stopped_by) override;

 private:
  bool is_first_at_its_instant(const Event& event);

  std::uint64_t count_ = 0, sliding_changes_ = 0;
  double instant_ = kUnset;               // of the event before [s]
  std::pair<int, int> pair_;              // the first at that instant,
  std::set<std::pair<int, int>> others_;  // and those after it
};

/// w h: discontinuities a body and largest step, each counted for its two bodies,  w h = 2 D h / (n
/// T). Where n w h is above 2, engines whose bodies all stop at each discontinuity begin to pay for
/// it.
/// @param movable_bodies  n;  @param simulated_s  T [s];  @param step_s  h, the largest step [s]
/// @return 0 where nothing moves or no time passes [-]
/// Source: our model of cost (report/engines_model.h); what a discontinuity is: B. Mirtich,
/// "Timewarp Rigid Body Simulation", SIGGRAPH 2000.
double discontinuities_a_body_and_step(std::uint64_t discontinuities, int movable_bodies,
                                       double simulated_s, double step_s);

/// The same of a run that has ended: as far as its last frame.
double discontinuities_a_body_and_step(const Trajectory& run);

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
