/// Linked bodies in joint coordinates: a forest of bodies that hang on each other, and the
/// articulated-body algorithm, which gives their accelerations in time linear in their number.
///
/// A link of the forest is a joint that leaves its body some freedom against its parent.
/// Orientation and angular velocity of a body are its own ones (in the world), not those against
/// its parent, but at a hinge or a weld; so that no joint has angles with a singular posture:
///   free    centre c, unit quaternion q; v, omega         a body that hangs on nothing
///   ball    q; omega                                      one point of it is a point of the parent
///   rod     u, q; u', omega                               p_own = p_parent + L u, |u| = 1 (R.1)
///   hinge   theta; theta'                                 turns about an axis of the parent
///   weld    nothing
/// y holds all places, then all velocities in the same order, as many of them as places (a
/// quaternion's four places go with omega in the body frame and a zero). Where stages of a method
/// leave |q| = 1 or |u| = 1, y says what its directions say: every function of y takes q/|q|, u/|u|
/// and the part of u' across u, whose rates are such that this is exact.
///
/// What links say beyond a forest (a loop) is cut: cut() names these links, and who integrates adds
/// their rows (reduced_motion.h of engines/stepping).
///
/// Frames and units as in body.h. Sources: R. Featherstone, "The calculation of robot dynamics
/// using articulated-body inertias", IJRR 1983; "Rigid body dynamics algorithms", 2008, chapter 7.
#pragma once

#include <vector>

#include "framework/dynamics/tree_link.h"

namespace tumble {

/// A fixed end, or the world: nothing pushes it, it may move along.
struct FixedEnd {
  Vector3d com_world = Vector3d::Zero(), velocity_world = Vector3d::Zero(),
           acceleration_world = Vector3d::Zero();
  Quaterniond world_from_body = Quaterniond::Identity();
};

class ArticulatedTree {
 public:
  /// @param fixed_ends  how many; links name them as places bodies.size(), ...
  /// @pre no link between two fixed ends
  /// Links that leave less freedom are kept in the forest first: a loop is cut where this costs
  /// least rows. Bodies that no fixed end holds hang on the heaviest of them, which is free.
  ArticulatedTree(const std::vector<Inertia>& bodies, int fixed_ends,
                  const std::vector<TreeLink>& links);

  /// Places in `links` of those that close loops.
  const std::vector<int>& cut() const { return cut_; }
  /// How many links a body of the longest branch hangs on.
  int depth() const { return depth_; }

  /// Begins at these states and returns their coordinates, where this then stands. Velocities and
  /// places that links do not allow are taken as the links allow them.
  /// @param turns_freely  whether no torque will act on any body: balls held at their centres then
  ///   turn evenly, and y leaves their turning out
  VectorXd begin(const std::vector<RigidBodyState>& states, const std::vector<FixedEnd>& fixed,
                 bool turns_freely);
  /// The units of y where a length is worth `length`: of places and velocities of free bodies; all
  /// else are angles, directions, and these a second. [m]
  VectorXd units(double length) const;
  /// How far the states that begin() took are from what it made of them: of places in parts of the
  /// largest arm, of turnings [rad], of velocities in parts of the fastest.
  double misfit() const { return misfit_; }
  /// Stands where y says. @param fixed  at the same time
  /// Cost: O(bodies); where this stands there already, a look at y
  void stand_at(const VectorXd& y, const std::vector<FixedEnd>& fixed);
  /// Of a body, where this stands. @param since_begin  the time since begin() [s]
  RigidBodyState state(int body, double since_begin) const;
  /// As forces see a body; its orientation and angular velocity are not known where it turns
  /// evenly.
  void put(int body, Body& seen) const {
    const Motion& motion = motions_[static_cast<std::size_t>(body)];
    seen.com_world = motion.c;
    seen.world_from_body = motion.q;
    seen.velocity_world = motion.v;
    seen.omega_world = motion.w;
  }

  /// Accelerations under these forces, where this stands. @param wrenches  by body
  /// Cost: O(bodies)
  void accelerate(const std::vector<Wrench>& wrenches);
  /// What they add to accelerations, (6 a body): linear, angular, world. Cost: O(bodies)
  VectorXd response(const std::vector<Wrench>& wrenches);
  /// Accelerations of the last accelerate(), (6): linear, angular, world [m/s^2, rad/s^2].
  Eigen::Matrix<double, 6, 1> acceleration(int body) const;
  /// y', by the last accelerate().
  VectorXd rate() const;
  /// y' at y, of its places only; of velocities 0. Cost: O(bodies), no forces and no pass over them
  VectorXd rates_of_places(const VectorXd& y) const;
  /// What the rod on which a body hangs pulls with, by the last accelerate(): > 0 is a pull. [N]
  double tension(int body) const { return -solved_[static_cast<std::size_t>(body)].along_rod; }
  /// What pushes each body at the joint on which it hangs, by accelerate() under these forces; 0
  /// for a free body. World frame [N]. Cost: O(bodies)
  std::vector<Vector3d> joint_forces(const std::vector<Wrench>& wrenches) const;
  /// The link on which a body hangs: its place in `links`; -1 for a free body.
  int link_of(int body) const { return nodes_[static_cast<std::size_t>(body)].link; }

 private:
  struct Node {
    TreeJoint kind = TreeJoint::kFree;
    int parent = -1, link = -1;  // a place: a body, or behind them a fixed end; -1 for a free body
    Vector3d point_parent = Vector3d::Zero(), point_own = Vector3d::Zero();
    Quaterniond parent_from_joint, joint_from_own;
    double length = 0.0;
    double mass = 0.0;
    Matrix3d inertia_body, inverse_inertia_body;
    Vector3d axis_parent;          // of a hinge
    bool is_even = false;          // its principal moments are the same
    bool is_principal = false;     // inertia_body is diagonal
    bool at_own_centre = true;     // its joint's point is its centre
    bool at_parent_centre = true;  // and its parent's
    bool is_point = true;          // this, and all that hangs on it hangs at its centre
    bool may_turn_evenly = false;  // nothing but an outer torque would change its turning
    bool turns_evenly = false;     // since begin(): its turning is not in y
    Quaterniond at_begin;          // orientation; of a hinge or a weld: against the parent
    int at = 0;                    // its first number among the places of y
  };
  struct Motion {
    Quaterniond q = Quaterniond::Identity();
    Matrix3d R;
    Vector3d c = Vector3d::Zero(), v = Vector3d::Zero();  // of the centre
    Vector3d w;
    Vector3d arm_own, arm_parent, centripetal_own, centripetal_parent;
    Vector3d u, u_rate, axis;  // of a rod; of a hinge
    double q_length = 1.0, u_length = 1.0, u_along = 0.0, angle_rate = 0.0;
    Matrix3d inertia;
    Vector3d a = Vector3d::Zero();  // of a fixed end
  };
  // F = M a + H alpha + f, N = H^T a + J alpha + n: force and torque about the centre that a body
  // with all that hangs on it asks of its joint
  struct Articulated {
    Matrix3d M, H, J, Hp, Jp, Jp_inverse, K, Mb_inverse, M_up, H_up, J_up;
    Vector3d x, h, j;
    double along = 0.0;  // mass along a rod, or inverse inertia about a hinge
    bool coupled = false;
  };
  struct Solved {
    Vector3d f, n, f_joint, n_joint, f_point;
    double bias = 0.0, along_rod = 0.0;
    Vector3d joint;     // of a rod: L u''; of a hinge: theta'', 0, 0
    Vector3d a, alpha;  // accelerations
  };

  // The largest squares of what states are away from what begin() makes of them.
  struct Misfit {
    double apart = 0.0, turned = 0.0, parting = 0.0, fastest = 0.0;
    /// @param v, w  of the state
    void add(const RigidBodyState& state, const Vector3d& v, const Vector3d& w, const Node& node,
             const Motion& motion, double size);
  };

  void hang(const std::vector<Inertia>& bodies, const std::vector<TreeLink>& links);
  void find_points(const std::vector<TreeLink>& links);
  void assign_numbers();
  bool set_fixed(const std::vector<FixedEnd>& fixed);
  void move_parent_point(const Node& node, Motion& motion) const;
  void turn_by_joint(const Node& node, double angle, double rate, Motion& motion) const;
  void settle_arms(const Node& node, Motion& motion) const;
  void factor();
  void factor_joint(int place);
  void add_to_parent(int place);
  void solve(const std::vector<Wrench>& wrenches, bool with_velocities);
  void gather(int place, bool with_velocities);
  void release(int place, bool with_velocities);
  int movable() const { return static_cast<int>(nodes_.size()); }

  std::vector<Node> nodes_;  // by body
  std::vector<int> order_;   // parents first
  std::vector<int> cut_;
  double misfit_ = 0.0, size_ = 1.0;  // largest arm [m]
  bool is_factored_ = false;          // where this stands
  VectorXd stands_at_;
  int depth_ = 0, half_ = 0;       // numbers of y that are places
  std::vector<Motion> motions_;    // by place: fixed ends too
  std::vector<Articulated> held_;  // by body
  std::vector<Solved> solved_;     // by place
};

}  // namespace tumble
