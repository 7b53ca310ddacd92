// Row 23: the same world a million times smaller and larger.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

/// Lengths times s, times times sqrt(s): gravity stays, and everything else goes alike.
scene::Scene bouncing_and_sliding(double s, bool scaled_rest_speed) {
  const double speed = std::sqrt(s);
  scene::Scene scene = truths::empty_scene("scaled", 1.0, scaled_rest_speed ? 1e-3 * speed : 1e-3);
  scene.gravity_m_s2 = kDown;
  scene.bodies = {truths::ball("ball", 1.0, 0.2 * s, s * Vector3d(0, 0, 1.5), speed * Vector3d(1.0, 0.2, 0), 0.7), truths::ball("other", 2.0, 0.3 * s, s * Vector3d(1.5, 0.1, 0.9), speed * Vector3d(-0.5, 0, 1), 0.7),
                  truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.7), truths::wall("left", s * Vector3d(-1, 0, 0), Vector3d::UnitX(), 0.9), truths::wall("right", s * Vector3d(3, 0, 0), -Vector3d::UnitX(), 0.9)};
  return scene;
}

scene::Scene box_at_rest_after_sliding(double s) {
  const double speed = std::sqrt(s);
  scene::Scene scene = with_contact("scaled contact", {rough(box("box", s * Vector3d(0.2, 0.2, 0.1), 1.0, s * Vector3d(0, 0, 0.1)), 0.3), floor_of(0.3)});
  scene.bodies[0].velocity_m_s = speed * Vector3d(1.5, 0, 0);
  scene.rest_speed_m_s = 1e-3 * speed;
  return scene;
}

/// Places over the size, at the same parts of the duration.
std::vector<Vector3d> places(const scene::Scene& scene, const Laws& laws, double s, double duration, std::size_t bodies) {
  const double time = std::sqrt(s);
  const Trajectory run = run_by_steps(scene, laws, duration * time, time / 60, 600);
  std::vector<Vector3d> all;
  for (const Frame& frame : run.frames)
    for (std::size_t b = 0; b < bodies; ++b) all.push_back(frame.poses[b].com_world / s);
  return all;
}

double largest(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double worst = a.size() == b.size() ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

void scales(const Given& given, Findings& findings) {
  compare_with_truth(given, findings, "mass_properties/box_1e-6");
  compare_with_truth(given, findings, "mass_properties/box_1e6");
  const double duration = 3.0;
  const auto metres = places(bouncing_and_sliding(1.0, true), given.laws, 1.0, duration, 2);
  report::Plot plot{"Two balls between walls, at other scales", {"frame"}, {"difference from the run in metres, over the size", "", report::Scale::kLog}, {}, {{1e-10, "threshold"}}, "A cut-off speed that does not scale shows at once where the world is small."};
  const auto curve = [&](const std::string& name, const std::vector<Vector3d>& found) {
    report::Curve c{name, {}, {}};
    for (std::size_t i = 0; i < std::min(found.size(), metres.size()); i += 2) c.x.push_back(static_cast<double>(i / 2)), c.y.push_back(std::max(1e-17, (found[i] - metres[i]).norm()));
    return c;
  };
  for (const double s : {1e-6, 1e6}) {
    const auto found = places(bouncing_and_sliding(s, true), given.laws, s, duration, 2);
    findings.at_most(fmt::format("two balls between walls, lengths x {:g}: places over the size", s), largest(found, metres), 1e-10, "", "roundings, grown by ten impacts; an absolute epsilon anywhere shows");
    plot.curves.push_back(curve(fmt::format("x {:g}", s), found));
  }
  const auto absolute = places(bouncing_and_sliding(1e-6, false), given.laws, 1e-6, duration, 2);
  findings.must_fail("x 1e-06 with a cut-off speed of 1 mm/s, as for metres: places over the size", largest(absolute, metres), 1e-10, "", "an absolute length or speed in a method is seen");
  plot.curves.push_back(curve("x 1e-6, absolute cut-off speed", absolute));
  findings.plot(std::move(plot));
  if (!given.laws.contact_forces) return findings.not_run("lasting contact", "needs the laws of a3, which nobody provides here");
  const auto slid = places(box_at_rest_after_sliding(1.0), given.laws, 1.0, 1.5, 1);
  for (const double s : {1e-6, 1e6})
    findings.at_most(fmt::format("box that slides to rest, lengths x {:g}: places over the size", s), largest(places(box_at_rest_after_sliding(s), given.laws, s, 1.5, 1), slid), 1e-10, "", "contact shells and tolerances must scale with the bodies");
}

}  // namespace

void add_scales(std::vector<Case>& cases) {
  cases.push_back({23, "tiny and huge", "The same scene with lengths a million times smaller or larger, and times scaled by the root, is the same motion. Slops of 5 mm or margins of 4 cm, as engines have them, "
                   "are then larger than the bodies.", "a1", scales});
}

}  // namespace tumble::battery
