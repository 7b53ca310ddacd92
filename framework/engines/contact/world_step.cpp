#include "framework/engines/contact/world_step.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/contact/impact_law.h"
#include "framework/engines/contact/impact_normal.h"

namespace tumble::engines {

WorldStep::WorldStep(World world, const Laws& laws, StepRules rules, RunCounters& counters,
                     TrajectorySink& sink,
                     const std::vector<const collision::CollisionShape*>& shapes)
    : laws_(laws),
      rules_(rules),
      counters_(counters),
      sink_(sink),
      moving_(std::move(world), laws, counters, shapes),
      impact_detection_(moving_, laws, counters),
      impacts_(laws, {rules.restitution_threshold, kMicroInterval * rules.step}, counters) {
  if (built::kContact && moving_.world().contact) {
    impacts_.use_contact_rules(rules.restitution_threshold, moving_.world().contact->impact_law);
    contacts_.emplace(moving_, laws, *moving_.world().contact, rules.restitution_threshold,
                      rules.step, counters, sink);
  }
  searches_ = built::kCollision && impact_detection_.any() &&
              (has_contacts() || rules.searches_without_contacts);
}

// ---- A step -------------------------------------------------------------------------------------

WorldStep::Taken WorldStep::take(double target, StepStages& stages) {
  Taken taken;
  const double start = moving_.time();
  choose_coordinates();
  // Bodies go where they would without each other. A sleeper that would be met takes the step
  // awake.
  stages.begin(followed(target));
  ++counters_.steps;
  if (searches_) taken.searched = pairs_in_step();
  if (stages.wake_approached(taken.searched)) return give_up();
  // Bodies in persistent contact go where their contacts let them; the step becomes shorter where a
  // contact changes within it.
  if (has_contacts() && !keep_contacts(taken, stages)) {
    taken.how = Taken::How::kEndedAtStart;
    return taken;
  }
  // The first impact among all others ends the step.
  const std::optional<Earliest> earliest =
      searches_ ? impact_detection_.earliest(taken.searched) : std::nullopt;
  if (earliest) taken.impact = taken.searched[earliest->pair];
  if (earliest && stages.wake(*taken.impact)) return give_up();
  // The world goes there as a whole, and what is left of overlaps is removed.
  const double reached = earliest ? earliest->time : moving_.target();
  stages.before_commit(reached);
  moving_.commit(reached);
  require_numbers();
  if (searches_) remove_overlaps(taken);
  if (!earliest) moving_.watch_links(reached - start);
  return taken;
}

// The step's target, or an earlier one up to which what acts can be followed.
double WorldStep::followed(double target) {
  const double asked = target - moving_.time(), longest = moving_.longest_step(asked);
  if (!(longest < asked)) return target;
  ++counters_.shortened_steps;
  return moving_.time() + longest;
}

// Of what is linked: contacts push bodies of six coordinates each.
void WorldStep::choose_coordinates() {
  if (moving_.world().coordinates != scene::Coordinates::kReduced || !has_contacts()) return;
  for (LinkedBodies& group : moving_.linked_groups()) group.set_touched(false);
  for (const Pair& pair : contacts_->lasting())
    for (const int body : {pair.first, pair.second})
      if (const int group = moving_.linked_group(body); group >= 0)
        moving_.linked_groups()[static_cast<std::size_t>(group)].set_touched(true);
}

// Pairs that may meet in the step under way, which is made shorter where bodies turn too far in it.
std::vector<WorldStep::Pair> WorldStep::pairs_in_step() {
  std::vector<Pair> pairs = impact_detection_.candidates();
  if (moving_.shorten_step(pairs, [&](const Pair& pair) {
        return has_contacts() && contacts_->deals_in_step(pair);
      }))
    pairs = impact_detection_.candidates();
  return pairs;
}

// Gives bodies in contact their paths. Where a contact asks for a shorter step, the step begins
// again with it.
// @return false where the engine ends the step at its start
bool WorldStep::keep_contacts(Taken& taken, StepStages& stages) {
  while (const auto earlier = contacts_->advance(taken.searched)) {
    if (!stages.begin_again(*earlier)) return false;
    taken.searched = impact_detection_.candidates();
  }
  if (contacts_->empty()) return true;
  taken.near = taken.searched = impact_detection_.candidates();  // the paths are others now
  std::erase_if(taken.searched, [&](const Pair& pair) { return contacts_->keeps(pair); });
  return true;
}

// At the committed end of a step: what rounding, turning and contacts have left of overlaps.
void WorldStep::remove_overlaps(const Taken& taken) {
  if (!impact_detection_.apart_at_target()) impact_detection_.separate(taken.searched);
  if (has_contacts() && !contacts_->commit()) impact_detection_.separate(taken.near);
}

WorldStep::Taken WorldStep::give_up() {
  moving_.give_up_step();
  ++counters_.rollbacks;
  Taken taken;
  taken.how = Taken::How::kGivenUp;
  return taken;
}

void WorldStep::require_numbers() const {
  for (int body = 0; body < moving_.size(); ++body)
    if (!moving_.world().bodies[static_cast<std::size_t>(body)].immovable() &&
        !is_finite(moving_.state(body)))
      throw StoppedRun(
          fmt::format("body {}: its state is not a number (integrator: {}; impulses: {})",
                      name(body), laws_.integrator_source, laws_.impulse_source));
}

// ---- The response to an impact ------------------------------------------------------------------

void WorldStep::respond(const std::vector<Pair>& pairs, Pair trigger, bool is_in_step,
                        StepStages& stages) {
  const StageTimer timer(counters_.impact_seconds);
  // All that touches at this instant takes part, awake.
  for (const int body : {trigger.first, trigger.second})
    if (moving_.resting(body)) moving_.wake(body);
  const TouchingPairs touching = touching_pairs(pairs, trigger, is_in_step);
  for (const TouchingPair& pair : touching.all) stages.wake({pair.a, pair.b});
  // Impulses act until nothing approaches; within them, what rods and joints hold.
  const Resolution resolution = naming(
      names(trigger), [&] { return impacts_.resolve(moving_, touching.all, touching.trigger); });
  for (const Event& event : resolution.events) stages.impact(event);
  if (!resolution.settled)
    throw StoppedRun(names(trigger) + ": " + left_approaching_message(laws_));
  // What was slow stays together: as a contact, or where the scene asks for none, at rest or a hop
  // apart.
  if (has_contacts()) return begin_slow_contacts(touching, resolution.events);
  bring_to_rest(touching, resolution.events);
  naming(names(trigger), [&] { send_apart(touching, resolution); });
}

// The trigger, the pairs that touch, and those in persistent contact: what rests on something
// touches it.
WorldStep::TouchingPairs WorldStep::touching_pairs(const std::vector<Pair>& pairs, Pair trigger,
                                                   bool is_in_step) {
  const auto is_in_contact = [&](Pair pair) {
    return has_contacts() && contacts_->lasts(pair) && (!is_in_step || contacts_->keeps(pair));
  };
  TouchingPairs touching;
  for (const Pair& pair : pairs) {
    collision::Gap gap = impact_detection_.gap(pair);
    const bool lasts = is_in_contact(pair);
    if (pair != trigger && !lasts && !(gap.distance <= impact_detection_.touching_distance(pair)))
      continue;
    if (pair == trigger) touching.trigger = touching.all.size();
    if (!lasts) choose_normal(pair, gap);
    const double band = lasts ? contacts_->impact_band(pair) : 0.0;
    touching.all.push_back(
        {pair.first, pair.second, gap, impact_detection_.touching_points(pair, gap, band)});
  }
  return touching;
}

// Along which the two push each other.
void WorldStep::choose_normal(Pair pair, collision::Gap& gap) {
  const double t = moving_.time();
  const auto& bodies = moving_.world().bodies;
  const MeetingBodies meeting{bodies[pair.first],
                              bodies[pair.second],
                              moving_.shape(pair.first),
                              moving_.shape(pair.second),
                              moving_.motion_at(pair.first, t),
                              moving_.motion_at(pair.second, t)};
  const Vector3d normal = normal_of_impact(meeting, gap, rules_.restitution_threshold);
  watch_normal(t, meeting, gap, normal, counters_.watch);
  gap.normal_b_to_a_world = normal;
}

// A pair that touches and whose impacts, if any, were slow enough not to bounce begins a persistent
// contact.
void WorldStep::begin_slow_contacts(const TouchingPairs& touching,
                                    const std::vector<Event>& events) {
  for (const TouchingPair& pair : touching.all) {
    bool slow = true;
    for (const Event& event : events)
      if (event.body_a == pair.a && event.body_b == pair.b)
        slow = slow && impacts_.stays(moving_.world(), pair, -event.normal_velocity_before);
    if (slow) contacts_->begin({pair.a, pair.b}, pair.gap);
  }
}

// Rest of balls that nothing pulls or pushes on immovable supports, which may move evenly.
void WorldStep::bring_to_rest(const TouchingPairs& touching, const std::vector<Event>& events) {
  const World& world = moving_.world();
  if (!world.gravity_world || events.empty()) return;
  double fastest = 0.0;
  for (const Event& event : events)
    fastest = std::max(fastest, std::abs(event.normal_velocity_before));
  for (const TouchingPair& pair : touching.all) {
    const bool a_is_support = world.bodies[pair.a].immovable();
    if (a_is_support == world.bodies[pair.b].immovable()) continue;
    const int support = a_is_support ? pair.a : pair.b, body = a_is_support ? pair.b : pair.a;
    const Vector3d up =
        a_is_support ? Vector3d(-pair.gap.normal_b_to_a_world) : pair.gap.normal_b_to_a_world;
    if (world.bodies[support].motion.angular_frequency_rad_s != 0.0) continue;
    if (!moving_.shape(body).is_ball() || !moving_.is_left_alone(body) ||
        moving_.linked_group(body) >= 0)
      continue;
    const bool rests = comes_to_rest(
        {*world.gravity_world, up, moving_.shape(body).bounding_radius(),
         impact_detection_.touching_distance({pair.a, pair.b}),
         world.bodies[body].inertia.inertia_body,
         !moving_.state(body).angular_momentum_world.isZero(0.0),
         moving_.velocity_of(body, moving_.time()) - moving_.velocity_of(support, moving_.time()),
         std::min(world.bodies[body].restitution, world.bodies[support].restitution),
         rules_.restitution_threshold, fastest});
    if (!rests) continue;
    RigidBodyState state = moving_.state(body);
    state.com_world -= pair.gap.distance * up;
    moving_.set_state(body, state);
    moving_.put_to_rest(body, support);
    sink_.event({moving_.time(), EventKind::kRest, pair.a, pair.b, pair.gap.point_b_world,
                 pair.gap.normal_b_to_a_world, 0.0, 0.0});
  }
}

void WorldStep::send_apart(const TouchingPairs& touching, const Resolution& resolution) {
  std::vector<TouchingPair> awake;
  for (const TouchingPair& pair : touching.all)
    if (!moving_.resting(pair.a) && !moving_.resting(pair.b)) awake.push_back(pair);
  impacts_.push_apart(moving_, awake, resolution.micro_impacts);
}

}  // namespace tumble::engines
