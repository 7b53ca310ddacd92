#include "framework/engines/contact/sleeping.h"

#include <algorithm>
#include <cmath>

#include "framework/collision/gap.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/body_groups.h"

namespace tumble::engines {
namespace {

constexpr double kStillFor = 0.5;  // s: a swing that turns back within it is seen to swing
// of the restitution threshold, on the average: ten times what large islands are solved to, a
// step's fall times 1e-5
constexpr double kMean = 0.01;

}  // namespace

Sleepers::Sleepers(MovingWorld& moving, PersistentContacts& contacts, const ContactModes* modes,
                   double restitution_threshold, RunCounters& counters, TrajectorySink& sink)
    : moving_(moving),
      contacts_(contacts),
      modes_(modes),
      restitution_threshold_(restitution_threshold),
      counters_(counters),
      sink_(sink),
      group_of_(moving.size(), -1) {
  for (const RigidBodyState& state : moving.states()) {
    const Place place{moving.time(), state.com_world, state.world_from_body};
    still_.push_back({place, place});
  }
  for (const LinkedBodies& group : moving.linked_groups()) held_.push_back(group.held());
}

// Notes when a body was last seen to move.
void Sleepers::watch(int body) {
  Stillness& still = still_[body];
  const RigidBodyState& state = moving_.state(body);
  const WorldBody& b = moving_.world().bodies[body];
  const double radius = moving_.shape(body).bounding_radius();
  const double speed = b.inertia.inverse_mass * state.momentum_world.norm() +
                       omega_of(state, b.inertia).norm() * radius;
  const auto way = [&](const Place& place) {
    return (state.com_world - place.com_world).norm() +
           state.world_from_body.angularDistance(place.world_from_body) * radius;
  };
  const Place here{moving_.time(), state.com_world, state.world_from_body};
  const bool fast = speed > kSlow * restitution_threshold_;
  if (fast || way(still.roughly) > kMean * restitution_threshold_ * kStillFor) still.roughly = here;
  if (fast || way(still.strictly) > kCreep * restitution_threshold_ * kStillFor)
    still.strictly = here;
}

bool Sleepers::is_still(const Group& group, double since) const {
  return std::all_of(group.bodies.begin(), group.bodies.end(), [&](int body) {
    return (group.slides || group.is_alone() ? still_[body].strictly : still_[body].roughly)
               .since <= since;
  });
}

// What is slow because something brakes it goes on.
bool Sleepers::is_in_equilibrium(const Group& group) {
  ContactIsland island;
  island.bodies = group.bodies;
  island.pairs = group.pairs;
  island.linked = group.linked;
  island.large = contacts_.is_large(island);
  return contacts_.is_in_equilibrium(
      island, (group.slides ? kCreep : kMean) * restitution_threshold_ * kStillFor);
}

bool Sleepers::is_driven_otherwise(int linked) const {
  return moving_.linked_groups()[linked].is_driven_otherwise(held_[linked]);
}

// Where a control law changes its mind the bodies it moves are not at rest, however slow they are.
void Sleepers::watch_control(int linked) {
  const LinkedBodies& group = moving_.linked_groups()[linked];
  if (!is_driven_otherwise(linked)) return;
  held_[linked] = group.held();
  for (const int body : group.bodies())
    still_[body].roughly.since = still_[body].strictly.since = moving_.time();
}

// Awake bodies that touch or are linked.
std::map<int, Sleepers::Group> Sleepers::groups_of(const std::vector<Pair>& touching) const {
  const std::vector<int> leader = group_leaders(moving_, touching);

  std::map<int, Group> groups;
  const bool weightless = !moving_.world().gravity_world;
  const auto end_at = [&](Group& group, int immovable) {
    group.held = true;
    if (immovable >= 0 && moving_.is_driven(immovable)) group.driven = true;
  };
  for (const auto& [a, b] : touching) {
    if (!moving_.can_move(a) && !moving_.can_move(b)) continue;
    Group& group = groups[leader[moving_.can_move(a) ? a : b]];
    group.pairs.push_back({a, b});
    group.slides = group.slides || (modes_ && modes_->slides({a, b}));
    for (const int body : {a, b})
      if (moving_.world().bodies[body].immovable()) end_at(group, body);
  }
  for (int k = 0; k < static_cast<int>(moving_.linked_groups().size()); ++k) {
    const LinkedBodies& linked = moving_.linked_groups()[k];
    if (!moving_.can_move(linked.bodies().front())) continue;
    Group& group = groups[leader[linked.bodies().front()]];
    group.linked.push_back(k);
    for (const int end : linked.fixed_ends()) end_at(group, end);
  }
  for (int body = 0; body < moving_.size(); ++body) {
    if (!moving_.can_move(body)) continue;
    if (const auto group = groups.find(leader[body]); group != groups.end())
      group->second.bodies.push_back(body);
  }
  for (auto& [first, group] : groups) group.held = group.held || weightless;
  return groups;
}

std::vector<int> Sleepers::look(const std::vector<Pair>& touching) {
  const StageTimer timer(counters_.sleep_seconds);
  for (int body = 0; body < moving_.size(); ++body) {
    if (moving_.can_move(body))
      watch(body);
    else if (moving_.asleep(body))
      ++counters_.body_steps_asleep;
  }
  for (int k = 0; k < static_cast<int>(held_.size()); ++k)
    if (moving_.can_move(moving_.linked_groups()[k].bodies().front())) watch_control(k);
  const double latest = moving_.time() - kStillFor;
  std::vector<int> fell_asleep;
  for (int body = 0; body < moving_.size(); ++body)
    // most of the time none is: no islands are formed
    if (moving_.can_move(body) && still_[body].roughly.since <= latest) {
      for (auto& [first, group] : groups_of(touching))
        if (group.held && !group.driven && is_still(group, latest)) {
          if (!is_in_equilibrium(group)) {  // looked at again after as long
            for (const int still : group.bodies)
              still_[still].roughly.since = still_[still].strictly.since = moving_.time();
            continue;
          }
          fell_asleep.insert(fell_asleep.end(), group.bodies.begin(), group.bodies.end());
          put_to_sleep(std::move(group));
        }
      break;
    }
  return fell_asleep;
}

void Sleepers::put_to_sleep(Group group) {
  const auto ours = [&](int body) {
    return std::binary_search(group.bodies.begin(), group.bodies.end(), body);
  };
  for (const ContactPoint& point : contacts_.forces())
    if (ours(point.body_a) || ours(point.body_b)) group.forces.push_back(point);
  for (const int body : group.bodies) {
    moving_.put_to_sleep(body);
    group_of_[body] = group.bodies.front();
    sink_.event({moving_.time(), EventKind::kSleep, body, -1, moving_.state(body).com_world,
                 Vector3d::UnitZ(), 0.0, 0.0});
  }
  asleep_.emplace(group.bodies.front(), std::move(group));
}

bool Sleepers::wake(int body, int waker) {
  if (body < 0 || group_of_[body] < 0) return false;
  const auto found = asleep_.find(group_of_[body]);
  for (const int sleeper : found->second.bodies) {
    moving_.wake(sleeper);
    group_of_[sleeper] = -1;
    still_[sleeper].roughly.since = still_[sleeper].strictly.since = moving_.time();
    sink_.event({moving_.time(), EventKind::kWake, sleeper, waker, moving_.state(sleeper).com_world,
                 Vector3d::UnitZ(), 0.0, 0.0});
  }
  asleep_.erase(found);
  return true;
}

bool Sleepers::wake(Pair pair) {
  const bool first = wake(pair.first, pair.second), second = wake(pair.second, pair.first);
  return first || second;
}

// Whether persistent contacts would hold the two apart in this step, as if the sleeper were a wall.
bool Sleepers::would_touch(Pair pair) {
  if (contacts_.lasts(pair)) return true;
  const World& world = moving_.world();
  if (world.contact->plastic_impacts != scene::PlasticImpacts::kInStep ||
      std::min(world.bodies[pair.first].restitution, world.bodies[pair.second].restitution) > 0.0)
    return false;
  const double h = moving_.target() - moving_.time();
  const auto pose = [&](int body) { return moving_.motion_at(body, moving_.time()).pose; };
  ++counters_.collision.gap_evaluations;
  const double near = h * moving_.fastest_in_step(pair.first) +
                      h * moving_.fastest_in_step(pair.second) + contacts_.open_distance(pair);
  return collision::gap_distance(moving_.shape(pair.first), pose(pair.first),
                                 moving_.shape(pair.second), pose(pair.second),
                                 moving_.pair_cache(pair.first, pair.second), near) <= near;
}

bool Sleepers::wake_approached(const std::vector<Pair>& candidates) {
  bool any = false;
  for (const Pair& pair : candidates)
    if ((moving_.asleep(pair.first) || moving_.asleep(pair.second)) && would_touch(pair))
      any = wake(pair) || any;
  return any;
}

void Sleepers::wake_where_control_changes() {
  for (int k = 0; k < static_cast<int>(held_.size()); ++k)
    if (const int first = moving_.linked_groups()[k].bodies().front();
        moving_.asleep(first) && is_driven_otherwise(k))
      wake(first, -1);
}

void Sleepers::append_forces(std::vector<ContactPoint>& forces) const {
  for (const auto& [first, group] : asleep_)
    forces.insert(forces.end(), group.forces.begin(), group.forces.end());
}

}  // namespace tumble::engines
