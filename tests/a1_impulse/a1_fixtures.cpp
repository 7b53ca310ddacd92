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

Body bracket(const Vector3d& com_world) {
  Matrix3d inertia;
  inertia << 4, -2, -2, -2, 5, -1, -2, -1, 6;
  return resting(finite_inertia(2.0, inertia), com_world);
}

Body ball(double mass, double radius, const Vector3d& com_world) {
  return resting(finite_inertia(mass, Matrix3d::Identity() * (0.4 * mass * radius * radius)),
                 com_world);
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
  return 0.5 * body.inertia.mass * velocity.linear_world.squaredNorm() +
         0.5 * omega_body.dot(body.inertia.inertia_body * omega_body);
}

double gap_rate(const Contact& contact, const Body& a, const Velocity& velocity_a, const Body& b,
                const Velocity& velocity_b) {
  return contact.normal_b_to_a_world.dot(velocity_at(a, velocity_a, contact.point_world) -
                                         velocity_at(b, velocity_b, contact.point_world));
}

namespace {

// A number other than 0; a vector of them.
bool is_something(double x) { return std::isfinite(x) && x != 0.0; }
bool is_something(const Vector3d& v) { return v.allFinite() && v != Vector3d::Zero(); }

bool asked_first(bool came, const std::string& scene, const std::string& expected,
                 const std::string& found, const std::string& n) {
  expect_true(
      came, expected, found,
      {.scene = "this test's own answer is \"nothing\", so this is asked before it: " + scene,
       .slip =
           "the function gives nothing (0, NaN, a miss, its own argument) where there is an answer",
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
  std::string found;
  for (const double side : {1.0, -1.0}) {  // either side of the triangle
    const auto hit =
        student().intersect_ray_triangle({{0.5, 0.75, 2 * side}, {0, 0, -side}}, triangle);
    came = came || (hit && std::isfinite(hit->t) && is_something(hit->barycentric));
    found += (found.empty() ? "from above " : ", from below ") +
             (hit ? "a hit at t = " + show(hit->t) + ", weights " + show(hit->barycentric)
                  : std::string("a miss"));
  }
  return asked_first(came, "a ray through the middle of a triangle", "a hit", found, "1");
}

bool gives_linear_acceleration() {
  const Vector3d found = student().linear_acceleration(block({5, 3, 1}), {2, 0, -8});
  return asked_first(is_something(found), "(2, 0, -8) N on a movable block",
                     "an acceleration other than 0", show(found), "3");
}

bool gives_angular_acceleration() {
  const Vector3d found = student().angular_acceleration(block({5, 3, 1}), {1, 4, 2});
  return asked_first(is_something(found), "(1, 4, 2) N m on a movable block",
                     "an acceleration other than 0", show(found), "4");
}

bool gives_relative_velocities() {
  const Body slower = falling_ball();
  Body faster = slower;
  faster.velocity_world = {0, 0, -6};
  const double slow = student().relative_normal_velocity(kUnderIt, slower, wall({0, 0, -1}));
  const double fast = student().relative_normal_velocity(kUnderIt, faster, wall({0, 0, -1}));
  return asked_first(is_something(slow) && is_something(fast - slow),
                     "a ball falls on a resting wall at 3 and at 6 m/s",
                     "two velocities other than 0, and other than each other",
                     show(slow) + " and " + show(fast), "5");
}

bool tells_motions_apart() {
  return asked_first(student().classify_relative_motion(-2.0, 0.001) !=
                         student().classify_relative_motion(2.0, 0.001),
                     "u_n = -2 and 2 m/s, tolerance 0.001 m/s", "two different cases",
                     "the same for both", "6");
}

bool gives_impulses() {
  const double found = student().collision_impulse(kUnderIt, falling_ball(), wall({0, 0, -1}), 0.5);
  return asked_first(is_something(found), "a 2 kg ball hits a wall at 3 m/s, e = 0.5",
                     "an impulse other than 0", show(found), "9");
}

bool gives_impulses_without_rotation() {
  const double found =
      student().collision_impulse_without_rotation(kUnderIt, falling_ball(), wall({0, 0, -1}), 0.5);
  return asked_first(is_something(found), "a 2 kg ball hits a wall at 3 m/s, e = 0.5",
                     "an impulse other than 0", show(found), "8");
}

bool moves_a_struck_body() {
  Body body = block({5, 3, 1});
  body.velocity_world = {1, 0, 0};
  const Vector3d after = student().apply_impulse(body, {0, 0, 6}, {5, 3, 1}).linear_world;
  return asked_first(
      is_something(Vector3d(after - body.velocity_world)),
      "6 N s through the centre of a movable block at " + show(body.velocity_world) + " m/s",
      "another velocity than before", show(after), "10");
}

bool moves_colliding_bodies() {
  const Body a = falling_ball(), b = ball(2.0, 0.5, {0, 0, -0.5});
  const a1::CollisionOutcome after = student().resolve_collision(kUnderIt, a, b, 0.5);
  const bool came = is_something(Vector3d(after.a.linear_world - a.velocity_world)) ||
                    is_something(Vector3d(after.b.linear_world - b.velocity_world));
  return asked_first(
      came, "a 2 kg ball falls at 3 m/s on another that rests, e = 0.5",
      "another velocity of A, " + show(a.velocity_world) + ", or of B, " + show(b.velocity_world),
      show(after.a.linear_world) + " and " + show(after.b.linear_world), "11");
}

Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size),
               z = random.between(-size, size);
  return {x, y, z};
}

Vector3d random_direction(Random& random) {
  // Uniform on the sphere: height and longitude are (Archimedes).
  const double z = random.between(-1.0, 1.0),
               longitude = random.between(0.0, 2.0 * std::numbers::pi);
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
  const double xx = random.between(0.05, 1.0), yy = random.between(0.05, 1.0),
               zz = random.between(0.05, 1.0);
  Body body;
  body.inertia =
      finite_inertia(mass, Matrix3d((mass * Vector3d(yy + zz, xx + zz, xx + yy)).asDiagonal()));
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
  // Reversing the normal is the only change that makes any two bodies approach.
  if (gap_rate(e.contact, e.a, velocity_of(e.a), e.b, velocity_of(e.b)) > 0.0)
    e.contact.normal_b_to_a_world *= -1.0;
  return e;
}

Encounter skew_encounter() {
  Encounter e{
      {{5.5, 2.25, 0.25}, Vector3d(2, -1, 2) / 3}, bracket({5, 3, 1}), bracket({6.25, 1.5, -0.75})};
  e.a.world_from_body = third_turn();
  e.a.velocity_world = {1, -2, -6};
  e.a.omega_world = {0.5, -1, 2};
  // Another tensor, another mass, and a rotation with a skew axis and angle: (1, 2, 4, 2) / 5.
  Matrix3d inertia;
  inertia << 2, -1, 1, -1, 3, 0.5, 1, 0.5, 2.5;
  e.b.inertia = finite_inertia(4.0, inertia);
  e.b.world_from_body = Quaterniond(0.2, 0.4, 0.8, 0.4);
  e.b.velocity_world = {0.25, 0.5, 1};
  e.b.omega_world = {-1.5, 0.75, 1};
  return e;
}

Body scaled(const Body& body, double length, double mass, double time) {
  Body other = body;
  other.com_world *= length;
  other.velocity_world *= length / time;
  other.omega_world /= time;
  other.inertia.mass *= mass;
  other.inertia.inverse_mass /= mass;
  other.inertia.inertia_body *= mass * length * length;
  other.inertia.inverse_inertia_body /= mass * length * length;
  return other;
}

Encounter scaled(const Encounter& e, double length, double mass, double time) {
  return {{e.contact.point_world * length, e.contact.normal_b_to_a_world},
          scaled(e.a, length, mass, time),
          scaled(e.b, length, mass, time)};
}

std::vector<Units> changes_of_unit() {
  // 1e-18 and 1e18: what is called small in a program is larger
  constexpr double kSmall = 0x1p-60, kLarge = 0x1p60;
  return {{kSmall, 1, 1}, {kLarge, 1, 1}, {1, kSmall, 1},
          {1, kLarge, 1}, {1, 1, kSmall}, {1, 1, kLarge}};
}

Mistake slip_of_units(bool right_in_plain_units, const std::string& slip) {
  return right_in_plain_units ? shown(slip)
                              : "the same question in plain units is answered wrongly, too: see "
                                "the tests before this one";
}

std::string show(const Units& units) {
  const auto times = [](double x, const char* what) {
    return x == 1.0 ? "" : std::string(what) + " times " + show_scale(x);
  };
  return times(units.length, "lengths") + times(units.mass, "masses") + times(units.time, "times");
}

// ---- (A1.5) and (A1.9) with a mistake in them ------------------------------------------------

Matrix3d inverse_inertia_by(const Body& body, InertiaSlip slip) {
  if (body.inertia.inverse_mass == 0.0) return Matrix3d::Zero();
  const Matrix3d R = body.world_from_body.toRotationMatrix(),
                 &inverse = body.inertia.inverse_inertia_body;
  switch (slip) {
    case InertiaSlip::kBodyAxes: return inverse;
    case InertiaSlip::kTransposed: return R.transpose() * inverse * R;
    case InertiaSlip::kDiagonal:
      return R * Vector3d(inverse.diagonal()).asDiagonal() * R.transpose();
    case InertiaSlip::kOneByOne:
      return R * Vector3d(body.inertia.inertia_body.diagonal().cwiseInverse()).asDiagonal() *
             R.transpose();
    case InertiaSlip::kNotInverted: return R * body.inertia.inertia_body * R.transpose();
    case InertiaSlip::kNone: break;
  }
  return R * inverse * R.transpose();
}

double relative_normal_velocity_by(const Encounter& e, const FormulaSlip& slip) {
  const auto& [contact, a, b] = e;
  const auto moves = [&](const Body& body) {
    return slip.walls_move || body.inertia.inverse_mass > 0;
  };
  const Vector3d origin = Vector3d::Zero(), &p = contact.point_world;
  const Vector3d arm_a = p - (slip.arms_from_com ? a.com_world : origin),
                 arm_b = slip.own_arms ? Vector3d(p - (slip.arms_from_com ? b.com_world : origin))
                                       : arm_a;
  const auto spin = [&](const Body& body, const Vector3d& arm, bool counts) -> Vector3d {
    return (counts ? slip.right_handed ? 1.0 : -1.0 : 0.0) * body.omega_world.cross(arm);
  };
  Vector3d u = Vector3d::Zero();
  if (moves(a)) u += a.velocity_world + spin(a, arm_a, slip.spin_of_a);
  if (moves(b)) u -= b.velocity_world + spin(b, arm_b, slip.spin_of_b);
  return contact.normal_b_to_a_world.dot(u);
}

double collision_impulse_by(const Encounter& e, double restitution, const FormulaSlip& slip) {
  const auto& [contact, a, b] = e;
  const Vector3d& n = contact.normal_b_to_a_world;
  const Vector3d origin = Vector3d::Zero(), &p = contact.point_world;
  const Vector3d arm_a = p - (slip.arms_from_com ? a.com_world : origin),
                 arm_b = slip.own_arms ? Vector3d(p - (slip.arms_from_com ? b.com_world : origin))
                                       : arm_a;
  const auto turning = [&](const Body& body, const Vector3d& arm, InertiaSlip inertia) {
    const Vector3d r_cross_n = arm.cross(n);
    return r_cross_n.dot(inverse_inertia_by(body, inertia) * r_cross_n);
  };
  double inverse_mass = a.inertia.inverse_mass + b.inertia.inverse_mass;
  if (slip.turning_of_a) inverse_mass += turning(a, arm_a, slip.inertia_of_a);
  if (slip.turning_of_b) inverse_mass += turning(b, arm_b, slip.inertia_of_b);
  const double u = relative_normal_velocity_by(e, slip);
  return u >= 0.0 ? 0.0 : -(1.0 + restitution) * u / inverse_mass;
}

namespace {

// Possible mistakes in a formula, with names for a velocity and for an impulse alike.
std::vector<std::pair<FormulaSlip, std::string>> formula_slips() {
  return {{{.spin_of_a = false, .spin_of_b = false},
           "relative velocity without rotation: the touching point moves at v + w x r"},
          {{.spin_of_a = false}, "the spin of A left out: u_a = v_a + w_a x r_a"},
          {{.spin_of_b = false},
           "the spin of B left out: u_b = v_b + w_b x r_b, for a turning wall too"},
          {{.right_handed = false}, "r x w where w x r belongs (or a left-handed cross product)"},
          {{.own_arms = false}, "the arm of A used for B: each body has its own arm, r = p - x"},
          {{.arms_from_com = false}, "the arm starts at the world's origin: r = p - x"},
          {{.walls_move = false},
           "an immovable body taken to be at rest: infinite mass says nothing about its velocity"}};
}

std::vector<std::pair<FormulaSlip, std::string>> denominator_slips() {
  using enum InertiaSlip;
  const std::string body_axes = "body inertia where world inertia belongs: I^-1 = R I_body^-1 R^T",
                    transposed = "R and R^T swapped: I^-1 = R I_body^-1 R^T";
  const std::string diagonal =
      "the diagonal of the tensor alone: products of inertia count, I^-1 is the inverse of the "
      "whole matrix";
  std::vector<std::pair<FormulaSlip, std::string>> slips = {
      {{.turning_of_a = false, .turning_of_b = false},
       "the rotation term of the denominator is missing"},
      {{.turning_of_a = false}, "the turning of A is missing in the denominator"},
      {{.turning_of_b = false},
       "the turning of B is missing in the denominator: it sums over both bodies"}};
  for (const auto& [inertia, words] :
       {std::pair{kBodyAxes, body_axes},
        {kTransposed, transposed},
        {kDiagonal, diagonal},
        {kOneByOne, diagonal},
        {kNotInverted, std::string("inertia where inverse inertia belongs")}}) {
    slips.push_back({{.inertia_of_a = inertia, .inertia_of_b = inertia}, words});
    slips.push_back({{.inertia_of_a = inertia}, words + " (in the term of A)"});
    slips.push_back({{.inertia_of_b = inertia}, words + " (in the term of B)"});
  }
  return slips;
}

/// A mistake that changes nothing here is left out: an answer that is almost right must not be
/// named after it.
Slips<Vector3d> without(const Vector3d& right, Slips<Vector3d> slips) {
  std::erase_if(slips, [&](const auto& slip) {
    return (slip.first - right).norm() <= 1e3 * kSameAnswer * right.norm();
  });
  return slips;
}

void add_if_wrong(Slips<double>& slips, double gives, double truth, const std::string& words) {
  if (std::abs(gives - truth) > 1e3 * kSameAnswer * std::abs(truth))
    slips.push_back({gives, words});
}

}  // namespace

Slips<double> slips_of_relative_velocity(const Encounter& e) {
  const double u = relative_normal_velocity_by(e);
  Slips<double> slips = {{-u, "u_b - u_a where u_a - u_b belongs: n points from B to A"}};
  for (const auto& [slip, words] : formula_slips())
    add_if_wrong(slips, relative_normal_velocity_by(e, slip), u, words);
  return slips;
}

Slips<double> slips_of_impulse(const Encounter& e, double restitution) {
  const double j = collision_impulse_by(e, restitution), plastic = j / (1.0 + restitution);
  Slips<double> slips = {{-j,
                          "the sign of j is wrong: u_n is negative when bodies approach, so j "
                          "needs the minus in front"}};
  add_if_wrong(slips, plastic, j, "the (1 + e) is missing");
  add_if_wrong(slips, restitution * plastic, j, "e where (1 + e) belongs");
  add_if_wrong(slips, (1.0 + restitution * restitution) * plastic, j,
               "1 + e^2 where 1 + e belongs: e is a ratio of speeds, e^2 one of energies");
  add_if_wrong(slips, (1.0 - restitution) * plastic, j, "1 - e where 1 + e belongs");
  add_if_wrong(slips, 2.0 * plastic, j, "a perfect bounce whatever e is: (1 + e), also for e = 0");
  for (const auto& [slip, words] : formula_slips())
    add_if_wrong(slips, collision_impulse_by(e, restitution, slip), j, words);
  for (const auto& [slip, words] : denominator_slips())
    add_if_wrong(slips, collision_impulse_by(e, restitution, slip), j, words);
  // A mistake in one place only: the velocity or the denominator.
  for (const auto& [slip, words] : formula_slips())
    add_if_wrong(slips, j * relative_normal_velocity_by(e, slip) / relative_normal_velocity_by(e),
                 j, words);
  const double speed = relative_normal_velocity_by(e);
  for (const auto& [slip, words] : formula_slips())
    if (const double u = relative_normal_velocity_by(e, slip); u < 0.0)
      add_if_wrong(slips, collision_impulse_by(e, restitution, slip) * speed / u, j,
                   words + " (in the denominator)");
  if (j > 0.0)
    slips.push_back({0.0,
                     "no impulse: approaching bodies treated as separating, or an absolute "
                     "threshold that takes something small for nothing"});
  return slips;
}

Slips<Vector3d> slips_of_apply(const Body& body, const Vector3d& impulse_world,
                               const Vector3d& point_world) {
  using enum InertiaSlip;
  const Vector3d& w = body.omega_world;
  const Vector3d angular_impulse = (point_world - body.com_world).cross(impulse_world),
                 change = inverse_inertia_by(body) * angular_impulse;
  const std::string diagonal =
      "the diagonal of the tensor alone: products of inertia count, I^-1 is the inverse of the "
      "whole matrix";
  return without(w + change,
                 {{w,
                   "the angular velocity is not changed: an impulse off the centre also turns, "
                   "however small it is"},
                  {w - change, "J x r where r x J belongs (or a left-handed cross product)"},
                  {change, "the old angular velocity is lost: the impulse adds to it"},
                  {w + angular_impulse, "the inverse inertia is missing"},
                  {w + inverse_inertia_by(body) * point_world.cross(impulse_world),
                   "the arm starts at the world's origin: r = p - x"},
                  {w + inverse_inertia_by(body, kBodyAxes) * angular_impulse,
                   "body inertia where world inertia belongs: I^-1 = R I_body^-1 R^T"},
                  {w + inverse_inertia_by(body, kTransposed) * angular_impulse,
                   "R and R^T swapped: I^-1 = R I_body^-1 R^T"},
                  {w + inverse_inertia_by(body, kDiagonal) * angular_impulse, diagonal},
                  {w + inverse_inertia_by(body, kOneByOne) * angular_impulse, diagonal},
                  {w + inverse_inertia_by(body, kNotInverted) * angular_impulse,
                   "inertia where inverse inertia belongs"}});
}

Vector3d angular_acceleration_by(const Body& body, const Vector3d& torque_world) {
  const Matrix3d R = body.world_from_body.toRotationMatrix(),
                 I = R * body.inertia.inertia_body * R.transpose();
  return inverse_inertia_by(body) * (torque_world - body.omega_world.cross(I * body.omega_world));
}

Slips<Vector3d> slips_of_angular_acceleration(const Body& body, const Vector3d& torque_world) {
  const Matrix3d R = body.world_from_body.toRotationMatrix(), &I = body.inertia.inertia_body,
                 &inverse = body.inertia.inverse_inertia_body;
  const Vector3d w = R.transpose() * body.omega_world, tau = R.transpose() * torque_world,
                 gyroscopic = w.cross(I * w);
  const Vector3d moments = I.diagonal(), one_by_one = moments.cwiseInverse();
  const Vector3d& w_world = body.omega_world;
  const Vector3d swapped_w = R * w_world, swapped_tau = R * torque_world;
  const Vector3d right = R * (inverse * (tau - gyroscopic));
  const std::string diagonal =
      "the diagonal of the tensor alone: Euler's three equations hold about principal axes only, "
      "so use the whole matrix";
  return without(
      right,
      {{R * (inverse * tau), "the gyroscopic term - w x (I w) is missing"},
       {R * (inverse * (tau + gyroscopic)),
        "the sign of the gyroscopic term is wrong: it is subtracted (or a left-handed cross "
        "product)"},
       {-right, "the sign is wrong"},
       {R * one_by_one.cwiseProduct(tau - w.cross(moments.cwiseProduct(w))), diagonal},
       {R * Vector3d(inverse.diagonal()).cwiseProduct(tau - w.cross(moments.cwiseProduct(w))),
        diagonal},
       {R * one_by_one.cwiseProduct(tau - gyroscopic), diagonal},
       {R * (inverse * (tau - w.cross(moments.cwiseProduct(w)))), diagonal},
       {R * (inverse * (torque_world - gyroscopic)),
        "the torque left in the world frame: tau_body = R^T tau_world"},
       {inverse * (tau - gyroscopic), "the result left in the body frame: R carries it back"},
       {inverse * (torque_world - w_world.cross(I * w_world)),
        "body inertia where world inertia belongs: bring torque and w into the body frame, and the "
        "result back"},
       {R * (inverse * (tau - w_world.cross(I * w_world))),
        "body inertia multiplied with world components of w: bring w into the body frame first"},
       {R.transpose() * (inverse * (swapped_tau - swapped_w.cross(I * swapped_w))),
        "R and R^T swapped: w_body = R^T w_world, and R takes the result back"},
       {R * (I * (tau - gyroscopic)), "inertia where inverse inertia belongs"},
       {Vector3d::Zero(),
        "nothing came: an absolute threshold takes something small for nothing"}});
}

}  // namespace tumble::testing
