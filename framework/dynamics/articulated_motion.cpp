// The articulated-body algorithm: from the leaves to the roots what each body asks of its joint,
//   F = M a + H alpha + f,      N = H^T a + J alpha + n      about its centre                 (R.2)
// then from the roots to the leaves what its joint gives. About the joint's point, at the arm d
// from the centre, with D = [d]x, a = a_point + D alpha - w x (w x d):
//   H_p = H + M D,   J_p = J + H^T D + D^T H + D^T M D,
//   f_p = f - M c,   n_p = n - H^T c - d x f_p
// A joint leaves some accelerations free, and these follow from the forces that it cannot take:
//   ball    N_p = 0:              alpha = -J_p^-1 (H_p^T a_p + n_p)                         (R.3)
//   rod     F across u = 0 too:   F = lambda u,  u . (a_own - a_parent) = -L |u'|^2         (R.4)
//   hinge   k . N_p = 0:          theta'' = -(h . a_p + j . alpha + s) / (k . J_p k)        (R.5)
// A rod's mass is none: what it passes on to its parent is the mass (u . M_b^-1 u)^-1 along u,
// which is regular however it stands.
#include "framework/core/error.h"
#include "framework/dynamics/articulated_tree.h"

namespace tumble {
namespace {

/// M [d]x, its columns from those of M.
Matrix3d times_cross(const Matrix3d& M, const Vector3d& d) {
  Matrix3d product;
  product.col(0) = d.z() * M.col(1) - d.y() * M.col(2);
  product.col(1) = d.x() * M.col(2) - d.z() * M.col(0);
  product.col(2) = d.y() * M.col(0) - d.x() * M.col(1);
  return product;
}
/// [d]x^T M
Matrix3d cross_transposed_times(const Vector3d& d, const Matrix3d& M) {
  Matrix3d product;
  for (int column = 0; column < 3; ++column) product.col(column) = M.col(column).cross(d);
  return product;
}
/// Adds X + X^T.
void add_with_transposed(const Matrix3d& X, double sign, Matrix3d& sum) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum(i, j) += sign * (X(i, j) + X(j, i));
}
/// Takes factor a b^T away.
void take_product(double factor, const Vector3d& a, const Vector3d& b, Matrix3d& from) {
  for (int j = 0; j < 3; ++j) from.col(j) -= (factor * b[j]) * a;
}

}  // namespace

void ArticulatedTree::factor() {
  for (int place = 0; place < movable(); ++place) {
    const Node& node = nodes_[static_cast<std::size_t>(place)];
    Articulated& held = held_[static_cast<std::size_t>(place)];
    held.M = node.mass * Matrix3d::Identity();
    held.coupled = false;
    if (!node.is_point) held.H.setZero();
    if (!node.turns_evenly) held.J = motions_[static_cast<std::size_t>(place)].inertia;
  }
  for (auto place = order_.rbegin(); place != order_.rend(); ++place) {
    factor_joint(*place);
    add_to_parent(*place);
  }
}

void ArticulatedTree::factor_joint(int place) {
  const Node& node = nodes_[static_cast<std::size_t>(place)];
  const Motion& motion = motions_[static_cast<std::size_t>(place)];
  Articulated& held = held_[static_cast<std::size_t>(place)];
  // About the joint's point.
  Matrix3d Jp;
  if (!node.turns_evenly) Jp = held.J;
  bool coupled = held.coupled;
  if (coupled) held.Hp = held.H;
  if (!node.at_own_centre && node.kind != TreeJoint::kFree) {
    const Vector3d& d = motion.arm_own;
    const Matrix3d MD = times_cross(held.M, d);
    if (coupled) add_with_transposed(times_cross(held.H.transpose(), d), 1.0, Jp);
    Jp += cross_transposed_times(d, MD);
    if (coupled)
      held.Hp += MD;
    else
      held.Hp = MD;
    coupled = true;
  }
  held.coupled = coupled;
  // A hinge frees one turning, a weld none: what is left goes up whole.
  held.M_up = held.M;
  if (node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld) {
    if (!coupled) held.Hp.setZero();
    held.H_up = held.Hp;
    held.J_up = held.Jp = Jp;
    if (node.kind == TreeJoint::kWeld) return;
    held.h = held.Hp * motion.axis;
    held.j = Jp * motion.axis;
    held.along = 1.0 / motion.axis.dot(held.j);
    take_product(held.along, held.h, held.h, held.M_up);
    take_product(held.along, held.h, held.j, held.H_up);
    take_product(held.along, held.j, held.j, held.J_up);
    return;
  }
  // All others free all turning.
  if (!node.turns_evenly) held.Jp_inverse = Jp.inverse();
  if (coupled) {
    held.K.noalias() = held.Hp * held.Jp_inverse;
    held.M_up -= held.K * held.Hp.transpose();
  }
  if (node.kind == TreeJoint::kBall) return;
  held.Mb_inverse = held.M_up.inverse();
  if (node.kind == TreeJoint::kFree) return;
  held.x = held.Mb_inverse * motion.u;
  held.along = 1.0 / motion.u.dot(held.x);
}

void ArticulatedTree::add_to_parent(int place) {
  const Node& node = nodes_[static_cast<std::size_t>(place)];
  if (node.parent < 0 || node.parent >= movable()) return;
  const Motion& motion = motions_[static_cast<std::size_t>(place)];
  const Articulated& held = held_[static_cast<std::size_t>(place)];
  const bool whole = node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld;
  Articulated& parent = held_[static_cast<std::size_t>(node.parent)];
  Matrix3d along_rod;
  if (node.kind == TreeJoint::kRod) {
    along_rod.setZero();
    take_product(-held.along, motion.u, motion.u, along_rod);
  }
  const Matrix3d& M = node.kind == TreeJoint::kRod ? along_rod : held.M_up;
  parent.M += M;
  if (whole) {
    parent.H += held.H_up;
    parent.J += held.J_up;
    parent.coupled = true;
  }
  if (node.at_parent_centre) return;
  const Vector3d& d = motion.arm_parent;
  const Matrix3d MD = times_cross(M, d);
  parent.H -= MD;
  parent.J += cross_transposed_times(d, MD);
  parent.coupled = true;
  if (whole) add_with_transposed(times_cross(held.H_up.transpose(), d), -1.0, parent.J);
}

// From the leaves to the roots: f and n of (R.2).
void ArticulatedTree::gather(int place, bool with_velocities) {
  const Node& node = nodes_[static_cast<std::size_t>(place)];
  const Motion& motion = motions_[static_cast<std::size_t>(place)];
  const Articulated& held = held_[static_cast<std::size_t>(place)];
  Solved& solved = solved_[static_cast<std::size_t>(place)];
  // About the joint's point.
  solved.f_joint = solved.f;
  solved.n_joint = solved.n;
  if (!node.at_own_centre) {
    if (with_velocities) {
      solved.f_joint -= held.M * motion.centripetal_own;
      // H^T c, of H = H_p - M D
      solved.n_joint -= held.Hp.transpose() * motion.centripetal_own +
                        motion.arm_own.cross(held.M * motion.centripetal_own);
    }
    solved.n_joint -= motion.arm_own.cross(solved.f_joint);
  }
  // What the joint takes of it.
  Vector3d f = solved.f_joint, n = solved.n_joint;
  const bool whole = node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld;
  if (!whole) {
    if (held.coupled) f -= held.K * n;
    solved.f_point = f;
    if (node.kind == TreeJoint::kFree) return;
    if (node.kind == TreeJoint::kRod) {
      solved.bias = held.x.dot(f);
      if (with_velocities) solved.bias -= node.length * motion.u_rate.squaredNorm();
      solved.bias *= held.along;
      f = solved.bias * motion.u;
    }
  } else if (node.kind == TreeJoint::kHinge) {
    if (with_velocities) {
      // alpha = alpha_parent + theta'' k + w_parent x theta' k
      const Vector3d turning =
          motions_[static_cast<std::size_t>(node.parent)].w.cross(motion.angle_rate * motion.axis);
      f += held.Hp * turning;
      n += held.Jp * turning;
    }
    solved.bias = held.along * motion.axis.dot(n);
    f -= solved.bias * held.h;
    n -= solved.bias * held.j;
  }
  if (node.parent >= movable()) return;
  // About the parent's centre.
  Solved& parent = solved_[static_cast<std::size_t>(node.parent)];
  if (!node.at_parent_centre) {
    if (with_velocities) {
      if (node.kind == TreeJoint::kRod)
        f += held.along * motion.u.dot(motion.centripetal_parent) * motion.u;
      else
        f += held.M_up * motion.centripetal_parent;
      if (whole) n += held.H_up.transpose() * motion.centripetal_parent;
    }
    parent.n += motion.arm_parent.cross(f);
  }
  parent.f += f;
  if (whole) parent.n += n;
}

// From the roots to the leaves: accelerations.
void ArticulatedTree::release(int place, bool with_velocities) {
  const Node& node = nodes_[static_cast<std::size_t>(place)];
  const Motion& motion = motions_[static_cast<std::size_t>(place)];
  const Articulated& held = held_[static_cast<std::size_t>(place)];
  Solved& solved = solved_[static_cast<std::size_t>(place)];
  // Of the joint's point on the parent.
  Vector3d a = Vector3d::Zero(), alpha = Vector3d::Zero();
  if (node.kind != TreeJoint::kFree) {
    const Solved& parent = solved_[static_cast<std::size_t>(node.parent)];
    a = parent.a;
    alpha = parent.alpha;
    if (!node.at_parent_centre) {
      a += parent.alpha.cross(motion.arm_parent);
      if (with_velocities) a += motion.centripetal_parent;
    }
  }
  // Of the joint's point on the body, and its turning.
  switch (node.kind) {
    case TreeJoint::kFree: a = -(held.Mb_inverse * solved.f_point); break;
    case TreeJoint::kRod: {
      const Vector3d& u = motion.u;
      solved.along_rod = held.along * u.dot(a) + solved.bias;
      const Vector3d apart = held.Mb_inverse * (solved.along_rod * u - solved.f_point) - a;
      solved.joint = apart - u.dot(apart) * u;
      if (with_velocities) solved.joint -= node.length * motion.u_rate.squaredNorm() * u;
      a += solved.joint;
      break;
    }
    case TreeJoint::kHinge: {
      if (with_velocities)
        alpha += motions_[static_cast<std::size_t>(node.parent)].w.cross(motion.angle_rate *
                                                                         motion.axis);
      const double turning =
          -held.along *
              (held.h.dot(a) + held.j.dot(solved_[static_cast<std::size_t>(node.parent)].alpha)) -
          solved.bias;
      solved.joint = {turning, 0.0, 0.0};
      alpha += turning * motion.axis;
      break;
    }
    case TreeJoint::kBall:
    case TreeJoint::kWeld: break;
  }
  if (node.kind != TreeJoint::kHinge && node.kind != TreeJoint::kWeld) {
    if (node.turns_evenly) {
      alpha.setZero();
    } else {
      Vector3d n = solved.n_joint;
      if (held.coupled) n += held.Hp.transpose() * a;
      alpha = -(held.Jp_inverse * n);
    }
  }
  solved.alpha = alpha;
  solved.a = a;
  if (node.at_own_centre) return;
  solved.a -= alpha.cross(motion.arm_own);
  if (with_velocities) solved.a -= motion.centripetal_own;
}

void ArticulatedTree::solve(const std::vector<Wrench>& wrenches, bool with_velocities) {
  for (int place = 0; place < movable(); ++place) {
    const Node& node = nodes_[static_cast<std::size_t>(place)];
    Solved& solved = solved_[static_cast<std::size_t>(place)];
    const Wrench& wrench = wrenches[static_cast<std::size_t>(place)];
    solved.f = -wrench.force_world;
    if (node.turns_evenly) {
      solved.n.setZero();
      continue;
    }
    const Motion& motion = motions_[static_cast<std::size_t>(place)];
    solved.n = -wrench.torque_world;
    if (with_velocities && !node.is_even) solved.n += motion.w.cross(motion.inertia * motion.w);
  }
  for (std::size_t place = nodes_.size(); place < solved_.size(); ++place) {
    solved_[place].alpha.setZero();
    solved_[place].a.setZero();
    if (with_velocities) solved_[place].a = motions_[place].a;
  }
  for (auto place = order_.rbegin(); place != order_.rend(); ++place)
    gather(*place, with_velocities);
  for (const int place : order_) release(place, with_velocities);
}

void ArticulatedTree::accelerate(const std::vector<Wrench>& wrenches) {
  if (!is_factored_) factor();
  is_factored_ = true;
  solve(wrenches, true);
}

// Newton's law from the leaves to the roots: m a is what acts on the body, its own joint, and the
// opposite of what its children are held by.
std::vector<Vector3d> ArticulatedTree::joint_forces(const std::vector<Wrench>& wrenches) const {
  std::vector<Vector3d> forces(nodes_.size(), Vector3d::Zero());
  for (auto at = order_.rbegin(); at != order_.rend(); ++at) {
    const auto place = static_cast<std::size_t>(*at);
    const Node& node = nodes_[place];
    forces[place] += node.mass * solved_[place].a - wrenches[place].force_world;
    if (node.parent >= 0 && node.parent < movable())
      forces[static_cast<std::size_t>(node.parent)] += forces[place];
    if (node.kind == TreeJoint::kFree) forces[place].setZero();
  }
  return forces;
}

VectorXd ArticulatedTree::response(const std::vector<Wrench>& wrenches) {
  if (!is_factored_) factor();
  is_factored_ = true;
  solve(wrenches, false);
  VectorXd all(6 * static_cast<Eigen::Index>(nodes_.size()));
  for (int place = 0; place < movable(); ++place)
    all.segment<6>(6 * static_cast<Eigen::Index>(place)) = acceleration(place);
  return all;
}

}  // namespace tumble
