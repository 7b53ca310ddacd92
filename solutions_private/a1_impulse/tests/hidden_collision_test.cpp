// Conservation laws and symmetries of collisions; inputs from a seed, every fourth with a moving
// wall.
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

// about 100 roundings of eps / 2, times the scale given at each use
constexpr double kHundredRoundings = 50 * kEps;
constexpr int kScenes = 100;

std::string case_of(int i, int seed) {
  return "random collision " + std::to_string(i) + " of seed " + std::to_string(seed);
}

/// Sum of the speeds that meet in the relative velocity [m/s]: what its rounding is relative to.
double speeds(const Contact& contact, const Body& a, const Body& b) {
  const auto of = [&](const Body& body) {
    return body.velocity_world.norm() +
           body.omega_world.norm() * (body.com_world.norm() + contact.point_world.norm());
  };
  return of(a) + of(b);
}

/// What rounding may do to j: the relative velocity is a small difference of large speeds.
double impulse_tolerance(const Encounter& e, double j) {
  const double approach =
      std::abs(gap_rate(e.contact, e.a, velocity_of(e.a), e.b, velocity_of(e.b)));
  return kHundredRoundings * j * (2.0 + speeds(e.contact, e.a, e.b) / approach);
}

/// How readily the touching point of a body gives way, as a matrix: 1/m + [r]^T I^-1 [r]. A second
/// way to the denominator.
Matrix3d mobility(const Body& body, const Vector3d& point_world) {
  const Vector3d r = point_world - body.com_world;
  Matrix3d r_cross;
  r_cross << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return body.inertia.inverse_mass * Matrix3d::Identity() +
         r_cross.transpose() * (R * body.inertia.inverse_inertia_body * R.transpose()) * r_cross;
}

double second_way(const Encounter& e, double restitution) {
  const Vector3d& n = e.contact.normal_b_to_a_world;
  const Matrix3d sum = mobility(e.a, e.contact.point_world) + mobility(e.b, e.contact.point_world);
  return -(1.0 + restitution) * gap_rate(e.contact, e.a, velocity_of(e.a), e.b, velocity_of(e.b)) /
         n.dot(sum * n);
}

TEST(HiddenImpulseWithoutRotation, AgreesWithTheClosedForm) {
  Random random(2201);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    Encounter e = random_encounter(random, i);
    const double u = e.contact.normal_b_to_a_world.dot(e.a.velocity_world - e.b.velocity_world);
    const double restitution = random.unit();
    const double j =
        u >= 0.0 ? 0.0
                 : (1.0 + restitution) * -u / (e.a.inertia.inverse_mass + e.b.inertia.inverse_mass);
    const double found =
        student().collision_impulse_without_rotation(e.contact, e.a, e.b, restitution);
    expect_near(found, j, kHundredRoundings * j * (2.0 + 20.0 / std::abs(u)), "N s",
                {.scene = case_of(i, 2201),
                 .slip = "velocities of the centres, inverse masses, (1 + e); 0 when separating",
                 .handout = equation("8")});
  }
}

TEST(HiddenCollisionImpulse, AgreesWithTheMobilityMatrix) {
  Random random(2202);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    const Encounter e = random_encounter(random, i);
    const double restitution = random.unit();
    const double j = second_way(e, restitution);
    expect_near(student().collision_impulse(e.contact, e.a, e.b, restitution), j,
                impulse_tolerance(e, j), "N s",
                {.scene = case_of(i, 2202),
                 .slip = "a term of the denominator: both arms, world inertia",
                 .handout = equation("9")});
  }
}

TEST(HiddenCollisionImpulse, IsTheSameWhicheverBodyIsCalledA) {
  Random random(2203);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    const Encounter e = random_encounter(random, i);
    const double j = student().collision_impulse(e.contact, e.a, e.b, 0.7);
    const double swapped = student().collision_impulse(
        {e.contact.point_world, -e.contact.normal_b_to_a_world}, e.b, e.a, 0.7);
    expect_true(j > 0.0, "a push between approaching bodies", show(j),
                {.scene = case_of(i, 2203), .slip = "the sign of u_n", .handout = equation("9")});
    expect_near(swapped, j, impulse_tolerance(e, j), "N s",
                {.scene = case_of(i, 2203) + ": bodies swapped, normal turned round",
                 .slip = "A and B treated differently",
                 .handout = equation("9")});
  }
}

TEST(HiddenCollisionImpulse, IsTheSameForEveryObserver) {
  if (!gives_impulses()) return;
  Random random(2204);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    Encounter e = random_encounter(random, i);
    const double j = student().collision_impulse(e.contact, e.a, e.b, 0.7);
    const Quaterniond turn = random_rotation(random);
    const Vector3d shift = random_vector(random, 3), boost = random_vector(random, 3);
    for (Body* body : {&e.a, &e.b}) {
      body->com_world = turn * body->com_world + shift;
      body->world_from_body = (turn * body->world_from_body).normalized();
      body->velocity_world = turn * body->velocity_world + boost;
      body->omega_world = turn * body->omega_world;
    }
    e.contact = {turn * e.contact.point_world + shift,
                 (turn * e.contact.normal_b_to_a_world).normalized()};
    // Four times: the turned scene is rounded itself, twice over.
    expect_near(
        student().collision_impulse(e.contact, e.a, e.b, 0.7), j,
        4 * impulse_tolerance(e, std::abs(j)), "N s",
        {.scene = case_of(i, 2204) + ", seen by an observer who is turned, elsewhere and moving",
         .slip = "body inertia where world inertia belongs, or an arm that starts at the world's "
                 "origin",
         .handout = equation("9")});
  }
}

TEST(HiddenCollisionImpulse, NeverPulls) {
  if (!gives_impulses()) return;
  Random random(2205);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    const Encounter e = random_encounter(random, i);
    const Contact away{e.contact.point_world, -e.contact.normal_b_to_a_world};
    expect_near(student().collision_impulse(away, e.a, e.b, 0.7), 0.0, 0.0, "N s",
                {.scene = case_of(i, 2205) + ", the normal turned round: the bodies separate",
                 .slip = "impulse applied to separating bodies",
                 .handout = equation("9")});
  }
}

TEST(HiddenApplyImpulse, WorksAsMuchAsTheBodyGainsInEnergy) {
  if (!moves_a_struck_body()) return;
  Random random(2206);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    const Body body = random_body(random);
    const Vector3d impulse = random_vector(random, 3),
                   point = body.com_world + random_vector(random, 1);
    const Velocity before = velocity_of(body),
                   after = student().apply_impulse(body, impulse, point);
    const auto at_point = [&](const Velocity& v) {
      return Vector3d(v.linear_world + v.angular_world.cross(point - body.com_world));
    };
    const double work = impulse.dot(at_point(before) + at_point(after)) / 2.0;
    const double scale = kinetic_energy(body, before) + kinetic_energy(body, after);
    expect_near(kinetic_energy(body, after) - kinetic_energy(body, before), work,
                4 * kHundredRoundings * scale, "J",
                {.scene = case_of(i, 2206) + ": energy gained against J . (u + u') / 2",
                 .slip = "the arm, the inverse inertia or its frame",
                 .handout = equation("10")});
  }
}

TEST(HiddenApplyImpulse, IsUndoneByItsOpposite) {
  if (!moves_a_struck_body()) return;
  Random random(2207);
  for (int i = 0; i < kScenes && !HasFailure(); ++i) {
    Body body = random_body(random);
    const Velocity before = velocity_of(body);
    const Vector3d impulse = random_vector(random, 3),
                   point = body.com_world + random_vector(random, 1);
    const Velocity after = student().apply_impulse(body, impulse, point);
    body.velocity_world = after.linear_world;
    body.omega_world = after.angular_world;
    const Velocity undone = student().apply_impulse(body, -impulse, point);
    const Story story{.scene = case_of(i, 2207) + ": J, then -J",
                      .slip = "the impulse does not add to the old velocities",
                      .handout = equation("10")};
    expect_near(undone.linear_world, before.linear_world,
                kHundredRoundings * (4 + after.linear_world.norm()), "m/s", story);
    expect_near(undone.angular_world, before.angular_world,
                kHundredRoundings * (4 + after.angular_world.norm()), "rad/s", story);
  }
}

/// Runs `judge` on kScenes collisions with what the submission made of them. `walls`: every fourth
/// B is a wall.
template <class Judge>
void collide(int seed, double restitution, bool walls, const Judge& judge) {
  Random random(static_cast<std::uint64_t>(seed));
  for (int i = 0; i < kScenes && !::testing::Test::HasFailure(); ++i) {
    const Encounter e = random_encounter(random, walls ? i : 0);
    judge(e, student().resolve_collision(e.contact, e.a, e.b, restitution), case_of(i, seed));
  }
}

TEST(HiddenResolveCollision, KeepsTheMomentumOfThePair) {
  if (!moves_colliding_bodies()) return;
  collide(2208, 0.7, false,
          [](const Encounter& e, const a1::CollisionOutcome& after, const std::string& scene) {
            const double ma = e.a.inertia.mass, mb = e.b.inertia.mass;
            const Vector3d before = ma * e.a.velocity_world + mb * e.b.velocity_world;
            const double scale =
                ma * (4 + after.a.linear_world.norm()) + mb * (4 + after.b.linear_world.norm());
            expect_near(
                ma * after.a.linear_world + mb * after.b.linear_world, before,
                kHundredRoundings * scale, "kg m/s",
                {.scene = scene,
                 .slip = "action is not reaction: B gets exactly the opposite of what A gets",
                 .handout = equation("11")});
          });
}

TEST(HiddenResolveCollision, KeepsTheAngularMomentumOfThePair) {
  if (!moves_colliding_bodies()) return;
  collide(2209, 0.7, false,
          [](const Encounter& e, const a1::CollisionOutcome& after, const std::string& scene) {
            const auto total = [&](const Velocity& a, const Velocity& b) {
              return Vector3d(angular_momentum(e.a, a) + angular_momentum(e.b, b));
            };
            const auto size = [](const Body& body, const Velocity& v) {
              return body.inertia.mass * body.com_world.norm() * v.linear_world.norm() +
                     body.inertia.inertia_body.norm() * v.angular_world.norm();
            };
            const double scale = size(e.a, velocity_of(e.a)) + size(e.b, velocity_of(e.b)) +
                                 size(e.a, after.a) + size(e.b, after.b);
            expect_near(total(after.a, after.b), total(velocity_of(e.a), velocity_of(e.b)),
                        4 * kHundredRoundings * scale, "kg m^2/s",
                        {.scene = scene + ", about the world's origin",
                         .slip = "the two impulses do not act at the same point, or inverse "
                                 "inertia in the wrong frame",
                         .handout = equation("11")});
          });
}

TEST(HiddenResolveCollision, OpensTheGapAtETimesTheSpeedItClosed) {
  for (const double restitution : {0.0, 0.3, 1.0}) {
    collide(
        2210, restitution, true,
        [&](const Encounter& e, const a1::CollisionOutcome& after, const std::string& scene) {
          const double closing = gap_rate(e.contact, e.a, velocity_of(e.a), e.b, velocity_of(e.b));
          const double arm_a = (e.contact.point_world - e.a.com_world).norm(),
                       arm_b = (e.contact.point_world - e.b.com_world).norm();
          const double scale = speeds(e.contact, e.a, e.b) + after.a.linear_world.norm() +
                               arm_a * after.a.angular_world.norm() + after.b.linear_world.norm() +
                               arm_b * after.b.angular_world.norm();
          expect_near(gap_rate(e.contact, e.a, after.a, e.b, after.b), -restitution * closing,
                      2 * kHundredRoundings * scale, "m/s",
                      {.scene = scene + ", e = " + show(restitution),
                       .slip = "the restitution law u_n' = -e u_n",
                       .handout = equation("11")});
        });
  }
}

TEST(HiddenResolveCollision, KeepsEnergyAtEOneAndNeverGainsBelow) {
  if (!moves_colliding_bodies()) return;
  for (const double restitution : {0.4, 1.0}) {
    collide(2211, restitution, false,
            [&](const Encounter& e, const a1::CollisionOutcome& after, const std::string& scene) {
              const double before =
                  kinetic_energy(e.a, velocity_of(e.a)) + kinetic_energy(e.b, velocity_of(e.b));
              // Exact: the pair loses (1 - e) j |u_n| / 2.
              const double closing =
                  -gap_rate(e.contact, e.a, velocity_of(e.a), e.b, velocity_of(e.b));
              const double loss = (1.0 - restitution) * second_way(e, restitution) * closing / 2.0;
              expect_near(kinetic_energy(e.a, after.a) + kinetic_energy(e.b, after.b),
                          before - loss, 20 * kHundredRoundings * before, "J",
                          {.scene = scene + ", e = " + show(restitution),
                           .slip = "the size of the impulse, or one of its two effects",
                           .handout = equation("11")});
            });
  }
}

}  // namespace
}  // namespace tumble::testing
