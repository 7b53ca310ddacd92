// Coordinates of an articulated tree: from states of bodies and back.
#include <cmath>

#include "framework/core/error.h"
#include "framework/dynamics/articulated_tree.h"

namespace tumble {
namespace {

using Eigen::Index;

// Each step writes I w and reads it back. An inverse rounded once for all would multiply w by the
// same 1 + eps every time, which adds up with the steps; with what it leaves solved for again, w
// comes back as it went.
Vector3d omega_body_of(const RigidBodyState& state, const Matrix3d& inertia_body,
                       const Matrix3d& inverse_inertia_body) {
  const Quaterniond& q = state.world_from_body;
  const Vector3d momentum_body = q.conjugate() * state.angular_momentum_world;
  const Vector3d omega_body = inverse_inertia_body * momentum_body;
  return omega_body + inverse_inertia_body * (momentum_body - inertia_body * omega_body);
}

/// q times the turn about z by this angle.
Quaterniond turned_about_z(const Quaterniond& q, double angle) {
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
  return {q.w() * c - q.z() * s, q.x() * c + q.y() * s, q.y() * c - q.x() * s,
          q.z() * c + q.w() * s};
}

/// The part of a turn that is about z.
Quaterniond twist_about_z(const Quaterniond& turn) {
  const double length = std::hypot(turn.w(), turn.z());
  if (length == 0.0) return Quaterniond::Identity();
  return {turn.w() / length, 0.0, 0.0, turn.z() / length};
}

/// R I R^T, which is symmetric: R I first, then six of its entries.
Matrix3d turned_inertia(const Matrix3d& R, const Matrix3d& inertia_body) {
  const Matrix3d half = R * inertia_body;
  Matrix3d turned;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      turned(i, j) = turned(j, i) =
          half(i, 0) * R(j, 0) + half(i, 1) * R(j, 1) + half(i, 2) * R(j, 2);
  return turned;
}

Quaterniond turn_of(const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0.0) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

}  // namespace

void ArticulatedTree::set_fixed(const std::vector<FixedEnd>& fixed) {
  for (std::size_t k = 0; k < fixed.size(); ++k) {
    Motion& motion = motions_[nodes_.size() + k];
    motion.q = fixed[k].world_from_body;
    motion.R = motion.q.toRotationMatrix();
    motion.c = fixed[k].com_world;
    motion.v = fixed[k].velocity_world;
    motion.a = fixed[k].acceleration_world;
    motion.w.setZero();
  }
}

// The joint's point on the parent becomes the body's place, for now.
void ArticulatedTree::move_parent_point(const Node& node, Motion& motion) const {
  const Motion& parent = motions_[static_cast<std::size_t>(node.parent)];
  motion.c = parent.c;
  motion.v = parent.v;
  motion.arm_parent.setZero();
  motion.centripetal_parent.setZero();
  if (node.at_parent_centre) return;
  motion.arm_parent = parent.R * node.point_parent;
  const Vector3d turning = parent.w.cross(motion.arm_parent);
  motion.c += motion.arm_parent;
  motion.v += turning;
  motion.centripetal_parent = parent.w.cross(turning);
}

void ArticulatedTree::turn_by_joint(const Node& node, double angle, double rate,
                                    Motion& motion) const {
  const Motion& parent = motions_[static_cast<std::size_t>(node.parent)];
  const Quaterniond parent_from_own =
      node.kind == TreeJoint::kHinge ? turned_about_z(node.at_begin, angle) * node.joint_from_own
                                     : node.at_begin * node.joint_from_own;
  motion.q = parent.q * parent_from_own;
  motion.w = parent.w;
  motion.angle_rate = rate;
  if (node.kind == TreeJoint::kWeld) return;
  motion.axis = parent.R * node.axis_parent;
  motion.w += rate * motion.axis;
}

// From the joint's point to the centre.
void ArticulatedTree::settle_arms(const Node& node, Motion& motion) const {
  motion.arm_own.setZero();
  motion.centripetal_own.setZero();
  if (node.turns_evenly) {
    motion.inertia = node.inertia_body;
    return;
  }
  motion.R = motion.q.toRotationMatrix();
  motion.inertia = node.is_even ? node.inertia_body : turned_inertia(motion.R, node.inertia_body);
  if (node.at_own_centre) return;
  motion.arm_own = motion.R * node.point_own;
  const Vector3d turning = motion.w.cross(motion.arm_own);
  motion.c -= motion.arm_own;
  motion.v -= turning;
  motion.centripetal_own = motion.w.cross(turning);
}

VectorXd ArticulatedTree::units(double length) const {
  VectorXd units = VectorXd::Ones(2 * half_);
  for (const Node& node : nodes_)
    if (node.kind == TreeJoint::kFree)
      for (const Index at : {Index{node.at}, Index{half_ + node.at}})
        units.segment<3>(at).setConstant(length);
  return units;
}

VectorXd ArticulatedTree::begin(const std::vector<RigidBodyState>& states,
                                const std::vector<FixedEnd>& fixed, bool turns_freely) {
  for (Node& node : nodes_) node.turns_evenly = turns_freely && node.may_turn_evenly;
  assign_numbers();
  set_fixed(fixed);
  VectorXd y = VectorXd::Zero(2 * half_);
  const Index half = half_;
  for (const int place : order_) {
    Node& node = nodes_[static_cast<std::size_t>(place)];
    Motion& motion = motions_[static_cast<std::size_t>(place)];
    const RigidBodyState& state = states[static_cast<std::size_t>(place)];
    motion.q = state.world_from_body.normalized();
    const Vector3d omega_body = omega_body_of(state, node.inertia_body, node.inverse_inertia_body);
    motion.w = motion.q * omega_body;
    Index at = node.at;
    // How the body stands against its parent, by what its joint leaves free.
    if (node.kind == TreeJoint::kFree) {
      motion.c = state.com_world;
      motion.v = state.momentum_world / node.mass;
      y.segment<3>(at) = motion.c;
      y.segment<3>(half + at) = motion.v;
      at += 3;
    } else {
      move_parent_point(node, motion);
      const Vector3d arm = motion.q * node.point_own;
      const Vector3d apart = state.com_world + arm - motion.c,
                     parting = state.momentum_world / node.mass + motion.w.cross(arm) - motion.v;
      if (node.kind == TreeJoint::kRod) {
        const Vector3d u = apart.normalized(), rate = parting / node.length;
        y.segment<3>(at) = u;
        y.segment<3>(half + at) = rate - u.dot(rate) * u;
        motion.c += node.length * u;
        motion.v += node.length * y.segment<3>(half + at);
        at += 3;
      } else if (node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld) {
        const Motion& parent = motions_[static_cast<std::size_t>(node.parent)];
        const Quaterniond turned = (parent.q * node.parent_from_joint).conjugate() * motion.q *
                                   node.joint_from_own.conjugate();
        node.at_begin = node.kind == TreeJoint::kHinge
                            ? Quaterniond(node.parent_from_joint * twist_about_z(turned))
                            : node.parent_from_joint;
        double rate = 0.0;
        if (node.kind == TreeJoint::kHinge) {
          const Vector3d axis = parent.q * node.axis_parent;
          rate = axis.dot(motion.w - parent.w);
          y[half + at] = rate;
        }
        turn_by_joint(node, 0.0, rate, motion);
      }
    }
    if (node.kind != TreeJoint::kHinge && node.kind != TreeJoint::kWeld) {
      node.at_begin = motion.q;
      if (!node.turns_evenly) {
        y.segment<4>(at) << motion.q.w(), motion.q.x(), motion.q.y(), motion.q.z();
        y.segment<3>(half + at) = omega_body;
      }
    }
    settle_arms(node, motion);
  }
  measure_misfit(states);
  return y;
}

void ArticulatedTree::measure_misfit(const std::vector<RigidBodyState>& states) {
  double apart = 0.0, turned = 0.0, parting = 0.0, fastest = 0.0;
  for (int place = 0; place < movable(); ++place) {
    const Node& node = nodes_[static_cast<std::size_t>(place)];
    const Motion& motion = motions_[static_cast<std::size_t>(place)];
    const RigidBodyState& state = states[static_cast<std::size_t>(place)];
    const Vector3d v = state.momentum_world / node.mass;
    apart = std::max(apart, (state.com_world - motion.c).norm());
    parting = std::max(parting, (v - motion.v).norm());
    fastest = std::max({fastest, v.norm(), size_ * motion.w.norm()});
    if (node.kind != TreeJoint::kHinge && node.kind != TreeJoint::kWeld) continue;
    const Vector3d w =
        state.world_from_body * omega_body_of(state, node.inertia_body, node.inverse_inertia_body);
    turned = std::max(turned, (state.world_from_body.conjugate() * motion.q).vec().norm());
    parting = std::max(parting, size_ * (w - motion.w).norm());
  }
  misfit_ = std::max(apart / size_, turned) + (parting > 0.0 ? parting / fastest : 0.0);
}

void ArticulatedTree::stand_at(const VectorXd& y, const std::vector<FixedEnd>& fixed) {
  require(y.size() == 2 * half_, "an articulated tree has as many numbers as begin() returned");
  set_fixed(fixed);
  is_factored_ = false;
  const Index half = half_;
  for (const int place : order_) {
    const Node& node = nodes_[static_cast<std::size_t>(place)];
    Motion& motion = motions_[static_cast<std::size_t>(place)];
    Index at = node.at;
    if (node.kind == TreeJoint::kFree) {
      motion.c = y.segment<3>(at);
      motion.v = y.segment<3>(half + at);
      at += 3;
    } else {
      move_parent_point(node, motion);
    }
    if (node.kind == TreeJoint::kRod) {
      motion.u_length = y.segment<3>(at).norm();
      motion.u = y.segment<3>(at) / motion.u_length;
      motion.u_along = motion.u.dot(y.segment<3>(half + at));
      motion.u_rate = y.segment<3>(half + at) - motion.u_along * motion.u;
      motion.c += node.length * motion.u;
      motion.v += node.length * motion.u_rate;
      at += 3;
    }
    if (node.kind == TreeJoint::kHinge) {
      turn_by_joint(node, y[at], y[half + at], motion);
    } else if (node.kind == TreeJoint::kWeld) {
      turn_by_joint(node, 0.0, 0.0, motion);
    } else if (!node.turns_evenly) {
      motion.q_length = y.segment<4>(at).norm();
      motion.q =
          Quaterniond(Eigen::Vector4d(y[at + 1], y[at + 2], y[at + 3], y[at]) / motion.q_length);
      motion.w = motion.q * Vector3d(y.segment<3>(half + at));
    }
    settle_arms(node, motion);
  }
}

RigidBodyState ArticulatedTree::state(int body, double since_begin) const {
  const Node& node = nodes_[static_cast<std::size_t>(body)];
  const Motion& motion = motions_[static_cast<std::size_t>(body)];
  RigidBodyState state;
  state.com_world = motion.c;
  state.momentum_world = node.mass * motion.v;
  if (node.turns_evenly) {
    state.world_from_body = (turn_of(since_begin * motion.w) * node.at_begin).normalized();
    state.angular_momentum_world = node.inertia_body(0, 0) * motion.w;
    return state;
  }
  state.world_from_body = motion.q.normalized();
  state.angular_momentum_world =
      state.world_from_body * (node.inertia_body * (state.world_from_body.conjugate() * motion.w));
  return state;
}

Eigen::Matrix<double, 6, 1> ArticulatedTree::acceleration(int body) const {
  const Solved& solved = solved_[static_cast<std::size_t>(body)];
  Eigen::Matrix<double, 6, 1> acceleration;
  acceleration << solved.a, solved.alpha;
  return acceleration;
}

// u' = |u| w, w' = u'' + (u . w_y) w for w across u, w_y as y says it: u/|u| and w then move as the
// exact ones do, whatever stages have left of |u| = 1 and u . w_y = 0.
VectorXd ArticulatedTree::rate() const {
  VectorXd rate = VectorXd::Zero(2 * half_);
  const Index half = half_;
  for (const int place : order_) {
    const Node& node = nodes_[static_cast<std::size_t>(place)];
    const Motion& motion = motions_[static_cast<std::size_t>(place)];
    const Solved& solved = solved_[static_cast<std::size_t>(place)];
    Index at = node.at;
    if (node.kind == TreeJoint::kFree) {
      rate.segment<3>(at) = motion.v;
      rate.segment<3>(half + at) = solved.a;
      at += 3;
    }
    if (node.kind == TreeJoint::kRod) {
      rate.segment<3>(at) = motion.u_length * motion.u_rate;
      rate.segment<3>(half + at) = solved.joint / node.length + motion.u_along * motion.u_rate;
      at += 3;
    }
    if (node.kind == TreeJoint::kHinge) {
      rate[at] = motion.angle_rate;
      rate[half + at] = solved.joint[0];
      continue;
    }
    if (node.kind == TreeJoint::kWeld || node.turns_evenly) continue;
    // q' = q (0, omega_body) / 2
    const Vector3d w = motion.q_length * (motion.q.conjugate() * motion.w);
    const Quaterniond turning = motion.q * Quaterniond(0.0, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z());
    rate.segment<4>(at) << turning.w(), turning.x(), turning.y(), turning.z();
    rate.segment<3>(half + at) = motion.q.conjugate() * solved.alpha;
  }
  return rate;
}

}  // namespace tumble
