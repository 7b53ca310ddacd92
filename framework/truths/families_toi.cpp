// toi_*: times of impact of bodies on given motions, by the framework's collision detection with
// the laws' root finder.
// World frame, z up. `exp(t [w])` is a rotation about the constant world axis w.
#include <cmath>

#include "framework/collision/first_impact.h"
#include "framework/core/shortest_turn.h"
#include "framework/engines/base/tolerances.h"
#include "framework/truths/families.h"
#include "framework/truths/impact_problem.h"

namespace tumble::truths {
namespace {

using namespace collision;

// s: searched in windows, each as long as all before, so that no case needs its own horizon
constexpr double kFirstHorizon = 1.0;
constexpr double kLastHorizon = 1024.0;  // s

/// x = x0 + v t + a t^2 / 2,   R = exp(t [w]) R0
struct GivenMotion {
  Vector3d com0_world = Vector3d::Zero(), velocity_world = Vector3d::Zero(),
           acceleration_world = Vector3d::Zero();
  Quaterniond world_from_body_0 = Quaterniond::Identity();
  Vector3d omega_world = Vector3d::Zero();

  MotionState at(double t) const {
    MotionState state;
    state.pose.com_world = com0_world + (velocity_world + 0.5 * t * acceleration_world) * t;
    const double speed = omega_world.norm();
    state.pose.world_from_body =
        speed > 0.0
            ? Quaterniond(Eigen::AngleAxisd(speed * t, omega_world / speed)) * world_from_body_0
            : world_from_body_0;
    state.velocity_world = velocity_world + t * acceleration_world;
    state.omega_world = omega_world;
    return state;
  }
  Motion motion() const {
    MotionBounds bounds;
    bounds.acceleration_world = acceleration_world;
    bounds.angular_speed = omega_world.norm();
    return {[copy = *this](double t) { return copy.at(t); }, bounds};
  }
};

struct Solid {
  CollisionShape shape;
  GivenMotion motion;
};

std::optional<Impact> find_impact(const Solid& a, const Solid& b, const Laws& laws,
                                  double last = kLastHorizon) {
  const ImpactOptions options{laws.find_impact_time};
  const Motion motion_a = a.motion.motion(), motion_b = b.motion.motion();
  double begin = 0.0;
  for (double end = std::min(kFirstHorizon, last); begin < last;
       begin = end, end = std::min(2.0 * end, last)) {
    if (auto impact = first_impact(a.shape, motion_a, b.shape, motion_b, begin, end, options))
      return impact;
  }
  return std::nullopt;
}

/// A half-space below the plane n.x = d.
Solid plane(const Vector3d& normal_world, double d) {
  GivenMotion at_rest;
  at_rest.com0_world = d * normal_world;
  at_rest.world_from_body_0 = shortest_turn(Vector3d::UnitZ(), normal_world);
  return {CollisionShape(HalfSpace{}), at_rest};
}

Vector3d gravity(const Case& truth) { return {0.0, 0.0, -truth.input("g").number()}; }

/// Compares the time; false, with a failed line, where no impact was found.
bool compare_toi(const Case& truth, const std::optional<Impact>& impact, Comparison& comparison) {
  if (!impact)
    comparison.agree("toi", false, "no impact was found");
  else
    comparison.closed_form(truth, "toi", impact->time);
  return impact.has_value();
}

// ---- toi_sphere_plane --------------------------------------------------------------------------

Solid ball_of(const Case& truth) {
  Solid ball{CollisionShape(Sphere{truth.input("R").number()}), {}};
  ball.motion.com0_world = truth.input("x0").vector3();
  ball.motion.velocity_world = truth.input("v0").vector3();
  ball.motion.acceleration_world = gravity(truth);
  return ball;
}

void compare_sphere_plane(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Solid ball = ball_of(truth);
  const auto impact = find_impact(
      ball, plane(truth.input("n").vector3().normalized(), truth.input("d").number()), laws);
  if (!compare_toi(truth, impact, comparison)) return;
  const MotionState state = ball.motion.at(impact->time);
  comparison.closed_form(truth, "centre_at_toi", VectorXd(state.pose.com_world));
  comparison.closed_form(truth, "velocity_at_toi", VectorXd(state.velocity_world));
  comparison.closed_form(truth, "contact_point", VectorXd(impact->gap.point_b_world));
  comparison.closed_form(truth, "normal_velocity_at_toi", impact->rate);
}

// ---- toi_rod_plane -----------------------------------------------------------------------------

Solid rod_of(const Case& truth) {
  const double half = 0.5 * truth.input("L").number(), phi0 = truth.input("phi0").number(),
               omega = truth.input("omega").number();
  const double thickness = 1e-25 * half;  // negligible, and yet a box
  Solid rod{CollisionShape(Box{Vector3d(half, thickness, thickness)}), {}};
  rod.motion.com0_world = {0.0, 0.0, truth.input("h").number()};
  rod.motion.velocity_world = {0.0, 0.0, truth.input("v_up").number()};
  rod.motion.acceleration_world = gravity(truth);
  // The angle grows from x towards z: a rotation about -y.
  rod.motion.world_from_body_0 = Eigen::AngleAxisd(phi0, -Vector3d::UnitY());
  rod.motion.omega_world = {0.0, -omega, 0.0};
  return rod;
}

void compare_rod_plane(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Solid rod = rod_of(truth);
  const double phi0 = truth.input("phi0").number(), omega = truth.input("omega").number();
  const auto impact = find_impact(rod, plane(Vector3d::UnitZ(), 0.0), laws);
  if (!compare_toi(truth, impact, comparison)) return;
  const MotionState state = rod.motion.at(impact->time);
  const Vector3d arm_world = impact->gap.point_a_world - state.pose.com_world;
  const double along_rod = (state.pose.world_from_body.conjugate() * arm_world).x();
  comparison.closed_form(truth, "tip_sign", along_rod < 0.0 ? -1.0 : 1.0);
  comparison.closed_form(truth, "tip_normal_velocity", impact->rate);
  comparison.closed_form(truth, "centre_height", state.pose.com_world.z());
  comparison.closed_form(truth, "angle", phi0 + omega * impact->time);
  comparison.closed_form(truth, "tip_x_from_centre", arm_world.x());
}

// ---- toi_boxes ---------------------------------------------------------------------------------

/// The colliding features, in the files' words, from the separating axis: a face's normal, or the
/// cross product of two edges.
std::string feature_pair(const Pose& a, const Pose& b, const Vector3d& normal_world) {
  // No case of the files has edges nearly parallel to faces: six digits tell them apart.
  const Matrix3d A = a.world_from_body.toRotationMatrix(), B = b.world_from_body.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    const std::string axis = std::to_string(i);
    if (A.col(i).cross(normal_world).norm() < engines::kSixDigits)
      return "vertex of B / face of A with body axis " + axis;
    if (B.col(i).cross(normal_world).norm() < engines::kSixDigits)
      return "vertex of A / face of B with body axis " + axis;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector3d axis = A.col(i).cross(B.col(j)).normalized();
      if (axis.cross(normal_world).norm() < engines::kSixDigits)
        return "edge of A along body axis " + std::to_string(i) + " / edge of B along body axis " +
               std::to_string(j);
    }
  }
  return "none";
}

Solid box_of(const Case& truth, const std::string& which) {
  Solid box{CollisionShape(Box{truth.input("half_" + which).vector3()}), {}};
  box.motion.com0_world = truth.input("x" + which).vector3();
  box.motion.velocity_world = truth.input("v" + which).vector3();
  box.motion.omega_world = truth.input("omega" + which + "_world").vector3();
  return box;
}

void compare_boxes(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Solid a = box_of(truth, "A"), b = box_of(truth, "B");
  const auto impact = find_impact(a, b, laws);
  if (!compare_toi(truth, impact, comparison)) return;
  const Vector3d normal_a_to_b = -impact->gap.normal_b_to_a_world;
  comparison.closed_form(truth, "normal_A_to_B", VectorXd(normal_a_to_b));
  comparison.closed_form(truth, "contact_point", VectorXd(impact->gap.point_a_world));
  comparison.closed_form(truth, "relative_normal_velocity", impact->rate);
  const std::string found =
      feature_pair(a.motion.at(impact->time).pose, b.motion.at(impact->time).pose, normal_a_to_b);
  comparison.agree("feature_pair", found == truth.output("feature_pair").text(), found);
}

// ---- toi_grazing -------------------------------------------------------------------------------

/// The two bodies of one row, and the rate at which the normal speed grows as they approach
/// [m/s^2].
struct Graze {
  Solid a, b;
  double closing_rate;
};

Graze ceiling(const Case& truth, const Value& row) {
  Solid ball{CollisionShape(Sphere{truth.input("R").number()}), {}};
  ball.motion.com0_world = {0.0, 0.0, truth.input("h").number()};
  ball.motion.velocity_world = {0.0, 0.0, truth.input("v").number()};
  ball.motion.acceleration_world = gravity(truth);
  return {ball, plane(-Vector3d::UnitZ(), -row.at("ceiling_height").number()),
          truth.input("g").number()};
}

Graze passing_spheres(const Case& truth, const Value& row) {
  const double v = truth.input("v").number(), r1 = truth.input("R1").number(),
               r2 = truth.input("R2").number();
  Solid mover{CollisionShape(Sphere{r1}), {}}, target{CollisionShape(Sphere{r2}), {}};
  mover.motion.com0_world = {-truth.input("D").number(), row.at("impact_parameter").number(), 0.0};
  mover.motion.velocity_world = {v, 0.0, 0.0};
  return {mover, target, v * v / (r1 + r2)};
}

void compare_graze(const Graze& graze, const Value& row, const std::string& name, const Laws& laws,
                   Comparison& comparison) {
  const double closest = row.at("time_of_closest").number(),
               floor = row.at("toi_tolerance_floor").number();
  const auto impact = find_impact(graze.a, graze.b, laws, 2.0 * closest);
  // A touching pair must not be found repeatedly: no NaN, and no overlap.
  const bool sane = !impact || (std::isfinite(impact->time) && impact->gap.distance >= 0.0);
  comparison.agree(name + ".sane", sane, "a finite time and no overlap, or no impact");
  const bool should_hit = row.at("verdict").text() != "miss";
  if (!row.at("decidable_in_binary64").boolean()) {
    comparison.not_compared(
        name + ".verdict",
        std::string("within rounding of a grazing contact, either answer is right; found ") +
            (impact ? "an impact" : "a miss"));
  } else {
    comparison.agree(name + ".verdict", impact.has_value() == should_hit, row.at("verdict").text());
  }
  const Pose a = graze.a.motion.at(closest).pose, b = graze.b.motion.at(closest).pose;
  const double scale = gap_scale(graze.a.shape, a, graze.b.shape, b);
  comparison.closed_form(name + ".closest_gap",
                         std::abs(compute_gap(graze.a.shape, a, graze.b.shape, b).distance -
                                  row.at("closest_gap").number()),
                         0x1p-53 * scale);
  if (!impact || !should_hit) return;
  comparison.closed_form(name + ".toi", std::abs(impact->time - row.at("toi").number()), floor);
  comparison.closed_form(name + ".normal_speed",
                         std::abs(-impact->rate - row.at("normal_speed").number()),
                         graze.closing_rate * floor);
}

void compare_grazing(const Case& truth, const Laws& laws, Comparison& comparison) {
  const std::string& kind = truth.input("kind").text();
  int index = 0;
  for (const Value& row : truth.output("rows").list()) {
    const std::string name = "rows[" + std::to_string(index++) + "]";
    if (kind == "ceiling")
      compare_graze(ceiling(truth, row), row, name, laws, comparison);
    else if (kind == "spheres")
      compare_graze(passing_spheres(truth, row), row, name, laws, comparison);
    else
      comparison.not_compared(name, "an unknown kind: " + kind);
  }
}

// ---- toi_tunnel --------------------------------------------------------------------------------

void compare_tunnel(const Case& truth, const Laws& laws, Comparison& comparison) {
  const double v = truth.input("v").number(), thickness = truth.input("wall_thickness").number(),
               dt = truth.input("dt").number();
  Solid bullet{CollisionShape(Sphere{truth.input("R").number()}), {}};
  bullet.motion.com0_world.x() = truth.input("x_centre_0").number();
  bullet.motion.velocity_world.x() = v;
  Solid wall{CollisionShape(Box{Vector3d(0.5 * thickness, 1.0, 1.0)}), {}};
  wall.motion.com0_world.x() = truth.input("wall_front_face_x").number() + 0.5 * thickness;
  compare_toi(truth, find_impact(bullet, wall, laws), comparison);
  comparison.closed_form(truth, "step_length", v * dt);

  bool seen = false;
  for (int k = 0; k * dt <= truth.input("T").number(); ++k) {
    seen = seen || compute_gap(bullet.shape, bullet.motion.at(k * dt).pose, wall.shape,
                               wall.motion.at(0.0).pose)
                           .distance < 0.0;
  }
  comparison.agree("discrete_sampling_sees_overlap",
                   seen == truth.output("discrete_sampling_sees_overlap").boolean(),
                   seen ? "seen" : "not seen");
  compare_tunnel_run(truth, laws, comparison);
}

}  // namespace

namespace {

ImpactProblem problem_between(const Case& truth, const Solid& a, const Solid& b, double window_s) {
  const double toi = truth.output("toi").number();
  ImpactProblem problem{truth.id, {}, {}, window_s * std::floor(toi / window_s), 0.0, toi, {}};
  problem.high = problem.low + window_s;
  problem.gap = [a, b](double t) {
    return compute_gap(a.shape, a.motion.at(t).pose, b.shape, b.motion.at(t).pose).distance;
  };
  problem.gap_rate = [a, b](double t) {
    const MotionState at_a = a.motion.at(t), at_b = b.motion.at(t);
    return gap_rate(compute_gap(a.shape, at_a.pose, b.shape, at_b.pose), at_a, at_b);
  };
  return problem;
}

/// Ball and plane under gravity: n.x0 - d - R + n.v t - (n.g / 2) t^2 = 0, the first root in the
/// form without cancellation.
double ball_meets_plane(const Case& truth) {
  const Vector3d normal = truth.input("n").vector3().normalized();
  const double c = normal.dot(truth.input("x0").vector3()) - truth.input("d").number() -
                   truth.input("R").number();
  const double b = normal.dot(truth.input("v0").vector3()), a = 0.5 * normal.dot(gravity(truth));
  return 2.0 * c / (-b + std::sqrt(b * b - 4.0 * a * c));
}

}  // namespace

std::optional<ImpactProblem> impact_problem(const Case& truth, double window_s) {
  if (truth.family == "toi_sphere_plane") {
    ImpactProblem problem = problem_between(
        truth, ball_of(truth),
        plane(truth.input("n").vector3().normalized(), truth.input("d").number()), window_s);
    problem.closed_form = [truth] { return ball_meets_plane(truth); };
    return problem;
  }
  if (truth.family == "toi_rod_plane")
    return problem_between(truth, rod_of(truth), plane(Vector3d::UnitZ(), 0.0), window_s);
  if (truth.family == "toi_boxes")
    return problem_between(truth, box_of(truth, "A"), box_of(truth, "B"), window_s);
  // A grazing impact is a double root, and a bullet has passed the wall at the end of a step: no
  // bracket.
  return std::nullopt;
}

void compare_times_of_impact(const Case& truth, const Laws& laws, Comparison& comparison) {
  if (truth.family == "toi_sphere_plane") compare_sphere_plane(truth, laws, comparison);
  if (truth.family == "toi_rod_plane") compare_rod_plane(truth, laws, comparison);
  if (truth.family == "toi_boxes") compare_boxes(truth, laws, comparison);
  if (truth.family == "toi_grazing") compare_grazing(truth, laws, comparison);
  if (truth.family == "toi_tunnel") compare_tunnel(truth, laws, comparison);
}

}  // namespace tumble::truths
