#include "tests/fuzz/judge_trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/collision/gap.h"
#include "framework/dynamics/world.h"
#include "framework/effects/build_world.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"

namespace tumble::fuzz {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEps = std::numeric_limits<double>::epsilon();
// Energy above the least so far, relative to the moving energy: methods of integration have
// truncation errors, which is no fault. The run itself reports one per cent; this is three times as
// much, because the initial energy is summed differently here.
constexpr double kEnergyGrowth = 0.03;
// Rounding and position correction may move a resting body: by this fraction of its size, which is
// invisible.
constexpr double kStir = 1e-5;
// Overlap relative to the smaller body's size. Contacts are kept apart up to rounding of sizes and
// positions; this is above all of them.
constexpr double kOverlap = 1e-8;
// Largest error of rods and joints, relative to their lever arms. Projection leaves 1e-10; a run
// that opens a joint leaves more.
constexpr double kOpen = 1e-6;
// A frame between two steps is interpolated between their ends, where links hold. The error is of
// fourth order: a tenth of a radian per step gives 1e-5 in the middle, and a run that opens a joint
// does so at the ends, too.
constexpr double kOpenBetween = 1e-4;

struct Judge {
  const scene::Scene& scene;
  const Trajectory& run;
  World world;
  std::vector<Fault> faults;

  const BodyPose& pose(const Frame& frame, int body) const {
    return frame.poses[static_cast<std::size_t>(body)];
  }
  Vector3d place(const Frame& frame, const Anchor& anchor) const {
    if (anchor.body < 0) return anchor.point_body;
    const BodyPose& at = pose(frame, anchor.body);
    return at.com_world + at.world_from_body * anchor.point_body;
  }

  /// Whether a frame at this time is interpolated between the ends of a step.
  bool is_between_steps(double time) const {
    return std::abs(time / run.info.step_s - std::round(time / run.info.step_s)) > 1e-6;
  }

  bool is_finite();
  void check_end();
  void check_energy();
  void check_gaps();
  void check_links();
};

bool Judge::is_finite() {
  for (const Frame& frame : run.frames)
    for (std::size_t i = 0; i < frame.poses.size(); ++i) {
      const BodyPose& at = frame.poses[i];
      if (at.com_world.allFinite() && at.world_from_body.coeffs().allFinite() &&
          at.velocity_world.allFinite() && at.omega_world.allFinite() &&
          std::abs(at.world_from_body.norm() - 1.0) < 1e-9)
        continue;
      faults.push_back({"number", fmt::format("body '{}' is not anywhere at t = {:.6g} s",
                                              run.bodies[i].name, frame.time)});
      return false;
    }
  return true;
}

void Judge::check_end() {
  const double end = run.frames.empty() ? 0.0 : run.frames.back().time;
  if (run.frames.empty() || end < scene.duration_s - 1.0 / 60.0 - 1e-9)
    faults.push_back(
        {"short", fmt::format("the last frame is at {:.6g} s of {:.6g} s", end, scene.duration_s)});
}

/// Energy of a frame, and the size of the sums from which it was computed.
struct Energy {
  double kinetic = 0.0, potential = 0.0, in_springs = 0.0, terms = 0.0;
};

Energy energy_of(const Judge& judge, const Frame& frame) {
  Energy energy;
  const auto add = [&](double& sum, double term) {
    sum += term;
    energy.terms += std::abs(term);
  };
  const World& world = judge.world;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const WorldBody& body = world.bodies[i];
    if (body.immovable()) continue;
    const BodyPose& at = frame.poses[i];
    const Vector3d omega_body = at.world_from_body.conjugate() * at.omega_world;
    add(energy.kinetic, 0.5 * body.inertia.mass * at.velocity_world.squaredNorm());
    add(energy.kinetic, 0.5 * omega_body.dot(body.inertia.inertia_body * omega_body));
    if (world.gravity_world)
      add(energy.potential, -body.inertia.mass * world.gravity_world->dot(at.com_world));
  }
  for (const effects::SpringLink& spring : world.effects.of<effects::SpringLink>()) {
    const double stretch = (judge.place(frame, spring.a) - judge.place(frame, spring.b)).norm() -
                           spring.spring.rest_length;
    add(energy.potential, 0.5 * spring.spring.stiffness * stretch * stretch);
    energy.in_springs += 0.5 * spring.spring.stiffness * stretch * stretch;
  }
  return energy;
}

/// The work of constant forces from one frame to the next: force times the displacement of its
/// point. Forces switch at frames.
double work_of_point_forces(const Judge& judge, const Frame& from, const Frame& to) {
  double work = 0.0;
  for (const effects::PointForce& force : judge.world.effects.of<effects::PointForce>()) {
    if (!(to.time <= force.end + 1e-9 && from.time >= force.start - 1e-9)) continue;
    const BodyPose &start = judge.pose(judge.run.frames.front(), force.body),
                   &a = judge.pose(from, force.body), &b = judge.pose(to, force.body);
    // all begin at 0
    const Vector3d point_body =
        start.world_from_body.conjugate() * (force.point_world - start.com_world);
    work += force.force_world.dot(b.com_world + b.world_from_body * point_body - a.com_world -
                                  a.world_from_body * point_body);
  }
  return work;
}

/// Bound on the work of motors: their largest torque times the rotation of the joint, twice to
/// allow for motion between frames.
double work_of_motors(const Judge& judge, const Frame& from, const Frame& to) {
  double work = 0.0;
  for (const effects::Motor& motor : judge.world.effects.of<effects::Motor>()) {
    const effects::JointLink& joint = motor.hinge;
    const auto rate = [&](const Frame& frame) {
      Vector3d omega = judge.pose(frame, joint.a.body).omega_world;
      if (joint.b.body >= 0) omega -= judge.pose(frame, joint.b.body).omega_world;
      return omega.norm();
    };
    work +=
        2.0 * motor.law.largest_torque_n_m * std::max(rate(from), rate(to)) * (to.time - from.time);
  }
  return work;
}

void Judge::check_energy() {
  for (const WorldBody& body : world.bodies)  // a driven body does work that frames do not show
    if (body.immovable() && body.collides &&
        (!body.motion.velocity_m_s.isZero(0) || !body.motion.amplitude_m.isZero(0)))
      return;
  double stir = 0.0;  // energy that position correction may add
  for (const WorldBody& body : world.bodies)
    // a perfectly inelastic body separates at this speed, a box at each of its corners
    if (!body.immovable())
      stir += 8.0 * body.inertia.mass * scene.rest_speed_m_s * scene.rest_speed_m_s;
  double largest = 0.0;
  for (const WorldBody& body : world.bodies)
    if (!body.immovable()) largest = std::max(largest, bounding_radius(body.shape));
  for (const WorldBody& body : world.bodies)
    if (!body.immovable() && world.gravity_world)
      stir += body.inertia.mass * world.gravity_world->norm() *
              (kStir * bounding_radius(body.shape) + kOverlap * largest);
  const Energy first = energy_of(*this, run.frames.front());
  std::vector<Energy> energies{first};
  std::vector<double> work{0.0};
  double given = 0.0, fall = 0.0;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const Frame &before = run.frames[k - 1], &frame = run.frames[k];
    const double done = work_of_point_forces(*this, before, frame),
                 motors = work_of_motors(*this, before, frame);
    work.push_back(work.back() + done + motors);
    given += std::abs(done) + motors;
    energies.push_back(energy_of(*this, frame));
    fall = std::max(fall, first.potential - energies.back().potential);
  }
  // all energy that the run has available
  const double scale = first.kinetic + first.in_springs + fall + given;
  double least = first.kinetic + first.potential;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    // a body that rotates by a radian per step has less energy on the interpolation between its
    // ends
    if (is_between_steps(run.frames[k].time)) continue;
    const double total = energies[k].kinetic + energies[k].potential - work[k];
    // Sums of terms of this size, rounded once per frame, and once per step by the engine.
    const double rounding =
        16.0 * kEps * energies[k].terms * (1.0 + run.frames[k].time / scene.step_s);
    const double gained = total - least - stir - rounding;
    least = std::min(least, total);
    if (gained > kEnergyGrowth * scale) {
      faults.push_back({"energy", fmt::format("{:.4g} J more than before at t = {:.6g} s, where "
                                              "{:.4g} J are at work ({:.3g} of them)",
                                              gained, run.frames[k].time, scale, gained / scale)});
      return;
    }
  }
}

void Judge::check_gaps() {
  std::vector<collision::CollisionShape> shapes;
  for (const WorldBody& body : world.bodies) shapes.emplace_back(body.shape);
  double worst = 0.0;
  std::string words;
  const bool has_links = !world.effects.of<effects::RodLink>().empty() ||
                         !world.effects.of<effects::JointLink>().empty();
  for (int i = 0; i < static_cast<int>(world.bodies.size()); ++i)
    for (int j = i + 1; j < static_cast<int>(world.bodies.size()); ++j) {
      const WorldBody &a = world.bodies[static_cast<std::size_t>(i)],
                      &b = world.bodies[static_cast<std::size_t>(j)];
      if ((a.immovable() && b.immovable()) || !a.collides || !b.collides ||
          (a.passes_movable && b.passes_movable))
        continue;
      if (std::binary_search(world.apart.begin(), world.apart.end(), std::pair(i, j))) continue;
      const collision::CollisionShape &shape_a = shapes[static_cast<std::size_t>(i)],
                                      &shape_b = shapes[static_cast<std::size_t>(j)];
      const double size = std::min(shape_a.is_half_space() ? kInfinity : shape_a.bounding_radius(),
                                   shape_b.is_half_space() ? kInfinity : shape_b.bounding_radius());
      for (const Frame& frame : run.frames) {
        const collision::Pose at_a{pose(frame, i).com_world, pose(frame, i).world_from_body},
            at_b{pose(frame, j).com_world, pose(frame, j).world_from_body};
        if (collision::least_gap(shape_a, at_a, shape_b, at_b) > 0) continue;
        const double gap = collision::compute_gap(shape_a, at_a, shape_b, at_b).distance;
        // linked bodies are on a cubic there, as joints are
        const bool is_on_a_curve = has_links && is_between_steps(frame.time);
        const double allowed = (is_on_a_curve ? kOpenBetween : kOverlap) * size +
                               16.0 * kEps *
                                   (collision::gap_scale(shape_a, at_a, shape_b, at_b) +
                                    at_a.com_world.norm() + at_b.com_world.norm());
        if (gap >= -allowed || gap / size >= worst) continue;
        worst = gap / size;
        words = fmt::format(
            "'{}' and '{}' overlap by {:.3g} m at t = {:.6g} s, {:.3g} of the smaller one", a.name,
            b.name, -gap, frame.time, -worst);
      }
    }
  if (!words.empty()) faults.push_back({"overlap", words});
}

void Judge::check_links() {
  // Without stabilisation, and with Baumgarte's, links drift by design, and the scene states it.
  if (!world.stabilisation || world.stabilisation->kind != scene::StabilisationKind::kProjection)
    return;
  double worst = 1.0;  // relative to the tolerance
  std::string words;
  const auto look = [&](const std::string& name, double open, double arm, double far, double time) {
    const double part = (open - 64.0 * kEps * far) / arm,
                 allowed = is_between_steps(time) ? kOpenBetween : kOpen;
    if (!(part / allowed > worst)) return;
    worst = part / allowed;
    words = fmt::format("'{}' is open by {:.3g} m at t = {:.6g} s, {:.3g} of its arms", name, open,
                        time, part);
  };
  const auto arm_of = [&](const Anchor& anchor) {
    return anchor.body < 0
               ? 0.0
               : anchor.point_body.norm() +
                     std::min(1e300,
                              bounding_radius(
                                  world.bodies[static_cast<std::size_t>(anchor.body)].shape));
  };
  for (const Frame& frame : run.frames) {
    for (const effects::RodLink& rod : world.effects.of<effects::RodLink>()) {
      const Vector3d a = place(frame, rod.a), b = place(frame, rod.b);
      look(rod.name, std::abs((a - b).norm() - rod.length), rod.length, a.norm() + b.norm(),
           frame.time);
    }
    for (const effects::JointLink& joint : world.effects.of<effects::JointLink>()) {
      const Vector3d a = place(frame, joint.a), b = place(frame, joint.b);
      look(joint.name, (a - b).norm(), arm_of(joint.a) + arm_of(joint.b), a.norm() + b.norm(),
           frame.time);
    }
  }
  if (!words.empty()) faults.push_back({"open", words});
}

}  // namespace

std::vector<Fault> faults_of(const scene::Scene& scene, const Trajectory& run) {
  Judge judge{scene, run, build_world(scene), {}};
  judge.check_end();
  if (run.frames.empty() || !judge.is_finite()) return judge.faults;
  judge.check_energy();
  judge.check_gaps();
  judge.check_links();
  return judge.faults;
}

}  // namespace tumble::fuzz
