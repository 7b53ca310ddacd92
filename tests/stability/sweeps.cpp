// Rows 16, 17 and 18: thin walls at high speed, bodies that spin fast, grazes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "framework/collision/first_impact.h"
#include "framework/core/random.h"
#include "framework/effects/gravity/gravity.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

using collision::CollisionShape;
using collision::Motion;
using collision::MotionBounds;
using collision::MotionState;

Motion straight(const Vector3d& from, const Vector3d& velocity) {
  return {[=](double t) {
            return MotionState{
                {from + t * velocity, Quaterniond::Identity()}, velocity, Vector3d::Zero()};
          },
          MotionBounds{}};
}

// ---- Row 16 -------------------------------------------------------------------------------------

// m/s, thickness and radius [m], s: 10 m a step
constexpr double kSpeed = 1000.0, kWall = 1e-3, kBullet = 0.01, kStep = 0.01;
constexpr int kShots = 10000;

struct Shot {
  Vector3d from, velocity;
  double impact() const { return (-0.5 * kWall - kBullet - from.x()) / velocity.x(); }  // [s]
};

/// From the left, up to 60 degrees askew; starts spread over a step's way: each hits within the
/// step.
Shot random_shot(Random& random) {
  const double angle = random.between(-1.0, 1.0), round = random.between(0.0, 2 * std::numbers::pi);
  const Vector3d velocity = kSpeed * Vector3d(std::cos(angle), std::sin(angle) * std::cos(round),
                                              std::sin(angle) * std::sin(round));
  const double away = random.between(0.02, kStep * velocity.x()), y = random.between(-1.0, 1.0),
               z = random.between(-1.0, 1.0);
  return {Vector3d(-away, y, z), velocity};
}

/// The same through the engine: each shot a run of one step, with broad phase, search, impact and
/// way back.
void shots_in_runs(const Given& given, Findings& findings) {
  scene::Scene scene = truths::empty_scene("shot", kStep, 1e-9);
  scene::BodySpec wall = box("wall", Vector3d(0.5 * kWall, 50.0, 50.0), 1.0, Vector3d::Zero());
  wall.immovable = true;
  wall.restitution = 1.0;
  scene.bodies = {truths::ball("bullet", 1.0, kBullet, Vector3d::Zero(), Vector3d::Zero(), 1.0),
                  wall};
  Random random(61);
  int missed = 0, through = 0;
  double late = 0.0, off = 0.0;
  for (int i = 0; i < kShots; ++i) {
    const Shot shot = random_shot(random);
    scene.bodies[0].position_m = shot.from;
    scene.bodies[0].velocity_m_s = shot.velocity;
    const Trajectory run = run_by_steps(scene, given.laws, kStep, kStep, 1);
    const auto hit = std::find_if(run.events.begin(), run.events.end(), [](const Event& event) {
      return event.kind == EventKind::kCollision;
    });
    if (hit == run.events.end())
      ++missed;
    else
      late = std::max(late, std::abs(hit->time - shot.impact()));
    // Mirrored at the wall: where it would be without the wall, less twice what it has gone since.
    const Vector3d end = run.frames.back().poses[0].com_world;
    Vector3d truth = shot.from + kStep * shot.velocity;
    truth.x() -= 2 * (kStep - shot.impact()) * shot.velocity.x();
    through += end.x() > 0 ? 1 : 0;
    off = std::max(off, (end - truth).norm());
  }
  findings.at_most("10^4 random shots, each a run of the engine with one step of 10 ms: missed",
                   missed, 0.0, "", "a guarantee, not a tolerance");
  findings.at_most("the same: found behind the wall", through, 0.0, "",
                   "a guarantee, not a tolerance");
  findings.at_most("the same: time of impact", late, 1e-12, "s",
                   "closed form; 5 m at 1000 m/s rounded, times 100");
  findings.at_most("the same: place at the step's end", off, 2e-9, "m",
                   "twice the time's tolerance at 1000 m/s");
}

void tunnelling(const Given& given, Findings& findings) {
  const CollisionShape bullet(Sphere{kBullet}), wall(Box{{0.5 * kWall, 50.0, 50.0}});
  const Motion still = straight(Vector3d::Zero(), Vector3d::Zero());
  Random random(16);
  int missed = 0, missed_by_steps = 0;
  double worst = 0.0;
  report::Curve seen{"shots that a look at the ends of steps sees", {}, {}},
      exact{"this project", {}, {}};
  for (int i = 0; i < kShots; ++i) {
    const Shot shot = random_shot(random);
    const auto impact = collision::first_impact(bullet, straight(shot.from, shot.velocity), wall,
                                                still, 0.0, kStep, {given.laws.find_impact_time});
    const double truth = shot.impact();
    if (impact)
      worst = std::max(worst, std::abs(impact->time - truth));
    else
      missed += truth <= kStep ? 1 : 0;
    const double x_end = shot.from.x() + kStep * shot.velocity.x();
    missed_by_steps += std::abs(x_end) > 0.5 * kWall + kBullet && truth <= kStep ? 1 : 0;
    if (i % 100 != 99) continue;
    seen.x.push_back(i + 1.0), seen.y.push_back(i + 1.0 - missed_by_steps);
    exact.x.push_back(i + 1.0), exact.y.push_back(i + 1.0 - missed);
  }
  findings.at_most("10^4 random shots at 1000 m/s against 1 mm: missed", missed, 0.0, "",
                   "a guarantee, not a tolerance");
  findings.at_most("time of impact", worst, 1e-12, "s",
                   "closed form; 5 m at 1000 m/s rounded, times 100");
  findings.must_fail("overlap looked for at the ends of steps of 10 ms: shots missed",
                     missed_by_steps, 0.0, "", "10 m a step jump over a wall of 1 mm");
  findings.plot({"Bullets of 1 cm at a wall of 1 mm",
                 {"shots"},
                 {"hits found"},
                 {exact, seen},
                 {},
                 "A look at the ends of steps sees one in some hundreds: those that happen to stop "
                 "within the wall."});
  if (!given.laws.collision_impulse)
    return findings.not_run("a run of the engine",
                            "needs the laws of a1, which nobody provides here");
  findings.part("10^4 runs of the engine", [&] { shots_in_runs(given, findings); });
  compare_with_truth(given, findings, "toi_tunnel/bullet_1000");
}

// ---- Row 17 -------------------------------------------------------------------------------------

/// When the lower tip of a spinning rod meets z = 0 if tips are moved along straight lines between
/// the ends of steps.
double chord_impact(const truths::Case& truth, double turn_a_step) {
  const double half = 0.5 * truth.input("L").number(), phi0 = truth.input("phi0").number(),
               omega = truth.input("omega").number();
  const double h0 = truth.input("h").number(), v = truth.input("v_up").number(),
               g = truth.input("g").number(), h = turn_a_step / std::abs(omega);
  const auto tip = [&](double t, double sign) {
    return h0 + v * t - 0.5 * g * t * t + sign * half * std::sin(phi0 + omega * t);
  };
  for (long i = 0; i < 1000000; ++i) {
    double first = 2.0;
    for (const double sign : {-1.0, 1.0}) {
      const double a = tip(static_cast<double>(i) * h, sign),
                   b = tip(static_cast<double>(i + 1) * h, sign);
      if (b < 0) first = std::min(first, a / (a - b));
    }
    if (first <= 1.0) return (static_cast<double>(i) + first) * h;
  }
  return kUnset;
}

void rotating(const Given& given, Findings& findings) {
  for (const char* id : {"toi_rod_plane/fast_spin", "toi_rod_plane/slow_spin",
                         "toi_rod_plane/no_gravity_sweep", "toi_boxes/cubes_vertex_face",
                         "toi_boxes/cubes_edge_edge", "toi_boxes/boxes_edge_edge_principal_spin"})
    compare_with_truth(given, findings, id);
  const truths::Case truth = given.truth("toi_rod_plane/fast_spin");
  const double toi = truth.output("toi").number();
  report::Plot plot{"A spinning rod falls on a floor: error of the time of impact",
                    {"turn a step", "rad", report::Scale::kLog},
                    {"error", "s", report::Scale::kLog},
                    {},
                    {{1e-10, "threshold"}},
                    "Tips moved along chords are off by (L/2)(1 - cos(w h / 2)), half a metre at "
                    "half a turn; bounds on the true motion do not depend on the step."};
  report::Curve chords{"tips along straight lines", {}, {}, true};
  for (double turn = 3.1; turn > 0.02; turn *= 0.5) {
    const double error = std::abs(chord_impact(truth, turn) - toi);
    chords.x.push_back(turn), chords.y.push_back(error);
    if (turn > 3)
      findings.must_fail("tips along straight lines, half a turn a step: time of impact", error,
                         1e-10, "s",
                         "the chord of a tip leaves its arc by (L/2)(1 - cos(w h / 2))");
  }
  plot.curves = {chords};
  findings.plot(std::move(plot));
}

// ---- Row 18 -------------------------------------------------------------------------------------

void grazing(const Given& given, Findings& findings) {
  compare_with_truth(given, findings, "toi_grazing/ceiling");
  compare_with_truth(given, findings, "toi_grazing/spheres");
  if (!given.laws.collision_impulse)
    return findings.not_run("runs of the engine",
                            "needs the laws of a1, which nobody provides here");
  // Thrown up so that the top of its flight is a gap below the ceiling.
  constexpr double top = 1.0, radius = 0.1;
  const double v = std::sqrt(2 * kG * top);
  report::Plot plot{"A ball that tops at a ceiling",
                    {"time after the top", "s"},
                    {"gap", "m"},
                    {},
                    {},
                    "At 1e-8 m of overlap the gap would be closed for 90 microseconds: a look at "
                    "the ends of steps of 10 ms does not see it."};
  for (const double gap : {0.0, 1e-12, -1e-12, -1e-8}) {
    scene::Scene scene = truths::empty_scene("graze", 1.0, 1e-9);
    effects::set_gravity(scene, kDown);
    scene.step_s = 0.01;
    scene.bodies = {
        truths::ball("ball", 1.0, radius, Vector3d(0, 0, 0), Vector3d(0, 0, v), 1.0),
        truths::wall("ceiling", Vector3d(0, 0, top + radius + gap), -Vector3d::UnitZ(), 1.0)};
    const Trajectory run = truths::run_in_steps(scene, given.laws, 0.6, 60, 60);
    const std::string name = fmt::format("gap {:g} m at the top", gap);
    double impact = kUnset;
    for (const Event& event : run.events)
      if (event.kind == EventKind::kCollision && std::isnan(impact)) impact = event.time;
    // Where it comes back to: z = v t - g t^2 / 2, whether it touched or not; an impact at speed w
    // that comes w / g early is as much late.
    const double t = run.frames.back().time, depth = std::max(-gap, 0.0),
                 early = 2 * std::sqrt(2 * depth / kG);
    const double expected = v * (t + early) - 0.5 * kG * (t + early) * (t + early);
    findings.at_most(name + ": place at 0.6 s",
                     std::abs(run.frames.back().poses[0].com_world.z() - expected),
                     4 * v * std::sqrt(2 * kRounding * top / kG) + 1e-12, "m",
                     "a double root is known to sqrt(2 u L / g) = 5e-9 s only, at 4.4 m/s");
    findings.at_most(name + ": steps", static_cast<double>(run.counters.counts.at("steps")), 70.0,
                     "", "60 of the run and some of the impact: no loop of steps of no length");
    if (gap < -1e-10) {
      const double entered = v / kG - std::sqrt(2 * depth / kG);
      findings.at_most(
          name + ": time of impact", std::abs(impact - entered),
          4 * kRounding * 3 * top / (kG * std::sqrt(2 * depth / kG)), "s",
          "four roundings of v t + g t^2 / 2 = 3 m at the speed it comes in with, 4.4e-4 m/s");
      double missed = 1.0;
      report::Curve path{"gap of the free flight", {}, {}};
      for (int i = 0; i <= 60; ++i) {
        const double ti = 0.01 * i, z = v * ti - 0.5 * kG * ti * ti;
        if (top + gap - z < 0) missed = 0.0;
      }
      findings.must_fail(name + ", sign of the gap at the ends of steps: impacts missed", missed,
                         0.0, "", "the gap is negative for 90 microseconds between two steps");
      for (int i = -100; i <= 100; ++i)
        path.x.push_back(1e-6 * i), path.y.push_back(gap + 0.5 * kG * 1e-12 * i * i);
      plot.curves = {path};
      plot.limits = {{0.0, "touching"}};
    }
  }
  findings.plot(std::move(plot));
}

}  // namespace

void add_sweeps(std::vector<Case>& cases) {
  cases.push_back({16, "tunnelling",
                   "A bullet crosses 10 m in a step, the wall is 1 mm thick. Engines that look for "
                   "overlaps at the ends of steps miss it, unless the body is flagged as a bullet. "
                   "Here no speed and no thinness is missed, and the time is exact.",
                   "", tunnelling});
  cases.push_back(
      {17, "rotating impacts",
       "Rods and boxes that spin fast. Most continuous methods sweep points along straight lines "
       "within a step: the tip of a metre of rod is off by half a metre at half a turn.",
       "", rotating});
  cases.push_back({18, "grazing",
                   "A ball that tops at a ceiling, touches it, or just does not. The gap has a "
                   "double root: its time is known to the root of rounding only, and either "
                   "verdict is right within 1e-15 m. "
                   "But no NaN, and no loop of steps of no length.",
                   "", grazing});
}

}  // namespace tumble::battery
