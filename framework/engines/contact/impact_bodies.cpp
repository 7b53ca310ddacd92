#include "framework/engines/contact/impact_bodies.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

std::size_t place_in(const LinkedBodies& group, int body) {
  return static_cast<std::size_t>(
      std::lower_bound(group.bodies().begin(), group.bodies().end(), body) -
      group.bodies().begin());
}

// Change of (v, omega) of a free body by an impulse at a point.
Vector6d free_response(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  Vector6d change;
  const Vector3d turn_body =
      body.world_from_body.conjugate() * (point_world - body.com_world).cross(impulse_world);
  change << body.inertia.inverse_mass * impulse_world,
      body.world_from_body * (body.inertia.inverse_inertia_body * turn_body);
  return change;
}

// Of a point that moves with a body.
Vector3d at_point(const Vector6d& velocity, const Vector3d& arm) {
  return velocity.head<3>() + velocity.tail<3>().cross(arm);
}

}  // namespace

Vector3d velocity_at(const Body& body, const Vector3d& point_world) {
  return body.velocity_world + body.omega_world.cross(point_world - body.com_world);
}

Vector3d relative_velocity(const Body& a, const Body& b, const Vector3d& point_world) {
  return velocity_at(a, point_world) - velocity_at(b, point_world);
}

Matrix3d inverse_effective_mass(const Body& body, const Vector3d& point_world) {
  Matrix3d K = Matrix3d::Zero();
  if (body.inertia.inverse_mass == 0.0) return K;
  for (int i = 0; i < 3; ++i)
    K.col(i) =
        at_point(free_response(body, Vector3d::Unit(i), point_world), point_world - body.com_world);
  return 0.5 * (K + K.transpose());
}

// ---- Energy -------------------------------------------------------------------------------------

// As (v' - v) . (v' + v) / 2: the energies themselves would take the digits away.
void EnergyOfImpact::add(const Inertia& inertia, const Quaterniond& q, const Velocity& from,
                         const Velocity& to, const Vector3d& seen_from) {
  const Vector3d v = from.linear_world - seen_from, v_after = to.linear_world - seen_from;
  mass += inertia.mass;
  before += 0.5 * inertia.mass * v.squaredNorm();
  change += 0.5 * inertia.mass * (to.linear_world - from.linear_world).dot(v + v_after);
  if (from.angular_world.isZero(0.0) && to.angular_world.isZero(0.0)) return;
  const Vector3d w = q.conjugate() * from.angular_world, w_after = q.conjugate() * to.angular_world;
  before += 0.5 * w.dot(inertia.inertia_body * w);
  change += 0.5 * (w_after - w).dot(inertia.inertia_body * (w + w_after));
}

double EnergyOfImpact::excess(double by_law, double least_speed) const {
  const double speed = std::max(least_speed, kNegligibleSpeed),
               size = before + std::abs(by_law) + 0.5 * mass * speed * speed;
  return size > 0 ? std::max(std::abs(change - by_law), change) / size : change;
}

std::vector<Velocity> velocities_of(const ContactProblem& problem) {
  std::vector<Velocity> velocities;
  velocities.reserve(problem.bodies.size());
  for (const PushedBody& body : problem.bodies)
    velocities.push_back({body.velocity_world, body.omega_world});
  return velocities;
}

double work_of(const ContactProblem& problem, const std::vector<Vector3d>& impulses,
               const std::vector<Velocity>& from, const std::vector<Velocity>& to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PushingContact& c = problem.contacts[i];
    const auto velocity = [&](const std::vector<Velocity>& velocities, int body) -> Vector3d {
      const auto k = static_cast<std::size_t>(body);
      return velocities[k].linear_world +
             velocities[k].angular_world.cross(c.point_world - problem.bodies[k].com_world);
    };
    sum += 0.5 * impulses[i].dot(velocity(from, c.body_a) - velocity(from, c.body_b) +
                                 velocity(to, c.body_a) - velocity(to, c.body_b));
  }
  return sum;
}

double work_of_rows(const ContactProblem& problem, const VectorXd& row_impulses,
                    const std::vector<Velocity>& from, const std::vector<Velocity>& to,
                    const Vector3d& seen_from) {
  if (row_impulses.size() != static_cast<Eigen::Index>(problem.rows.size())) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const auto& [a, b, row] = problem.rows[i];
    const auto rate = [&](int body, const Vector6d& jacobian) {
      const auto k = static_cast<std::size_t>(body);
      if (problem.bodies[k].inverse_mass == 0.0) return 0.0;  // its energy is not counted
      const Vector3d linear = 0.5 * (from[k].linear_world + to[k].linear_world) - seen_from;
      const Vector3d angular = 0.5 * (from[k].angular_world + to[k].angular_world);
      return jacobian.head<3>().dot(linear) + jacobian.tail<3>().dot(angular);
    };
    sum += row_impulses[static_cast<Eigen::Index>(i)] *
           (rate(a, row.jacobian_a) + rate(b, row.jacobian_b));
  }
  return sum;
}

// ---- Bodies -------------------------------------------------------------------------------------

Body& ImpactBodies::body(int index) {
  const auto found = bodies_.find(index);
  return found != bodies_.end()
             ? found->second
             : bodies_.emplace(index, moving_.body_at_impact(index)).first->second;
}

void ImpactBodies::set_velocity(int index, const Velocity& velocity) {
  Body& changed = body(index);
  changed.velocity_world = velocity.linear_world;
  changed.omega_world = velocity.angular_world;
  changed_.insert(index);
}

void ImpactBodies::write_back() {
  for (const int index : changed_) {
    const Body& body = bodies_.at(index);
    RigidBodyState state = moving_.state(index);
    state.momentum_world = body.inertia.mass * body.velocity_world;
    state.angular_momentum_world =
        angular_momentum_of(body.omega_world, body.world_from_body, body.inertia);
    moving_.set_state(index, state);
  }
}

int ImpactBodies::held_group(int body) const {
  const int group = moving_.linked_group(body);
  return group >= 0 && moving_.linked_groups()[static_cast<std::size_t>(group)].has_constraints()
             ? group
             : -1;
}

LinkedBodies::Instant& ImpactBodies::instant(int group) {
  const auto found = instants_.find(group);
  if (found != instants_.end()) return found->second;
  return instants_
      .emplace(group, moving_.linked_groups()[static_cast<std::size_t>(group)].at_instant(
                          moving_.states(), moving_.time()))
      .first->second;
}

bool ImpactBodies::put_on_constraints(int a, int b) {
  bool any = false;
  for (const int group : {held_group(a), held_group(b)}) {
    if (group < 0 || !on_constraints_.insert(group).second) continue;
    std::vector<RigidBodyState> states = moving_.states();
    LinkedBodies& held = moving_.linked_groups()[static_cast<std::size_t>(group)];
    held.project_velocities(states, moving_.time());
    for (const int index : held.bodies()) {
      const Inertia& inertia = moving_.world().bodies[static_cast<std::size_t>(index)].inertia;
      const RigidBodyState& state = states[static_cast<std::size_t>(index)];
      set_velocity(index, {inertia.inverse_mass * state.momentum_world, omega_of(state, inertia)});
    }
    any = true;
  }
  return any;
}

std::optional<Vector3d> ImpactBodies::driven_velocity(const std::vector<int>& bodies) {
  std::optional<Vector3d> common;
  bool is_one = true;
  const auto look = [&](const Vector3d& velocity) {
    if (!common) common = velocity;
    is_one = is_one && velocity == *common;
  };
  for (const int index : bodies) {
    if (moving_.world().bodies[static_cast<std::size_t>(index)].immovable())
      look(moving_.velocity_of(index, moving_.time()));
    else if (const int group = held_group(index); group >= 0)
      for (const int end : moving_.linked_groups()[static_cast<std::size_t>(group)].fixed_ends())
        look(end < 0 ? Vector3d(Vector3d::Zero()) : moving_.velocity_of(end, moving_.time()));
  }
  if (!is_one) return std::nullopt;
  return common.value_or(Vector3d::Zero());
}

// ---- Impulses -----------------------------------------------------------------------------------

ImpactBodies::Answer ImpactBodies::answer(const TouchedPoint& touched, bool with_tangents) {
  Answer answer;
  const Vector3d& n = touched.normal_b_to_a_world;
  answer.directions.resize(3, with_tangents ? 3 : 1);
  answer.directions.col(0) = n;
  if (with_tangents)
    answer.directions.rightCols<2>() << n.unitOrthogonal(), n.cross(n.unitOrthogonal());
  for (const int index : {touched.a, touched.b})
    answer.free_world += inverse_effective_mass(body(index), touched.point_world);
  answer.held = answer.directions.transpose() * answer.free_world * answer.directions;

  std::set<int> groups{held_group(touched.a), held_group(touched.b)};
  groups.erase(-1);
  for (const int group : groups) {
    LinkedBodies& held = moving_.linked_groups()[static_cast<std::size_t>(group)];
    const LinkedBodies::Instant& now = instant(group);
    Answer::Reaction reaction{group, MatrixXd(6 * static_cast<Eigen::Index>(now.bodies.size()),
                                              answer.directions.cols())};
    for (Eigen::Index d = 0; d < answer.directions.cols(); ++d) {
      VectorXd change = VectorXd::Zero(reaction.velocities.rows());
      for (const auto& [index, sign] : {std::pair{touched.a, 1.0}, std::pair{touched.b, -1.0}})
        if (held_group(index) == group)
          change.segment<6>(6 * static_cast<Eigen::Index>(place_in(held, index))) =
              free_response(body(index), sign * answer.directions.col(d), touched.point_world);
      reaction.velocities.col(d) = held.reaction(now, change);
    }
    for (const auto& [index, sign] : {std::pair{touched.a, 1.0}, std::pair{touched.b, -1.0}}) {
      if (held_group(index) != group) continue;
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(place_in(held, index));
      for (Eigen::Index d = 0; d < answer.directions.cols(); ++d)
        answer.held.col(d) += sign * answer.directions.transpose() *
                              at_point(reaction.velocities.col(d).segment<6>(at),
                                       touched.point_world - body(index).com_world);
    }
    answer.reactions.push_back(std::move(reaction));
  }
  answer.held = (0.5 * (answer.held + answer.held.transpose())).eval();
  // What holds bodies never lets them yield more than freely, nor backwards.
  const double free = answer.free_along(n);
  if (!(answer.held_normal() >= -kSixDigits * free &&
        answer.held_normal() <= (1 + kSixDigits) * free))
    throw StoppedRun(fmt::format(
        "rods and joints (constraint_correction of {}): with the links' reactions an impulse of 1 "
        "N s changes the normal velocity by {:.6g} m/s, on the free bodies by {:.6g}; "
        "links can only take from it, so what the correction changes is not the smallest change "
        "that leaves every row's rate as it is",
        laws_.source_of_links(), answer.held_normal(), free));
  return answer;
}

EnergyOfImpact ImpactBodies::push(const TouchedPoint& touched, const Answer& answer,
                                  const Vector3d& impulse_world) {
  // Velocities before, of all that changes.
  std::vector<std::pair<int, Velocity>> before;
  const auto note = [&](int index) {
    const Body& now = body(index);
    if (now.inertia.inverse_mass != 0.0)
      before.emplace_back(index, Velocity{now.velocity_world, now.omega_world});
  };
  for (const int index : {touched.a, touched.b})
    if (answer.reactions.empty() || held_group(index) < 0) note(index);
  for (const Answer::Reaction& reaction : answer.reactions)
    for (const int index :
         moving_.linked_groups()[static_cast<std::size_t>(reaction.group)].bodies())
      note(index);

  // The impulse itself.
  for (const auto& [index, sign] : {std::pair{touched.a, 1.0}, std::pair{touched.b, -1.0}}) {
    Body& pushed = body(index);
    if (pushed.inertia.inverse_mass == 0.0) continue;
    // its mass was part of the impulse: it takes its share
    if (moving_.resting(index)) moving_.wake(index);
    set_velocity(index, laws_.apply_impulse(pushed, sign * impulse_world, touched.point_world));
  }
  // What rods and joints make of it.
  for (const Answer::Reaction& reaction : answer.reactions) {
    const VectorXd change = reaction.velocities * (answer.directions.transpose() * impulse_world);
    const std::vector<int>& members =
        moving_.linked_groups()[static_cast<std::size_t>(reaction.group)].bodies();
    for (std::size_t k = 0; k < members.size(); ++k) {
      const Body& member = body(members[k]);
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(k);
      set_velocity(members[k], {member.velocity_world + change.segment<3>(at),
                                member.omega_world + change.segment<3>(at + 3)});
    }
  }

  EnergyOfImpact energy;
  const auto frame = [&]() -> Vector3d {
    if (!answer.reactions.empty())
      return driven_velocity({touched.a, touched.b}).value_or(Vector3d::Constant(kUnset));
    return body(touched.a).inertia.inverse_mass == 0.0   ? body(touched.a).velocity_world
           : body(touched.b).inertia.inverse_mass == 0.0 ? body(touched.b).velocity_world
                                                         : Vector3d(Vector3d::Zero());
  };
  const Vector3d driven = frame();
  for (const auto& [index, from] : before) {
    const Body& now = body(index);
    energy.add(now.inertia, now.world_from_body, from, {now.velocity_world, now.omega_world},
               driven);
  }
  return energy;
}

}  // namespace tumble::engines
