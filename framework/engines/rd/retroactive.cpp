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
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/sleeping.h"
#include "framework/engines/contact/world_step.h"
#include "framework/engines/rd/recorder.h"
#include "framework/engines/stepping/energy_watch.h"
#include "framework/engines/stepping/stability.h"

namespace tumble::engines {
namespace {

class RetroactiveRun : private StepStages {
 public:
  RetroactiveRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                 TrajectorySink& sink)
      : scene_(scene),
        laws_(guarded(laws)),
        sink_(sink),
        step_(options.step_s.value_or(scene.step_s)),
        duration_(options.duration_s.value_or(scene.duration_s)),
        world_step_(build_world(scene), laws_, {step_, scene.rest_speed_m_s}, counters_, sink),
        moving_(world_step_.moving()),
        callbacks_(options.callbacks),
        hand_(options.hand),
        recorder_(FrameTimes(options, scene.duration_s), sink),
        energy_watch_(scene.rest_speed_m_s, step_, true) {
    if (options.propagator == "auto")
      moving_.go_in_closed_form();
    else
      moving_.watch_free_turning();
    if (!world_step_.has_contacts()) return;
    PersistentContacts& contacts = world_step_.contacts();
    recorder_.record_contacts_of(contacts);
    if (callbacks_.empty()) contacts.watch_losses();
    if (built::kFriction &&
        std::any_of(moving_.world().bodies.begin(), moving_.world().bodies.end(),
                    [](const WorldBody& body) { return body.friction > 0.0; }))
      modes_.emplace(moving_, contacts, scene.rest_speed_m_s, sink);
    if (!built::kSleep || !moving_.world().contact->sleep) return;
    sleepers_.emplace(moving_, contacts, modes_ ? &*modes_ : nullptr, scene.rest_speed_m_s,
                      counters_, sink);
    recorder_.record_contacts_of(*sleepers_);
  }

  void run();

 private:
  // What the scene does not ask for is asked for by none of these.
  bool has_modes() const { return built::kFriction && built::kContact && modes_.has_value(); }
  bool has_sleepers() const { return built::kSleep && built::kContact && sleepers_.has_value(); }

  template <class Write>
  void record(const Write& write) {
    const StageTimer timer(counters_.record_seconds);
    write();
  }
  void report_light_bodies();
  const std::vector<ContactPoint>& contacts() const;  // of the step that was taken last
  void stop_for(const Runaway& runaway);
  void run_to_the_end();
  double next_target() const;
  void take_from_hand();
  void switch_forces();
  void run_callbacks();
  void advance_to(double target);
  void note_touching(const std::vector<std::pair<int, int>>& near);

  // What a step of all bodies has besides the world's own (world_step.h): sleep, modes of friction,
  // pictures.
  void begin(double target) override { moving_.begin_step(target); }
  bool begin_again(double target) override {
    moving_.begin_step_again(target);
    return true;
  }
  bool wake_approached(const std::vector<std::pair<int, int>>& candidates) override {
    return has_sleepers() && sleepers_->wake_approached(candidates);
  }
  bool wake(std::pair<int, int> pair) override { return has_sleepers() && sleepers_->wake(pair); }
  void before_commit(double reached) override;
  void impact(const Event& event) override {
    sink_.event(event);
    energy_watch_.note(event);
  }

  const scene::Scene& scene_;
  const Laws laws_;  // guarded
  TrajectorySink& sink_;
  double step_, duration_;
  double target_ = 0.0;  // of advance_to [s]
  RunCounters counters_;
  WorldStep world_step_;
  MovingWorld& moving_;  // of world_step_
  const std::vector<Callback> callbacks_;
  std::size_t called_ = 0;
  const Hand hand_;
  FrameRecorder recorder_;
  std::optional<ContactModes> modes_;  // where contacts may have friction
  std::optional<Sleepers> sleepers_;   // where the scene asks for sleep
  // pairs in contact in the step that was committed last
  std::vector<std::pair<int, int>> touching_;
  long grid_index_ = 0;
  std::set<double> switch_times_;
  double next_look_ = std::numeric_limits<double>::infinity();  // of a control law
  std::string stopped_by_;
  EnergyWatch energy_watch_;
};

double RetroactiveRun::next_target() const {
  const auto next = switch_times_.upper_bound(moving_.time());
  const double target = first_of(
      {static_cast<double>(grid_index_ + 1) * step_, next_look_,
       next != switch_times_.end() ? *next : kInfinity,
       built::kCallback && called_ < callbacks_.size() ? callbacks_[called_].time : kInfinity},
      step_);
  // no step of a rounding's length at the end
  return is_at_end(target, duration_, step_) ? duration_ : target;
}

void RetroactiveRun::take_from_hand() {
  if (!hand_) return;
  const auto more = hand_({moving_.time(), moving_.world(), moving_.states()});
  if (!more) return;
  moving_.take_in(*more);
  energy_watch_.take_in(moving_.world());
  for (const effects::Effect* effect : effects::all())
    if (effect->is_asked(*more))
      for (const effects::Switch& one : effect->switches(moving_.world()))
        if (one.event.time > moving_.time()) switch_times_.insert(one.event.time);
}

void RetroactiveRun::switch_forces() {
  for (const auto& due : moving_.due_switches()) {
    if (has_sleepers()) sleepers_->wake(due.second.event.body_a, -1);
    moving_.turn(due);
    sink_.event(due.second.event);
  }
}

// Callbacks that are due. The step ends there, and the next begins with the velocities that they
// have set.
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
      events.push_back({moving_.time(), EventKind::kControl, body, -1, state.com_world,
                        Vector3d::UnitZ(), 0.0, 0.0});
    }
    moving_.keep_constraints(events);
    for (const Event& event : events) sink_.event(event);
  }
}

void RetroactiveRun::note_touching(const std::vector<std::pair<int, int>>& near) {
  touching_.clear();
  std::copy_if(near.begin(), near.end(), std::back_inserter(touching_),
               [&](const auto& pair) { return world_step_.contacts().keeps(pair); });
}

void RetroactiveRun::before_commit(double reached) {
  if (has_modes()) modes_->look();
  record([&] { recorder_.record_before(moving_, reached); });
  if (reached < target_) ++counters_.synchronisations;
}

// Steps until the target is reached; each ends there, at the first impact in it, or where bodies
// that turn far, or contacts, have cut it.
void RetroactiveRun::advance_to(double target) {
  target_ = target;
  int idle = 0;
  long impacts = 0;
  while (moving_.time() < target) {
    const double before = moving_.time();
    const WorldStep::Taken step = world_step_.take(target, *this);
    if (step.how != WorldStep::Taken::How::kCommitted) continue;
    if (world_step_.has_contacts()) {
      world_step_.contacts().for_each_kept(
          [&](const auto& pair) { energy_watch_.note_touch(pair.first, pair.second); });
      world_step_.contacts().for_each_loss([&](const std::vector<int>& bodies, double energy) {
        energy_watch_.note_lost_at_contacts(bodies, energy);
      });
    }
    if (has_sleepers()) note_touching(step.near);
    if (!built::kCollision || !step.impact) continue;
    // The step was committed no farther than the impact: free bodies by a shorter step of their
    // method, all others on their smooth paths.
    ++counters_.rollbacks;
    world_step_.respond(step.around(), *step.impact, true, *this);
    idle = moving_.time() > before ? 0 : idle + 1;
    if (idle > kMostIdleSteps || ++impacts > most_impacts(moving_.size())) {
      stopped_by_ =
          endless_impacts_message(moving_.time(), world_step_.names(*step.impact), moving_.world());
      return;
    }
  }
}

// Reports bodies that are too light for the step: on rods between heavy ones, or between joints.
void RetroactiveRun::report_light_bodies() {
  const RunCounters before = counters_;  // what is looked at must not show in what a run counts
  const LinkForces at_start = moving_.measure_links(moving_.states(), 0.0, {});
  counters_ = before;
  if (const auto step = report_unstable_links(moving_.world(), at_start, laws_, {step_, duration_},
                                              counters_.notices))
    counters_.watch.name_step(*step);
}

void RetroactiveRun::run() {
  const std::string where = scene_.file.empty() ? scene_.name : scene_.file.string();
  world_step_.impact_detection().refuse_overlap(where, scene_);
  refuse_unstable_steps(moving_.world(), laws_, {step_, duration_}, place_of_step(scene_, step_),
                        counters_.notices);
  for (const effects::Effect* effect : effects::all())
    for (const effects::Switch& one : effect->switches(moving_.world()))
      switch_times_.insert(one.event.time);
  try {
    if (moving_.world().stabilisation) report_light_bodies();
    run_to_the_end();
  } catch (const StoppedRun& stop) {
    stopped_by_ = fmt::format("at t = {:.6f} s, {}", moving_.time(), stop.what());
  }
  energy_watch_.tell(moving_.world(), laws_, counters_);
  sink_.end(counters_.named(), stopped_by_);
}

const std::vector<ContactPoint>& RetroactiveRun::contacts() const {
  static const std::vector<ContactPoint> none;
  return world_step_.has_contacts() ? world_step_.contacts().forces() : none;
}

void RetroactiveRun::stop_for(const Runaway& runaway) {
  const LinkForces links = moving_.measure_links(moving_.states(), moving_.time(), contacts());
  stopped_by_ = runaway_message(moving_.time(), moving_.world(), runaway,
                                {moving_.states(), links, contacts()}, laws_);
}

void RetroactiveRun::run_to_the_end() {
  switch_forces();
  // bodies that touch at the start may overlap by a rounding
  std::vector<std::pair<int, int>> all;
  for (int i = 0; i < moving_.size(); ++i)
    for (int j = i + 1; j < moving_.size(); ++j)
      if (moving_.may_collide(i, j)) all.emplace_back(i, j);
  world_step_.impact_detection().separate(all);
  if (world_step_.has_contacts()) world_step_.contacts().begin_where_touching(all);
  run_callbacks();
  const auto watch_energy = [&] {
    if (!callbacks_.empty()) return;  // they bring energy in
    // what rests without contacts stays where its support goes
    if (!world_step_.has_contacts())
      for (int body = 0; body < moving_.size(); ++body)
        if (moving_.resting(body)) energy_watch_.note_touch(body, -1);
    if (const auto runaway =
            energy_watch_.look(moving_.time(), moving_.world(), moving_.states(), contacts()))
      stop_for(*runaway);
  };
  watch_energy();  // what the first step does counts, too
  record([&] { recorder_.record_committed(moving_); });
  while (stopped_by_.empty() && moving_.time() < duration_) {
    next_look_ = moving_.look();
    if (has_sleepers()) sleepers_->wake_where_control_changes();
    const double target = next_target();
    advance_to(target);
    if (!stopped_by_.empty()) break;
    if (target >= static_cast<double>(grid_index_ + 1) * step_) ++grid_index_;
    take_from_hand();
    switch_forces();
    run_callbacks();
    watch_energy();
    record([&] { recorder_.record_committed(moving_); });
    if (has_sleepers())
      for (const int body : sleepers_->look(touching_)) energy_watch_.note_sleep(body);
  }
}

}  // namespace

void run_retroactive(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                     TrajectorySink& sink) {
  std::optional<RetroactiveRun> run;
  try {
    run.emplace(scene, laws, options, sink);
  } catch (const StoppedRun& stop) {  // links are drawn onto their constraints where they start
    return sink.end(RunCounters{}.named(), fmt::format("at t = 0.000000 s, {}", stop.what()));
  }
  run->run();
}

}  // namespace tumble::engines
