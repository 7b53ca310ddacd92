// Hidden: laws that world inertia and a rigid body's derivative obey in any pose.
#include <Eigen/LU>

#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

Matrix3d random_inertia(Random& random) {
  // Moments of a real solid: no one exceeds the sum of the others. Turned, so that products of
  // inertia occur.
  const double a = random.between(1, 2), b = random.between(1, 2), c = random.between(1, 2);
  const Matrix3d R = random_rotation(random).toRotationMatrix();
  return R * Vector3d(b + c, a + c, a + b).asDiagonal() * R.transpose();
}

Inertia random_body(Random& random) {
  const double mass = random.between(0.5, 5);
  const Matrix3d inertia = random_inertia(random);
  return {mass, 1 / mass, inertia, inertia.inverse()};
}

RigidBodyState random_state(Random& random) {
  const Vector3d com = random_vector(random, 5);
  const Quaterniond q = random_rotation(random);
  const Vector3d momentum = random_vector(random, 3);
  return {com, q, momentum, random_vector(random, 3)};
}

VectorXd derivative(const RigidBodyState& state, const Inertia& inertia, const Wrench& wrench) {
  const VectorXd found = a2_module().rigid_body_derivative(state, inertia, wrench);
  return found.size() == kStateSize ? found : VectorXd(VectorXd::Constant(kStateSize, kUnset));
}

Quaterniond quaternion_rate(const VectorXd& rate) { return {rate[3], rate[4], rate[5], rate[6]}; }

TEST(InertiaInWorld, GivesTheSameEnergyInBothFrames) {
  Random random(31);
  for (int i = 0; i < 50; ++i) {
    const Matrix3d inertia_body = random_inertia(random);
    const Quaterniond q = random_rotation(random);
    const Vector3d omega_body = random_vector(random, 2), omega_world = q * omega_body;
    const Matrix3d found = a2_module().inertia_in_world(inertia_body, q);
    const Story story{.scene = "a random tensor in a random pose, number " + std::to_string(i),
                      .slip = "R and R^T swapped: R I R^T, not R^T I R",
                      .handout = equation(3)};
    expect_near(omega_world.dot(found * omega_world), omega_body.dot(inertia_body * omega_body),
                200 * kEps * 50, "J (twice the energy)", story);
    expect_near(found.trace(), inertia_body.trace(), 100 * kEps * 12, "kg m^2 (trace)", story);
    expect_near(found, Matrix3d(found.transpose()), 100 * kEps * 4, "kg m^2 (symmetry)", story);
  }
}

TEST(RigidBodyDerivative, TurnsWithTheWorld) {
  if (!a_body_moves()) return;
  // Turn the whole world by S: every vector of the derivative turns by S, and q' becomes S q'.
  Random random(32);
  for (int i = 0; i < 30; ++i) {
    const Inertia inertia = random_body(random);
    const RigidBodyState state = random_state(random);
    const Wrench wrench{random_vector(random, 3), random_vector(random, 3)};
    const Quaterniond S = random_rotation(random);
    const RigidBodyState turned{S * state.com_world, S * state.world_from_body,
                                S * state.momentum_world, S * state.angular_momentum_world};
    const VectorXd rate = derivative(state, inertia, wrench);
    const VectorXd found =
        derivative(turned, inertia, {S * wrench.force_world, S * wrench.torque_world});
    const RigidBodyState parts = unpack(rate);
    VectorXd expected(kStateSize);
    const Quaterniond q_rate = S * quaternion_rate(rate);
    expected << S * parts.com_world, q_rate.w(), q_rate.x(), q_rate.y(), q_rate.z(),
        S * parts.momentum_world, S * parts.angular_momentum_world;
    expect_near(found, expected, 400 * kEps * 10, "(x', q', P', L')",
                {.scene = "a random body, and the same with the whole world turned, number " +
                          std::to_string(i),
                 .slip = "body and world swapped: the side of the product in q' = 1/2 (0, w) q, or "
                         "w = R I^-1 R^T L",
                 .handout = equation(4)});
  }
}

TEST(RigidBodyDerivative, KeepsTheLengthOfTheQuaternionAndKnowsOnlyItsOwnAngularVelocity) {
  Random random(33);
  for (int i = 0; i < 30; ++i) {
    const Inertia inertia = random_body(random);
    const RigidBodyState state = random_state(random);
    const VectorXd rate = derivative(state, inertia, no_wrench());
    const Quaterniond q = state.world_from_body, q_rate = quaternion_rate(rate);
    // w = 2 q' q^-1, and its energy is L . w / 2 = L_body . I^-1 L_body / 2.
    const Quaterniond twice(2 * (q_rate * q.conjugate()).coeffs());
    const Vector3d L_body = q.conjugate() * state.angular_momentum_world;
    const Story story{.scene = "a random body in a random pose, number " + std::to_string(i),
                      .slip = "q' = 1/2 (0, w) q: the factor 1/2, the side, or the frame of w",
                      .handout = equation(4)};
    expect_near(q.coeffs().dot(q_rate.coeffs()), 0.0, 100 * kEps * 3, "1/s (q . q')", story);
    expect_near(twice.vec().dot(state.angular_momentum_world),
                L_body.dot(inertia.inverse_inertia_body * L_body), 400 * kEps * 20,
                "J (twice the energy)", story);
    expect_near(twice.vec(), Vector3d(q * (inertia.inverse_inertia_body * L_body)), 400 * kEps * 10,
                "rad/s (w)", story);
  }
}

TEST(RigidBodyDerivative, ANeedleKeepsItsDigits) {
  // Moments 1e-6 : 1 : 1 and |L| = 1: the components across the needle are of size 1 and good to
  // round-off through the body frame, while a world inverse inertia has entries of 1e6 whose
  // rounding, 1e-10, reaches every component.
  const Inertia needle{1.0, 1.0, Vector3d(1e-6, 1, 1).asDiagonal(),
                       Vector3d(1e6, 1, 1).asDiagonal()};
  Random random(34);
  for (int i = 0; i < 30; ++i) {
    RigidBodyState state = random_state(random);
    const Matrix3d R = state.world_from_body.toRotationMatrix();
    const Vector3d across = random_vector(random, 1);
    state.angular_momentum_world = R * Vector3d(1e-6, across.y(), across.z());
    const Quaterniond q_rate = quaternion_rate(derivative(state, needle, no_wrench()));
    const Vector3d omega_world = 2 * (q_rate * state.world_from_body.conjugate()).vec();
    expect_near(
        Vector2d((R.transpose() * omega_world).tail<2>()), Vector2d(across.tail<2>()), 100 * kEps,
        "rad/s (across the needle)",
        {.scene =
             "a needle, moments 1e-6, 1, 1 kg m^2, in a random pose, number " + std::to_string(i),
         .slip = "a world inverse inertia loses digits: w = R (I_body^-1 (R^T L)), from the right",
         .handout = equation(5)});
  }
}

// The test's own step, so that a slip in the student's step is paid for elsewhere.
VectorXd own_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const VectorXd a = f(t, y), b = f(t + h / 2, y + h / 2 * a), c = f(t + h / 2, y + h / 2 * b),
                 d = f(t + h, y + h * c);
  return y + h / 6 * (a + 2 * b + 2 * c + d);
}

TEST(RigidBodyDerivative, LeadsAFreeTopToItsExactPose) {
  const Inertia disc{1.0, 1.0, Vector3d(1, 1, 2).asDiagonal(), Vector3d(1, 1, 0.5).asDiagonal()};
  const RigidBodyState start{Vector3d::Zero(), Quaterniond::Identity(), {1, 2, 3}, {0.4, 0.3, 10}};
  const OdeFunction f = [&](double, const VectorXd& y) {
    return derivative(unpack(y), disc, no_wrench());
  };
  const Quaterniond exact(-0.804151396875696316944775701432, 0.0477968939575963714743105384979,
                          0.0000912183417293028194210805571931, 0.592499771738425880194587343086);
  std::vector<double> errors;
  for (const int steps : {100, 200, 400}) {
    const RigidBodyState end = unpack(integrate(own_step, f, 0, pack(start), 1.0, steps));
    const Quaterniond q = end.world_from_body;
    errors.push_back(std::min(distance(q, exact), distance(q, Quaterniond(-exact.coeffs()))));
    const Story story{
        .scene = "a free disc, moments 1, 1, 2 kg m^2, L = (0.4, 0.3, 10) kg m^2/s, for 1 s",
        .steps = std::to_string(steps) + " steps of a correct Runge-Kutta method",
        .slip = "a free body keeps P and L, and its centre moves at P / m",
        .handout = equation(4)};
    expect_near(end.angular_momentum_world, start.angular_momentum_world, 0.0, "kg m^2/s", story);
    expect_near(end.com_world, Vector3d(1, 2, 3), 1e-12, "m", story);
  }
  // Fourth order: error 5.2e-8 at 100 steps, and a sixteenth of it at each halving (measured); a
  // wrong frame or factor leaves 0.1.
  const Story story{
      .scene = "a free disc, moments 1, 1, 2 kg m^2, its pose after 1 s in closed form",
      .steps = "100, 200, 400 steps",
      .slip = "q' = 1/2 (0, w) q: the factor 1/2, the side, or the frame of w",
      .handout = equation(4)};
  expect_near(errors.back(), 0.0, 1e-9, "(distance of quaternions)", story);
  expect_orders({std::log2(errors[0] / errors[1]), std::log2(errors[1] / errors[2])}, 4.0, 0.1,
                story);
}

}  // namespace
}  // namespace tumble::a2_testing
