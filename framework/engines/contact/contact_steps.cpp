// Where an island in contact comes out of a step, and the paths that lead there. Part of
// PersistentContacts.
#include <algorithm>
#include <cmath>

#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/persistent_contacts.h"

namespace tumble::engines {

// What the next step remembers of this one's impulses.
void PersistentContacts::keep_warm_start(const ContactIsland& island, const StepContacts& contacts,
                                         const ContactProblem& problem,
                                         const ContactSolution& solution, double h) {
  problems_.note_unsolved(island, solution, h);
  warm_start_.remember(contacts, problem, solution, h);
  if (solution.sharing == LoadSharing::kMostEven)
    next_sharing_.insert(island.pairs.begin(), island.pairs.end());
  bool any_slides = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vector3d force = solution.impulses_world[i] / h, point = problem.contacts[i].point_world;
    const bool slides =
        solution.modes[i] == ContactMode::kSlide && !force.isZero(0.0) &&
        slip_speed(problem, i, solution.velocities) > kCreep * restitution_threshold_;
    if (i == 0 || contacts[i].pair != contacts[i - 1].pair) next_stuck_.insert(contacts[i].pair);
    if (slides) next_stuck_.erase(contacts[i].pair);
    any_slides = any_slides || slides;
    if (!force.isZero(0.0))
      forces_.push_back({contacts[i].pair.first, contacts[i].pair.second, point,
                         contacts[i].point.normal_b_to_a_world, force, solution.by_contact_forces});
  }
  if (any_slides) problems_.say_undecided(island, solution);
}

// Where the island's bodies come out with these impulses: ends_.
// @param inertia_at_ends  the problem took the inertia of the bodies where ends_ has had them so
// far; else at the end of their free paths
void PersistentContacts::find_ends(const ContactIsland& island, const ContactProblem& problem,
                                   const ContactSolution& solution, double h, bool activation,
                                   bool inertia_at_ends) {
  correction_.place_driven(ends_, moving_.target());
  // the problem's first bodies are the island's
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    const Velocity& after = solution.velocities[k];
    const RigidBodyState& free = moving_.path_end(body);
    RigidBodyState& end = ends_[body];
    const Vector3d turning = after.angular_world - problem.bodies[k].omega_world;
    const Quaterniond at = inertia_at_ends ? end.world_from_body : free.world_from_body;
    if (activation) {
      const RigidBodyState& start = moving_.state(body);
      end.com_world = start.com_world + h * after.linear_world;
      end.world_from_body = turned(start.world_from_body, h * after.angular_world);
    } else {
      end.com_world =
          free.com_world + 0.5 * h * (after.linear_world - problem.bodies[k].velocity_world);
      end.world_from_body = turned(free.world_from_body, 0.5 * h * turning);
    }
    // the free path's, and what the impulses give: nothing else changes it
    end.angular_momentum_world =
        free.angular_momentum_world + angular_momentum_of(turning, at, inertia);
    end.momentum_world = inertia.mass * after.linear_world;
  }
}

// The angle that the fastest of the island's bodies turns in the step; a ball looks the same
// however it turns.
double PersistentContacts::largest_turn(const ContactIsland& island,
                                        const std::vector<RigidBodyState>& ends, double h) const {
  double turn = 0.0;
  for (const int body : island.bodies)
    if (!moving_.shape(body).is_ball())
      turn = std::max(turn, omega_of(ends[body], moving_.world().bodies[body].inertia).norm() * h);
  return turn;
}

// The angle that the normal between two balls, or of a ball on an edge, turns most in the step:
// what slides or rolls there follows a curve.
double PersistentContacts::turn_of_normals(const ContactIsland& island,
                                           const std::vector<RigidBodyState>& ends) const {
  double turn = 0.0;
  for (const Pair& pair : island.pairs) {
    if (points_.find(pair)->empty()) continue;
    Vector3d start, stop;
    if (geometry_.are_balls(pair)) {
      start = moving_.state(pair.first).com_world - moving_.state(pair.second).com_world;
      stop = ends[pair.first].com_world - ends[pair.second].com_world;
    } else if (geometry_.is_ball_on_edges(pair)) {
      start = geometry_.gap_of(pair, moving_.states()).normal_b_to_a_world;
      stop = geometry_.gap_of(pair, ends).normal_b_to_a_world;
    } else {
      continue;
    }
    turn = std::max(turn, std::atan2(start.cross(stop).norm(), start.dot(stop)));
  }
  return turn;
}

// Contacts of an island that turns: at the middle of the step, where their forces act evenly, with
// targets that make the velocities at the step's end fit the surfaces there: J_middle v' = target -
// (J_end - J_middle) v'. Without that a body that tips over its edge gains or loses energy in
// proportion to the step.
StepContacts PersistentContacts::contacts_midway(const ContactIsland& island,
                                                 const StepContacts& contacts) {
  const std::vector<RigidBodyState>& starts = moving_.states();
  const std::vector<RigidBodyState>& ends = ends_;
  std::vector<RigidBodyState>& middle = midway_;
  for (const int body : island.bodies) {
    middle[body].com_world = 0.5 * (starts[body].com_world + ends[body].com_world);
    middle[body].world_from_body =
        starts[body].world_from_body.slerp(0.5, ends[body].world_from_body);
  }
  for (const int body : moving_.driven_bodies())
    middle[body].com_world = 0.5 * (starts[body].com_world + ends[body].com_world);
  const auto slip = [&](Pair pair, const std::vector<RigidBodyState>& at,
                        const collision::ManifoldPoint& p) -> Vector3d {
    const Vector3d point = geometry_.point_of(pair, p);
    const auto velocity = [&](int body) -> Vector3d {
      const WorldBody& b = moving_.world().bodies[body];
      if (b.immovable()) return prescribed_velocity(b, moving_.target());
      return b.inertia.inverse_mass * ends[body].momentum_world +
             omega_of(ends[body], b.inertia).cross(point - at[body].com_world);
    };
    return velocity(pair.first) - velocity(pair.second);
  };
  StepContacts result;
  std::size_t from = 0;
  for (const Pair& pair : island.pairs) {
    std::size_t to = from;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    if (to == from) continue;
    double farthest = 0.0;  // no point of the contact can be farther off by the step's end
    for (std::size_t i = from; i < to; ++i)
      farthest = std::max({farthest, contacts[i].start_gap, contacts[i].point.gap});
    for (const int body : {pair.first, pair.second})
      farthest +=
          (ends[body].com_world - starts[body].com_world).norm() +
          (moving_.shape(body).is_half_space()
               ? 0.0
               : moving_.shape(body).bounding_radius() *
                     starts[body].world_from_body.angularDistance(ends[body].world_from_body));
    const double near = geometry_.same_within(pair),
                 reach = geometry_.are_balls(pair)
                             ? geometry_.size_of(pair)
                             : std::min(near, farthest + geometry_.margin(pair));
    const ContactManifold at_middle = geometry_.points_at(pair, middle, reach),
                          at_end = geometry_.points_at(pair, ends, reach);
    for (std::size_t i = from; i < to; ++i) {
      StepContact step_contact = contacts[i];
      const ContactGeometry::SamePoint at_mid =
          geometry_.same_point(pair, step_contact.point, starts, at_middle, middle, near);
      const collision::ManifoldPoint *const mid = at_mid.point, *end = nullptr;
      step_contact.leaves_its_face = !mid && at_mid.is_over_a_corner;
      if (mid) {
        const ContactGeometry::SamePoint then =
            geometry_.same_point(pair, *mid, middle, at_end, ends, near);
        end = then.point;
        step_contact.leaves_its_face = !end && then.is_over_a_corner;
      }
      if (mid && end) {
        step_contact.point = *mid;
        const Vector3d at_end_point = slip(pair, ends, *end),
                       at_mid_point = slip(pair, middle, *mid);
        step_contact.target -=
            end->normal_b_to_a_world.dot(at_end_point) - mid->normal_b_to_a_world.dot(at_mid_point);
        step_contact.slip_target_world = at_mid_point - at_end_point;
      }
      result.push_back(step_contact);
    }
    from = to;
  }
  return result;
}

// @return whether no overlap was left
bool PersistentContacts::set_paths(const ContactIsland& island, const StepContacts& contacts,
                                   const std::vector<RigidBodyState>& contacts_at,
                                   const ContactProblem& problem, const ContactSolution& solution,
                                   double h, bool activation) {
  const bool is_midway = &contacts_at == &midway_;
  find_ends(island, problem, solution, h, activation, is_midway);
  // Where nothing turns, points stay as near as they are; but what is driven goes another way than
  // its velocities at the ends say.
  std::vector<ActiveContact> active;
  if (!activation && contacts.size() <= kContact.many_contacts)
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Pair& pair = contacts[i].pair;
      if ((is_midway || moving_.is_driven(pair.first) || moving_.is_driven(pair.second)) &&
          contacts[i].start_gap < kContact.far_at_start * geometry_.margin(pair) &&
          solution.impulses_world[i].squaredNorm() > 0.0)
        active.push_back({pair, contacts[i].point, &contacts_at});
    }
  // Pairs that are not in contact may meet within the step: that is for the finding of impacts.
  const bool apart =
      correction_.correct_positions(island, island.pairs, ends_, moving_.target(), active);
  for (const int body : moving_.driven_bodies()) ends_[body] = moving_.state(body);
  // The path goes where position correction has moved its end, however short the step: velocities
  // along it are no momenta. What rods and joints hold is put right where a step ends within it
  // (MovingWorld::commit).
  for (const int body : island.bodies) {
    if (activation)
      set_straight_path(body, ends_[body]);
    else
      moving_.set_path(body, moving_.state(body), ends_[body], SmoothPath::Momenta::kEven);
    moving_.refuse_fast_turning(body);
  }
  return apart;
}

// From place to place, as x' = x + h v' says: a bent path would dip below the surface on its way.
void PersistentContacts::set_straight_path(int body, const RigidBodyState& end) {
  const Inertia& inertia = moving_.world().bodies[body].inertia;
  RigidBodyState start = moving_.state(body);
  start.momentum_world = end.momentum_world;
  start.angular_momentum_world =
      angular_momentum_of(omega_of(end, inertia), start.world_from_body, inertia);
  moving_.set_path(body, start, end, SmoothPath::Momenta::kEven);
}

}  // namespace tumble::engines
