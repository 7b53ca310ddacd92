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

/// Of a turn about z: cosine and sine of half its angle.
struct Twist {
  double c, s;
};

/// q times the turn.
Quaterniond twisted_about_z(const Quaterniond& q, Twist by) {
  return {q.w() * by.c - q.z() * by.s, q.x() * by.c + q.y() * by.s, q.y() * by.c - q.x() * by.s,
          q.z() * by.c + q.w() * by.s};
}

/// The part of a turn that is about z.
Twist twist_about_z(const Quaterniond& turn) {
  const double length = std::sqrt(turn.w() * turn.w() + turn.z() * turn.z());
  if (length == 0.0) return {1.0, 0.0};
  return {turn.w() / length, turn.z() / length};
}

Quaterniond turn_of(const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0.0) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

}  // namespace

/// @return whether one of them stood or moved in another way before
bool ArticulatedTree::set_fixed(const std::vector<FixedEnd>& fixed) {
  bool is_new = false;
  for (std::size_t k = 0; k < fixed.size(); ++k) {
    Motion& motion = motions_[nodes_.size() + k];
    is_new = is_new || motion.q.coeffs() != fixed[k].world_from_body.coeffs() ||
             motion.c != fixed[k].com_world || motion.v != fixed[k].velocity_world ||
             motion.a != fixed[k].acceleration_world;
    motion.q = fixed[k].world_from_body;
    motion.R = motion.q.toRotationMatrix();
    motion.c = fixed[k].com_world;
    motion.v = fixed[k].velocity_world;
    motion.a = fixed[k].acceleration_world;
    motion.w.setZero();
  }
  return is_new;
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
  const Quaterniond parent_from_joint =
      angle == 0.0 ? node.at_begin
                   : twisted_about_z(node.at_begin, {std::cos(0.5 * angle), std::sin(0.5 * angle)});
  const Quaterniond parent_from_own = parent_from_joint * node.joint_from_own;
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
  if (node.turns_evenly) return;
  motion.R = motion.q.toRotationMatrix();
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
  is_factored_ = false;
  VectorXd y = VectorXd::Zero(2 * half_);
  const Index half = half_;
  Misfit misfit;
  for (const int place : order_) {
    Node& node = nodes_[static_cast<std::size_t>(place)];
    Motion& motion = motions_[static_cast<std::size_t>(place)];
    const RigidBodyState& state = states[static_cast<std::size_t>(place)];
    motion.q = state.world_from_body.normalized();
    motion.q_length = 1.0;
    const Vector3d omega_body = omega_body_of(state, node.inertia_body, node.inverse_inertia_body);
    const Vector3d v = state.momentum_world / node.mass, w = motion.q * omega_body;
    motion.w = w;
    Index at = node.at;
    // How the body stands against its parent, by what its joint leaves free.
    if (node.kind == TreeJoint::kFree) {
      motion.c = state.com_world;
      motion.v = v;
      y.segment<3>(at) = motion.c;
      y.segment<3>(half + at) = motion.v;
      at += 3;
    } else {
      move_parent_point(node, motion);
      if (node.kind == TreeJoint::kRod) {
        const Vector3d arm = motion.q * node.point_own;
        const Vector3d apart = state.com_world + arm - motion.c,
                       parting = v + w.cross(arm) - motion.v;
        const Vector3d u = apart.normalized(), rate = parting / node.length;
        motion.u_length = 1.0;
        motion.u_along = 0.0;
        motion.u = u;
        motion.u_rate = rate - u.dot(rate) * u;
        y.segment<3>(at) = motion.u;
        y.segment<3>(half + at) = motion.u_rate;
        motion.c += node.length * motion.u;
        motion.v += node.length * motion.u_rate;
        at += 3;
      } else if (node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld) {
        const Motion& parent = motions_[static_cast<std::size_t>(node.parent)];
        const Quaterniond turned = (parent.q * node.parent_from_joint).conjugate() * motion.q *
                                   node.joint_from_own.conjugate();
        node.at_begin = node.kind == TreeJoint::kHinge
                            ? twisted_about_z(node.parent_from_joint, twist_about_z(turned))
                            : node.parent_from_joint;
        double rate = 0.0;
        if (node.kind == TreeJoint::kHinge) {
          const Vector3d axis = parent.q * node.axis_parent;
          rate = axis.dot(w - parent.w);
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
    misfit.add(state, v, w, node, motion, size_);
  }
  misfit_ = std::max(std::sqrt(misfit.apart) / size_, std::sqrt(misfit.turned));
  if (misfit.parting > 0.0) misfit_ += std::sqrt(misfit.parting / misfit.fastest);
  stands_at_ = y;
  return y;
}

void ArticulatedTree::Misfit::add(const RigidBodyState& state, const Vector3d& v, const Vector3d& w,
                                  const Node& node, const Motion& motion, double size) {
  apart = std::max(apart, (state.com_world - motion.c).squaredNorm());
  parting = std::max(parting, (v - motion.v).squaredNorm());
  fastest = std::max({fastest, v.squaredNorm(), size * size * motion.w.squaredNorm()});
  if (node.kind != TreeJoint::kHinge && node.kind != TreeJoint::kWeld) return;
  turned = std::max(turned, (state.world_from_body.conjugate() * motion.q).vec().squaredNorm());
  parting = std::max(parting, size * size * (w - motion.w).squaredNorm());
}

void ArticulatedTree::stand_at(const VectorXd& y, const std::vector<FixedEnd>& fixed) {
  require(y.size() == 2 * half_, "an articulated tree has as many numbers as begin() returned");
  if (!set_fixed(fixed) && y.size() == stands_at_.size() && y == stands_at_) return;
  stands_at_ = y;
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

VectorXd ArticulatedTree::rates_of_places(const VectorXd& y) const {
  VectorXd rate = VectorXd::Zero(2 * half_);
  const Index half = half_;
  for (const Node& node : nodes_) {
    Index at = node.at;
    if (node.kind == TreeJoint::kFree) {
      rate.segment<3>(at) = y.segment<3>(half + at);
      at += 3;
    }
    if (node.kind == TreeJoint::kRod) {
      const Vector3d u = y.segment<3>(at).normalized();
      const Vector3d u_rate = y.segment<3>(half + at);
      rate.segment<3>(at) = y.segment<3>(at).norm() * (u_rate - u.dot(u_rate) * u);
      at += 3;
    }
    if (node.kind == TreeJoint::kHinge) rate[at] = y[half + at];
    if (node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld || node.turns_evenly)
      continue;
    const Vector3d w = 0.5 * y.segment<3>(half + at);
    const Quaterniond turning =
        Quaterniond(y[at], y[at + 1], y[at + 2], y[at + 3]) * Quaterniond(0.0, w.x(), w.y(), w.z());
    rate.segment<4>(at) << turning.w(), turning.x(), turning.y(), turning.z();
  }
  return rate;
}

}  // namespace tumble
