// friction_incline, roll_incline, slip_to_roll: a block or a ball in persistent contact with a
// plane, run by the engine with the chosen laws.
//
// The forces are constant while a body slides, sticks or rolls, and the engine's motion is exact
// for constant forces: the step size has no effect. Besides rounding only the documented tolerance
// of the contact solver has one: a fraction of m g for forces, of g for accelerations, of g t for
// velocities. x points down the incline, y across it, z out of it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/dynamics/contact_problem.h"
#include "framework/engines/base/tolerances.h"
#include "framework/truths/families.h"
#include "framework/truths/memory_scene.h"
#include "framework/scene/write_entries.h"

namespace tumble::truths {
namespace {

// per run at least; the motion changes within a step, not at its end
constexpr long kSteps = 50;
// s: contact forces follow from the impulse of gravity in a step, g h, and are rounded at its size
constexpr double kLongestStep = 0.1;

struct Incline {
  double angle, mu, g, m;

  Incline(const Case& truth, double degrees)
      : angle(degrees * std::numbers::pi / 180.0),
        mu(truth.input("mu").number()),
        g(truth.input("g").number()),
        m(truth.input("m").number()) {}
  Quaterniond orientation() const {
    return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  }
  Vector3d down() const { return {std::cos(angle), 0.0, -std::sin(angle)}; }
  Vector3d out() const { return {std::sin(angle), 0.0, std::cos(angle)}; }
  scene::Scene scene(const std::string& name, double duration, scene::BodySpec body,
                     double height) const;
};

/// @param height  of the body's centre above the plane [m]
scene::Scene Incline::scene(const std::string& name, double duration, scene::BodySpec body,
                            double height) const {
  scene::Scene scene = empty_scene(name, duration, engines::kNegligibleSpeed);
  scene::EntryWriter{scene}("gravity_m_s2", Vector3d(0, 0, -g));
  scene.contact = scene::ContactSpec{};
  body.position_m = height * out();
  scene::BodySpec plane = wall("incline", Vector3d::Zero(), Vector3d::UnitZ(), 0.0);
  plane.world_from_body = orientation();
  for (scene::BodySpec* spec : {&body, &plane}) {
    spec->friction = mu;
    spec->restitution = 0.0;
  }
  scene.bodies = {body, plane};
  return scene;
}

/// A run with a frame at every step.
Trajectory run_by_steps(const scene::Scene& scene, const Laws& laws) {
  const long steps = std::max(kSteps, static_cast<long>(scene.duration_s / kLongestStep));
  return run_in_steps(scene, laws, scene.duration_s, steps, steps);
}

struct Push {
  double normal = 0.0;
  Vector3d friction = Vector3d::Zero();
};
/// Contact force of the incline on the first body, over all contact points.
Push push_in(const Frame& frame) {
  Push push;
  for (const ContactPoint& contact : frame.contacts) {
    const double sign = contact.body_a == 0 ? 1.0 : -1.0;
    const double normal = contact.force_on_a_world.dot(contact.normal_b_to_a_world);
    push.normal += normal;
    push.friction += sign * (contact.force_on_a_world - normal * contact.normal_b_to_a_world);
  }
  return push;
}

/// Energy dissipated by friction. Heights are measured along the incline: the contact margin
/// between body and plane does no work.
double energy_lost(const Incline& incline, const Frame& from, const Frame& to) {
  const double way = incline.down().dot(to.poses[0].com_world - from.poses[0].com_world);
  return from.kinetic_energy - to.kinetic_energy +
         incline.m * incline.g * std::sin(incline.angle) * way;
}

// ---- friction_incline --------------------------------------------------------------------------

// A flat block: friction at its base, mu m g high at most, does not lift its edge.
scene::Scene block_on(const Incline& incline, const std::string& name, double duration, double v0) {
  const double half_length = 0.5, half_height = 0.25 * half_length / (1.0 + incline.mu);  // [m]
  scene::BodySpec block = ball("block", incline.m, 1.0, Vector3d::Zero(), v0 * incline.down(), 0.0);
  block.shape = scene::BoxSpec{Vector3d(half_length, half_length, half_height)};
  block.world_from_body = incline.orientation();
  return incline.scene(name, duration, block, half_height);
}

/// The tolerance is the larger of 100 floors and the solver's tolerance of `size`.
void check_solved(const Case& truth, const std::string& output, double found, double size,
                  Comparison& comparison) {
  const double floor = truth.floor(output), solver = ContactOptions{}.tolerance * size,
               rounding = kClosedFormFactor * floor;
  comparison.check(output, std::abs(found - truth.output(output).number()), floor,
                   std::max(rounding, solver),
                   solver > rounding ? "tolerance: that of the contact solver" : "");
}

double speed_down(const Incline& incline, const Frame& frame) {
  return incline.down().dot(frame.poses[0].velocity_world);
}

/// Whether a block on an incline with this friction stays at rest after release.
bool holds(Incline incline, double mu, const Laws& laws) {
  incline.mu = mu;
  const Trajectory run = run_by_steps(block_on(incline, "let go", 1.0, 0.0), laws);
  return run.frames.back().poses[0].velocity_world.norm() <= engines::kNegligible;
}

/// The last frame with this speed above 0. @pre the first frame has it
template <class Speed>
const Frame& last_sliding(const Trajectory& run, const Speed& speed) {
  const double least = engines::kNegligible * std::abs(speed(run.frames.front()));
  std::size_t last = 0;
  while (last + 1 < run.frames.size() && std::abs(speed(run.frames[last + 1])) > least) ++last;
  return run.frames[last];
}

}  // namespace

void compare_friction_incline(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Incline incline(truth, truth.input("alpha_deg").number());
  const double v0 = truth.input("v0").number();
  const double critical = std::tan(incline.angle);
  comparison.closed_form(truth, "critical_mu", critical);
  if (critical > 0.0) {
    comparison.attempt("critical_mu in runs", [&] {
      comparison.agree(
          "critical_mu in runs",
          holds(incline, critical * (1.0 + engines::kSixDigits), laws) &&
              !holds(incline, critical * (1.0 - engines::kSixDigits), laws),
          "a released block stays at a friction 1e-6 above it and slides at one 1e-6 below");
    });
  }

  comparison.attempt("run", [&] {
    // Long enough to stop and stand, if it stops.
    const double braking =
        incline.g * (incline.mu * std::cos(incline.angle) - std::sin(incline.angle));
    const bool stops = braking > 0.0;
    const double duration = stops ? 1.3 * std::abs(v0) / braking : 1.0;
    const Trajectory run = run_by_steps(block_on(incline, truth.id, duration, v0), laws);
    const auto speed = [&](const Frame& frame) { return speed_down(incline, frame); };
    const Frame &first = run.frames.front(), &sliding = last_sliding(run, speed),
                &end = run.frames.back();
    const double g = incline.g, weight = incline.m * g,
                 deceleration = (speed(first) - speed(sliding)) / sliding.time;
    check_solved(truth, "deceleration", deceleration, g, comparison);
    check_solved(truth, "normal_force", push_in(sliding).normal, weight, comparison);
    check_solved(truth, "friction_force_sliding", push_in(sliding).friction.norm(), weight,
                 comparison);
    if (!stops || truth.output("stop_time").is_null()) {
      comparison.agree("stop_time",
                       !stops && truth.output("stop_time").is_null() && &sliding == &end,
                       "never stops");
      return;
    }
    // t = v0 / a and d = v0^2 / (2 a) have the relative error of a.
    const double time = sliding.time + speed(sliding) / deceleration,
                 way = incline.down().dot(end.poses[0].com_world - first.poses[0].com_world);
    check_solved(truth, "stop_time", time, time * g / braking, comparison);
    check_solved(truth, "stop_distance", way, std::abs(way) * g / braking, comparison);
    check_solved(truth, "friction_force_rest", push_in(end).friction.norm(), weight, comparison);
    check_solved(truth, "energy_dissipated", energy_lost(incline, first, end),
                 weight * std::abs(way) * g / braking, comparison);
    comparison.agree("stands",
                     end.poses[0].velocity_world.norm() <= engines::kNegligible * std::abs(v0) &&
                         push_in(end).normal > 0.0,
                     "stands still at the end, pressed onto the incline");
  });
}

// ---- Round bodies ------------------------------------------------------------------------------

namespace {

/// A ball with I = beta m R^2: every body that rolls straight, cylinder or hoop, moves like it.
scene::BodySpec round_body(double m, double R, double beta, const Vector3d& velocity,
                           const Vector3d& omega) {
  scene::BodySpec body = ball("round", m, R, Vector3d::Zero(), velocity, 0.0);
  body.inertia_body_kg_m2 = beta * m * R * R * Matrix3d::Identity();
  body.omega_world_rad_s = omega;
  return body;
}

}  // namespace

void compare_roll_incline(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Incline incline(truth, truth.input("alpha_deg").number());
  const double R = truth.input("R").number(), beta = truth.input("beta").number(),
               T = truth.input("T").number();
  comparison.closed_form(truth, "critical_mu", std::tan(incline.angle) * beta / (1.0 + beta));
  comparison.attempt("run", [&] {
    const scene::Scene scene = incline.scene(
        truth.id, T, round_body(incline.m, R, beta, Vector3d::Zero(), Vector3d::Zero()), R);
    const Trajectory run = run_by_steps(scene, laws);
    const Frame &first = run.frames.front(), &middle = run.frames[run.frames.size() / 2],
                &end = run.frames.back();
    const auto speed = [&](const Frame& frame) { return speed_down(incline, frame); };
    const auto spin = [](const Frame& frame) { return frame.poses[0].omega_world.y(); };
    const bool rolls =
        std::abs(speed(end) - R * spin(end)) <= engines::kNegligible * std::abs(speed(end));
    comparison.agree("rolls_without_slip", rolls == truth.output("rolls_without_slip").boolean(),
                     rolls ? "it rolls" : "it slides");
    const double time = end.time - middle.time;
    const double g = incline.g;
    check_solved(truth, "acceleration", (speed(end) - speed(middle)) / time, g, comparison);
    check_solved(truth, "angular_acceleration", (spin(end) - spin(middle)) / time, g / (beta * R),
                 comparison);
    check_solved(truth, "friction_force", push_in(end).friction.norm(), incline.m * g, comparison);
    check_solved(truth, "x_T",
                 incline.down().dot(end.poses[0].com_world - first.poses[0].com_world), g * T * T,
                 comparison);
    check_solved(truth, "v_T", speed(end), g * T, comparison);
    check_solved(truth, "omega_T", spin(end), g * T / (beta * R), comparison);
  });
}

void compare_slip_to_roll(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Incline level(truth, 0.0);
  const double R = truth.input("R").number(), beta = truth.input("beta").number(),
               v0 = truth.input("v0").number(), w0 = truth.input("omega0_forward").number();
  comparison.attempt("run", [&] {
    // Long enough to roll, if friction makes it roll.
    const double braking = level.mu * level.g * (1.0 + 1.0 / beta), slip0 = std::abs(v0 - R * w0);
    const double duration = braking > 0.0 && slip0 > 0.0 ? 1.3 * slip0 / braking : 1.0;
    const Trajectory run = run_by_steps(
        level.scene(truth.id, duration,
                    round_body(level.m, R, beta, Vector3d(v0, 0, 0), Vector3d(0, w0, 0)), R),
        laws);
    const auto slip = [R](const Frame& frame) {
      return frame.poses[0].velocity_world.x() - R * frame.poses[0].omega_world.y();
    };
    const Frame &first = run.frames.front(), &sliding = last_sliding(run, slip),
                &end = run.frames.back();
    const bool rolls = std::abs(slip(end)) <= engines::kNegligible * std::max(slip0, std::abs(v0));
    if (!rolls || truth.output("roll_time").is_null()) {
      comparison.agree("roll_time", !rolls && truth.output("roll_time").is_null(),
                       rolls ? "it rolls" : "it never rolls");
      return;
    }
    // The slip decreases linearly while it slides.
    const double change = std::abs(slip(first) - slip(sliding)),
                 roll_time = change > 0.0 ? sliding.time * std::abs(slip(first)) / change : 0.0;
    const double speed = end.poses[0].velocity_world.x(), gained = level.g * duration;
    check_solved(truth, "roll_time", roll_time, duration / level.mu, comparison);
    check_solved(truth, "roll_velocity", speed, gained, comparison);
    check_solved(truth, "roll_omega", end.poses[0].omega_world.y(), gained / (beta * R),
                 comparison);
    check_solved(
        truth, "roll_distance",
        end.poses[0].com_world.x() - first.poses[0].com_world.x() - speed * (end.time - roll_time),
        gained * duration / level.mu, comparison);
    check_solved(truth, "energy_lost", energy_lost(level, first, end),
                 level.m * gained * (std::abs(v0) + gained), comparison);
  });
}

}  // namespace tumble::truths
