// A rigid body as y: world inertia (A2.3), derivative of the state (A2.4), (A2.5).
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

TEST(InertiaInWorld, TurnsWithTheBody) {
  const Matrix3d found = a2_module().inertia_in_world(Vector3d(1, 2, 4).asDiagonal(), third_turn());
  // Body x now lies along world y, y along z, z along x.
  expect_near(
      found, Matrix3d(Vector3d(4, 1, 2).asDiagonal()), kRoundoff * 4, "kg m^2",
      {.scene = "moments 1, 2, 4 kg m^2 about body x, y, z, turned by 120 degrees about (1, 1, 1)",
       .slip =
           likely(found,
                  Slips<Matrix3d>{
                      {Vector3d(2, 4, 1).asDiagonal(), "R and R^T swapped: R I R^T, not R^T I R"},
                      {Vector3d(1, 2, 4).asDiagonal(), "body inertia where world inertia belongs"}},
                  "R I R^T"),
       .handout = equation(3)});
}

TEST(InertiaInWorld, MixesAxesOnASkewTurn) {
  // 45 degrees about z: R = (c, -s, 0; s, c, 0; 0, 0, 1), c = s = sqrt(1/2).
  const Quaterniond q(std::cos(M_PI / 8), 0, 0, std::sin(M_PI / 8));
  const Matrix3d found = a2_module().inertia_in_world(Vector3d(1, 3, 5).asDiagonal(), q);
  Matrix3d expected, swapped;
  expected << 2, -1, 0, -1, 2, 0, 0, 0, 5;
  swapped << 2, 1, 0, 1, 2, 0, 0, 0, 5;
  expect_near(found, expected, kRoundoff * 5, "kg m^2",
              {.scene = "moments 1, 3, 5 kg m^2, turned by 45 degrees about z",
               .slip = likely(found,
                              Slips<Matrix3d>{{swapped, "R and R^T swapped: R I R^T, not R^T I R"},
                                              {Vector3d(1, 3, 5).asDiagonal(),
                                               "body inertia where world inertia belongs"}},
                              "R I R^T with R on the left and its transpose on the right"),
               .handout = equation(3)});
}

TEST(InertiaInWorld, ProductsOfInertiaTurnToo) {
  const Matrix3d I = bracket().inertia_body;
  for (const Quaterniond& q : {Quaterniond::Identity(), third_turn(), skew_turn()}) {
    const Matrix3d R = q.toRotationMatrix(), moments = Vector3d(I.diagonal()).asDiagonal(),
                   found = a2_module().inertia_in_world(I, q), expected = R * I * R.transpose();
    const Matrix3d of_result = Vector3d(expected.diagonal()).asDiagonal();
    expect_near(
        found, expected, kRoundoff * 8, "kg m^2",
        {.scene = "I = (4, -2, -2; -2, 5, -1; -2, -1, 6) kg m^2, a lopsided body, turned by (w, x, "
                  "y, z) = " +
                  show(Eigen::RowVector4d(q.w(), q.x(), q.y(), q.z())),
         .slip = likely(
             found,
             Slips<Matrix3d>{
                 {R * moments * R.transpose(), kDiagonalAlone},
                 {of_result,
                  "the diagonal of the result alone: a turned tensor has products of inertia"},
                 {R.transpose() * I * R, "R and R^T swapped: R I R^T, not R^T I R"},
                 {I, "body inertia where world inertia belongs"}},
             "R I R^T with R on the left and its transpose on the right"),
         .handout = equation(3)});
  }
}

TEST(RigidBodyDerivative, MovesTheCentreOfMassAndPassesForces) {
  RigidBodyState state = resting();
  state.momentum_world = {6, -2, 4};
  const VectorXd found = a2_module().rigid_body_derivative(state, block(), {{1, 2, 3}, {4, 5, 6}});
  const VectorXd expected = vector({3, -1, 2, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6});
  VectorXd undivided = expected, swapped = expected;
  undivided.head<3>() *= 2;
  swapped.tail<6>() << 4, 5, 6, 1, 2, 3;
  expect_near(
      found, expected, kRoundoff * 6, "(x', q', P', L')",
      {.scene = "2 kg with momentum (6, -2, 4) kg m/s, not turning; force (1, 2, 3) N, torque (4, "
                "5, 6) N m",
       .slip = found.size() != 13
                   ? "the derivative has 13 numbers, as pack() orders them"
                   : likely(found,
                            Slips<VectorXd>{
                                {undivided, "momentum is taken for velocity: x' = P / m"},
                                {swapped, "force and torque are swapped: P' = F, L' = tau"}},
                            "x' = P / m, P' = F, L' = tau in the order of pack()"),
       .handout = equation(4)});
}

TEST(RigidBodyDerivative, TurnsTheQuaternion) {
  RigidBodyState state = resting();
  state.world_from_body = third_turn();
  state.angular_momentum_world = {8, 2, 4};
  // World moments 4, 1, 2: w = (2, 2, 2). q' = 1/2 (0, w) q = 1/2 (-3, 1, 1, 1).
  VectorXd found = a2_module().rigid_body_derivative(state, block(), no_wrench());
  if (found.size() != kStateSize) found = VectorXd::Constant(kStateSize, kUnset);
  const VectorXd q_rate = found.segment<4>(3);
  expect_near(
      q_rate, vector({-1.5, 0.5, 0.5, 0.5}), kRoundoff * 3, "1/s (w x y z)",
      {.scene = "a body turned by 120 degrees about (1, 1, 1) turns about that line at w = "
                "(2, 2, 2) rad/s",
       .slip = likely(
           q_rate,
           Slips<VectorXd>{
               {vector({-3, 1, 1, 1}), "the factor 1/2 of q' = 1/2 (0, w) q is forgotten"},
               {vector({0.5, 0.5, 0.5, -1.5}),
                "the order of the quaternion is wrong: pack() puts w first, coeffs() puts it last"},
               {vector({-2.125, 0.125, 0.125, 1.875}), "body and world swapped: w = R I^-1 R^T L"},
               {vector({-2.5, 2, -1.5, 2}),
                "the inertia of the body frame is used for the world: w = R I^-1 R^T L"},
               {vector({1.5, -0.5, -0.5, -0.5}), "the sign of w is wrong"}},
           "q' = 1/2 (0, w) q with w = R I^-1 R^T L"),
       .handout = equation(4)});
}

TEST(RigidBodyDerivative, KnowsInWhichFrameItTurns) {
  RigidBodyState state = resting();
  state.world_from_body = third_turn();
  state.angular_momentum_world = {4, 2, 0};
  // World moments 4, 1, 2: w_world = (1, 2, 0), w_body = R^T w = (2, 0, 1).
  // (0, w) q = (-w.v, q_w w + w x v) with v = (.5, .5, .5): (-1.5; 0.5 + 1, 1 - 0.5, 0 - 0.5), and
  // half of it.
  VectorXd found = a2_module().rigid_body_derivative(state, block(), no_wrench());
  if (found.size() != kStateSize) found = VectorXd::Constant(kStateSize, kUnset);
  const VectorXd q_rate = found.segment<4>(3);
  // Results of the known mistakes: body angular velocity from the left, world from the right,
  // inertia not rotated, R for R^T.
  const auto half_product = [](const Vector3d& w, bool from_left) {
    const Quaterniond spin(0, w.x(), w.y(), w.z()),
        rate = from_left ? spin * third_turn() : third_turn() * spin;
    return vector({rate.w() / 2, rate.x() / 2, rate.y() / 2, rate.z() / 2});
  };
  const VectorXd expected = vector({-0.75, 0.75, 0.25, -0.25});
  expect_near(
      q_rate, expected, kRoundoff * 3, "1/s (w x y z)",
      {.scene = "moments 1, 2, 4 kg m^2, turned by 120 degrees about (1, 1, 1), L = (4, 2, 0) kg "
                "m^2/s in the world",
       .slip = likely(
           q_rate,
           Slips<VectorXd>{
               {2 * expected, "the factor 1/2 of q' = 1/2 (0, w) q is forgotten"},
               {vector({0.75, 0.25, -0.25, -0.75}),
                "the order of the quaternion is wrong: pack() puts w first, coeffs() puts it last"},
               {half_product({1, 2, 0}, false),
                "the side of the product is wrong: w in the world frame must stand left of q"},
               {half_product({2, 0, 1}, true),
                "the body's angular velocity stands left of q: turn it into the world first"},
               {half_product({4, 1, 0}, true),
                "body inertia where world inertia belongs: w = R I^-1 R^T L"},
               {half_product({2, 0.5, 0}, true), "R and R^T swapped: w = R I^-1 R^T L"},
               {half_product({16, 2, 0}, true), "inertia where inverse inertia belongs"},
               {half_product({4, 2, 0}, true),
                "angular momentum is not angular velocity: w = R I^-1 R^T L"}},
           "q' = 1/2 (0, w) q with w = R I^-1 R^T L"),
       .handout = equation(5)});
}

// In units from a nanometre to a million kilometres: no absolute size is small. Powers of two, so
// that answers scale exactly.
TEST(RigidBodyDerivative, ProductsOfInertiaCountInEveryUnit) {
  bool is_right_in_plain_units = false;
  for (const auto& [inertia_unit, momentum_unit] :
       {std::pair{1.0, 1.0}, {1.0, 0x1p-60}, {0x1p-60, 0x1p-60}, {0x1p60, 1.0}, {1.0, 0x1p60}}) {
    Inertia body = bracket();
    body.mass *= inertia_unit, body.inverse_mass /= inertia_unit;
    body.inertia_body *= inertia_unit, body.inverse_inertia_body /= inertia_unit;
    RigidBodyState state = resting();
    state.world_from_body = skew_turn();
    state.momentum_world = Vector3d(6, -2, 4) * momentum_unit;
    const Vector3d L = state.angular_momentum_world = Vector3d(3, -2, 1) * momentum_unit;
    VectorXd found = a2_module().rigid_body_derivative(state, body, no_wrench());
    if (found.size() != kStateSize) found = VectorXd::Constant(kStateSize, kUnset);
    const double unit = momentum_unit / inertia_unit;
    const Matrix3d R = skew_turn().toRotationMatrix();
    // q' in units of the answer, from the angular velocity that a formula gives.
    const auto rate_of = [&](const Quaterniond& two_rate) {
      return VectorXd(vector({two_rate.w(), two_rate.x(), two_rate.y(), two_rate.z()}) /
                      (2 * unit));
    };
    const auto rate = [&](const Vector3d& w_world) {
      return rate_of(Quaterniond(0, w_world.x(), w_world.y(), w_world.z()) * skew_turn());
    };
    const Vector3d L_body = R.transpose() * L, moments = body.inertia_body.diagonal(),
                   inverses = body.inverse_inertia_body.diagonal();
    const Vector3d w_right = R * (body.inverse_inertia_body * L_body);
    const VectorXd q_rate = found.segment<4>(3) / unit,
                   expected = rate(R * (body.inverse_inertia_body * L_body));
    const std::string scene =
        "a lopsided body, I = (4, -2, -2; -2, 5, -1; -2, -1, 6) kg m^2 times " +
        show_scale(inertia_unit) +
        ", in a skew pose; P = (6, -2, 4) kg m/s and L = (3, -2, 1) kg m^2/s times " +
        show_scale(momentum_unit);
    const bool in_plain_units = inertia_unit == 1.0 && momentum_unit == 1.0;
    const std::string unit_slip =
        in_plain_units ? "q' = 1/2 (0, w) q with w = R I^-1 R^T L"
        : is_right_in_plain_units
            ? "an absolute threshold: a body is immovable where its inverse mass is exactly 0, and "
              "turns however small L is"
            : "the same in kilograms and metres is wrong, too: see the story before this one";
    if (in_plain_units)
      is_right_in_plain_units = (q_rate - expected).cwiseAbs().maxCoeff() <= kRoundoff * 5;
    expect_near(
        q_rate, expected, kRoundoff * 5, "units/s (w x y z)",
        {.scene = scene,
         .slip = likely(
             q_rate,
             Slips<VectorXd>{
                 {rate(R * inverses.cwiseProduct(L_body)), kDiagonalAlone},
                 {rate(R * L_body.cwiseQuotient(moments)), kDiagonalAlone},
                 {rate(body.inverse_inertia_body * L),
                  "body inertia where world inertia belongs: w = R I^-1 R^T L"},
                 {rate(R.transpose() * (body.inverse_inertia_body * (R * L))),
                  "R and R^T swapped: w = R I^-1 R^T L"},
                 {rate(body.inverse_inertia_body * L_body),
                  "the body's angular velocity stands left of q: turn it into the world first"},
                 {rate(R * (body.inverse_inertia_body * L)),
                  "R^T is missing: L stands in the world, I^-1 in the body"},
                 {rate_of(skew_turn() * Quaterniond(0, w_right.x(), w_right.y(), w_right.z())),
                  "the world's w stands right of q: q' = 1/2 (0, w) q"}},
             unit_slip),
         .handout = equation(5)});
    expect_near(Vector3d(found.head<3>() / unit), Vector3d(3, -1, 2), kRoundoff * 3, "units/s (x')",
                {.scene = scene,
                 .slip = in_plain_units ? "x' = P / m" : unit_slip,
                 .handout = equation(4)});
  }
}

TEST(RigidBodyDerivative, InfiniteMassStaysWhereItIs) {
  if (!a_body_moves()) return;
  Inertia wall{INFINITY, 0.0, Matrix3d::Constant(kUnset), Matrix3d::Zero()};
  const VectorXd found = a2_module().rigid_body_derivative(resting(), wall, {{1, 2, 3}, {4, 5, 6}});
  expect_near(
      found, vector({0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6}), 0.0, "(x', q', P', L')",
      {.scene =
           "a wall: infinite mass, inverse mass 0; force (1, 2, 3) N, torque (4, 5, 6) N m: it "
           "stays, and P' = F, L' = tau",
       .slip =
           "infinite mass: use inverse_mass and inverse_inertia_body, never mass or inertia_body",
       .handout = equation(4),
       .no_number =
           "infinite mass: use inverse_mass and inverse_inertia_body, never mass or inertia_body"});
}

TEST(RigidBodyDerivative, FollowsASymmetricTop) {
  // A disc, moments 1, 1, 2, precesses about L at |L| / 1 and rotates in itself at w3 (1 - 2) / 1:
  // q(t) = q_L(|L| t) q_3(-5 t).
  const Vector3d L(0.4, 0.3, 10.0);
  const auto q_at = [&](double t) {
    return Quaterniond(Eigen::AngleAxisd(L.norm() * t, L.normalized())) *
           Quaterniond(Eigen::AngleAxisd(-5.0 * t, Vector3d::UnitZ()));
  };
  const Inertia disc{1.0, 1.0, Vector3d(1, 1, 2).asDiagonal(), Vector3d(1, 1, 0.5).asDiagonal()};
  for (const double t : {0.0, 0.3, 2.0}) {
    RigidBodyState state = resting();
    state.world_from_body = q_at(t);
    state.angular_momentum_world = L;
    VectorXd found = a2_module().rigid_body_derivative(state, disc, no_wrench());
    if (found.size() != kStateSize) found = VectorXd::Constant(kStateSize, kUnset);
    // The closed form, differentiated by the product rule.
    const Quaterniond along_L(0, L.x(), L.y(), L.z()), along_3(0, 0, 0, -5);
    const Quaterniond left = along_L * q_at(t), right = q_at(t) * along_3;
    const VectorXd expected = vector({left.w() + right.w(), left.x() + right.x(),
                                      left.y() + right.y(), left.z() + right.z()}) /
                              2;
    // |L| = 10, and the angle's rounding
    expect_near(VectorXd(found.segment<4>(3)), expected, 10 * kRoundoff * 10, "1/s (w x y z)",
                {.scene = "a free disc, moments 1, 1, 2 kg m^2, L = (0.4, 0.3, 10) kg m^2/s, t = " +
                          show(t) + " s, in closed form",
                 .slip = "frames in w = R I^-1 R^T L, or the factor 1/2",
                 .handout = equation(5)});
  }
}

}  // namespace
}  // namespace tumble::a2_testing
