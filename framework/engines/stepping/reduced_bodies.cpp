// Linked bodies in joint coordinates. Part of LinkedBodies.
//
// Each step begins at the bodies' states and ends there, so that whatever else looks at the world
// (impacts, contacts, pictures, processes that go back in time) knows nothing of coordinates, and a
// step depends on these states alone. A loop is closed by the rows of the links that the tree
// leaves out:
//   A lambda = -(J u' + J' u),   A = J (response of the tree to J^T)                      (R.6)
// A has a column for each row, each in time linear in the bodies. Redundant rows (four hinges of a
// plane linkage, a rod beside a rod) make it singular: a step obeys those that say something new
// where it begins (redundant_rows.cpp). In a posture where more of them do not, the lambda of least
// norm is taken. That is measured against the row's own response in bodies that nothing else holds,
// J M^-1 J^T: a rod beside a rod of the tree leaves an A of rounding alone.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/decompositions.h"
#include "framework/dynamics/split_ode.h"
#include "framework/dynamics/state_units.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/linked_bodies.h"

namespace tumble::engines {
namespace {

// Rows beside the tree cost the cube of their number; six coordinates a body with a sparse
// factorisation are cheaper from about here on.
constexpr std::size_t kMostLoopRows = 60;
// Of a row's response in free bodies, against the pivots of (R.6): rows that say the same leave
// 1e-14, and a four-bar linkage that is stretched to 1e-6 rad of its singular posture 1e-12.
constexpr double kRedundant = 1e-13;
// Of states against the links: rounding of a hundred bodies after each other is 1e-13, what an
// impact within a step leaves goes by the fourth power of the step.
constexpr double kLinksFit = 1e-12;

/// J M^-1 J^T of one end of a row, of a body that nothing else holds.
double free_response(const Vector6d& jacobian, const Body& body) {
  const Vector3d turning_body = body.world_from_body.conjugate() * jacobian.tail<3>();
  return body.inertia.inverse_mass * jacobian.head<3>().squaredNorm() +
         turning_body.dot(body.inertia.inverse_inertia_body * turning_body);
}

/// The lambda of least norm of (R.6), in the measure of free responses. @param free  (rows)
VectorXd solve_with_redundant(const MatrixXd& A, const VectorXd& wanted, const VectorXd& free) {
  const VectorXd scale = (free.array() > 0.0).select(free.array().rsqrt(), 0.0);
  const MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  const double largest = scaled.colwise().norm().maxCoeff();
  if (!(largest > kRedundant)) return VectorXd::Zero(wanted.size());
  return scale.cwiseProduct(
      least_squares(scaled, scale.cwiseProduct(wanted), kRedundant / largest));
}

}  // namespace

void LinkedBodies::plant_tree() {
  int row = 0;
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    const std::size_t before = joints_.size();
    terms_[k].acting->append_joints(joints_);
    int rows_of_joints = 0;
    for (std::size_t j = before; j < joints_.size(); ++j) {
      joints_[j].row += row;
      rows_of_joints += joints_[j].row_count;
    }
    const int rows = static_cast<int>(terms_[k].acting->row_count());
    if (rows == 0) pulling_.push_back(k);
    if (rows != rows_of_joints) {
      kept_maximal_by_ = fmt::format("{} holds bodies by rows that are no joints",
                                     effects::all()[terms_[k].effect]->name());
      return;
    }
    row += rows;
  }
  if (row == 0) {
    kept_maximal_by_ = "it has neither rods nor joints";
    return;
  }
  std::vector<Inertia> inertias;
  for (const int body : bodies_)
    inertias.push_back(world_.bodies[static_cast<std::size_t>(body)].inertia);
  tree_.emplace(inertias, static_cast<int>(fixed_.size()), joints_);
  for (const int cut : tree_->cut())
    for (int k = 0; k < joints_[static_cast<std::size_t>(cut)].row_count; ++k)
      loop_rows_.push_back(joints_[static_cast<std::size_t>(cut)].row + k);
  if (loop_rows_.size() > kMostLoopRows) {
    kept_maximal_by_ = fmt::format(
        "its loops have {} rows, and beside a tree at most {} are cheaper than a "
        "sparse solution of all",
        loop_rows_.size(), kMostLoopRows);
    tree_.reset();
    return;
  }
  ends_.resize(fixed_.size());
  seen_.resize(bodies_.size() + fixed_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) seen_[i].inertia = inertias[i];
  wrenches_.resize(seen_.size());
  feels_gravity_.resize(bodies_.size());
  for (std::size_t k = 0; k < fixed_.size(); ++k) {
    Body& end = seen_[bodies_.size() + k];
    end = {infinite_inertia(), Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
           Vector3d::Zero()};
    if (fixed_[k] < 0) continue;
    const WorldBody& body = world_.bodies[static_cast<std::size_t>(fixed_[k])];
    end.world_from_body = body.state.world_from_body;
    ends_move_ = ends_move_ || !body.motion.velocity_m_s.isZero(0.0) ||
                 body.motion.angular_frequency_rad_s != 0.0;
  }
}

std::string LinkedBodies::reduced_in_words() const {
  std::string words = fmt::format("{} bodies", bodies_.size());
  if (loop_rows_.empty()) return words + ", a tree: no rows";
  return words + fmt::format(", a tree and {} rows that close {} loop{}", loop_rows_.size(),
                             tree_->cut().size(), tree_->cut().size() == 1 ? "" : "s");
}

std::vector<std::string> coordinates_in_words(const World& world) {
  const Laws none;
  RunCounters counters;
  std::vector<std::string> all;
  for (LinkedGroup& group : groups_of_linked_bodies(world)) {
    const std::string first = world.bodies[static_cast<std::size_t>(group.bodies.front())].name;
    const LinkedBodies linked(world, none, counters, {}, std::move(group));
    const std::string& kept = linked.kept_maximal_by();
    all.push_back(fmt::format("island of '{}': {}", first,
                              kept.empty() ? "joint coordinates, " + linked.reduced_in_words()
                                           : "six coordinates a body, for " + kept));
  }
  return all;
}

bool goes_without_rows(const World& world) {
  const Laws none;
  RunCounters counters;
  for (LinkedGroup& group : groups_of_linked_bodies(world)) {
    const LinkedBodies linked(world, none, counters, {}, std::move(group));
    const bool collides = std::any_of(
        linked.bodies().begin(), linked.bodies().end(),
        [&](int body) { return world.bodies[static_cast<std::size_t>(body)].collides; });
    if (linked.has_constraints() && (collides || !linked.goes_without_rows())) return false;
  }
  return true;
}

void LinkedBodies::stand_fixed_ends_at(double t) {
  for (std::size_t k = 0; k < fixed_.size(); ++k) {
    Body& seen = seen_[bodies_.size() + k];
    FixedEnd& end = ends_[k];
    if (fixed_[k] >= 0) {
      const WorldBody& body = world_.bodies[static_cast<std::size_t>(fixed_[k])];
      seen.com_world = prescribed_position(body, t);
      seen.velocity_world = prescribed_velocity(body, t);
      end.acceleration_world = acceleration_of_fixed(fixed_[k], seen.com_world, t);
    }
    end.com_world = seen.com_world;
    end.velocity_world = seen.velocity_world;
    end.world_from_body = seen.world_from_body;
  }
}

// Coordinates of these states. Where an impact within a step, or a time in six coordinates, has
// left links open, the states are projected first, as six coordinates would be: what the tree alone
// would take away is not the least in the measure of the masses, and would change energy.
VectorXd LinkedBodies::begin_reduced(std::vector<RigidBodyState>& local, double t) {
  begun_at_ = t;
  stand_fixed_ends_at(t);
  bool turns_freely = pulling_.empty();
  const Vector3d gravity_world = world_.gravity_world.value_or(Vector3d::Zero());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    feels_gravity_[i] = left_alone_ && left_alone_(bodies_[i]) ? 1 : 0;
    turns_freely = turns_freely && feels_gravity_[i] != 0;
    if (feels_gravity_[i] != 0)
      wrenches_[i] = {seen_[i].inertia.mass * gravity_world, Vector3d::Zero()};
  }
  VectorXd y = tree_->begin(local, ends_, turns_freely);
  if (tree_->misfit() > kLinksFit && laws_.constraint_correction) {
    project_local(local, t, true);
    y = tree_->begin(local, ends_, turns_freely);
  }
  return y;
}

// The rows of loops, where the tree stands.
void LinkedBodies::close_loops() {
  const StageTimer timer(counters_.constraint_seconds);
  const std::vector<Constraint> all = rows(seen_);
  const auto m = static_cast<Eigen::Index>(loop_rows_.size());
  const auto in_bodies = [&](int place) {
    return static_cast<std::size_t>(place) < bodies_.size();
  };
  MatrixXd A(m, m);
  VectorXd wanted(m), free = VectorXd::Zero(m);
  std::vector<Wrench> push(bodies_.size(), {Vector3d::Zero(), Vector3d::Zero()});
  const auto add = [&](const Constraint& row, double lambda, std::vector<Wrench>& sum) {
    for (const auto& [place, jacobian] :
         {std::pair{row.body_a, &row.row.jacobian_a}, std::pair{row.body_b, &row.row.jacobian_b}}) {
      if (!in_bodies(place)) continue;
      sum[static_cast<std::size_t>(place)].force_world += lambda * jacobian->head<3>();
      sum[static_cast<std::size_t>(place)].torque_world += lambda * jacobian->tail<3>();
    }
  };
  // J u' + J' u without multipliers
  for (Eigen::Index k = 0; k < m; ++k) {
    const ConstraintRow& row = all[static_cast<std::size_t>(loop_rows_[k])].row;
    wanted[k] = -row.velocity_product;
    if (world_.stabilisation && world_.stabilisation->kind == scene::StabilisationKind::kBaumgarte)
      wanted[k] +=
          laws_.baumgarte_acceleration(row.value, row.rate, world_.stabilisation->time_constant_s);
    for (const auto& [place, jacobian] :
         {std::pair{all[static_cast<std::size_t>(loop_rows_[k])].body_a, &row.jacobian_a},
          std::pair{all[static_cast<std::size_t>(loop_rows_[k])].body_b, &row.jacobian_b}}) {
      if (in_bodies(place))
        free[k] += free_response(*jacobian, seen_[static_cast<std::size_t>(place)]);
      wanted[k] -=
          in_bodies(place)
              ? jacobian->dot(tree_->acceleration(place))
              : jacobian->head<3>().dot(
                    ends_[static_cast<std::size_t>(place) - bodies_.size()].acceleration_world);
    }
  }
  for (Eigen::Index column = 0; column < m; ++column) {
    const Constraint& pushing = all[static_cast<std::size_t>(loop_rows_[column])];
    add(pushing, 1.0, push);
    const VectorXd response = tree_->response(push);
    add(pushing, -1.0, push);
    for (Eigen::Index k = 0; k < m; ++k) {
      const Constraint& row = all[static_cast<std::size_t>(loop_rows_[k])];
      A(k, column) = 0.0;
      if (in_bodies(row.body_a))
        A(k, column) +=
            row.row.jacobian_a.dot(response.segment<6>(6 * static_cast<Eigen::Index>(row.body_a)));
      if (in_bodies(row.body_b))
        A(k, column) +=
            row.row.jacobian_b.dot(response.segment<6>(6 * static_cast<Eigen::Index>(row.body_b)));
    }
  }
  std::vector<Eigen::Index> obeyed;
  for (Eigen::Index k = 0; k < m; ++k)
    if (obeyed_.empty() || obeyed_[static_cast<std::size_t>(loop_rows_[k])] != 0)
      obeyed.push_back(k);
  ++counters_.constraint_solves;
  if (!obeyed.empty()) {  // a rod beside a rod of the tree leaves nothing to solve
    const VectorXd lambda = solve_with_redundant(A(obeyed, obeyed), wanted(obeyed), free(obeyed));
    for (std::size_t k = 0; k < obeyed.size(); ++k)
      add(all[static_cast<std::size_t>(loop_rows_[static_cast<std::size_t>(obeyed[k])])],
          lambda[static_cast<Eigen::Index>(k)], wrenches_);
  }
  tree_->accelerate(wrenches_);
}

VectorXd LinkedBodies::reduced_rate(double t, const VectorXd& y) {
  ++counters_.derivative_evaluations;
  accelerate_tree(t, y);
  return tree_->rate();
}

void LinkedBodies::accelerate_tree(double t, const VectorXd& y) {
  time_of_stage_ = t;
  if (ends_move_) stand_fixed_ends_at(t);
  tree_->stand_at(y, ends_);
  const bool is_pure = pulling_.empty() && loop_rows_.empty();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int place = static_cast<int>(i);
    if (!is_pure) tree_->put(place, seen_[i]);
    if (feels_gravity_[i] == 0)
      wrenches_[i] = outer_wrench_(bodies_[i], tree_->state(place, t - begun_at_));
    else if (!is_pure)
      wrenches_[i] = {seen_[i].inertia.mass * world_.gravity_world.value_or(Vector3d::Zero()),
                      Vector3d::Zero()};
  }
  if (!pulling_.empty()) {
    const StageTimer timer(counters_.force_seconds);
    for (std::size_t k = bodies_.size(); k < wrenches_.size(); ++k)
      wrenches_[k] = {Vector3d::Zero(), Vector3d::Zero()};
    for (const std::size_t k : pulling_) terms_[k].acting->add_forces(seen_, wrenches_);
  }
  tree_->accelerate(wrenches_);
  if (!loop_rows_.empty()) close_loops();
}

// What rows would push with, had the tree any: a rod along itself, a joint at its point.
VectorXd LinkedBodies::multipliers_of_tree(std::vector<RigidBodyState> local, double t) {
  const VectorXd y = begin_reduced(local, t);
  accelerate_tree(t, y);
  const std::vector<Vector3d> forces = tree_->joint_forces(wrenches_);
  VectorXd multipliers = VectorXd::Zero(static_cast<Eigen::Index>(row_count_));
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int place = static_cast<int>(i);
    if (tree_->link_of(place) < 0) continue;
    const TreeLink& link = joints_[static_cast<std::size_t>(tree_->link_of(place))];
    if (link.kind == TreeJoint::kRod)
      multipliers[link.row] = -tree_->tension(place);
    else
      multipliers.segment<3>(link.row) = link.a == place ? forces[i] : Vector3d(-forces[i]);
  }
  return multipliers;
}

// Without a law that projects: what the tree makes of these states, which is theirs where they fit
// its links.
void LinkedBodies::settle_on_tree(std::vector<RigidBodyState>& local, double t) {
  stand_fixed_ends_at(t);
  tree_->begin(local, ends_, false);
  for (std::size_t i = 0; i < local.size(); ++i) local[i] = tree_->state(static_cast<int>(i), 0.0);
}

// What nothing but gravity acts on keeps its angular momentum about its centre of mass, its
// momentum changes by m g h, and the centre goes along what the method makes of a parabola, or the
// angular momentum about another point would change. In coordinates of joints a method keeps these
// to its order only: the rest is given back to the bodies as to one rigid body, which no link
// notices.
void LinkedBodies::keep_momentum(const std::vector<RigidBodyState>& before, double h,
                                 std::vector<RigidBodyState>& after) {
  if (!bend_) bend_ = path_bend(laws_);
  struct Whole {
    double mass = 0.0;
    Vector3d centre = Vector3d::Zero(), momentum = Vector3d::Zero(), spin = Vector3d::Zero();
  };
  const auto whole_of = [&](const std::vector<RigidBodyState>& states) {
    Whole whole;
    for (std::size_t i = 0; i < states.size(); ++i) {
      whole.mass += seen_[i].inertia.mass;
      whole.centre += seen_[i].inertia.mass * states[i].com_world;
      whole.momentum += states[i].momentum_world;
    }
    whole.centre /= whole.mass;
    for (const RigidBodyState& state : states)
      whole.spin += state.angular_momentum_world +
                    (state.com_world - whole.centre).cross(state.momentum_world);
    return whole;
  };
  const Whole then = whole_of(before), now = whole_of(after);
  Matrix3d inertia = Matrix3d::Zero();  // of the whole, about its centre
  for (std::size_t i = 0; i < after.size(); ++i) {
    const Matrix3d R = after[i].world_from_body.toRotationMatrix();
    const Vector3d arm = after[i].com_world - now.centre;
    inertia +=
        R * seen_[i].inertia.inertia_body * R.transpose() +
        seen_[i].inertia.mass * (arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose());
  }
  const Vector3d gravity_world = world_.gravity_world.value_or(Vector3d::Zero()),
                 velocity = (then.momentum - now.momentum) / now.mass + h * gravity_world,
                 place = then.centre - now.centre + h * then.momentum / then.mass +
                         0.5 * *bend_ * h * h * gravity_world,
                 omega = least_squares(inertia, then.spin - now.spin, kRedundant);
  for (std::size_t i = 0; i < after.size(); ++i) {
    RigidBodyState& state = after[i];
    state.momentum_world +=
        seen_[i].inertia.mass * (velocity + omega.cross(Vector3d(state.com_world - now.centre)));
    state.com_world += place;
    state.angular_momentum_world +=
        angular_momentum_of(omega, state.world_from_body, seen_[i].inertia);
  }
}

std::vector<RigidBodyState> LinkedBodies::advance_reduced(std::vector<RigidBodyState> local,
                                                          double t, double h) {
  const VectorXd y = begin_reduced(local, t);
  const bool falls_freely =
      fixed_.empty() && pulling_.empty() &&
      std::all_of(feels_gravity_.begin(), feels_gravity_.end(), [](char feels) { return feels; });
  const std::vector<RigidBodyState> before = falls_freely ? local : std::vector<RigidBodyState>();
  choose_rows(local, t);
  const OdeFunction f =
      SplitOde{[&](double time, const VectorXd& state) {
                 need_size(state, y);
                 return reduced_rate(time, state);
               },
               [&](double, const VectorXd& state) { return tree_->rates_of_places(state); }};
  ++counters_.integrations;
  const VectorXd units = laws_.steps_in_units
                             ? tree_->units(nearest_power_of_two(length_ > 0.0 ? length_ : 1.0))
                             : VectorXd();
  const VectorXd end = naming(subject(), [&] { return integrate_by(laws_, f, t, y, h, units); });
  stand_fixed_ends_at(t + h);
  tree_->stand_at(end, ends_);
  for (std::size_t i = 0; i < local.size(); ++i) local[i] = tree_->state(static_cast<int>(i), h);
  if (!loop_rows_.empty() && world_.stabilisation &&
      world_.stabilisation->kind == scene::StabilisationKind::kProjection)
    project_local(local, t + h, true);
  if (falls_freely) keep_momentum(before, h, local);
  return local;
}

}  // namespace tumble::engines
