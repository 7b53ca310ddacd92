#include "tests/a1_impulse/a1_fixtures.h"

#include <cmath>
#include <numbers>

namespace tumble::testing {
namespace {

Body resting(const Inertia& inertia, const Vector3d& com_world) {
  return {inertia, com_world, Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
}

Vector3d velocity_at(const Body& body, const Velocity& velocity, const Vector3d& point_world) {
  return velocity.linear_world + velocity.angular_world.cross(point_world - body.com_world);
}

}  // namespace

Body block(const Vector3d& com_world) {
  return resting(finite_inertia(2.0, Vector3d(1.0, 2.0, 4.0).asDiagonal()), com_world);
}

Body ball(double mass, double radius, const Vector3d& com_world) {
  return resting(finite_inertia(mass, Matrix3d::Identity() * (0.4 * mass * radius * radius)), com_world);
}

Body wall(const Vector3d& com_world) {
  Inertia inertia = infinite_inertia();
  inertia.inertia_body.setConstant(kUnset);
  return resting(inertia, com_world);
}

Vector3d angular_momentum(const Body& body, const Velocity& velocity) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return body.com_world.cross(body.inertia.mass * velocity.linear_world) +
         R * (body.inertia.inertia_body * (R.transpose() * velocity.angular_world));
}

double kinetic_energy(const Body& body, const Velocity& velocity) {
  const Vector3d omega_body = body.world_from_body.conjugate() * velocity.angular_world;
  return 0.5 * body.inertia.mass * velocity.linear_world.squaredNorm() + 0.5 * omega_body.dot(body.inertia.inertia_body * omega_body);
}

double gap_rate(const Contact& contact, const Body& a, const Velocity& velocity_a, const Body& b, const Velocity& velocity_b) {
  return contact.normal_b_to_a_world.dot(velocity_at(a, velocity_a, contact.point_world) -
                                         velocity_at(b, velocity_b, contact.point_world));
}

namespace {

// A number that is not nothing; a vector of them.
bool is_something(double x) { return std::isfinite(x) && x != 0.0; }
bool is_something(const Vector3d& v) { return v.allFinite() && v != Vector3d::Zero(); }

bool asked_first(bool came, const std::string& scene, const std::string& expected, const std::string& n) {
  expect_true(came, expected, "nothing of the kind",
              {.scene = "asked first, because this test's own answer is \"nothing\": " + scene,
               .slip = "the function gives nothing (0, NaN, a miss, its own argument) whatever it is asked",
               .handout = equation(n)});
  return came;
}

Body falling_ball() {
  Body body = ball(2.0, 0.5, {0, 0, 0.5});
  body.velocity_world = {0, 0, -3};
  return body;
}
const Contact kUnderIt{{0, 0, 0}, Vector3d::UnitZ()};

}  // namespace

bool gives_hits() {
  const Triangle triangle{{0, 0, 0}, {4, 0, 0}, {0, 2, 0}};
  bool came = false;
  for (const double side : {1.0, -1.0}) {   // either face will do
    const auto hit = student().intersect_ray_triangle({{0.5, 0.75, 2 * side}, {0, 0, -side}}, triangle);
    came = came || (hit && std::isfinite(hit->t) && is_something(hit->barycentric));
  }
  return asked_first(came, "a ray through the middle of a triangle", "a hit", "1");
}

bool gives_linear_acceleration() {
  return asked_first(is_something(student().linear_acceleration(block({5, 3, 1}), {2, 0, -8})), "(2, 0, -8) N on a movable block", "an acceleration other than 0", "3");
}

bool gives_angular_acceleration() {
  return asked_first(is_something(student().angular_acceleration(block({5, 3, 1}), {1, 4, 2})), "(1, 4, 2) N m on a movable block", "an acceleration other than 0", "4");
}

bool gives_relative_velocities() {
  const Body slower = falling_ball();
  Body faster = slower;
  faster.velocity_world = {0, 0, -6};
  const double slow = student().relative_normal_velocity(kUnderIt, slower, wall({0, 0, -1}));
  const double fast = student().relative_normal_velocity(kUnderIt, faster, wall({0, 0, -1}));
  return asked_first(is_something(slow) && is_something(fast - slow), "a ball falls on a resting wall at 3 and at 6 m/s", "two velocities other than 0", "5");
}

bool tells_motions_apart() {
  return asked_first(student().classify_relative_motion(-2.0, 0.001) != student().classify_relative_motion(2.0, 0.001),
                     "u_n = -2 and 2 m/s, tolerance 0.001 m/s", "two different cases", "6");
}

bool gives_impulses() {
  return asked_first(is_something(student().collision_impulse(kUnderIt, falling_ball(), wall({0, 0, -1}), 0.5)),
                     "a 2 kg ball hits a wall at 3 m/s, e = 0.5", "an impulse other than 0", "9");
}

bool gives_impulses_without_rotation() {
  return asked_first(is_something(student().collision_impulse_without_rotation(kUnderIt, falling_ball(), wall({0, 0, -1}), 0.5)),
                     "a 2 kg ball hits a wall at 3 m/s, e = 0.5", "an impulse other than 0", "8");
}

bool moves_a_struck_body() {
  Body body = block({5, 3, 1});
  body.velocity_world = {1, 0, 0};
  const Vector3d change = student().apply_impulse(body, {0, 0, 6}, {5, 3, 1}).linear_world - body.velocity_world;
  return asked_first(is_something(change), "6 N s through the centre of a movable block", "another velocity than before", "10");
}

bool moves_colliding_bodies() {
  const Body a = falling_ball(), b = ball(2.0, 0.5, {0, 0, -0.5});
  const a1::CollisionOutcome after = student().resolve_collision(kUnderIt, a, b, 0.5);
  const bool came = is_something(Vector3d(after.a.linear_world - a.velocity_world)) || is_something(Vector3d(after.b.linear_world - b.velocity_world));
  return asked_first(came, "a 2 kg ball falls at 3 m/s on another that rests, e = 0.5", "other velocities than before", "11");
}

Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size), z = random.between(-size, size);
  return {x, y, z};
}

Vector3d random_direction(Random& random) {
  // Uniform on the sphere: height and longitude are (Archimedes).
  const double z = random.between(-1.0, 1.0), longitude = random.between(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return Vector3d(r * std::cos(longitude), r * std::sin(longitude), z).normalized();
}

Quaterniond random_rotation(Random& random) {
  const Vector3d axis = random_direction(random);
  return Quaterniond(Eigen::AngleAxisd(random.between(0.0, std::numbers::pi), axis)).normalized();
}

Body random_body(Random& random) {
  // Moments of a solid are sums of two of three positive second moments of its mass.
  const double mass = std::pow(10.0, random.between(-1.0, 1.0));
  const double xx = random.between(0.05, 1.0), yy = random.between(0.05, 1.0), zz = random.between(0.05, 1.0);
  Body body;
  body.inertia = finite_inertia(mass, Matrix3d((mass * Vector3d(yy + zz, xx + zz, xx + yy)).asDiagonal()));
  body.com_world = random_vector(random, 3.0);
  body.world_from_body = random_rotation(random);
  body.velocity_world = random_vector(random, 4.0);
  body.omega_world = random_vector(random, 4.0);
  return body;
}

Encounter random_encounter(Random& random, int number) {
  Encounter e;
  e.a = random_body(random);
  e.b = random_body(random);
  if (number % 4 == 3) {
    const Body moving = e.b;
    e.b = wall(moving.com_world);
    e.b.velocity_world = moving.velocity_world;
    e.b.omega_world = moving.omega_world;
  }
  e.contact.point_world = 0.5 * (e.a.com_world + e.b.com_world) + random_vector(random, 1.0);
  e.contact.normal_b_to_a_world = random_direction(random);
  // Turning the normal round is the only change that makes any two bodies approach.
  if (gap_rate(e.contact, e.a, velocity_of(e.a), e.b, velocity_of(e.b)) > 0.0) e.contact.normal_b_to_a_world *= -1.0;
  return e;
}

}  // namespace tumble::testing
