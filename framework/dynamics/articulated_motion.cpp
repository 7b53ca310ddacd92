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
/// J + sign (H^T D + D^T Hp), D = [d]x: symmetric, as its three terms are together.
Matrix3d moved(const Matrix3d& J, double sign, const Matrix3d& H, const Matrix3d& Hp,
               const Vector3d& d) {
  const double x = sign * d.x(), y = sign * d.y(), z = sign * d.z();
  // (H^T D)_ij = (D^T H)_ji: rows of [d]x^T
  const auto entry = [&](int i, int j) {
    const auto row = [&](const Matrix3d& M, int k, int column) {
      return k == 0   ? z * M(1, column) - y * M(2, column)
             : k == 1 ? x * M(2, column) - z * M(0, column)
                      : y * M(0, column) - x * M(1, column);
    };
    return J(i, j) + (row(H, j, i) + row(Hp, i, j));
  };
  Matrix3d sum;
  sum(0, 0) = entry(0, 0);
  sum(1, 1) = entry(1, 1);
  sum(2, 2) = entry(2, 2);
  sum(0, 1) = sum(1, 0) = entry(0, 1);
  sum(0, 2) = sum(2, 0) = entry(0, 2);
  sum(1, 2) = sum(2, 1) = entry(1, 2);
  return sum;
}
/// M - factor a a^T of a symmetric M
Matrix3d without(const Matrix3d& M, double factor, const Vector3d& a) {
  const Vector3d b = factor * a;
  Matrix3d rest;
  rest(0, 0) = M(0, 0) - b.x() * a.x();
  rest(1, 1) = M(1, 1) - b.y() * a.y();
  rest(2, 2) = M(2, 2) - b.z() * a.z();
  rest(0, 1) = rest(1, 0) = M(0, 1) - b.x() * a.y();
  rest(0, 2) = rest(2, 0) = M(0, 2) - b.x() * a.z();
  rest(1, 2) = rest(2, 1) = M(1, 2) - b.y() * a.z();
  return rest;
}

/// R I R^T, which is symmetric: R I first, then six of its entries.
Matrix3d turned_inertia(const Matrix3d& R, const Matrix3d& inertia_body, bool is_principal) {
  Matrix3d half;
  if (is_principal)
    half.noalias() = R * inertia_body.diagonal().asDiagonal();
  else
    half.noalias() = R * inertia_body;
  Matrix3d turned;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      turned(i, j) = turned(j, i) =
          half(i, 0) * R(j, 0) + half(i, 1) * R(j, 1) + half(i, 2) * R(j, 2);
  return turned;
}

}  // namespace

void ArticulatedTree::factor() {
  for (int place = 0; place < movable(); ++place) {
    const Node& node = nodes_[static_cast<std::size_t>(place)];
    Articulated& held = held_[static_cast<std::size_t>(place)];
    held.M = node.mass * Matrix3d::Identity();
    held.coupled = false;
    if (!node.is_point) held.H.setZero();
    if (node.turns_evenly) continue;
    Motion& motion = motions_[static_cast<std::size_t>(place)];
    motion.inertia = node.is_even ? node.inertia_body
                                  : turned_inertia(motion.R, node.inertia_body, node.is_principal);
    held.J = motion.inertia;
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
  const bool has_arm = !node.at_own_centre && node.kind != TreeJoint::kFree;
  if (has_arm) {
    const Matrix3d H = coupled ? held.H : Matrix3d::Zero().eval();
    const Matrix3d Hp = H + times_cross(held.M, motion.arm_own);
    Jp = moved(held.J, 1.0, H, Hp, motion.arm_own);
    held.Hp = Hp;
    coupled = true;
  } else if (coupled) {
    held.Hp = held.H;
  }
  held.coupled = coupled;
  // A hinge frees one turning, a weld none: what is left goes up whole.
  if (node.kind == TreeJoint::kHinge || node.kind == TreeJoint::kWeld) {
    if (!coupled) held.Hp.setZero();
    held.Jp = Jp;
    if (node.kind == TreeJoint::kWeld) {
      held.M_up = held.M;
      held.H_up = held.Hp;
      held.J_up = Jp;
      return;
    }
    const Vector3d h = held.Hp * motion.axis, j = Jp * motion.axis;
    const double along = 1.0 / motion.axis.dot(j);
    held.M_up = without(held.M, along, h);
    held.H_up = held.Hp - h * (along * j).transpose();
    held.J_up = without(Jp, along, j);
    held.h = h;
    held.j = j;
    held.along = along;
    return;
  }
  held.M_up = held.M;
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
  const Matrix3d M = node.kind == TreeJoint::kRod
                         ? Matrix3d(motion.u * (held.along * motion.u).transpose())
                         : held.M_up;
  parent.M += M;
  if (node.at_parent_centre) {
    if (!whole) return;
    parent.H += held.H_up;
    parent.J += held.J_up;
    parent.coupled = true;
    return;
  }
  // About the parent's centre: (R.2) moved by the other way.
  const Vector3d& d = motion.arm_parent;
  const Matrix3d H = whole ? held.H_up : Matrix3d::Zero().eval();
  const Matrix3d at_centre = H - times_cross(M, d);
  parent.H += at_centre;
  parent.J += moved(whole ? held.J_up : Matrix3d::Zero().eval(), -1.0, H, at_centre, d);
  parent.coupled = true;
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
