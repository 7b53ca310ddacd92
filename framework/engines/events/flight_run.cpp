#include "framework/engines/events/flight_run.h"

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/engines/guarded_laws.h"

namespace tumble::engines {
namespace {

constexpr double kMicroInterval = 0.01;   // of the step: a pair that meets again sooner, and slowly, is sent apart (as retroactive.cpp)

}  // namespace

FlightRun::FlightRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink)
    : world_(scene, options.engine), laws_(guarded(laws)), step_(options.step_s.value_or(scene.step_s)), duration_(options.duration_s.value_or(scene.duration_s)),
      rate_(options.frame_rate_hz), impacts_(world_, laws_.find_impact_time, step_), meetings_(world_, laws_, {scene.rest_speed_m_s, kMicroInterval * step_}), sink_(sink) {}

Meeting FlightRun::meet(const EventKey& key, const Flight& f, const Flight& g) {
  const auto subject = [&] { return fmt::format("bodies {} and {}", name(key.body_a), name(key.body_b)); };
  if (key.generation > kMostGenerations)
    throw StoppedRun(fmt::format("at t = {:.6f} s, {}: time stands still, impacts cause each other without end; a lasting contact is needed there, or a larger \"rest_speed_m_s\"", key.time, subject()));
  try {
    ++counters.impacts;
    Meeting meeting = meetings_.meet(key, f, g);
    counters.impulses += meeting.impulse > 0 ? 1 + meeting.more.size() : 0;
    counters.integrations += (world_.can_move(key.body_a) ? 1 : 0) + (world_.can_move(key.body_b) ? 1 : 0);
    return meeting;
  } catch (const StoppedRun& stop) {
    throw StoppedRun(fmt::format("at t = {:.6f} s, {}: {}", key.time, subject(), stop.what()));
  }
}

void FlightRun::commit(const EventKey& key, const Event& first, const std::vector<Event>& more) {
  if (!(last_ < key))
    throw PreconditionError(fmt::format("events are committed in their order: {} and {} at {:.17g} s ({}) after {} and {} at {:.17g} s ({})", name(key.body_a), name(key.body_b), key.time, key.generation,
                                        name(last_.body_a), name(last_.body_b), last_.time, last_.generation));
  last_ = key;
  ++counters.discontinuities;
  sink_.event(first);
  for (const Event& event : more) sink_.event(event);
}

void FlightRun::commit_frame(const FlightOf& flight_of) {
  const StageTimer timer(counters.record_seconds);
  sink_.frame(frame_of(world_, next_frame(), flight_of));
  ++next_;
}

void FlightRun::end(const std::string& stopped_by) {
  counters.pair_checks += cost.pair_checks;
  counters.collision.gap_evaluations += cost.narrow.gap_evaluations;
  counters.collision.root_findings += cost.narrow.root_findings;
  sink_.end(counters.named(), stopped_by);
}

}  // namespace tumble::engines
