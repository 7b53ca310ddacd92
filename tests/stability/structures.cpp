// Rows 12 and 13: an arch, a body in a nip: what stands or falls by a number that is known.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/point_force/point_force.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

// ---- Row 12 -------------------------------------------------------------------------------------

/// One stone of a semicircular arch of middle radius 1, in the frame of the arch's centre, its
/// middle along x. Coordinates are those that a .3ds file keeps, so that all that follows from them
/// is exact.
struct Stone {
  double inner_x, inner_z, outer_x, outer_z;
  double half_angle() const { return std::atan2(outer_z - inner_z, outer_x - inner_x); }
  // where the joints' planes meet
  double centre() const { return inner_x - inner_z * (outer_x - inner_x) / (outer_z - inner_z); }
  double com() const {  // of the trapezium
    const double h = outer_x - inner_x;
    return inner_x + h / 3 * (inner_z + 2 * outer_z) / (inner_z + outer_z);
  }
};

Stone stone_of(int n, double thickness) {
  const double b = 0.5 * std::numbers::pi / n, inner = 1 - 0.5 * thickness,
               outer = 1 + 0.5 * thickness;
  const auto kept = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  return {kept(inner * std::cos(b)), kept(inner * std::sin(b)), kept(outer * std::cos(b)),
          kept(outer * std::sin(b))};
}

scene::Scene arch(int n, double thickness, const std::filesystem::path& folder) {
  constexpr double kMu = 0.5;
  const Stone stone = stone_of(n, thickness);
  const std::filesystem::path file = folder / fmt::format("stone_{}_{}.3ds", n, thickness);
  write_prism({{stone.inner_x, -stone.inner_z},
               {stone.outer_x, -stone.outer_z},
               {stone.outer_x, stone.outer_z},
               {stone.inner_x, stone.inner_z}},
              0.25, file);
  const double b = stone.half_angle(), first = 0.5 * (std::numbers::pi - 2 * n * b),
               radius = stone.com() - stone.centre();
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < n; ++i) {
    const double angle = first + (2 * i + 1) * b;
    scene::BodySpec body = rough(box("stone" + std::to_string(i), Vector3d::Ones(), 1.0,
                                     radius * Vector3d(std::cos(angle), 0, std::sin(angle))),
                                 kMu);
    body.shape = scene::ModelSpec{file.string(), "", 1.0};
    body.mass_kg.reset();
    body.density_kg_m3 = 2000.0;
    bodies.push_back(turned(body, -angle, Vector3d::UnitY()));  // x of the stone along the radius
  }
  // abutments: boxes under the first and the last joint
  for (const double end : {first, std::numbers::pi - first}) {
    const double side = end < 1 ? -1.0 : 1.0;  // away from the arch, around the centre
    const Vector3d radial(std::cos(end), 0, std::sin(end)),
        away(-side * std::sin(end), 0, side * std::cos(end));
    scene::BodySpec abutment = rough(box(end < 1 ? "right abutment" : "left abutment",
                                         Vector3d(0.4, 0.5, 0.2), 1.0, radial + 0.2 * away),
                                     kMu);
    abutment.mass_kg.reset();
    abutment.immovable = true;
    bodies.push_back(turned(abutment, -end, Vector3d::UnitY()));
  }
  return with_contact("arch", std::move(bodies));
}

void masonry_arch(const Given& given, Findings& findings) {
  const PrivateFolder folder;
  report::Plot plot{
      "Arch of 25 stones: how far the crown has come down",
      {"time", "s"},
      {"drop", "R", report::Scale::kLog},
      {},
      {{1e-3, "threshold"}},
      "An arch stands while a line of thrust fits into it: from t/R = 0.1075 on (Milankovitch)."};
  for (const int n : {25, 101}) {
    if (n > 25 && !given.is_long) continue;
    for (const double thickness : {0.12, 0.09}) {
      const std::string name = fmt::format("{} stones, t/R = {:g}", n, thickness);
      findings.part(name, [&] {
        const bool stands = thickness > 0.1075;
        // Of 101 thin stones 0.1 s show the fall; from then on joints strike shut one at a time, by
        // hundreds, and each ends a step.
        const double duration = stands ? (given.is_long ? 10.0 : 1.0) : n > 25 ? 0.1 : 0.5;
        const Trajectory run =
            run_by_steps(arch(n, thickness, folder.path()), given.laws, duration, 1.0 / 240, 100);
        const auto crown = [&](const Frame& frame) {
          return run.frames.front().poses[static_cast<std::size_t>(n / 2)].com_world.z() -
                 frame.poses[static_cast<std::size_t>(n / 2)].com_world.z();
        };
        double drop = 0.0;
        for (const Frame& frame : run.frames) drop = std::max(drop, std::abs(crown(frame)));
        if (stands)
          findings.at_most(name + fmt::format(", {:g} s: drop of the crown", duration), drop, 1e-3,
                           "R", "static, at mu = 0.5");
        else
          findings.must_fail(name + fmt::format(", {:g} s: stands", duration), drop, 1e-3, "R",
                             "no line of thrust fits into it");
        findings.at_least(name + ": smallest gap", smallest_gap(run), 0.0, "m",
                          "nothing interpenetrates");
        if (n == 25)
          plot.curves.push_back(curve_of(
              fmt::format("t/R = {:g}", thickness), run,
              [&](const Frame& frame) { return std::max(1e-12, std::abs(crown(frame))); }));
      });
    }
  }
  findings.plot(std::move(plot));
}

// ---- Row 13 -------------------------------------------------------------------------------------

/// A ball between a floor and a jaw hinged at the origin, at an angle of 2 a; the jaw is pressed
/// down with 100 N. No gravity. The ball is in balance under two forces only along the line through
/// both points of contact, a off either normal: mu >= tan(a).
scene::Scene nip(double a, double mu) {
  constexpr double kBall = 0.1;
  const double reach = kBall / std::sin(a);
  scene::BodySpec ball =
      rough(truths::ball("ball", 1.0, kBall, Vector3d(reach * std::cos(a), 0, reach * std::sin(a)),
                         Vector3d::Zero(), 0.0),
            mu);
  const Vector3d along(std::cos(2 * a), 0, std::sin(2 * a)),
      up(-std::sin(2 * a), 0, std::cos(2 * a));
  scene::BodySpec jaw =
      turned(rough(box("jaw", Vector3d(1.0, 0.3, 0.05), 1.0, along + 0.05 * up), mu), -2 * a,
             Vector3d::UnitY());
  scene::Scene scene = with_contact("nip", {ball, jaw, floor_of(mu)});
  scene.effects.of<effects::GravitySpec>().clear();
  scene.stabilisation = scene::StabilisationSpec{};
  scene.effects.of<effects::JointSpec>() = {
      {"hinge", effects::JointKind::kHinge, "jaw", "", Vector3d::Zero(), Vector3d::UnitY()}};
  scene.apart = {{"jaw", "floor"}};
  scene.effects.of<effects::PointForceSpec>() = {
      {"jaw", -100.0 * up, along + 0.05 * up, 0.0, 100.0}};
  return scene;
}

void wedge(const Given& given, Findings& findings) {
  constexpr double kCreep = 2e-4;  // m: 1e-3 of the ball, as of stacks and cards
  report::Plot plot{"Ball in a nip of 2 x 0.2 rad: how far it has come out",
                    {"time", "s"},
                    {"way", "m", report::Scale::kLog},
                    {},
                    {{kCreep, "threshold"}},
                    "Two percent of friction decide whether the nip holds it."};
  for (const double a : {0.2, 0.35}) {
    for (const double part : {1.02, 0.98}) {
      const std::string name = fmt::format("half-angle {:g}, mu = {:g} tan(a)", a, part);
      findings.part(name, [&] {
        const Trajectory run = run_by_steps(nip(a, part * std::tan(a)), given.laws,
                                            given.is_long ? 5.0 : 0.3, 1.0 / 1000, 150);
        const double way = drift_of(run, 0);
        if (part > 1)
          findings.at_most(name + ": way of the ball", way, kCreep, "m",
                           "self-locking from mu = tan(a); creep at most 1e-3 of the body");
        else
          findings.must_fail(name + ": stays", way, kCreep, "m",
                             "2 % below the limit it is squeezed out");
        findings.at_least(name + ": smallest gap", smallest_gap(run), 0.0, "m",
                          "pressed, not pressed in");
        if (a == 0.2)
          plot.curves.push_back(
              curve_of(fmt::format("mu = {:g} tan(a)", part), run, [&](const Frame& f) {
                return std::max(
                    1e-14, (f.poses[0].com_world - run.frames.front().poses[0].com_world).norm());
              }));
      });
    }
  }
  findings.plot(std::move(plot));
  findings.part("spikes and cliff edges", [&] { spikes(given, findings); });
}

}  // namespace

void add_structures(std::vector<Case>& cases) {
  cases.push_back({12, "masonry arch",
                   "A semicircle of loose stones stands by its shape alone if it is thicker than a "
                   "tenth of its radius (0.1075), and falls with four hinges if it is thinner. "
                   "Nothing but contact forces decides.",
                   "a1 a3", masonry_arch});
  cases.push_back({13, "wedge, jamming",
                   "A body squeezed between two faces locks itself if friction is at least the "
                   "tangent of half their angle, whatever the force. Two percent above and two "
                   "below must differ: no creep, no overlap.",
                   "a1 a3", wedge});
}

}  // namespace tumble::battery
