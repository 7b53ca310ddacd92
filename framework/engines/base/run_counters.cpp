#include "framework/engines/base/run_counters.h"

#include <algorithm>

namespace tumble::engines {

void RunCounters::add(const RunCounters& other) {
  for (const auto count : {&RunCounters::steps,
                           &RunCounters::synchronisations,
                           &RunCounters::shortened_steps,
                           &RunCounters::integrations,
                           &RunCounters::undone_integrations,
                           &RunCounters::derivative_evaluations,
                           &RunCounters::candidate_pairs,
                           &RunCounters::pair_checks,
                           &RunCounters::rollbacks,
                           &RunCounters::anti_messages,
                           &RunCounters::states_kept,
                           &RunCounters::impacts,
                           &RunCounters::impulses,
                           &RunCounters::micro_impacts,
                           &RunCounters::position_corrections,
                           &RunCounters::bodies_put_to_rest,
                           &RunCounters::bodies_woken,
                           &RunCounters::callback_calls,
                           &RunCounters::constraint_solves,
                           &RunCounters::constraint_corrections,
                           &RunCounters::contact_solves,
                           &RunCounters::contact_points,
                           &RunCounters::contact_sweeps,
                           &RunCounters::contact_factorisations,
                           &RunCounters::contact_unsolved,
                           &RunCounters::contacts_begun,
                           &RunCounters::contacts_ended,
                           &RunCounters::contact_activations,
                           &RunCounters::large_island_steps,
                           &RunCounters::friction_points,
                           &RunCounters::bodies_put_to_sleep,
                           &RunCounters::body_steps_asleep,
                           &RunCounters::passages_begun,
                           &RunCounters::passages_let_go,
                           &RunCounters::impacts_at_home,
                           &RunCounters::impacts_across,
                           &RunCounters::rounds,
                           &RunCounters::held_back})
    this->*count += other.*count;
  for (std::size_t k = 0; k < effect_calls.size(); ++k) effect_calls[k] += other.effect_calls[k];
  for (const auto seconds :
       {&RunCounters::integration_seconds, &RunCounters::collision_seconds,
        &RunCounters::impact_seconds, &RunCounters::constraint_seconds,
        &RunCounters::contact_seconds, &RunCounters::control_seconds, &RunCounters::force_seconds,
        &RunCounters::sleep_seconds, &RunCounters::together_seconds, &RunCounters::alone_seconds,
        &RunCounters::record_seconds})
    this->*seconds += other.*seconds;
  most_states = std::max(most_states, other.most_states);
  collision.gap_evaluations += other.collision.gap_evaluations;
  collision.root_findings += other.collision.root_findings;
  watch.add(other.watch);
  for (const std::string& notice : other.notices)
    if (std::find(notices.begin(), notices.end(), notice) == notices.end())
      notices.push_back(notice);
}

Counters RunCounters::named() const {
  Counters named;
  named.counts = {{"steps", steps},
                  {"synchronisations", synchronisations},
                  {"shortened_steps", shortened_steps},
                  {"integrations", integrations},
                  {"undone_integrations", undone_integrations},
                  {"derivative_evaluations", derivative_evaluations},
                  {"candidate_pairs", candidate_pairs},
                  {"pair_checks", pair_checks},
                  {"gap_evaluations", collision.gap_evaluations},
                  {"root_findings", collision.root_findings},
                  {"rollbacks", rollbacks},
                  {"anti_messages", anti_messages},
                  {"states_kept", states_kept},
                  {"impacts", impacts},
                  {"impulses", impulses},
                  {"micro_impacts", micro_impacts},
                  {"position_corrections", position_corrections},
                  {"bodies_put_to_rest", bodies_put_to_rest},
                  {"bodies_woken", bodies_woken},
                  {"callback_calls", callback_calls},
                  {"constraint_solves", constraint_solves},
                  {"constraint_corrections", constraint_corrections},
                  {"contact_solves", contact_solves},
                  {"contact_points", contact_points},
                  {"contact_sweeps", contact_sweeps},
                  {"contact_factorisations", contact_factorisations},
                  {"contact_unsolved", contact_unsolved},
                  {"contacts_begun", contacts_begun},
                  {"contacts_ended", contacts_ended},
                  {"contact_activations", contact_activations},
                  {"large_island_steps", large_island_steps},
                  {"friction_points", friction_points},
                  {"bodies_put_to_sleep", bodies_put_to_sleep},
                  {"body_steps_asleep", body_steps_asleep},
                  {"passages_begun", passages_begun},
                  {"passages_let_go", passages_let_go},
                  {"impacts_at_home", impacts_at_home},
                  {"impacts_across_territories", impacts_across},
                  {"least_events_of_a_thread", least_of_a_thread},
                  {"rounds_of_threads", rounds},
                  {"held_back", held_back},
                  {"most_states_of_a_body", most_states}};
  for (std::size_t k = 0; k < effects::all().size(); ++k)
    named.counts[effects::all()[k]->counter()] = effect_calls[k];
  named.stage_seconds = {{"integration", integration_seconds},
                         {"collision", collision_seconds},
                         {"impacts", impact_seconds},
                         {"constraints", constraint_seconds},
                         {"contacts", contact_seconds},
                         {"control", control_seconds},
                         {"forces", force_seconds},
                         {"sleep", sleep_seconds},
                         {"recording", record_seconds}};
  if (together_seconds > 0.0) named.stage_seconds["threads_together"] = together_seconds;
  if (alone_seconds > 0.0) named.stage_seconds["thread_alone"] = alone_seconds;
  named.notices = notices;
  for (const std::string& notice : watch.notices()) named.notices.push_back(notice);
  named.faults = watch.faults();
  return named;
}

bool DiscontinuityCount::is_first_at_its_instant(const Event& event) {
  const std::pair<int, int> pair(event.body_a, event.body_b);
  if (event.time == instant_) return pair != pair_ && others_.insert(pair).second;
  instant_ = event.time;
  pair_ = pair;
  if (!others_.empty()) others_.clear();
  return true;
}

void DiscontinuityCount::event(const Event& event) {
  const bool is_one = event.kind != EventKind::kSleep && event.kind != EventKind::kWake &&
                      event.kind != EventKind::kStick && event.kind != EventKind::kSlide;
  const bool holds_from_the_start = event.kind == EventKind::kContact && event.time == 0.0;
  const bool is_change_of_sliding =
      event.kind == EventKind::kStick || event.kind == EventKind::kSlide;
  // at 0 it holds from the start
  if (is_change_of_sliding && event.time > 0.0) ++sliding_changes_;
  if (is_one && !holds_from_the_start && is_first_at_its_instant(event)) ++count_;
  sink_.event(event);
}

void DiscontinuityCount::end(const Counters& counters, const std::string& stopped_by) {
  Counters with_count = counters;
  with_count.counts["discontinuities"] = count_;
  if (sliding_changes_ > 0) with_count.counts["sliding_changes"] = sliding_changes_;
  sink_.end(with_count, stopped_by);
}

double discontinuities_a_body_and_step(std::uint64_t discontinuities, int movable_bodies,
                                       double simulated_s, double step_s) {
  if (movable_bodies <= 0 || !(simulated_s > 0)) return 0.0;
  return 2.0 * static_cast<double>(discontinuities) * step_s / (movable_bodies * simulated_s);
}

double discontinuities_a_body_and_step(const Trajectory& run) {
  const auto count = run.counters.counts.find("discontinuities");
  if (count == run.counters.counts.end() || run.frames.empty()) return 0.0;
  const auto movable = std::count_if(run.bodies.begin(), run.bodies.end(),
                                     [](const TrajectoryBody& body) { return !body.immovable; });
  return discontinuities_a_body_and_step(count->second, static_cast<int>(movable),
                                         run.frames.back().time, run.info.step_s);
}

}  // namespace tumble::engines
