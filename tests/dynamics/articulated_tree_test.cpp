// Joint coordinates and the articulated-body algorithm, against a second implementation: the same
// bodies in six coordinates each, their links as equations with Lagrange multipliers, solved
// densely.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "framework/core/shortest_turn.h"
#include "framework/dynamics/articulated_tree.h"

namespace tumble::testing::articulated_test {
namespace {

using Eigen::Index;
constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Bodies, what they hang on, forces, and states that the links allow.
struct Linkage {
  std::vector<Inertia> bodies;
  std::vector<FixedEnd> fixed;
  std::vector<TreeLink> links;
  std::vector<Wrench> wrenches;
  std::vector<RigidBodyState> states;
};

class Lot {
 public:
  explicit Lot(unsigned seed) : engine_(seed) {}
  double number() { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine_); }
  double between(double low, double high) { return low + (high - low) * 0.5 * (number() + 1.0); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine_); }
  Vector3d vector() { return {number(), number(), number()}; }
  Quaterniond turn() { return Quaterniond(number(), number(), number(), number()).normalized(); }
  /// Of a point: the centre in one of three, where other branches of the algorithm are taken.
  Vector3d anchor() { return below(3) == 0 ? Vector3d(Vector3d::Zero()) : vector(); }

 private:
  std::mt19937 engine_;
};

Inertia inertia_by_lot(Lot& lot) {
  const double mass = lot.between(0.5, 2.0);
  if (lot.below(3) == 0) return finite_inertia(mass, lot.between(0.1, 1.0) * Matrix3d::Identity());
  const Matrix3d R = lot.turn().toRotationMatrix();
  const Vector3d sides = Vector3d(lot.between(0.1, 1), lot.between(0.1, 1), lot.between(0.1, 1)),
                 moments(sides.y() + sides.z(), sides.x() + sides.z(), sides.x() + sides.y());
  return finite_inertia(mass, R * moments.asDiagonal() * R.transpose());
}

/// A forest of any shape: each body hangs on an earlier one, on an end, or on nothing.
Linkage forest_by_lot(Lot& lot, int bodies, const std::vector<TreeJoint>& kinds) {
  Linkage all;
  all.fixed.resize(2);
  all.fixed[1] = {lot.vector(), lot.vector(), lot.vector(), lot.turn()};
  for (int i = 0; i < bodies; ++i) {
    all.bodies.push_back(inertia_by_lot(lot));
    all.wrenches.push_back({10.0 * lot.vector(), 5.0 * lot.vector()});
    all.states.push_back({2.0 * lot.vector(), lot.turn(), lot.vector(), lot.vector()});
    const TreeJoint kind =
        kinds[static_cast<std::size_t>(lot.below(static_cast<int>(kinds.size())))];
    if (kind == TreeJoint::kFree) continue;
    int parent = lot.below(i + 2);
    if (parent >= i) parent += bodies - i;  // a fixed end
    TreeLink link{kind,       i,         parent, lot.anchor(), lot.anchor(), lot.between(0.3, 1.0),
                  lot.turn(), lot.turn()};
    if (lot.below(2) == 0) {
      std::swap(link.a, link.b);
      std::swap(link.point_a_body, link.point_b_body);
      std::swap(link.a_from_joint, link.b_from_joint);
    }
    all.links.push_back(link);
  }
  return all;
}

/// A body, or an end, as the dense equations see it.
struct Seen {
  Vector3d c, v, w;
  Quaterniond q;
};
Seen seen(const Linkage& all, int place) {
  const int n = static_cast<int>(all.bodies.size());
  if (place >= n) {
    const FixedEnd& end = all.fixed[static_cast<std::size_t>(place - n)];
    return {end.com_world, end.velocity_world, Vector3d::Zero(), end.world_from_body};
  }
  const RigidBodyState& state = all.states[static_cast<std::size_t>(place)];
  const Inertia& inertia = all.bodies[static_cast<std::size_t>(place)];
  const Quaterniond& q = state.world_from_body;
  return {state.com_world, state.momentum_world / inertia.mass,
          q * (inertia.inverse_inertia_body * (q.conjugate() * state.angular_momentum_world)), q};
}

/// J u' + J'u = wanted of all links, in the columns of bodies.
struct Rows {
  MatrixXd J;
  VectorXd rate, moved;  // J u; what J u' has to be: ends that accelerate count
};
Rows rows_of(const Linkage& all) {
  const Index n = static_cast<Index>(all.bodies.size());
  Rows rows{MatrixXd::Zero(0, 6 * n), VectorXd(0), VectorXd(0)};
  const auto append = [&](const TreeLink& link, const Eigen::Matrix<double, 6, 1>& of_a,
                          const Eigen::Matrix<double, 6, 1>& of_b, double product) {
    const Index at = rows.J.rows();
    rows.J.conservativeResize(at + 1, Eigen::NoChange);
    rows.rate.conservativeResize(at + 1);
    rows.moved.conservativeResize(at + 1);
    rows.J.row(at).setZero();
    rows.rate[at] = 0.0;
    rows.moved[at] = -product;
    for (const auto& [place, jacobian] : {std::pair{link.a, of_a}, std::pair{link.b, of_b}}) {
      const Seen body = seen(all, place);
      rows.rate[at] += jacobian.head<3>().dot(body.v) + jacobian.tail<3>().dot(body.w);
      if (place < n)
        rows.J.block<1, 6>(at, 6 * place) += jacobian.transpose();
      else
        rows.moved[at] -= jacobian.head<3>().dot(
            all.fixed[static_cast<std::size_t>(place - n)].acceleration_world);
    }
  };
  for (const TreeLink& link : all.links) {
    const Seen a = seen(all, link.a), b = seen(all, link.b);
    const Vector3d ra = a.q * link.point_a_body, rb = b.q * link.point_b_body;
    const Vector3d apart = a.c + ra - b.c - rb, parting = a.v + a.w.cross(ra) - b.v - b.w.cross(rb),
                   bend = a.w.cross(a.w.cross(ra)) - b.w.cross(b.w.cross(rb));
    Eigen::Matrix<double, 6, 1> of_a, of_b;
    const auto along = [&](const Vector3d& e, double product) {
      of_a << e, ra.cross(e);
      of_b << -e, e.cross(rb);
      append(link, of_a, of_b, product);
    };
    if (link.kind == TreeJoint::kRod) {
      along(apart, parting.squaredNorm() + apart.dot(bend));
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) along(Vector3d::Unit(axis), bend[axis]);
    if (link.kind == TreeJoint::kBall) continue;
    const Matrix3d A = (a.q * link.a_from_joint).toRotationMatrix(),
                   B = (b.q * link.b_from_joint).toRotationMatrix();
    const auto across = [&](const Vector3d& x, const Vector3d& z) {
      const Vector3d e = x.cross(z);
      of_a << Vector3d::Zero(), e;
      of_b << Vector3d::Zero(), -e;
      append(link, of_a, of_b, (a.w.cross(x).cross(z) + x.cross(b.w.cross(z))).dot(a.w - b.w));
    };
    across(A.col(0), B.col(2));
    across(A.col(1), B.col(2));
    if (link.kind == TreeJoint::kWeld) across(A.col(0), B.col(1));
  }
  return rows;
}

/// u' of all bodies by M u' = f + J^T lambda, J u' = moved.
VectorXd dense_accelerations(const Linkage& all) {
  const Index n = static_cast<Index>(all.bodies.size());
  const Rows rows = rows_of(all);
  const Index m = rows.J.rows();
  MatrixXd K = MatrixXd::Zero(6 * n + m, 6 * n + m);
  VectorXd right(6 * n + m);
  for (Index i = 0; i < n; ++i) {
    const auto& inertia = all.bodies[static_cast<std::size_t>(i)];
    const Seen body = seen(all, static_cast<int>(i));
    const Matrix3d R = body.q.toRotationMatrix(), I = R * inertia.inertia_body * R.transpose();
    K.block<3, 3>(6 * i, 6 * i) = inertia.mass * Matrix3d::Identity();
    K.block<3, 3>(6 * i + 3, 6 * i + 3) = I;
    const Wrench& wrench = all.wrenches[static_cast<std::size_t>(i)];
    right.segment<3>(6 * i) = wrench.force_world;
    right.segment<3>(6 * i + 3) = wrench.torque_world - body.w.cross(I * body.w);
  }
  K.block(6 * n, 0, m, 6 * n) = rows.J;
  K.block(0, 6 * n, 6 * n, m) = rows.J.transpose();
  right.tail(m) = rows.moved;
  return K.fullPivLu().solve(right).head(6 * n);
}

bool has(const Linkage& all, TreeJoint kind) {
  return std::any_of(all.links.begin(), all.links.end(),
                     [&](const TreeLink& link) { return link.kind == kind; });
}

const std::vector<TreeJoint> kAllKinds = {TreeJoint::kFree, TreeJoint::kBall, TreeJoint::kHinge,
                                          TreeJoint::kWeld, TreeJoint::kRod};

/// Stands at what begin() makes of the states, and writes that back to them.
VectorXd settle(ArticulatedTree& tree, Linkage& all) {
  const VectorXd y = tree.begin(all.states, all.fixed, false);
  tree.stand_at(y, all.fixed);
  for (std::size_t i = 0; i < all.bodies.size(); ++i)
    all.states[i] = tree.state(static_cast<int>(i), 0.0);
  return y;
}

// Rounding, over all forests below: the dense matrix has condition numbers up to 1e5 (rods that
// stand nearly across what hangs on them), accelerations reach 1e3. A wrong sign or a term left out
// is off by the size of the accelerations.
constexpr double kRounding = 1e-9;

TEST(ArticulatedTree, AcceleratesAsDenseEquationsDo) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    Lot lot(seed);
    // every kind by itself, then all mixed
    const auto kinds = seed % 2 == 0 ? std::vector<TreeJoint>{kAllKinds[seed / 2 % 5]} : kAllKinds;
    Linkage all = forest_by_lot(lot, 1 + lot.below(9), kinds);
    ArticulatedTree tree(all.bodies, 2, all.links);
    ASSERT_TRUE(tree.cut().empty());
    settle(tree, all);
    EXPECT_LT(rows_of(all).rate.norm(), 1e3 * kEps) << "links hold in seed " << seed;
    tree.accelerate(all.wrenches);
    const VectorXd expected = dense_accelerations(all);
    for (int i = 0; i < static_cast<int>(all.bodies.size()); ++i)
      EXPECT_LT((tree.acceleration(i) - expected.segment<6>(6 * i)).norm(),
                kRounding * (1.0 + expected.norm()))
          << "seed " << seed << ", body " << i;
  }
}

TEST(ArticulatedTree, JointForcesAreWhatMovesEachBody) {
  // A uniform rod that is let go horizontally, hinged at its end, falls with 3 g / 2 L, so that its
  // hinge carries a quarter of its weight. A ball at rest hangs on a rod by its own, m g.
  constexpr double kLength = 0.8, kMass = 2.0, kGravity = 9.81;
  const double across = kMass * kLength * kLength / 12;
  const std::vector<Inertia> bodies = {
      finite_inertia(kMass, Vector3d(1e-3, across, across).asDiagonal()),
      finite_inertia(3.0, 0.1 * Matrix3d::Identity())};
  std::vector<TreeLink> links(2);
  links[0].kind = TreeJoint::kHinge;
  links[0].a = 2;
  links[0].b = 0;
  links[0].point_b_body = {-0.5 * kLength, 0, 0};
  links[0].a_from_joint = links[0].b_from_joint =
      shortest_turn(Vector3d::UnitZ(), Vector3d::UnitY());
  links[1].kind = TreeJoint::kRod;
  links[1].a = 1;
  links[1].b = 2;
  links[1].length = 0.5;
  ArticulatedTree tree(bodies, 1, links);
  const Vector3d zero = Vector3d::Zero();
  const std::vector<RigidBodyState> states = {
      {{0.5 * kLength, 0, 0}, Quaterniond::Identity(), zero, zero},
      {{0, 0, -0.5}, Quaterniond::Identity(), zero, zero}};
  std::vector<Wrench> weights;
  for (const Inertia& body : bodies)
    weights.push_back({body.mass * kGravity * -Vector3d::UnitZ(), zero});
  tree.stand_at(tree.begin(states, {FixedEnd{}}, false), {FixedEnd{}});
  tree.accelerate(weights);
  const std::vector<Vector3d> forces = tree.joint_forces(weights);
  constexpr double kTolerance = 100 * kEps * kMass * kGravity;
  EXPECT_LT((forces[0] - 0.25 * kMass * kGravity * Vector3d::UnitZ()).norm(), kTolerance);
  EXPECT_LT((forces[1] - 3.0 * kGravity * Vector3d::UnitZ()).norm(), kTolerance);
  EXPECT_NEAR(tree.tension(1), 3.0 * kGravity, kTolerance) << "a pull is positive";
}

TEST(ArticulatedTree, JointForcesOfFreeBodiesTogetherAreNone) {
  // What two bodies of a forest push each other with cancels: all forces at joints of bodies on
  // fixed ends are what momentum changes by, beyond what acts from outside.
  for (unsigned seed = 0; seed < 50; ++seed) {
    Lot lot(3000 + seed);
    Linkage all = forest_by_lot(lot, 1 + lot.below(9), kAllKinds);
    ArticulatedTree tree(all.bodies, 2, all.links);
    settle(tree, all);
    tree.accelerate(all.wrenches);
    const std::vector<Vector3d> forces = tree.joint_forces(all.wrenches);
    const VectorXd expected = dense_accelerations(all);
    Vector3d from_ends = Vector3d::Zero();
    double size = 1.0;
    for (int i = 0; i < static_cast<int>(all.bodies.size()); ++i) {
      const auto at = static_cast<std::size_t>(i);
      from_ends += all.bodies[at].mass * expected.segment<3>(6 * i) - all.wrenches[at].force_world;
      size = std::max(size, forces[at].norm());
    }
    Vector3d found = Vector3d::Zero();
    const int n = static_cast<int>(all.bodies.size());
    for (std::size_t i = 0; i < all.bodies.size(); ++i) {
      if (tree.link_of(static_cast<int>(i)) < 0) {
        EXPECT_EQ(forces[i].norm(), 0.0) << "a free body";
        continue;
      }
      const TreeLink& link = all.links[static_cast<std::size_t>(tree.link_of(static_cast<int>(i)))];
      if (std::max(link.a, link.b) >= n) found += forces[i];
    }
    EXPECT_LT((found - from_ends).norm(), kRounding * size * (1.0 + expected.norm()))
        << "seed " << seed;
  }
}

TEST(ArticulatedTree, RespondsToAPushAsItsAccelerationsChange) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Lot lot(1000 + seed);
    Linkage all = forest_by_lot(lot, 1 + lot.below(9), kAllKinds);
    ArticulatedTree tree(all.bodies, 2, all.links);
    settle(tree, all);
    tree.accelerate(all.wrenches);
    VectorXd before(6 * static_cast<Index>(all.bodies.size())), after = before;
    for (int i = 0; i < static_cast<int>(all.bodies.size()); ++i)
      before.segment<6>(6 * i) = tree.acceleration(i);
    std::vector<Wrench> push, pushed = all.wrenches;
    for (Wrench& wrench : pushed) {
      push.push_back({lot.vector(), lot.vector()});
      wrench.force_world += push.back().force_world;
      wrench.torque_world += push.back().torque_world;
    }
    const VectorXd response = tree.response(push);
    tree.accelerate(pushed);
    for (int i = 0; i < static_cast<int>(all.bodies.size()); ++i)
      after.segment<6>(6 * i) = tree.acceleration(i);
    EXPECT_LT((after - before - response).norm(), kRounding * (1.0 + before.norm()));
  }
}

TEST(ArticulatedTree, RatesOfPlacesAreThoseOfTheWholeRate) {
  // Ten roundings of numbers up to 4 here: velocities reach 10 and go through a turn and back.
  constexpr double kTurnAndBack = 1e-14;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Lot lot(3000 + seed);
    Linkage all = forest_by_lot(lot, 1 + lot.below(6), kAllKinds);
    ArticulatedTree tree(all.bodies, 2, all.links);
    VectorXd y = settle(tree, all);
    const Index half = y.size() / 2;
    for (Index i = 0; i < half; ++i) y[i] *= 1.2, y[half + i] += 0.3;  // as stages leave them
    const VectorXd alone = tree.rates_of_places(y);
    tree.stand_at(y, all.fixed);
    tree.accelerate(all.wrenches);
    const VectorXd whole = tree.rate().head(half);
    EXPECT_LT((alone.head(half) - whole).norm(), kTurnAndBack * (1.0 + whole.norm())) << seed;
  }
}

TEST(ArticulatedTree, StandsAfterItsBeginningAsIfItCameFromElsewhere) {
  // Directions of length 1 are made so once more: a rounding of places and velocities, which
  // accelerations see by the condition numbers above.
  for (unsigned seed = 0; seed < 100; ++seed) {
    Lot lot(4000 + seed);
    Linkage all = forest_by_lot(lot, 1 + lot.below(6), kAllKinds);
    ArticulatedTree tree(all.bodies, 2, all.links);
    settle(tree, all);  // states that the links allow
    const VectorXd y = tree.begin(all.states, all.fixed, false);
    tree.accelerate(all.wrenches);
    const VectorXd begun = tree.rate();
    tree.stand_at(1.1 * y, all.fixed);
    tree.stand_at(y, all.fixed);
    tree.accelerate(all.wrenches);
    const VectorXd come = tree.rate();
    EXPECT_LT((come - begun).norm(), kRounding * (1.0 + come.norm())) << seed;
    // Where a fixed end moves, the same y is another place.
    std::vector<FixedEnd> moved = all.fixed;
    moved[1].com_world += Vector3d(1.0, 2.0, 3.0);
    tree.stand_at(y, moved);
    for (const TreeLink& link : all.links)
      if (tree.link_of(0) >= 0 && &link == &all.links[static_cast<std::size_t>(tree.link_of(0))] &&
          std::max(link.a, link.b) == static_cast<int>(all.bodies.size()) + 1) {
        EXPECT_NEAR((tree.state(0, 0.0).com_world - all.states[0].com_world).norm(),
                    Vector3d(1.0, 2.0, 3.0).norm(), kRounding)
            << seed;
      }
  }
}

TEST(ArticulatedTree, RatesMoveVelocitiesByTheAccelerations) {
  // Central differences of h: h^2 of third derivatives that reach 1e5, and rounding over h.
  constexpr double h = 1e-5, kDifference = 1e-5;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Lot lot(2000 + seed);
    Linkage all = forest_by_lot(lot, 1 + lot.below(6), kAllKinds);
    all.fixed[1].acceleration_world.setZero();
    ArticulatedTree tree(all.bodies, 2, all.links);
    VectorXd y = settle(tree, all);
    // Stages leave |q| = |u| = 1, and y still says the same: where all places are directions, they
    // are scaled.
    if (seed % 2 == 1 && all.links.size() == all.bodies.size() && !has(all, TreeJoint::kHinge))
      y.head(y.size() / 2) *= 1.2;
    tree.stand_at(y, all.fixed);
    tree.accelerate(all.wrenches);
    const VectorXd rate = tree.rate();
    std::vector<Eigen::Matrix<double, 6, 1>> accelerations;
    for (int i = 0; i < static_cast<int>(all.bodies.size()); ++i)
      accelerations.push_back(tree.acceleration(i));
    const auto velocities_at = [&](double part) {
      std::vector<FixedEnd> fixed = all.fixed;
      fixed[1].com_world += part * fixed[1].velocity_world;
      tree.stand_at(y + part * rate, fixed);
      for (std::size_t i = 0; i < all.bodies.size(); ++i)
        all.states[i] = tree.state(static_cast<int>(i), 0.0);
      std::vector<std::pair<Seen, Vector3d>> found;
      for (int i = 0; i < static_cast<int>(all.bodies.size()); ++i)
        found.emplace_back(seen(all, i), Vector3d::Zero());
      return found;
    };
    const auto after = velocities_at(h), before = velocities_at(-h);
    double size = 1.0;
    for (const auto& acceleration : accelerations) size = std::max(size, acceleration.norm());
    for (std::size_t i = 0; i < all.bodies.size(); ++i) {
      const auto &late = after[i].first, &early = before[i].first;
      EXPECT_LT(((late.v - early.v) / (2 * h) - accelerations[i].head<3>()).norm(),
                kDifference * size * size)
          << "seed " << seed;
      EXPECT_LT(((late.w - early.w) / (2 * h) - accelerations[i].tail<3>()).norm(),
                kDifference * size * size)
          << "seed " << seed;
      EXPECT_LT(((late.c - early.c) / (2 * h) - 0.5 * (late.v + early.v)).norm(),
                kDifference * size * size)
          << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace tumble::testing::articulated_test
