#include "framework/engines/contact/sequential_impacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "framework/dynamics/point_impact.h"
#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/impact_law.h"

namespace tumble::engines {
namespace {

// bodies in persistent contact pass an impact on in ever smaller parts; but a light one between
// heavy ones goes to and fro as fast as it was hit, where it rebounds by this much and nothing is
// driven: rounds go on while what approaches is faster than this part of the first round's
constexpr int kRoundsAmongContacts = 60;
constexpr double kRebounds = 0.5, kStillFast = 0.05;
// of the first round's approach: where rounds end with more to rebound, it is worth a word
constexpr double kSeenRebound = 0.02;
// impulses at one instant: more are reported as one for each pair
constexpr std::size_t kMostEventsPerPair = 64;
// of the largest change of a velocity at that instant: what another order changes and is worth a
// word
constexpr double kSeenOrder = 1e-3;
// rounds in which ties are looked for that impulses of earlier ones have made
constexpr int kRoundsWatched = 8;
// pairs at one instant: in a heap of more nothing is symmetric, and both orders take long
constexpr std::size_t kMostInOrder = 64;

Contact contact_of(const TouchingPair& pair, const Vector3d& point_world) {
  return {point_world, pair.gap.normal_b_to_a_world};
}

TouchedRegion region_of(const TouchingPair& pair) {
  return {pair.gap.normal_b_to_a_world, pair.points_world};
}

// The impulses of each pair at one instant as one event: their sum, from the fastest approach on. A
// large island passes an impact to and fro ten thousand times.
std::vector<Event> one_a_pair(const std::vector<Event>& events) {
  std::vector<Event> sums;
  std::map<std::pair<int, int>, std::size_t> place;
  for (const Event& event : events) {
    const auto [found, is_new] = place.try_emplace({event.body_a, event.body_b}, sums.size());
    if (is_new) {
      sums.push_back(event);
      continue;
    }
    Event& sum = sums[found->second];
    sum.impulse += event.impulse;
    sum.normal_velocity_before = std::min(sum.normal_velocity_before, event.normal_velocity_before);
    sum.normal_velocity_after = event.normal_velocity_after;
    sum.energy_change += event.energy_change;
    sum.energy_excess = std::max(sum.energy_excess, event.energy_excess);
  }
  return sums;
}

double restitution_of(const World& world, const TouchingPair& pair) {
  return std::min(world.bodies[pair.a].restitution, world.bodies[pair.b].restitution);
}
double friction_of(const World& world, const TouchingPair& pair) {
  return !built::kFriction ? 0.0
                           : std::min(world.bodies[pair.a].friction, world.bodies[pair.b].friction);
}

}  // namespace

struct SequentialImpacts::Work {
  ImpactBodies bodies;  // as they are between impulses
  Resolution result;
  // once rounds have ended: what approaches still and would rebound, of the first round's fastest
  double rebound_left = 0.0;
  // by pair and point: places stay as they are
  std::map<std::tuple<const TouchingPair*, double, double, double>, ImpactBodies::Answer> answers;

  Work(MovingWorld& moving, const Laws& laws) : bodies(moving, laws) {}
  Body& body(int index) { return bodies.body(index); }
  const World& world() { return bodies.moving().world(); }

  const ImpactBodies::Answer& answer(const TouchingPair& pair, const Vector3d& point,
                                     bool with_tangents) {
    const auto [found, is_new] = answers.try_emplace({&pair, point.x(), point.y(), point.z()});
    if (is_new || (with_tangents && found->second.directions.cols() == 1))
      found->second =
          bodies.answer({pair.a, pair.b, point, pair.gap.normal_b_to_a_world}, with_tangents);
    return found->second;
  }
};

bool SequentialImpacts::stays(const World& world, const TouchingPair& pair,
                              double approach_speed) const {
  const double restitution = restitution_of(world, pair);
  return contact_threshold_ &&
         laws_.ends_in_contact(approach_speed, restitution, *contact_threshold_);
}

double SequentialImpacts::friction_at_impact(const World& world, const TouchingPair& pair) const {
  return built::kFriction && contact_threshold_ ? friction_of(world, pair) : 0.0;
}

bool SequentialImpacts::collide(Work& work, const TouchingPair& pair, double threshold) {
  Body& a = work.body(pair.a);
  Body& b = work.body(pair.b);
  const double friction = friction_at_impact(work.world(), pair);
  if (friction > 0 && pair.points_world.size() > 1)
    return collide_together(work, {&pair}, threshold, true);
  auto [approach, point] = fastest_approach(laws_, region_of(pair), a, b, threshold);
  if (!(approach < -threshold)) return false;
  const bool is_held = work.bodies.is_held(pair.a, pair.b);
  if (is_held && work.bodies.put_on_constraints(pair.a, pair.b)) {
    const Approach now = fastest_approach(laws_, region_of(pair), a, b, threshold);
    approach = now.velocity;
    point = now.point_world;
    if (!(approach < -threshold)) return false;
  }
  const Contact contact = contact_of(pair, point);
  const TouchedPoint touched{pair.a, pair.b, contact.point_world, contact.normal_b_to_a_world};
  const double restitution =
      stays(work.world(), pair, -approach) ? 0.0 : restitution_of(work.world(), pair);

  // The law's impulse is that of the free bodies without friction: what holds them makes it
  // smaller, friction at the point both.
  double impulse = laws_.collision_impulse(contact, a, b, restitution),
         by_law = work_of_impulse(impulse, approach, restitution);
  Vector3d impulse_world = impulse * contact.normal_b_to_a_world;
  static const ImpactBodies::Answer free_bodies;
  const ImpactBodies::Answer* answer = &free_bodies;
  if (is_held || friction > 0) {
    answer = &work.answer(pair, point, friction > 0);
    const double free = answer->free_along(contact.normal_b_to_a_world),
                 held = answer->held_normal();
    if (!(held > kSolverResidue * free))
      throw StoppedRun(
          fmt::format("they approach at {:.3g} m/s, and rods and joints hold both completely along "
                      "the normal of the contact: no impulse can keep them apart. What drives them "
                      "together (\"motion\") must leave them room",
                      -approach));
    impulse *= free / held;
    impulse_world = impulse * contact.normal_b_to_a_world;
    by_law = work_of_impulse(impulse, approach, restitution);
    if (friction > 0) {
      ++counters_.friction_points;
      const Vector3d velocity = relative_velocity(a, b, contact.point_world);
      const Matrix3d K = answer->held_world();
      impulse_world =
          impulse_of({K, velocity, contact.normal_b_to_a_world, held * impulse, friction})
              .impulse_on_a_world;
      impulse = impulse_world.dot(contact.normal_b_to_a_world);
      by_law = energy_of(impulse_world, velocity, K);
    }
  }
  const EnergyOfImpact energy = work.bodies.push(touched, *answer, impulse_world);
  ++counters_.impulses;
  work.result.events.push_back({work.bodies.moving().time(), EventKind::kCollision, pair.a, pair.b,
                                contact.point_world, contact.normal_b_to_a_world, impulse, approach,
                                normal_velocity(contact, a, b), energy.change,
                                energy.excess(by_law, rules_.restitution_threshold)});
  return true;
}

namespace {

double size_of_work(const ContactProblem& problem, const ContactSolution& solution) {
  double size = 0.0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i)
    for (const int body : {problem.contacts[i].body_a, problem.contacts[i].body_b})
      size += solution.impulses_world[i].norm() * (problem.bodies[body].velocity_world.norm() +
                                                   solution.velocities[body].linear_world.norm());
  return size;
}

}  // namespace

// Newton's restitution at all contacts, as far as it creates no energy.
ContactSolution SequentialImpacts::solve_without_gain(const ContactProblem& problem) {
  const std::vector<Velocity> before = velocities_of(problem);
  const auto solve = [&](const ContactProblem& asked) {
    ++counters_.contact_solves;
    return solve_contacts(asked);
  };
  ContactSolution whole = solve(problem);
  const auto gains = [&](const ContactSolution& solution) {
    return work_of(problem, solution.impulses_world, before, solution.velocities) >
           kSolverResidue * size_of_work(problem, solution);
  };
  if (!gains(whole)) return whole;
  ContactProblem less = problem;
  for (PushingContact& contact : less.contacts) contact.friction = 0.0;
  ContactSolution base = solve(less);
  if (gains(base)) {
    less = problem;
    for (PushingContact& contact : less.contacts) contact.target = 0.0;
    base = solve(less);
  }
  // On the line between the two all laws but Coulomb's on the slip hold as they do at both ends,
  // and energy is a parabola.
  const auto mixed = [](double share, const auto& from, const auto& to) {
    return (from + share * (to - from)).eval();
  };
  ContactSolution difference = whole;
  std::vector<Velocity> change = whole.velocities;
  for (std::size_t i = 0; i < whole.impulses_world.size(); ++i)
    difference.impulses_world[i] -= base.impulses_world[i];
  for (std::size_t i = 0; i < change.size(); ++i)
    change[i] = {change[i].linear_world - base.velocities[i].linear_world,
                 change[i].angular_world - base.velocities[i].angular_world};
  const std::vector<Velocity> none(change.size(), {Vector3d::Zero(), Vector3d::Zero()});
  const double bend = work_of(problem, difference.impulses_world, none, change);
  const double slope = work_of(problem, difference.impulses_world, before, base.velocities) +
                       work_of(problem, base.impulses_world, none, change);
  const double share = share_without_gain(
      work_of(problem, base.impulses_world, before, base.velocities), slope, bend);
  for (std::size_t i = 0; i < whole.impulses_world.size(); ++i)
    whole.impulses_world[i] = mixed(share, base.impulses_world[i], whole.impulses_world[i]);
  for (std::size_t i = 0; i < whole.velocities.size(); ++i)
    whole.velocities[i] = {
        mixed(share, base.velocities[i].linear_world, whole.velocities[i].linear_world),
        mixed(share, base.velocities[i].angular_world, whole.velocities[i].angular_world)};
  return whole;
}

// The same as of a step's contacts (PersistentContacts::note_unsolved). No shorter step helps: an
// impact takes none.
void SequentialImpacts::note_unsolved(const MovingWorld& moving, const std::vector<int>& bodies,
                                      const ContactSolution& solution) {
  const double allowed = solution.impulses_world.size() > kContact.many_contacts
                             ? kContact.unsolved_in_large_island
                             : kContactSolved;
  if (solution.converged || solution.residual <= allowed) return;
  counters_.watch.note(RunWatch::Kind::kContactUnsolved, names_of(moving.world(), bodies),
                       {solution.residual, allowed, moving.time(), 0.0});
}

// Newton's law of restitution for all pairs at once: v_n' >= -e v_n where they approach, v_n' >= 0
// elsewhere, with friction, and with the rows of what is linked to them.
bool SequentialImpacts::collide_together(Work& work, const std::vector<const TouchingPair*>& pairs,
                                         double threshold, bool rebounds) {
  // corners carry; the middle lies between them
  const auto first_corner = [](const TouchingPair& pair) {
    return pair.points_world.size() > 1 ? 1u : 0u;
  };
  const auto approach_at = [&](const TouchingPair& pair, std::size_t k) {
    return laws_.relative_normal_velocity(contact_of(pair, pair.points_world[k]), work.body(pair.a),
                                          work.body(pair.b));
  };
  const auto approaches = [&](const TouchingPair* pair) {
    for (std::size_t k = first_corner(*pair); k < pair->points_world.size(); ++k)
      if (approach_at(*pair, k) < -threshold) return true;
    return false;
  };
  if (std::none_of(pairs.begin(), pairs.end(), approaches)) return false;
  for (const TouchingPair* pair : pairs) work.bodies.put_on_constraints(pair->a, pair->b);

  // Bodies: those that touch, and what is linked to them.
  MovingWorld& moving = work.bodies.moving();
  ContactProblem problem;
  BodyPlaces places;
  places.begin(moving.size());
  std::vector<int> all;  // bodies of the problem
  std::vector<int> held_groups;
  const auto place = [&](int index) {
    const int next = static_cast<int>(problem.bodies.size()), at = places.enter(index, next);
    if (at != next) return at;
    all.push_back(index);
    if (moving.resting(index)) moving.wake(index);
    const Body& body = work.body(index);
    const Matrix3d R = body.world_from_body.toRotationMatrix();
    problem.bodies.push_back({body.inertia.inverse_mass,
                              R * body.inertia.inverse_inertia_body * R.transpose(), body.com_world,
                              body.velocity_world, body.omega_world});
    if (const int group = work.bodies.held_group(index);
        group >= 0 && std::find(held_groups.begin(), held_groups.end(), group) == held_groups.end())
      held_groups.push_back(group);
    return at;
  };
  struct Met {
    const TouchingPair* pair;
    double approach;
  };
  std::vector<Met> met;
  for (const TouchingPair* touching : pairs) {
    const TouchingPair& pair = *touching;
    for (std::size_t k = first_corner(pair); k < pair.points_world.size(); ++k) {
      const double approach = approach_at(pair, k);
      const double restitution = !rebounds || stays(work.world(), pair, -approach)
                                     ? 0.0
                                     : restitution_of(work.world(), pair);
      problem.contacts.push_back({place(pair.a), place(pair.b), pair.points_world[k],
                                  pair.gap.normal_b_to_a_world, friction_of(work.world(), pair),
                                  approach < 0 ? -restitution * approach : 0.0, Vector3d::Zero()});
      met.push_back({&pair, approach});
    }
  }
  for (const int group : held_groups)
    for (const int member : moving.linked_groups()[static_cast<std::size_t>(group)].bodies())
      place(member);
  for (const int group : held_groups)
    add_rows(moving.linked_groups()[static_cast<std::size_t>(group)], moving.states(),
             moving.time(), places, problem);
  keep_rates(problem);

  const std::vector<Velocity> before = velocities_of(problem);
  const ContactSolution solution = solve_without_gain(problem);
  std::sort(all.begin(), all.end());
  note_unsolved(moving, all, solution);
  const Vector3d driven = work.bodies.driven_velocity(all).value_or(Vector3d::Constant(kUnset));
  EnergyOfImpact energy;
  for (const int index : all) {
    const auto at = static_cast<std::size_t>(places.at(index));
    const Body& body = work.body(index);
    if (body.inertia.inverse_mass == 0.0) continue;
    energy.add(body.inertia, body.world_from_body, before[at], solution.velocities[at], driven);
    work.bodies.set_velocity(index, solution.velocities[at]);
  }
  // unsolved: never more is all that can be asked
  const double excess = energy.excess(
      solution.converged ? work_of(problem, solution.impulses_world, before, solution.velocities)
                         : energy.change,
      rules_.restitution_threshold);
  bool is_first = true;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const TouchingPair& pair = *met[i].pair;
    const double impulse = solution.impulses_world[i].dot(pair.gap.normal_b_to_a_world);
    if (!(impulse > 0)) continue;
    ++counters_.impulses;
    const Contact contact = contact_of(pair, problem.contacts[i].point_world);
    // The energy of all, which the first stands for.
    work.result.events.push_back({moving.time(), EventKind::kCollision, pair.a, pair.b,
                                  contact.point_world, contact.normal_b_to_a_world, impulse,
                                  met[i].approach,
                                  normal_velocity(contact, work.body(pair.a), work.body(pair.b)),
                                  is_first ? energy.change : 0.0, is_first ? excess : 0.0});
    is_first = false;
  }
  return true;
}

bool SequentialImpacts::push_pair_apart(Work& work, const TouchingPair& pair) {
  const auto [rate, point] = fastest_approach(laws_, region_of(pair), work.body(pair.a),
                                              work.body(pair.b), rules_.restitution_threshold);
  if (rate >= kFastEnough * rules_.restitution_threshold) return false;
  const Vector3d& n = pair.gap.normal_b_to_a_world;
  const ImpactBodies::Answer& answer = work.answer(pair, point, false);
  // links hold both where they are
  if (!(answer.held_normal() > kSolverResidue * answer.free_along(n))) return false;
  work.bodies.push({pair.a, pair.b, point, n}, answer,
                   (rules_.restitution_threshold - rate) / answer.held_normal() * n);
  ++counters_.micro_impacts;
  return true;
}

void SequentialImpacts::push_apart(MovingWorld& moving, const std::vector<TouchingPair>& touching,
                                   const std::vector<TouchingPair>& micro_impacts) {
  if (micro_impacts.empty()) return;
  Work work(moving, laws_);
  const auto had_micro_impact = [&](const TouchingPair& pair) {
    return std::any_of(micro_impacts.begin(), micro_impacts.end(),
                       [&](const TouchingPair& m) { return m.a == pair.a && m.b == pair.b; });
  };
  bool again = true;
  for (int round = 0; again && round < kMostPushes; ++round) {
    again = false;
    for (const TouchingPair& pair : touching)
      if (had_micro_impact(pair) || work.bodies.changed().contains(pair.a) ||
          work.bodies.changed().contains(pair.b))
        again = push_pair_apart(work, pair) || again;
  }
  work.bodies.write_back();
}

// @return false: pairs still approach after all rounds
bool SequentialImpacts::collide_in_turn(Work& work, std::vector<const TouchingPair*> in_turn,
                                        double threshold, std::vector<Tie>* ties, int turned_from) {
  const std::vector<Event>& events = work.result.events;
  const auto fastest_since = [&](std::size_t first) {
    double fastest = 0.0;
    for (std::size_t k = first; k < events.size(); ++k)
      fastest = std::max(fastest, -events[k].normal_velocity_before);
    return fastest;
  };
  const bool goes_on = !contact_threshold_ ||
                       std::all_of(in_turn.begin(), in_turn.end(), [&](const TouchingPair* pair) {
                         const MovingWorld& moving = work.bodies.moving();
                         return restitution_of(work.world(), *pair) >= kRebounds &&
                                !moving.is_driven(pair->a) && !moving.is_driven(pair->b);
                       });
  double at_first = 0.0, now = 0.0;
  bool again = true;
  for (int round = 1; again && round < kMostImpactRounds; ++round) {
    if (contact_threshold_ && round >= kRoundsAmongContacts &&
        (!goes_on || now <= kStillFast * at_first))
      break;
    const std::size_t first = events.size();
    if (round == turned_from) std::reverse(in_turn.begin(), in_turn.end());
    if (ties && round <= kRoundsWatched)
      if (const std::optional<Tie> tie = tie_of(work, in_turn, threshold, round))
        ties->push_back(*tie);
    again = false;
    for (const TouchingPair* pair : in_turn) again = collide(work, *pair, threshold) || again;
    now = fastest_since(first);
    if (round == 1) at_first = now;
  }
  work.rebound_left = 0.0;
  if (again)
    for (const TouchingPair* pair : in_turn)
      work.rebound_left =
          std::max(work.rebound_left, restitution_of(work.world(), *pair) * now / at_first);
  return !again;
}

// Two that approach at the beginning of a round and share a body that moves. Before the first
// impulse all count. A row of unequal balls has such only after others; in a heap of what hardly
// rebounds they are many, and little hangs on them: later ones count where both rebound.
std::optional<SequentialImpacts::Tie> SequentialImpacts::tie_of(
    Work& work, const std::vector<const TouchingPair*>& pairs, double threshold, int round) {
  std::map<int, const TouchingPair*> hit;  // by body
  std::optional<Tie> tie;
  for (const TouchingPair* touching : pairs) {
    const TouchingPair& pair = *touching;
    if (round > 1 && restitution_of(work.world(), pair) < kRebounds) continue;
    const Approach approach =
        fastest_approach(laws_, region_of(pair), work.body(pair.a), work.body(pair.b), threshold);
    // what rests on a support meets it with what gravity gives it in a step
    if (!(approach.velocity < -std::max(threshold, rules_.restitution_threshold))) continue;
    for (const int body : {pair.a, pair.b}) {
      if (work.body(body).inertia.inverse_mass == 0.0) continue;
      const auto [other, is_first] = hit.try_emplace(body, &pair);
      if (!is_first && !tie) tie = Tie{body, round, other->second, &pair};
    }
  }
  return tie;
}

// What the opposite order makes of impacts at one instant, from the round of the tie on. Nothing of
// it is kept.
void SequentialImpacts::watch_order(Work& work, const Tie& tie,
                                    const std::vector<TouchingPair>& pairs, double threshold) {
  MovingWorld& moving = work.bodies.moving();
  const RunCounters before = counters_;
  Work other(moving, laws_);
  std::vector<const TouchingPair*> in_turn;
  for (const TouchingPair& pair : pairs) in_turn.push_back(&pair);
  bool is_known = false;
  try {
    is_known = collide_in_turn(other, in_turn, threshold, nullptr, tie.round);
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun&) {
    // the order that counts has gone well
  }
  counters_ = before;
  if (!is_known) return;
  double fastest = 0.0, apart = 0.0;  // [m/s]
  for (const TouchingPair& pair : pairs)
    for (const int body : {pair.a, pair.b}) {
      const Body start = moving.body_at_impact(body);
      const Body &one = work.body(body), &two = other.body(body);
      const double arm =
          moving.shape(body).is_half_space() ? 0.0 : moving.shape(body).bounding_radius();
      const auto difference = [&](const Vector3d& v, const Vector3d& w) {
        return (one.velocity_world - v).norm() + arm * (one.omega_world - w).norm();
      };
      fastest = std::max(fastest, difference(start.velocity_world, start.omega_world));
      apart = std::max(apart, difference(two.velocity_world, two.omega_world));
    }
  if (!(apart > kSeenOrder * fastest)) return;
  const auto name = [&](int body) { return "'" + work.world().bodies[body].name + "'"; };
  const auto partner = [&](const TouchingPair& pair) {
    return name(pair.a == tie.body ? pair.b : pair.a);
  };
  counters_.watch.say(
      kOrderOfImpacts, moving.time(),
      fmt::format(
          "at t = {:.6g} s {} meets {} and {} at one instant: impacts act one after the other, in "
          "the order of bodies in the file, and the opposite order gives velocities that differ by "
          "{:.2g} m/s. What is symmetric does not stay so; \"contact\": {{\"impact_law\": "
          "\"simultaneous\"}} and --engine rd resolve impacts of one instant together",
          moving.time(), name(tie.body), partner(*tie.one), partner(*tie.two), apart));
}

Resolution SequentialImpacts::resolve(MovingWorld& moving, const std::vector<TouchingPair>& pairs,
                                      std::size_t trigger) {
  Work work(moving, laws_);
  ApproachThreshold approach_threshold;
  for (const TouchingPair& pair : pairs)
    approach_threshold.look(laws_, region_of(pair), work.body(pair.a), work.body(pair.b));
  const double threshold = approach_threshold.value();

  bool again = false;
  std::vector<const TouchingPair*> in_turn;
  for (const TouchingPair& pair : pairs) in_turn.push_back(&pair);
  if (law_ == scene::ImpactLaw::kSimultaneous) {
    collide_together(work, in_turn, threshold, true);
  } else {
    const bool is_watched = pairs.size() > 1 && pairs.size() <= kMostInOrder &&
                            !counters_.watch.has_said(kOrderOfImpacts, moving.time());
    std::vector<Tie> ties;
    again = !collide_in_turn(work, in_turn, threshold, is_watched ? &ties : nullptr);
    for (const Tie& tie : ties)
      if (!again && !counters_.watch.has_said(kOrderOfImpacts, moving.time()))
        watch_order(work, tie, pairs, threshold);
  }
  // what is left of an impact that many bodies in contact pass to and fro is resolved at all at
  // once
  if (again && contact_threshold_) {
    if (work.rebound_left > kSeenRebound)
      counters_.watch.say(
          "rebounds left out", moving.time(),
          fmt::format(
              "at t = {:.6g} s {} bodies, among them {}, passed an impact to and fro: after "
              "{} rounds {:.2g} of its speed was left to rebound, and was resolved without "
              "rebound",
              moving.time(), work.bodies.changed().size(),
              names_of(moving.world(), {pairs[trigger].a, pairs[trigger].b}), kRoundsAmongContacts,
              work.rebound_left));
    collide_together(work, in_turn, threshold, false);
    again = false;
    work.result.events = one_a_pair(work.result.events);
  } else if (work.result.events.size() > kMostEventsPerPair * pairs.size()) {
    work.result.events = one_a_pair(work.result.events);
  }
  work.result.settled = !again;

  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const TouchingPair& pair = pairs[k];
    const auto [last, first_time] =
        last_impacts_.try_emplace({pair.a, pair.b}, -std::numeric_limits<double>::infinity());
    double approach = 0.0;
    bool hit = false;
    for (const Event& event : work.result.events) {
      if (event.body_a != pair.a || event.body_b != pair.b) continue;
      hit = true;
      approach = std::max(approach, -event.normal_velocity_before);
    }
    if (!hit && k != trigger) continue;
    const bool in_vain = work.result.events.empty();
    const bool soon_again = moving.time() - last->second < rules_.micro_interval &&
                            approach < rules_.restitution_threshold;
    if (in_vain || soon_again) work.result.micro_impacts.push_back(pair);
    last->second = moving.time();
  }
  work.bodies.write_back();
  ++counters_.impacts;
  return work.result;
}

}  // namespace tumble::engines
