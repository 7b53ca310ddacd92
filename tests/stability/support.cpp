#include "tests/stability/support.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/not_implemented.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/truths/families.h"
#include "models/write_3ds.h"

namespace tumble::battery {

scene::BodySpec box(const std::string& name, const Vector3d& half_extents, double mass,
                    const Vector3d& position) {
  scene::BodySpec body = truths::ball(name, mass, 1.0, position, Vector3d::Zero(), 0.0);
  body.shape = scene::BoxSpec{half_extents};
  return body;
}

scene::BodySpec rough(scene::BodySpec body, double friction, double restitution) {
  body.friction = friction;
  body.restitution = restitution;
  return body;
}

scene::BodySpec floor_of(double friction) {
  return rough(truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.0), friction);
}

scene::BodySpec turned(scene::BodySpec body, double angle, const Vector3d& axis) {
  body.world_from_body = Quaterniond(Eigen::AngleAxisd(angle, axis)) * body.world_from_body;
  return body;
}

scene::Scene with_contact(const std::string& name, std::vector<scene::BodySpec> bodies) {
  scene::Scene scene = truths::empty_scene(name, 1.0, 1e-3);
  effects::set_gravity(scene, kDown);
  scene.bodies = std::move(bodies);
  scene.contact.emplace();
  return scene;
}

scene::Scene chain(const std::vector<double>& masses, double length, const Vector3d& direction) {
  return truths::straight_chain(masses, length, direction, kDown);
}

Trajectory run_by_steps(const scene::Scene& scene, const Laws& laws, double duration, double h,
                        long frames) {
  const long about = std::max(1L, std::lround(duration / h)),
             stride = std::max(1L, about / std::max(1L, frames)),
             steps = std::max(1L, about / stride) * stride;
  return truths::run_in_steps(scene, laws, static_cast<double>(steps) * h, steps, steps / stride);
}

double energy_of(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

double energy_drift(const Trajectory& run, double scale) {
  double worst = 0.0;
  for (const Frame& frame : run.frames)
    worst = std::max(worst, std::abs(energy_of(frame) - energy_of(run.frames.front())) / scale);
  return worst;
}

double energy_rise(const Trajectory& run) {
  double rise = 0.0, lowest = energy_of(run.frames.front());
  for (const Frame& frame : run.frames) {
    rise = std::max(rise, energy_of(frame) - lowest);
    lowest = std::min(lowest, energy_of(frame));
  }
  return rise / energy_of(run.frames.front());
}

double drift_of(const Trajectory& run, std::size_t body) {
  double worst = 0.0;
  for (const Frame& frame : run.frames)
    worst = std::max(
        worst, (frame.poses[body].com_world - run.frames.front().poses[body].com_world).norm());
  return worst;
}

double tilt_of(const Trajectory& run, std::size_t body) {
  double worst = 0.0;
  for (const Frame& frame : run.frames)
    worst = std::max(worst, angle_between(frame.poses[body].world_from_body,
                                          run.frames.front().poses[body].world_from_body));
  return worst;
}

double smallest_gap(const Trajectory& run) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Frame& frame : run.frames) smallest = std::min(smallest, frame.smallest_gap);
  return smallest;
}

double push_up(const Frame& frame, int on, int by) {
  double push = 0.0;
  for (const ContactPoint& contact : frame.contacts) {
    if (contact.body_a == on && contact.body_b == by) push += contact.force_on_a_world.z();
    if (contact.body_a == by && contact.body_b == on) push -= contact.force_on_a_world.z();
  }
  return push;
}

double angle_between(const Quaterniond& a, const Quaterniond& b) {
  const Quaterniond turn = a.conjugate() * b;
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

report::Curve curve_of(const std::string& name, const Trajectory& run,
                       const std::function<double(const Frame&)>& value) {
  report::Curve curve{name, {}, {}};
  for (const Frame& frame : run.frames) {
    curve.x.push_back(frame.time);
    curve.y.push_back(value(frame));
  }
  return curve;
}

void compare_with_truth(const Given& given, Findings& findings, const std::string& id,
                        bool exact_only) {
  findings.part("truth " + id, [&] {
    const truths::Case truth = given.truth(id);
    Laws laws = given.laws;
    if (exact_only)
      laws.state_derivative = [](const RigidBodyState&, const Inertia&, const Wrench&) -> VectorXd {
        throw NotImplemented("state_derivative", "left out");
      };
    truths::Comparison comparison;
    truths::framework_families().at(truth.family)(truth, laws, comparison);
    const truths::Line* worst = nullptr;
    const auto ratio = [](const truths::Line& line) { return line.error / line.tolerance; };
    for (const truths::Line& line : comparison.lines()) {
      if (exact_only && line.output.starts_with("rk4.")) continue;
      if (line.verdict == truths::Verdict::kNotAttempted)
        return findings.not_run("truth " + id, line.note);
      // without a number
      if (line.verdict == truths::Verdict::kWrong && !(ratio(line) > 1.0))
        throw std::runtime_error(line.output + ": " + line.note);
      if (line.verdict == truths::Verdict::kNotCompared || !(ratio(line) >= 0.0)) continue;
      if (worst == nullptr || ratio(line) > ratio(*worst)) worst = &line;
    }
    require(worst != nullptr, "no output of truth " + id + " was compared");
    findings.at_most(
        "truth " + id + ": " + worst->output, worst->error, worst->tolerance, "",
        worst->note.empty()
            ? "100 floors of double precision; of all outputs the one closest to its mark"
            : worst->note);
  });
}

void write_model(const TriangleMesh& mesh, const std::filesystem::path& file) {
  write_whole(file, models::write_3ds({{"model", mesh}}));
}

void write_prism(const std::vector<Vector2d>& corners, double half_depth,
                 const std::filesystem::path& file) {
  TriangleMesh mesh;
  for (const double y : {-half_depth, half_depth})
    for (const Vector2d& corner : corners) mesh.vertices.emplace_back(corner.x(), y, corner.y());
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    mesh.faces.push_back({i, 4 + j, j});
    mesh.faces.push_back({i, 4 + i, 4 + j});
  }
  for (const Face& face : {Face{0, 1, 2}, Face{0, 2, 3}, Face{4, 6, 5}, Face{4, 7, 6}})
    mesh.faces.push_back(face);
  write_model(mesh, file);
}

}  // namespace tumble::battery
