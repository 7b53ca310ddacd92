// Row 23: the same world a million times smaller and larger.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/effects/gravity/gravity.h"
#include "framework/effects/spring/spring.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

/// Lengths times s, times times sqrt(s): gravity stays, and everything else goes alike.
scene::Scene bouncing_and_sliding(double s, bool scaled_restitution_threshold) {
  const double speed = std::sqrt(s);
  scene::Scene scene =
      truths::empty_scene("scaled", 1.0, scaled_restitution_threshold ? 1e-3 * speed : 1e-3);
  effects::set_gravity(scene, kDown);
  scene.bodies = {truths::ball("ball", 1.0, 0.2 * s, s * Vector3d(0, 0, 1.5),
                               speed * Vector3d(1.0, 0.2, 0), 0.7),
                  truths::ball("other", 2.0, 0.3 * s, s * Vector3d(1.5, 0.1, 0.9),
                               speed * Vector3d(-0.5, 0, 1), 0.7),
                  truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.7),
                  truths::wall("left", s * Vector3d(-1, 0, 0), Vector3d::UnitX(), 0.9),
                  truths::wall("right", s * Vector3d(3, 0, 0), -Vector3d::UnitX(), 0.9)};
  return scene;
}

scene::Scene box_at_rest_after_sliding(double s) {
  const double speed = std::sqrt(s);
  scene::Scene scene = with_contact(
      "scaled contact",
      {rough(box("box", s * Vector3d(0.2, 0.2, 0.1), 1.0, s * Vector3d(0, 0, 0.1)), 0.3),
       floor_of(0.3)});
  scene.bodies[0].velocity_m_s = speed * Vector3d(1.5, 0, 0);
  scene.rest_speed_m_s = 1e-3 * speed;
  return scene;
}

/// A bob on a damped spring, pulled aside: frequencies go with 1 / sqrt(s), so that stiffness goes
/// with 1 / s.
scene::Scene on_a_spring(double s) {
  scene::Scene scene = truths::empty_scene("scaled spring", 1.0, 1e-3 * std::sqrt(s));
  effects::set_gravity(scene, kDown);
  scene.bodies = {truths::point_mass("bob", 1.0, s * Vector3d(0.6, 0.2, -1.0), Vector3d::Zero())};
  scene.effects.of<effects::SpringSpec>() = {{"spring",
                                              {"", Vector3d::Zero()},
                                              {"bob", Vector3d::Zero()},
                                              100.0 / s,
                                              0.5 / std::sqrt(s),
                                              s * 1.0}};
  return scene;
}

scene::Scene short_chain(double s) {
  scene::Scene scene = chain({1.0, 0.5, 2.0}, s * 0.4, Vector3d(0.8, 0, -0.6));
  scene.rest_speed_m_s = 1e-3 * std::sqrt(s);
  return scene;
}

/// Three boxes, each a little off the one below. @param knock  of the middle one [m/s, where s = 1]
scene::Scene stack_of_three(double s, const Vector3d& knock) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 3; ++i)
    bodies.push_back(rough(box("box" + std::to_string(i), s * Vector3d(0.2, 0.2, 0.1), 1.0,
                               s * Vector3d(0.03 * i, 0, 0.1 + 0.2 * i)),
                           0.3));
  bodies[1].velocity_m_s = std::sqrt(s) * knock;
  bodies.push_back(floor_of(0.3));
  scene::Scene scene = with_contact("scaled stack", std::move(bodies));
  scene.rest_speed_m_s = 1e-3 * std::sqrt(s);
  return scene;
}

scene::Scene standing_stack(double s) { return stack_of_three(s, Vector3d::Zero()); }
scene::Scene knocked_stack(double s) { return stack_of_three(s, Vector3d(0.7, 0.2, 0)); }

/// Places over the size, at the same parts of the duration.
std::vector<Vector3d> places(const scene::Scene& scene, const Laws& laws, double s, double duration,
                             std::size_t bodies) {
  const double time = std::sqrt(s);
  const Trajectory run = run_by_steps(scene, laws, duration * time, time / 60, 600);
  std::vector<Vector3d> all;
  for (const Frame& frame : run.frames)
    for (std::size_t b = 0; b < bodies; ++b) all.push_back(frame.poses[b].com_world / s);
  return all;
}

double largest(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double worst = a.size() == b.size() ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

void scales(const Given& given, Findings& findings) {
  compare_with_truth(given, findings, "mass_properties/box_1e-6");
  compare_with_truth(given, findings, "mass_properties/box_1e6");
  const double duration = 3.0;
  const auto metres = places(bouncing_and_sliding(1.0, true), given.laws, 1.0, duration, 2);
  report::Plot plot{"Two balls between walls, at other scales",
                    {"frame"},
                    {"difference from the run in metres, over the size", "", report::Scale::kLog},
                    {},
                    {{1e-10, "threshold"}},
                    "A cut-off speed that does not scale shows at once where the world is small."};
  const auto curve = [&](const std::string& name, const std::vector<Vector3d>& found) {
    report::Curve c{name, {}, {}};
    for (std::size_t i = 0; i < std::min(found.size(), metres.size()); i += 2)
      c.x.push_back(static_cast<double>(i / 2)),
          c.y.push_back(std::max(1e-17, (found[i] - metres[i]).norm()));
    return c;
  };
  for (const double s : {1e-6, 1e6}) {
    const auto found = places(bouncing_and_sliding(s, true), given.laws, s, duration, 2);
    findings.at_most(
        fmt::format("two balls between walls, lengths x {:g}: places over the size", s),
        largest(found, metres), 1e-10, "",
        "roundings, grown by ten impacts; an absolute epsilon anywhere shows");
    plot.curves.push_back(curve(fmt::format("x {:g}", s), found));
  }
  const auto absolute = places(bouncing_and_sliding(1e-6, false), given.laws, 1e-6, duration, 2);
  findings.must_fail("x 1e-06 with a cut-off speed of 1 mm/s, as for metres: places over the size",
                     largest(absolute, metres), 1e-10, "",
                     "an absolute length or speed in a method is seen");
  plot.curves.push_back(curve("x 1e-6, absolute cut-off speed", absolute));
  findings.plot(std::move(plot));
  if (!given.laws.contact_forces)
    return findings.not_run("persistent contact",
                            "needs the laws of a3, which nobody provides here");
  struct Thing {
    const char* name;
    scene::Scene (*scene)(double);
    double duration;
    std::size_t bodies;
    const char* why;
  };
  for (const Thing& thing :
       {Thing{"bob on a damped spring", on_a_spring, 3.0, 1,
              "the same steps of the same method in other units: roundings"},
        Thing{"chain of 3 rods", short_chain, 1.0, 3,
              "roundings, grown by the chain some hundred times; tolerances of links and of their "
              "projection must scale"},
        Thing{"box that slides to rest", box_at_rest_after_sliding, 1.5, 1,
              "contact shells and tolerances must scale with the bodies"},
        Thing{"stack of 3", standing_stack, 1.0, 3, "the same: it stands"},
        Thing{"stack of 3, the middle one knocked", knocked_stack, 1.0, 3, ""}}) {
    const auto expected = places(thing.scene(1.0), given.laws, 1.0, thing.duration, thing.bodies);
    const auto off = [&](double s) {
      return largest(places(thing.scene(s), given.laws, s, thing.duration, thing.bodies), expected);
    };
    // Twelve points of contact share what three boxes need in more than one way, and where one
    // begins to slide, solvers' tolerances decide: lengths x 1e-6 alone, which rounds every number,
    // moves where the knocked stack stops by 1e-4 of its size. Powers of two round nothing.
    if (thing.scene != knocked_stack)
      for (const double s : {1e-6, 1e6})
        findings.at_most(fmt::format("{}, lengths x {:g}: places over the size", thing.name, s),
                         off(s), 1e-10, "", thing.why);
    for (const int power : {-20, 20})
      findings.at_most(fmt::format("{}, lengths x 2^{}: places over the size", thing.name, power),
                       off(std::ldexp(1.0, power)), 0.0, "",
                       "times by 2^10 or 2^-10: every number of the run is another power of two, "
                       "and only an absolute epsilon could make a difference");
  }
}

}  // namespace

void add_scales(std::vector<Case>& cases) {
  cases.push_back(
      {23, "tiny and huge",
       "The same scene with lengths a million times smaller or larger, and times scaled by the "
       "root, is the same motion. Slops of 5 mm or margins of 4 cm, as engines have them, "
       "are then larger than the bodies.",
       "a1", scales});
}

}  // namespace tumble::battery
