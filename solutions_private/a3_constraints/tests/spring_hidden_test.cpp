// Hidden: laws that every spring obeys, at any place, speed and length.
#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

AnchorState random_anchor(Random& random) {
  const Vector3d p = random_vector(random, 3);
  return {p, random_vector(random, 3)};
}

Spring random_spring(Random& random) {
  const double k = random.between(1, 20), c = random.between(1, 5);
  return {k, c, random.between(0, 3)};
}

TEST(AnchorVelocity, KeepsTheDistanceBetweenTwoPointsOfABody) {
  Random random(321);
  for (int i = 0; i < 30; ++i) {
    const Body body = random_body(random);
    const Vector3d p = random_vector(random, 1), q = random_vector(random, 1);
    const Vector3d d = a3_module().anchor_position(body, p) - a3_module().anchor_position(body, q);
    const Vector3d d_rate =
        a3_module().anchor_velocity(body, p) - a3_module().anchor_velocity(body, q);
    const Story story{.scene = "two points of a random body, number " + std::to_string(i),
                      .slip = "omega x r with r = R p: a rigid body does not stretch",
                      .handout = equation(2)};
    expect_near(d.norm(), (p - q).norm(), 40 * kEps * 4, "m (distance)", story);
    expect_near(d.dot(d_rate), 0.0, 200 * kEps * 40, "m^2/s (d . d')", story);
    expect_near(d_rate, Vector3d(body.omega_world.cross(body.world_from_body * (p - q))),
                200 * kEps * 10, "m/s", story);
  }
}

TEST(SpringForce, TurnsAndTravelsWithTheObserver) {
  Random random(322);
  for (int i = 0; i < 30; ++i) {
    const Spring spring = random_spring(random);
    const AnchorState a = random_anchor(random), b = random_anchor(random);
    const Vector3d force = a3_module().spring_force(spring, a, b), shift = random_vector(random, 2),
                   drift = random_vector(random, 2);
    const Quaterniond S = random_rotation(random);
    const auto seen = [&](const AnchorState& anchor) {
      return AnchorState{S * (anchor.point_world + shift), S * (anchor.velocity_world + drift)};
    };
    const Story story{
        .scene = "a random spring, number " + std::to_string(i),
        .slip = "the velocity of one end only, or an absolute place: only differences count",
        .handout = equation(3)};
    expect_true(force.norm() > 0, "a force", "none", story);
    expect_near(a3_module().spring_force(spring, seen(a), seen(b)), Vector3d(S * force),
                100 * kEps * 300, "N (turned, shifted, moving observer)", story);
    Story other = story;
    other.slip = "the force on A is the opposite of the force on B, whoever is called A";
    expect_near(a3_module().spring_force(spring, b, a), Vector3d(-force), 20 * kEps * 300,
                "N (A and B exchanged)", other);
  }
}

TEST(SpringForce, GivesThePowerThatItsEnergyLoses) {
  // F . v_a - F . v_b = -d/dt (k (|d| - L0)^2 / 2) - c |d|'^2, both with |d|' = n . (v_b - v_a).
  Random random(323);
  for (int i = 0; i < 30; ++i) {
    const Spring spring = random_spring(random);
    const AnchorState a = random_anchor(random), b = random_anchor(random);
    const Vector3d d = b.point_world - a.point_world, u = b.velocity_world - a.velocity_world;
    const double rate = d.normalized().dot(u),
                 power = -spring.stiffness * (d.norm() - spring.rest_length) * rate -
                         spring.damping * rate * rate;
    expect_near(
        -a3_module().spring_force(spring, a, b).dot(u), power, 100 * kEps * 2000, "W",
        {.scene = "a random spring, number " + std::to_string(i),
         .slip =
             "a spring that feeds energy: the sign of the damping, or damping across the spring",
         .handout = equation(3)});
  }
}

TEST(SpringForce, IsRightAtEveryLength) {
  // Along (2, -1, 2) / 3, of length 3 s. At tiny lengths the force is k L0 (a direction remains),
  // at huge ones k |d|.
  const Vector3d n = Vector3d(2, -1, 2) / 3;
  for (const double size : {1e-200, 1e-160, 1e-100, 1e-5, 1e5, 1e100, 1e200}) {
    const AnchorState a{Vector3d::Zero(), Vector3d::Zero()}, b{size * Vector3d(2, -1, 2), n};
    const Vector3d found =
        a3_module().spring_force({.stiffness = 2, .damping = 4, .rest_length = 0.5}, a, b);
    const double expected = 2 * (3 * size - 0.5) + 4, unit = std::max(1.0, size);
    expect_near(found / unit, Vector3d(expected / unit * n), 40 * kEps * 10,
                "N in units of " + show(unit),
                {.scene = "k = 2 N/m, c = 4 N s/m, rest length 0.5 m, lengthening at 1 m/s, " +
                          show(3 * size) + " m long",
                 .slip = "|d|^2 leaves the range of doubles: divide d by its largest component "
                         "first (or use stableNorm)",
                 .handout = equation(3),
                 .no_number = "|d|^2 leaves the range of doubles: divide d by its largest "
                              "component first (or use stableNorm)"});
  }
}

TEST(SpringForce, MakesAPeriodOfTwoPiRootMOverK) {
  // m x'' + k x = 0 by velocity Verlet, which keeps the phase to (w h)^2 / 24 a period: 1.6e-6
  // here.
  const double k = 50, mass = 2, period = 2 * M_PI * std::sqrt(mass / k);
  const Spring spring{.stiffness = k, .damping = 0, .rest_length = 1};
  const AnchorState anchor{Vector3d::Zero(), Vector3d::Zero()};
  const int steps = 1000;
  const double h = period / steps;
  Vector3d x(1.3, 0, 0), v = Vector3d::Zero();
  expect_near(a3_module().spring_force(spring, {x, v}, anchor), Vector3d(-15, 0, 0), 1e-12, "N",
              {.scene = "the same spring before it is let go",
               .slip = "the sign of the force, or the rest length",
               .handout = equation(3)});
  for (int i = 0; i < steps; ++i) {
    v += h / 2 / mass * a3_module().spring_force(spring, {x, v}, anchor);
    x += h * v;
    v += h / 2 / mass * a3_module().spring_force(spring, {x, v}, anchor);
  }
  expect_near(
      x, Vector3d(1.3, 0, 0), 1e-5, "m",
      {.scene = "2 kg on a spring of 50 N/m, pulled out by 0.3 m and let go, after one period",
       .slip = "the sign of the force, or the rest length",
       .handout = equation(3)});
}

}  // namespace
}  // namespace tumble::a3_testing
