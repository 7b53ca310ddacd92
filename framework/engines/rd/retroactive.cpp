#include "framework/engines/rd/retroactive.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/contact/contact_paths.h"
#include "framework/engines/contact/impact_law.h"
#include "framework/engines/contact/impact_response.h"
#include "framework/engines/contact/meetings.h"
#include "framework/engines/contact/sequential_impacts.h"
#include "framework/engines/contact/sleeping.h"
#include "framework/engines/rd/recorder.h"
#include "framework/engines/stepping/stability.h"

namespace tumble::engines {
namespace {

constexpr double kNoStep = 1e-9;         // of the step: a shorter last one is taken with the one before

class RetroactiveRun {
 public:
  RetroactiveRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink)
      : scene_(scene), laws_(guarded(laws)), sink_(sink), step_(options.step_s.value_or(scene.step_s)),
        duration_(options.duration_s.value_or(scene.duration_s)), moving_(build_world(scene), laws_, counters_), meetings_(moving_, laws_, counters_),
        impacts_(laws_, {scene.rest_speed_m_s, kMicroInterval * step_}, counters_), callbacks_(options.callbacks), recorder_(options.frame_rate_hz, duration_, sink), energy_watch_(scene.rest_speed_m_s, step_, true) {
    if (options.propagator == "auto") moving_.go_in_closed_form();
    if (!built::kContact || !moving_.world().contact) return;
    contacts_.emplace(moving_, laws_, *moving_.world().contact, scene.rest_speed_m_s, counters_, sink);
    impacts_.use_contact_rules(scene.rest_speed_m_s, moving_.world().contact->impact_law);
    recorder_.record_contacts_of(*contacts_);
    if (built::kFriction && std::any_of(moving_.world().bodies.begin(), moving_.world().bodies.end(), [](const WorldBody& body) { return body.friction > 0.0; })) modes_.emplace(moving_, *contacts_, scene.rest_speed_m_s, sink);
    if (!built::kSleep || !moving_.world().contact->sleep) return;
    sleepers_.emplace(moving_, *contacts_, modes_ ? &*modes_ : nullptr, scene.rest_speed_m_s, counters_, sink);
    recorder_.record_contacts_of(*sleepers_);
  }

  void run();

 private:
  // What the scene does not ask for is asked for by none of these.
  bool has_collisions() const { return built::kCollision && meetings_.any(); }
  bool has_contacts() const { return built::kContact && contacts_.has_value(); }
  bool has_modes() const { return built::kFriction && built::kContact && modes_.has_value(); }
  bool has_sleepers() const { return built::kSleep && built::kContact && sleepers_.has_value(); }

  template <class Write>
  void record(const Write& write) {
    const StageTimer timer(counters_.record_seconds);
    write();
  }
  void tell_of_light_bodies();
  void stop_for(const Runaway& runaway);
  void run_to_the_end();
  double next_target() const;
  void switch_forces();
  void run_callbacks();
  std::vector<std::pair<int, int>> pairs_in_step();
  void advance_to(double target);
  void resolve_at(const std::vector<std::pair<int, int>>& pairs, std::pair<int, int> trigger);
  void note_touching(const std::vector<std::pair<int, int>>& near);
  void begin_again();
  void settle(const std::vector<TouchingPair>& touching, const std::vector<Event>& events);
  void watch_for_trouble();
  std::string name(int body) const { return "'" + moving_.world().bodies[body].name + "'"; }

  const scene::Scene& scene_;
  const Laws laws_;   // guarded
  TrajectorySink& sink_;
  double step_, duration_;
  RunCounters counters_;
  MovingWorld moving_;
  Meetings meetings_;
  SequentialImpacts impacts_;
  const std::vector<Callback> callbacks_;
  std::size_t called_ = 0;
  FrameRecorder recorder_;
  std::optional<LastingContacts> contacts_;   // where the scene asks for them
  std::optional<ContactModes> modes_;         // where contacts may have friction
  std::optional<Sleepers> sleepers_;          // where the scene asks for sleep
  std::vector<std::pair<int, int>> touching_; // pairs in contact in the step that was committed last
  long grid_index_ = 0;
  std::set<double> switch_times_;
  double next_look_ = std::numeric_limits<double>::infinity();   // of a control law
  std::string stopped_by_;
  EnergyWatch energy_watch_;
};

double RetroactiveRun::next_target() const {
  double target = static_cast<double>(grid_index_ + 1) * step_;
  if (target > duration_ - kNoStep * step_) target = duration_;   // no step of a rounding's length at the end
  target = std::min(target, next_look_);
  const auto next = switch_times_.upper_bound(moving_.time());
  if (next != switch_times_.end()) target = std::min(target, *next);
  if (built::kCallback && called_ < callbacks_.size()) target = std::min(target, callbacks_[called_].time);
  return target;
}

void RetroactiveRun::switch_forces() {
  for (const auto& due : moving_.due_switches()) {
    if (has_sleepers()) sleepers_->wake(due.second.event.body_a, -1);
    moving_.turn(due);
    sink_.event(due.second.event);
  }
}

// Those whose time has come: the step ends there, and the next begins with what they have made of velocities.
void RetroactiveRun::run_callbacks() {
  if (!built::kCallback) return;
  for (; called_ < callbacks_.size() && callbacks_[called_].time <= moving_.time(); ++called_) {
    ++counters_.callback_calls;
    std::vector<Event> events;
    for (const int body : callbacks_[called_].bodies) {
      if (has_sleepers()) sleepers_->wake(body, -1);
      if (moving_.resting(body)) moving_.wake(body);
      RigidBodyState state = moving_.state(body);
      callbacks_[called_].act(body, state);
      moving_.set_state(body, state);
      events.push_back({moving_.time(), EventKind::kControl, body, -1, state.com_world, Vector3d::UnitZ(), 0.0, 0.0});
    }
    moving_.keep_constraints(events);
    for (const Event& event : events) sink_.event(event);
  }
}

void RetroactiveRun::resolve_at(const std::vector<std::pair<int, int>>& pairs, std::pair<int, int> trigger) {
  const StageTimer timer(counters_.impact_seconds);
  for (const int body : {trigger.first, trigger.second})
    if (moving_.resting(body)) moving_.wake(body);
  const TouchingPairs touching = touching_pairs(meetings_, pairs, trigger, [&](const auto& pair) { return has_contacts() && contacts_->lasts(pair) && contacts_->keeps(pair); });
  if (has_sleepers())
    for (const TouchingPair& pair : touching.all) sleepers_->wake({pair.a, pair.b});
  const std::string subject = fmt::format("bodies {} and {}", name(trigger.first), name(trigger.second));
  const Resolution resolution = naming(subject, [&] { return impacts_.resolve(moving_, touching.all, touching.trigger); });
  for (const Event& event : resolution.events) sink_.event(event);
  for (const Event& event : resolution.events) energy_watch_.note(event);
  if (!resolution.settled) stopped_by_ = fmt::format("at t = {:.6f} s, {}: {}", moving_.time(), subject, told_left_approaching(laws_));
  if (has_contacts()) return begin_slow_contacts(touching, resolution.events, impacts_, moving_.world(), *contacts_);
  settle(touching.all, resolution.events);
  std::vector<TouchingPair> awake;
  for (const TouchingPair& pair : touching.all)
    if (!moving_.resting(pair.a) && !moving_.resting(pair.b)) awake.push_back(pair);
  naming(subject, [&] { impacts_.push_apart(moving_, awake, resolution.micro_impacts); });
}

// Rest of balls on immovable supports, which may move evenly. No hand pushes what rests.
void RetroactiveRun::settle(const std::vector<TouchingPair>& touching, const std::vector<Event>& events) {
  if (!moving_.world().gravity_world || events.empty()) return;
  double fastest = 0.0;
  for (const Event& event : events) fastest = std::max(fastest, std::abs(event.normal_velocity_before));
  for (const TouchingPair& pair : touching) {
    const bool a_is_support = moving_.world().bodies[pair.a].immovable();
    if (a_is_support == moving_.world().bodies[pair.b].immovable()) continue;
    const int support = a_is_support ? pair.a : pair.b, body = a_is_support ? pair.b : pair.a;
    const Vector3d up = a_is_support ? Vector3d(-pair.gap.normal_b_to_a_world) : pair.gap.normal_b_to_a_world;
    if (moving_.world().bodies[support].motion.angular_frequency_rad_s != 0.0) continue;
    if (!moving_.shape(body).is_ball() || !moving_.is_left_alone(body)) continue;
    const bool rests = comes_to_rest({*moving_.world().gravity_world, up, moving_.shape(body).bounding_radius(), meetings_.touching_distance({pair.a, pair.b}), moving_.world().bodies[body].inertia.inertia_body,
                                      !moving_.state(body).angular_momentum_world.isZero(0.0), moving_.velocity_of(body, moving_.time()) - moving_.velocity_of(support, moving_.time()),
                                      std::min(moving_.world().bodies[body].restitution, moving_.world().bodies[support].restitution), scene_.rest_speed_m_s, fastest});
    if (!rests) continue;
    RigidBodyState state = moving_.state(body);
    state.com_world -= pair.gap.distance * up;
    moving_.set_state(body, state);
    moving_.put_to_rest(body, support);
    sink_.event({moving_.time(), EventKind::kRest, pair.a, pair.b, pair.gap.point_b_world, pair.gap.normal_b_to_a_world, 0.0, 0.0});
  }
}

void RetroactiveRun::watch_for_trouble() {
  for (int i = 0; i < moving_.size(); ++i) {
    if (moving_.world().bodies[i].immovable()) continue;
    const VectorXd y = pack(moving_.state(i));
    if (y.allFinite()) continue;
    stopped_by_ = fmt::format("at t = {:.6f} s, body {}: its state is not a number (integrator: {}; impulses: {})", moving_.time(), name(i),
                              laws_.integrator_source, laws_.impulse_source);
    return;
  }
}

void RetroactiveRun::note_touching(const std::vector<std::pair<int, int>>& near) {
  touching_.clear();
  std::copy_if(near.begin(), near.end(), std::back_inserter(touching_), [&](const auto& pair) { return contacts_->keeps(pair); });
}

// A sleeper is met in the step under way: it takes it awake.
void RetroactiveRun::begin_again() {
  moving_.give_up_step();
  ++counters_.rollbacks;
}

// Those that may meet in the step under way, which is made shorter where bodies turn too far in it.
std::vector<std::pair<int, int>> RetroactiveRun::pairs_in_step() {
  std::vector<std::pair<int, int>> pairs = meetings_.candidates();
  if (moving_.shorten_step(pairs, [&](const auto& pair) { return has_contacts() && contacts_->deals_in_step(pair); })) pairs = meetings_.candidates();
  return pairs;
}

void RetroactiveRun::advance_to(double target) {
  int idle = 0;
  long impacts = 0;
  while (stopped_by_.empty() && moving_.time() < target) {
    // Bodies go where they would without each other. A sleeper that would be met takes the step awake.
    moving_.begin_step(target);
    ++counters_.steps;
    PairsOfStep pairs;
    if (has_collisions()) pairs.searched = pairs_in_step();
    if (has_sleepers() && sleepers_->wake_met(pairs.searched)) {
      begin_again();
      continue;
    }
    // Bodies in lasting contact go where their contacts let them; the step becomes shorter where a contact changes within it.
    if (has_contacts())
      keep_contacts(*contacts_, meetings_, pairs, [&](double earlier) {
        moving_.begin_step_again(earlier);
        return true;
      });
    // The first impact among all others ends the step.
    std::optional<Earliest> earliest;
    if (has_collisions()) earliest = meetings_.earliest(pairs.searched);
    if (has_sleepers() && earliest && sleepers_->wake(pairs.searched[earliest->pair])) {
      begin_again();
      continue;
    }
    if (has_modes()) modes_->look();
    const double before = moving_.time(), reached = earliest ? earliest->time : moving_.target();
    record([&] { recorder_.record_before(moving_, reached); });
    // The world goes there as a whole, and what is left of overlaps is taken back.
    if (reached < target) ++counters_.synchronisations;
    moving_.commit(reached);
    watch_for_trouble();
    if (!stopped_by_.empty()) return;
    if (has_collisions()) take_back_overlaps(has_contacts() ? &*contacts_ : nullptr, meetings_, pairs);
    if (has_sleepers()) note_touching(pairs.near);
    if (!earliest) moving_.watch_links(reached - before);
    if (!built::kCollision || !earliest) continue;
    // Velocities jump, by the laws' impulses, at everything that touches there.
    ++counters_.rollbacks;
    const std::pair<int, int> trigger = pairs.searched[earliest->pair];
    resolve_at(pairs.near.empty() ? pairs.searched : pairs.near, trigger);
    idle = reached > before ? 0 : idle + 1;
    if (idle > kMostIdleSteps || ++impacts > most_impacts(moving_.size()))
      stopped_by_ = told_endless_impacts(moving_.time(), fmt::format("bodies {} and {}", name(trigger.first), name(trigger.second)));
  }
}

// On rods between heavy ones, or between joints.
void RetroactiveRun::tell_of_light_bodies() {
  const RunCounters before = counters_;   // what is looked at must not show in what a run counts
  const LinkForces at_start = moving_.measure_links(moving_.states(), 0.0, {});
  counters_ = before;
  if (const auto step = tell_of_unstable_links(moving_.world(), at_start, laws_, {step_, duration_}, counters_.notices)) counters_.watch.name_step(*step);
}

void RetroactiveRun::run() {
  const std::string where = scene_.file.empty() ? scene_.name : scene_.file.string();
  meetings_.refuse_overlap(where, scene_);
  refuse_unstable_steps(moving_.world(), laws_, {step_, duration_}, where, counters_.notices);
  for (const effects::Effect* effect : effects::all())
    for (const effects::Switch& one : effect->switches(moving_.world())) switch_times_.insert(one.event.time);
  try {
    if (moving_.world().stabilisation) tell_of_light_bodies();
    run_to_the_end();
  } catch (const StoppedRun& stop) {
    stopped_by_ = fmt::format("at t = {:.6f} s, {}", moving_.time(), stop.what());
  }
  energy_watch_.tell(moving_.world(), counters_);
  sink_.end(counters_.named(), stopped_by_);
}

void RetroactiveRun::stop_for(const Runaway& runaway) {
  const std::vector<ContactPoint> none, &contacts = has_contacts() ? contacts_->forces() : none;
  const LinkForces links = moving_.measure_links(moving_.states(), moving_.time(), contacts);
  stopped_by_ = told_runaway(moving_.time(), moving_.world(), runaway, {moving_.states(), links, contacts}, laws_);
}

void RetroactiveRun::run_to_the_end() {
  switch_forces();
  std::vector<std::pair<int, int>> all;   // bodies that touch at the start may overlap by a rounding
  for (int i = 0; i < moving_.size(); ++i)
    for (int j = i + 1; j < moving_.size(); ++j)
      if (moving_.may_collide(i, j)) all.emplace_back(i, j);
  meetings_.separate(all);
  if (has_contacts()) contacts_->begin_where_touching(all);
  run_callbacks();
  const auto watch_energy = [&] {
    if (!callbacks_.empty()) return;   // they bring energy in
    if (const auto runaway = energy_watch_.look(moving_.time(), moving_.world(), moving_.states())) stop_for(*runaway);
  };
  watch_energy();   // what the first step does counts, too
  record([&] { recorder_.record_committed(moving_); });
  while (stopped_by_.empty() && moving_.time() < duration_) {
    next_look_ = moving_.look();
    if (has_sleepers()) sleepers_->wake_where_control_changes();
    const double target = next_target();
    advance_to(target);
    if (!stopped_by_.empty()) break;
    if (target >= static_cast<double>(grid_index_ + 1) * step_) ++grid_index_;
    switch_forces();
    run_callbacks();
    watch_energy();
    record([&] { recorder_.record_committed(moving_); });
    if (has_sleepers()) sleepers_->look(touching_);
  }
}

}  // namespace

void run_retroactive(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink) {
  std::optional<RetroactiveRun> run;
  try {
    run.emplace(scene, laws, options, sink);
  } catch (const StoppedRun& stop) {   // links are drawn onto their constraints where they start
    return sink.end(RunCounters{}.named(), fmt::format("at t = 0.000000 s, {}", stop.what()));
  }
  run->run();
}

}  // namespace tumble::engines
