#include "framework/engines/contact/persistent_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/collision/gap.h"
#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/impact_bodies.h"
#include "framework/engines/stepping/body_groups.h"

namespace tumble::engines {

void PersistentContacts::recall(ContactMemory memory) {
  memory_ = std::move(memory);
  memory_.longest_step = std::max(memory_.longest_step, step_);
  islands_.clear();
  points_.clear();
  reach_.clear();
  forces_.clear();
  problems_.take_unsolved();
}

void PersistentContacts::begin(Pair pair, const collision::Gap& gap) {
  if (!memory_.persistent.insert(pair).second) return;
  ++counters_.contacts_begun;
  sink_.event({moving_.time(), EventKind::kContact, pair.first, pair.second, gap.point_b_world,
               gap.normal_b_to_a_world, 0.0, 0.0});
}

void PersistentContacts::begin_where_touching(const std::vector<Pair>& pairs) {
  for (const Pair& pair : pairs) {
    const double within =
        std::max(geometry_.margin(pair),
                 geometry_.is_inelastic(pair) ? kSixDigits * geometry_.size_of(pair) : 0.0);
    // twice: margins are above what a bound is rounded by
    if (geometry_.least_gap_of(pair, moving_.states()) > 2 * within) continue;
    const collision::Gap gap = geometry_.gap_of(pair, moving_.states());
    if (gap.distance > within) continue;
    const ContactManifold points = geometry_.points_at(pair, moving_.states(), within);
    const Body a = moving_.body_at_impact(pair.first), b = moving_.body_at_impact(pair.second);
    const bool slow =
        std::all_of(points.begin(), points.end(), [&](const collision::ManifoldPoint& p) {
          const Vector3d relative =
              a.velocity_world + a.omega_world.cross(geometry_.point_of(pair, p) - a.com_world) -
              b.velocity_world - b.omega_world.cross(geometry_.point_of(pair, p) - b.com_world);
          return std::abs(relative.dot(p.normal_b_to_a_world)) < restitution_threshold_;
        });
    if (!slow) continue;
    begin(pair, gap);
    memory_.apart_at_start.insert(pair);
  }
  remove_overlaps();
}

// Positions of a scene are rounded: for bodies wedged between others no single displacement removes
// the overlap.
void PersistentContacts::remove_overlaps() {
  std::vector<RigidBodyState> states = moving_.states();
  const auto closed = [&](const Pair& pair) {
    return geometry_.distance_of(pair, states, 0.0) < 0;
  };
  for (const ContactIsland& island :
       islands({memory_.persistent.begin(), memory_.persistent.end()})) {
    if (std::none_of(island.pairs.begin(), island.pairs.end(), closed)) continue;
    correction_.correct_positions(island, island.pairs, states, moving_.time());
    for (const int body : island.bodies) moving_.set_state(body, states[body]);
  }
}

bool PersistentContacts::plastic(Pair pair) const {
  if (locates() && memory_.in_large_island.empty()) return false;
  return geometry_.is_inelastic(pair) &&
         (!locates() || memory_.in_large_island.contains(pair.first) ||
          memory_.in_large_island.contains(pair.second));
}

std::vector<ContactIsland> PersistentContacts::islands(const std::vector<Pair>& touching) {
  const int n = moving_.size();
  const std::vector<int> leader = group_leaders(moving_, touching);
  std::map<int, ContactIsland> by_leader;
  for (const auto& pair : touching)
    by_leader[leader[moving_.can_move(pair.first) ? pair.first : pair.second]].pairs.push_back(
        pair);
  for (int i = 0; i < n; ++i) {
    if (!moving_.can_move(i)) continue;
    const auto island = by_leader.find(leader[i]);
    if (island == by_leader.end()) continue;
    island->second.bodies.push_back(i);
    const int linked = moving_.linked_group(i);
    if (linked >= 0 && moving_.linked_groups()[linked].bodies().front() == i)
      island->second.linked.push_back(linked);
  }
  std::vector<ContactIsland> result;
  for (auto& [first, island] : by_leader) result.push_back(std::move(island));
  return result;
}

// Whether a gap is what six digits leave at the start of places that were meant to touch, and
// closes slowly: a path that forces bend dips no deeper than that on its way, and a straight one
// would leave out what they bend.
bool PersistentContacts::is_apart_by_digits(Pair pair,
                                            const collision::ManifoldPoint& point) const {
  if (!memory_.apart_at_start.contains(pair)) return false;
  const double digits = kSixDigits * geometry_.size_of(pair);
  if (point.gap > digits) return false;
  const Vector3d at = geometry_.point_of(pair, point);
  const Body a = moving_.body_at_impact(pair.first), b = moving_.body_at_impact(pair.second);
  const double approach = -point.normal_b_to_a_world.dot(relative_velocity(a, b, at));
  return approach * (moving_.target() - moving_.time()) <= digits;
}

StepContacts PersistentContacts::contacts_of(const ContactIsland& island) {
  StepContacts contacts;
  for (const Pair& pair : island.pairs)
    for (const collision::ManifoldPoint& point : *points_.find(pair)) {
      if (!locates() && !reach_.may_close(pair, point, moving_.target() - moving_.time())) continue;
      const double margin = geometry_.margin(pair), distance = point.gap - margin;
      const bool is_apart =
          distance > kContact.touching_band * margin + kNegligible * reach_.of(pair);
      // what shares a load with others, and what decimals of the scene leave apart, closes its gap
      // on the way, and is no impact
      const bool shares = is_apart && memory_.sharing.contains(pair) &&
                          distance <= kContact.sharing_band * geometry_.size_of(pair);
      const bool activates =
          is_apart && !shares && !(island.linked.empty() && is_apart_by_digits(pair, point));
      contacts.push_back({pair, point,
                          is_apart ? -distance / (moving_.target() - moving_.time()) : 0.0,
                          activates, Vector3d::Zero(), point.gap});
    }
  return contacts;
}

std::optional<double> PersistentContacts::advance(const std::vector<Pair>& candidates) {
  const StageTimer timer(counters_.contact_seconds);
  const double h = moving_.target() - moving_.time();
  memory_.longest_step = std::max(memory_.longest_step, h);
  points_.clear();
  forces_.clear();
  islands_.clear();
  lost_.clear();
  has_committed_ = false;
  began_ = moving_.time();
  target_ = moving_.target();
  problems_.take_unsolved();
  // Which pairs touch in this step: those in persistent contact, and those without restitution
  // where impacts are solved in steps.
  std::vector<Pair> touching;
  const bool in_step = !locates() || !memory_.in_large_island.empty();
  reach_.clear();
  if (in_step)
    touching =
        reach_.look(candidates, memory_.persistent, [&](Pair pair) { return plastic(pair); });
  for (const Pair& pair : candidates) {
    if (in_step || (!memory_.persistent.contains(pair) && !plastic(pair))) continue;
    ContactManifold points = geometry_.points_at(pair, moving_.states(), reach_.of(pair));
    if (points.empty()) continue;
    touching.push_back(pair);
    points_.enter(pair, std::move(points));
  }
  if (touching.empty()) {
    memory_.pressing.clear();
    return std::nullopt;
  }
  ends_ = midway_ = moving_.states();
  // What touches or is linked is solved together, island by island; large islands without
  // restitution are solved in steps.
  islands_ = islands(touching);
  for (ContactIsland& island : islands_) island.large = large_.is_large(island);
  memory_.in_large_island.clear();
  for (const ContactIsland& island : islands_)
    if (island.large && locates())
      memory_.in_large_island.insert(island.bodies.begin(), island.bodies.end());
  if (in_step) {
    for (const Pair& pair : touching) points_.enter(pair, {});
    for (const ContactIsland& island : islands_)
      for (const Pair& pair : island.pairs)
        if (!island.large && reach_.may_meet(pair))
          *points_.find(pair) = geometry_.points_at(pair, moving_.states(), reach_.of(pair));
  }
  note_near_pairs(candidates);
  pressed_.begin_step(islands_);
  // Every island gets its paths; where one asks for a shorter step, the step begins again for all.
  warm_start_.begin_step();
  next_stuck_.clear();
  next_sharing_.clear();
  if (const auto earlier = take_steps(h)) {
    progress_.require(islands_);
    return earlier;
  }
  // The next step begins with these impulses.
  warm_start_.end_step();
  memory_.pressing = pressed_.take_next();
  memory_.stuck = std::move(next_stuck_);
  memory_.sharing = std::move(next_sharing_);
  return std::nullopt;
}

// Every island's step.
// @return the earliest target that one of them asks for: the step begins again for all, and once
// for many groups is cheaper than once for each. Of ends of sliding, the one that is looked for is
// that of the earliest. The island that asked last is asked first, and as long as it asks the
// others' steps would be in vain: one at rest is not solved again for each impact of a large island
// elsewhere.
std::optional<double> PersistentContacts::take_steps(double h) {
  const auto step = [&](const ContactIsland& island) {
    return island.large ? take_large_island_step(island, h) : take_step(island, h);
  };
  const auto first =
      std::find_if(islands_.begin(), islands_.end(), [&](const ContactIsland& island) {
        return std::binary_search(island.bodies.begin(), island.bodies.end(), memory_.asked_last);
      });
  if (first != islands_.end())
    if (const auto earlier = step(*first)) return earlier;
  const auto of_first = static_cast<std::ptrdiff_t>(forces_.size());
  std::ptrdiff_t before_first = 0;  // forces of groups that stand before it
  std::optional<double> earliest;
  std::optional<SlidingSearch> of_earliest;
  for (const ContactIsland& island : islands_) {
    if (first != islands_.end() && &island == &*first) {
      before_first = static_cast<std::ptrdiff_t>(forces_.size()) - of_first;
      continue;
    }
    const std::optional<SlidingSearch> before = memory_.sliding_search;
    const std::optional<double> earlier = step(island);
    if (earlier && (!earliest || *earlier < *earliest)) {
      earliest = earlier;
      of_earliest = memory_.sliding_search;
      memory_.asked_last = island.bodies.front();
    }
    memory_.sliding_search = before;
  }
  if (earliest) memory_.sliding_search = of_earliest;
  // in the order of the groups
  std::rotate(forces_.begin(), forces_.begin() + of_first,
              forces_.begin() + of_first + before_first);
  return earliest;
}

void PersistentContacts::note_near_pairs(const std::vector<Pair>& candidates) {
  std::vector<ContactIsland*> group_of(moving_.size(), nullptr);
  for (ContactIsland& island : islands_)
    for (const int body : island.bodies) group_of[body] = &island;
  for (const Pair& pair : candidates) {
    ContactIsland *const a = group_of[pair.first], *const b = group_of[pair.second];
    if (a) a->near.push_back(pair);
    if (b && b != a) b->near.push_back(pair);
  }
}

bool PersistentContacts::is_curved(const ContactIsland& island) const {
  return std::any_of(island.bodies.begin(), island.bodies.end(),
                     [&](int body) { return moving_.shape(body).ellipsoid() != nullptr; }) ||
         std::any_of(island.pairs.begin(), island.pairs.end(), [&](const Pair& pair) {
           return geometry_.are_balls(pair) || geometry_.is_ball_on_edges(pair);
         });
}

// One island's step.
// @return an earlier target (or the same after an impact) to begin the step again with
std::optional<double> PersistentContacts::take_step(const ContactIsland& island, double h) {
  StepContacts contacts = contacts_of(island);
  const bool located = locates(), moves = located && fastest_speed(moving_, island) >
                                                         kContact.moving * restitution_threshold_;
  // Points that touch and approach: their velocities jump, without rebound, and the step begins
  // again.
  if (moves && activation_.apply_impacts_of_active(island, contacts)) return moving_.target();
  // The impulses that keep what touches from approaching; points that separate slowly close their
  // gap again by the step's end.
  ContactProblem problem = problems_.of(island, contacts, moving_.states(), h);
  const bool separates = activation_.allow_separation(island, contacts, problem);
  ContactSolution solution = problems_.solve(island, problem, h);
  warm_start_.remember_attempt(contacts, problem, solution, h);
  bool activation = activates(contacts, solution);
  // Contacts that become active within the step: it ends where the first does, or their gaps close
  // by its end. Too many, and the island is solved in steps.
  if (moves && activation_.is_activated(island, contacts, problem, solution, h)) {
    if (large_.becomes_large(island)) return moving_.target();
    if (const auto again = activation_.handle(island, contacts, h)) return again;
    problem = problems_.of(island, contacts, moving_.states(), h);
    solution = problems_.solve(island, problem, h);
    activation = false;
  } else if (activation && separates) {  // on straight paths what separates has not left
    keep_together(contacts, problem);
    solution = problems_.solve(island, problem, h);
    activation = activates(contacts, solution);
  }
  // An island that turns too far gets a shorter step; one that turns at all meets its contacts at
  // the step's middle.
  find_ends(island, problem, solution, h, activation);
  const double turn = std::max(largest_turn(island, ends_, h), turn_of_normals(island, ends_));
  if (located && turn > 2 * kContact.most_turn && h > kContact.shortest_step * memory_.longest_step)
    return moving_.time() + h * kContact.most_turn / turn;
  // A point that presses only there closes a gap that is hardly one. What is linked to it stays on
  // the curve that its rods and joints ask for.
  const bool stays_curved = moves && !island.linked.empty();
  bool is_midway = false;
  StepContacts used = contacts;
  int rounds = turn <= kContact.even_turn ? 0 : is_curved(island) ? kContact.curved_rounds : 1;
  for (int round = 0; round < rounds && !activation; ++round) {
    if (round > 0) find_ends(island, problem, solution, h, activation, true);
    is_midway = true;
    const StepContacts before = std::exchange(used, contacts_midway(island, contacts));
    // it presses for the whole of a step or not at all: of a short one
    if (located && h > kContact.shortest_step_at_corners * memory_.longest_step &&
        presses_over_a_corner(used, solution))
      return moving_.time() + 0.5 * h;
    // a load that statics does not tell: until targets fit each other
    if (solution.sharing == LoadSharing::kMostEven && round + 1 == rounds &&
        rounds < kContact.most_sharing_rounds &&
        largest_change_of_targets(before, used) >
            kContact.same_targets * problems_.indistinct_speed(island))
      ++rounds;
    problem = problems_.of(island, used, midway_, h, &ends_);
    // the same points, a little farther on
    for (std::size_t i = 0; i < used.size(); ++i)
      problem.contacts[i].warm_start_world = solution.impulses_world[i];
    solution = problems_.solve(island, problem, h);
    activation = !stays_curved && activates(used, solution);
    if (!activation || !separates) continue;
    // A contact becomes active after all: paths are straight then, and what was to separate stays.
    for (std::size_t i = 0; i < used.size(); ++i)
      if (!contacts[i].activates) problem.contacts[i].target = used[i].target -= contacts[i].target;
    solution = problems_.solve(island, problem, h);
    activation = activates(used, solution);
  }
  problems_.require_numbers(island, solution);
  if (pressed_.finds_other(island, used, problem, solution, h, is_midway ? &ends_ : nullptr))
    return take_step(island, h);
  // A pair that stops sliding, or slides back, ends the step there.
  if (const auto stop = located ? sliding_stop_.of(problem, contacts, solution, h) : std::nullopt)
    return stop;
  // The bodies' paths, with overlaps removed; where some stay, a shorter step may do. Contacts
  // bring no energy in.
  if (!set_paths(island, used, is_midway ? midway_ : moving_.states(), problem, solution, h,
                 activation)) {
    if (!located && island.linked.empty()) return take_large_island_step(island, h);
    if (h > kContact.shortest_step * memory_.longest_step) return moving_.time() + 0.5 * h;
  }
  const bool is_long = h > kContact.shortest_step_for_energy * memory_.longest_step;
  if (located && (is_long || watches_losses_))
    if (const auto energy = energy_of(island)) {
      if (is_long && energy->gain > energy->unseen) return moving_.time() + 0.5 * h;
      if (watches_losses_) note_loss(island, contacts, problem, solution, *energy);
    }
  keep_warm_start(island, contacts, problem, solution, h);
  return std::nullopt;
}

// The same of a large one.
// @return an earlier target to begin the step again with
std::optional<double> PersistentContacts::take_large_island_step(const ContactIsland& island,
                                                                 double h) {
  const auto [contacts, problem, solution] = large_.solve(island, h);
  find_ends(island, problem, solution, h, true);
  // Pairs with bodies of other groups may meet within the step: that is for the finding of impacts.
  std::vector<double> gaps(island.pairs.size(), 0.0);
  const bool apart =
      correction_.correct_large_island(island, island.pairs, ends_, moving_.target(), gaps);
  for (const int body : moving_.driven_bodies()) ends_[body] = moving_.state(body);
  if (!apart && h > kContact.shortest_step * memory_.longest_step) return moving_.time() + 0.5 * h;
  for (const int body : island.bodies) {
    set_straight_path(body, ends_[body]);
    moving_.refuse_fast_turning(body);
  }
  keep_warm_start(island, contacts, problem, solution, h);
  return std::nullopt;
}

void PersistentContacts::remove_overlaps_within_step(std::vector<RigidBodyState>& states,
                                                     double t) {
  const RunCounters before = counters_;  // what is looked at must not show in what a run counts
  const double left = (moving_.target() - t) / (moving_.target() - moving_.time());
  for (const ContactIsland& island : islands_) {
    // A path that leads straight to the step's end has the velocity of that end all along. Momenta
    // that change evenly show no energy that neither end has.
    if (!island.linked.empty()) continue;  // momenta of these are on their rods and joints
    for (const int body : island.bodies) {
      const RigidBodyState &start = moving_.state(body), &end = moving_.path_end(body);
      states[body].momentum_world = left * start.momentum_world + (1 - left) * end.momentum_world;
      states[body].angular_momentum_world =
          left * start.angular_momentum_world + (1 - left) * end.angular_momentum_world;
    }
  }
  const auto closed = [&](const Pair& pair) { return geometry_.overlap(pair, states); };
  bool any = true;
  // one island's corrections may close another's gaps
  for (int round = 0; round < kContact.most_corrections && any; ++round) {
    any = false;
    for (const ContactIsland& island : islands_) {
      if (std::none_of(island.near.begin(), island.near.end(), closed)) continue;
      any = true;
      std::vector<double> gaps(island.near.size(), 0.0);
      if (island.large || !correction_.correct_positions(island, island.near, states, t))
        correction_.correct_large_island(island, island.near, states, t, gaps);
    }
  }
  counters_ = before;
}

void PersistentContacts::remove_overlaps(const std::vector<Pair>& pairs,
                                         std::vector<RigidBodyState>& states, double t) {
  const RunCounters before = counters_;  // as above
  const auto closed = [&](const Pair& pair) { return geometry_.overlap(pair, states); };
  for (int round = 0;
       round < kContact.most_corrections && std::any_of(pairs.begin(), pairs.end(), closed);
       ++round)
    for (const ContactIsland& island : islands(pairs)) {
      if (std::none_of(island.pairs.begin(), island.pairs.end(), closed)) continue;
      std::vector<double> gaps(island.pairs.size(), 0.0);
      if (!correction_.correct_positions(island, island.pairs, states, t))
        correction_.correct_large_island(island, island.pairs, states, t, gaps);
    }
  counters_ = before;
}

// A ball has been carried by another, or about an edge, to where nothing presses them together: no
// force in the step, and along the normal
//   a_n = n . (g_a - g_b) + v_t . dn/dt > 0,  on a ball  v_t . dn/dt = v_t^2 / R,
//       R the distance of their centres, v_t their velocity along the surface.
bool PersistentContacts::flies_off(Pair pair, const std::vector<RigidBodyState>& states) const {
  const bool balls = geometry_.are_balls(pair);
  if (!balls && !geometry_.is_ball_on_edges(pair)) return false;
  const auto pushes = [&](const ContactPoint& point) {
    return point.body_a == pair.first && point.body_b == pair.second;
  };
  if (std::any_of(forces_.begin(), forces_.end(), pushes)) return false;
  // of the first against the second
  Vector3d gravity = Vector3d::Zero(), velocity = Vector3d::Zero();
  for (const auto& [body, sign] : {std::pair{pair.first, 1.0}, std::pair{pair.second, -1.0}}) {
    const WorldBody& b = moving_.world().bodies[body];
    velocity +=
        sign * (b.immovable() ? prescribed_velocity(b, moving_.time())
                              : Vector3d(b.inertia.inverse_mass * states[body].momentum_world));
    if (!b.immovable() && moving_.world().gravity_world)
      gravity += sign * *moving_.world().gravity_world;
  }
  const collision::Gap gap = geometry_.gap_of(pair, states);
  const Vector3d n = gap.normal_b_to_a_world;
  const double normal_speed = n.dot(velocity);
  const Vector3d along = velocity - normal_speed * n;
  double leaves = n.dot(gravity);  // [m/s^2]
  if (balls) {
    leaves +=
        along.squaredNorm() / (states[pair.first].com_world - states[pair.second].com_world).norm();
  } else if (const double speed = along.norm(); speed > 0) {
    // the ball a little farther on
    const bool is_first = moving_.shape(pair.first).is_ball();
    const double way = kSixDigits * geometry_.size_of(pair);
    collision::Pose first = geometry_.pose(pair.first, states),
                    second = geometry_.pose(pair.second, states);
    (is_first ? first : second).com_world += (is_first ? way : -way) / speed * along;
    const collision::Gap later = collision::compute_gap(moving_.shape(pair.first), first,
                                                        moving_.shape(pair.second), second);
    leaves += speed / way * along.dot(later.normal_b_to_a_world - n);
  }
  return normal_speed > 0 && leaves > 0;
}

// Nearer than this the two are in contact; what comes back need not begin anew. [m]
double PersistentContacts::near_distance(Pair pair, bool lasted, bool is_large,
                                         const std::vector<RigidBodyState>& states) const {
  const bool stays_near = lasted && !flies_off(pair, states);
  return std::max(is_large ? 2 * geometry_.large_island_margin(pair) : open_distance(pair),
                  stays_near ? restitution_threshold_ * memory_.longest_step : 0.0);
}

void PersistentContacts::end(Pair pair, const collision::Gap& gap) {
  memory_.persistent.erase(pair);
  ++counters_.contacts_ended;
  sink_.event({moving_.time(), EventKind::kBreak, pair.first, pair.second, gap.point_b_world,
               gap.normal_b_to_a_world, 0.0, 0.0});
}

// Of two that are both left alone nothing has changed. Whether an island is large is not known
// between steps: the larger distance decides.
void PersistentContacts::end_where_apart() {
  const std::vector<RigidBodyState>& states = moving_.states();
  for (const Pair& pair : std::vector<Pair>(memory_.persistent.begin(), memory_.persistent.end())) {
    if (keeps(pair) || (!moving_.can_move(pair.first) && !moving_.can_move(pair.second))) continue;
    const double near =
        std::max(near_distance(pair, true, false, states), near_distance(pair, true, true, states));
    if (!geometry_.is_within(pair, states, near)) end(pair, geometry_.gap_of(pair, states));
  }
}

bool PersistentContacts::commit() {
  const StageTimer timer(counters_.contact_seconds);
  // A pair that was out of reach in the whole step, as after a cut within the one before.
  end_where_apart();
  if (islands_.empty()) return true;
  counters_.watch.add(problems_.take_unsolved());
  // of a step that an impact has cut, its part
  for (Loss& loss : lost_) loss.energy *= (moving_.time() - began_) / (target_ - began_);
  has_committed_ = true;
  if (moving_.time() >= target_) memory_.apart_at_start.clear();
  bool apart = true;
  std::vector<RigidBodyState> states = moving_.states();
  for (const ContactIsland& island : islands_) {
    std::vector<double> gaps(island.near.size(), 0.0);
    if (island.large) {
      apart = correction_.correct_large_island(island, island.near, states, moving_.time(), gaps) &&
              apart;
    } else {
      correction_.correct_positions(island, island.near, states, moving_.time());
      apart = false;
    }
    for (const int body : island.bodies) moving_.set_state(body, states[body]);
    for (std::size_t k = 0; k < island.near.size(); ++k) {
      const Pair& pair = island.near[k];
      if (!keeps(pair)) continue;
      const bool lasted = lasts(pair);
      const double near = near_distance(pair, lasted, island.large, states);
      const bool is_near = island.large ? gaps[k] <= near : geometry_.is_within(pair, states, near);
      if (is_near == lasted) continue;
      const collision::Gap gap = geometry_.gap_of(pair, states);
      if (is_near)
        begin(pair, gap);
      else
        end(pair, gap);
    }
  }
  return apart;
}

}  // namespace tumble::engines
