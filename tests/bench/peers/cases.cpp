#include "tests/bench/peers/cases.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "framework/core/random.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/truths/memory_scene.h"

namespace tumble::peers {
namespace {

using scene::BodySpec;
using scene::Scene;
using truths::ball;
using truths::empty_scene;
using truths::wall;

const Vector3d kDown(0, 0, -kGravity);
constexpr double kFloorFriction = 0.5;

std::vector<double> times(double step, int count) {
  std::vector<double> all;
  for (int k = 1; k <= count; ++k) all.push_back(k * step);
  return all;
}

/// first, first / 2, ... so many steps.
std::vector<double> halvings(double first, int count) {
  std::vector<double> all;
  for (int k = 0; k < count; ++k) all.push_back(std::ldexp(first, -k));
  return all;
}

BodySpec solid_box(const std::string& name, const Vector3d& half_extents, double mass,
                   const Vector3d& position) {
  BodySpec body = ball(name, mass, 1.0, position, Vector3d::Zero(), 0.0);
  body.shape = scene::BoxSpec{half_extents};
  return body;
}

BenchCase free_top(bool quick) {
  BenchCase bench{
      .id = "S1",
      .name = "free top",
      .title = "A torque-free top turns over: moments 1, 2, 3, 60 s",
      .error_name = "error of the orientation after 60 s",
      .error_unit = "rad",
      .truth =
          "tests/truths/free_top_asymmetric__dzhanibekov_123.json: Taylor series with 60 digits, "
          "checked against Jacobi's elliptic functions",
      .goals = {{.words = "1e-7 rad at 1/30 s", .error = 1e-7, .step = 1.0 / 30},
                {.words = "1e-7 rad for a fiftieth of Simbody's price",
                 .error = 1e-7,
                 .ratio = 1.0 / 50,
                 .peer = "Simbody"}},
      .note =
          "The middle moment is the unstable one: what is wrong early grows until the top turns "
          "over. Semi-implicit engines are of first order here, MuJoCo's RK4 of second: it adds "
          "its stages' angular velocities before it turns by their sum.",
      .scene = empty_scene("S1", 60.0, 1e-3),
      .sample_times = times(10.0, 6),
      .steps = halvings(1.0 / 30, quick ? 3 : 9)};
  BodySpec top = ball("top", 1.0, 0.1, Vector3d::Zero(), Vector3d::Zero(), 1.0);
  top.inertia_body_kg_m2 = Vector3d(1, 2, 3).asDiagonal();
  top.omega_world_rad_s = Vector3d(0.01, 1, 0.01);
  top.collides = false;
  bench.scene.bodies = {top};
  return bench;
}

/// Straight rods joined by hinges about y, the first to the world's origin. Nothing collides.
Scene chain_of_hinges(const std::string& name, int links, double length, double width, double mass,
                      const Vector3d& direction) {
  Scene scene = empty_scene(name, 1.0, 1e-3);
  effects::set_gravity(scene, kDown);
  scene.stabilisation = scene::StabilisationSpec{};
  std::string above;
  for (int k = 0; k < links; ++k) {
    BodySpec link =
        solid_box("link" + std::to_string(k), Vector3d(length / 2, width / 2, width / 2), mass,
                  (k + 0.5) * length * direction);
    link.world_from_body = Quaterniond::FromTwoVectors(Vector3d::UnitX(), direction);
    link.collides = false;
    scene.bodies.push_back(link);
    scene.effects.of<effects::JointSpec>().push_back({"joint" + std::to_string(k),
                                                      effects::JointKind::kHinge, link.name, above,
                                                      k * length * direction, Vector3d::UnitY()});
    above = link.name;
  }
  return scene;
}

BenchCase chain(bool quick) {
  BenchCase bench{
      .id = "S2",
      .name = "chain of 8",
      .title = "A chain of 8 rods swings from horizontal, 5 s",
      .error_name = "energy or joints, the worse",
      .error_unit = "",
      .truth =
          "energy and joints must stay: |E - E0| over the energy of the fall (m g L / "
          "2), opening of the joints over a link's length",
      .goals = {{.words = "1e-7 at 1/960 s", .error = 1e-7, .step = 1.0 / 960},
                {.words = "1e-11 at 1/7680 s", .error = 1e-11, .step = 1.0 / 7680},
                {.words = "1e-6 for half of MuJoCo's price",
                 .error = 1e-6,
                 .ratio = 0.5,
                 .peer = "MuJoCo"},
                {.words = "1e-4 for a tenth of ODE's price",
                 .error = 1e-4,
                 .ratio = 0.1,
                 .peer = "ODE"}},
      .note =
          "In joint coordinates (Tumble's, MuJoCo's, Simbody's, DART's, Bullet's btMultiBody) a "
          "hinge has an angle, so joints cannot open and eight numbers are solved for; "
          "ODE, Bullet's constraints and Tumble's rows have six coordinates a body, and "
          "the joints as 40 rows.",
      .scene = chain_of_hinges("S2", 8, kChainLink, 0.02, 1.0, Vector3d::UnitX()),
      .sample_times = times(0.1, quick ? 10 : 50),
      .steps = halvings(1.0 / 60, quick ? 3 : 8)};
  bench.scene.duration_s = bench.sample_times.back();
  return bench;
}

/// The same of many rods: what a step costs where joints are many.
BenchCase long_chain(int n, double duration) {
  const std::string many = std::to_string(n);
  BenchCase bench{
      .id = "S2-" + many,
      .name = "chain of " + many,
      .title = fmt::format("A chain of {} rods swings from horizontal, {} s", n, duration),
      .error_name = "energy or joints, the worse",
      .error_unit = "",
      .truth =
          "energy and joints must stay: |E - E0| over the energy of the fall (m g L / 2), opening "
          "of the joints over a link's length",
      .note =
          "A step of one length costs whoever has joint coordinates in proportion to the rods, a "
          "direct solver of all rows at once (ODE) with their cube. Where 1e-3 is enough Bullet's "
          "btMultiBody is cheap: one evaluation a step, of first order. MuJoCo's file of a hundred "
          "nested bodies and more is refused by its XML reader.",
      .scene = chain_of_hinges("S2", n, kChainLink, 0.02, 1.0, Vector3d::UnitX()),
      .sample_times = times(0.1, static_cast<int>(std::lround(duration * 10))),
      .steps = halvings(1.0 / 60, n > 100 ? 5 : 7)};
  if (n > 100)
    bench.goals = {{.words = "a step at most 12 times as dear as of 100 rods",
                    .step = 1.0 / 240,
                    .ratio = 12.0,
                    .bench = "S2-100"}};
  else
    bench.goals = {{.words = "1e-9, and joints that close to 1e-10", .error = 1e-9}};
  bench.scene.duration_s = bench.sample_times.back();
  return bench;
}

BenchCase elastic_balls(int n, bool quick) {
  const double side = std::cbrt(n / 100.0);  // m: the same density for every number
  const int cells = static_cast<int>(std::ceil(std::cbrt(n)));
  const double cell = side / cells, room = 0.5 * cell - kBallRadius;
  BenchCase bench{
      .id = "S3-" + std::to_string(n),
      .name = std::to_string(n) + " balls",
      .title = std::to_string(n) + " elastic balls in a box, 2 s",
      .error_name = "energy or overlap, the worse",
      .error_unit = "",
      .truth =
          "elastic balls keep their energy and never overlap: |E - E0| / E0, deepest overlap over "
          "a radius",
      .goals = {{.words = "energy 1e-12, no overlap", .error = 1e-12}},
      .note =
          "Steps decide how deep balls sink into each other before an engine notices; Tumble finds "
          "the instant, so that its step decides only the price: by retroactive detection every "
          "impact takes all bodies back to it. Overlaps of a tenth of a radius are cheap from the "
          "peers. MuJoCo has no restitution: its contacts are undamped springs.",
      .scene = empty_scene("S3", quick ? 0.5 : 2.0, 1e-3),
      .sample_times = times(0.1, quick ? 5 : 20),
      .steps = halvings(1.0 / 30, quick ? 2 : 7)};
  if (n == 1000)
    bench.goals = {{.words = "energy 1e-12, no overlap, for 0.5 s", .error = 1e-12, .price_s = 0.5},
                   {.words = "the same for 0.1 s", .error = 1e-12, .price_s = 0.1}};
  Random random(static_cast<std::uint64_t>(n));
  const auto jitter = [&](double size) {
    const double x = random.between(-size, size), y = random.between(-size, size),
                 z = random.between(-size, size);
    return Vector3d(x, y, z);
  };
  for (int k = 0; k < n; ++k) {
    const Vector3d corner(k % cells, (k / cells) % cells, k / (cells * cells));
    const Vector3d place = (corner + Vector3d::Constant(0.5)) * cell + jitter(0.9 * room);
    bench.scene.bodies.push_back(
        ball("ball" + std::to_string(k), 1.0, kBallRadius, place, jitter(1.0), 1.0));
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {-1, 1}) {
      const Vector3d normal = -sign * Vector3d::Unit(axis);
      bench.scene.bodies.push_back(
          wall("wall" + std::to_string(2 * axis + (sign + 1) / 2),
               sign > 0 ? Vector3d(side * Vector3d::Unit(axis)) : Vector3d::Zero(), normal, 1.0));
    }
  return bench;
}

BenchCase bouncing_ball(bool quick) {
  BenchCase bench{.id = "S4",
                  .name = "bounces",
                  .title = "A ball bounces, e = 0.8, 5 s",
                  .error_name = "error of the first ten bounces",
                  .error_unit = "s",
                  .truth = "tests/truths/bouncing_ball__e0.8.json: a geometric series",
                  .goals = {{.words = "1e-12 s for 0.5 ms", .error = 1e-12, .price_s = 0.5e-3}},
                  .note =
                      "Of a stepped engine the instant of a bounce is where its last flight "
                      "reaches the floor, not the end of the step.",
                  .scene = empty_scene("S4", 5.0, 1e-3),
                  .sample_times = {1.0, 2.0, 3.5, 5.0},
                  .steps = halvings(1.0 / 60, quick ? 3 : 8),
                  .watches_first_body = true};
  constexpr double kRadius = 0.1;  // m
  effects::set_gravity(bench.scene, kDown);
  bench.scene.bodies = {
      ball("ball", 1.0, kRadius, Vector3d(0, 0, 1.0 + kRadius), Vector3d::Zero(), 0.8),
      wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.8)};
  return bench;
}

BenchCase stack(int n, bool quick) {
  const std::string many = std::to_string(n);
  BenchCase bench{
      .id = n == 10 ? "S5" : "S5-" + many,
      .name = "stack of " + many,
      .title = "A stack of " + many + " boxes at rest, 10 s",
      .error_name = "way of the top box",
      .error_unit = "m",
      .truth = "static equilibrium: nothing moves",
      .note =
          "ODE's direct stepper drops the stack at most steps (its solver reports internal "
          "errors). MuJoCo's default contacts give by 1 cm; harder ones hold the stack at some "
          "steps (1/60 s) and let it fall at others (1/30, 1/120 s), which a curve of the best "
          "does "
          "not show. Tumble finds every contact point anew and solves to rounding at every step.",
      .scene = empty_scene("S5", quick ? 2.0 : 10.0, 1e-3),
      .sample_times = times(1.0, quick ? 2 : 10),
      .steps = halvings(1.0 / 30, quick ? 2 : 7)};
  effects::set_gravity(bench.scene, kDown);
  bench.scene.contact.emplace();
  bench.goals = {{.words = "1e-6 m at 1/60 s", .error = 1e-6, .step = 1.0 / 60}};
  if (n == 10)
    bench.goals.insert(bench.goals.end(),
                       {{.words = "1e-6 m for 0.65 s", .error = 1e-6, .price_s = 0.65},
                        {.words = "1e-6 m for 0.1 s", .error = 1e-6, .price_s = 0.1}});
  else
    bench.goals.push_back(
        {.words = "1e-6 m faster than real time", .error = 1e-6, .price_s = 10.0});
  for (int k = 0; k < n; ++k)
    bench.scene.bodies.push_back(solid_box("box" + std::to_string(k), Vector3d::Constant(0.5), 1.0,
                                           Vector3d(0, 0, k + 0.5)));
  bench.scene.bodies.push_back(wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.0));
  for (BodySpec& body : bench.scene.bodies) body.friction = kFloorFriction;
  return bench;
}

BenchCase heavy_bob(bool quick) {
  constexpr double kAngle = 25 * std::numbers::pi / 180;
  const Vector3d direction(std::sin(kAngle), 0, -std::cos(kAngle));
  BenchCase bench{
      .id = "S6",
      .name = "heavy bob",
      .title = "A bob of 10 kg swings on 10 links of 1 g, 10 s",
      .error_name = "energy or joints, the worse",
      .error_unit = "",
      .truth =
          "energy and joints must stay: |E - E0| over the energy of the fall, opening of the "
          "joints over a link's length",
      .goals = {{.words = "1e-9 at 1/1920 s", .error = 1e-9, .step = 1.0 / 1920},
                {.words = "stable at 1/960 s", .error = 1e-3, .step = 1.0 / 960},
                {.words = "1e-9 for half of MuJoCo's price",
                 .error = 1e-9,
                 .ratio = 0.5,
                 .peer = "MuJoCo"}},
      .note =
          "A link of a gram under 90 N swings across at sqrt(12 T / (m l)), some 3,000 rad/s: an "
          "explicit step of 1/960 s is not stable. Tumble stops such a run and says so; the others "
          "go on with energies from nowhere. Gauss's implicit method in joint coordinates is "
          "stable "
          "at any step: at 1/20 s it keeps the energy of these swings, which is what is judged "
          "here, "
          "and not their phase.",
      .scene = chain_of_hinges("S6", 10, kBobLink, 0.01, 0.001, direction),
      .sample_times = times(0.1, quick ? 5 : 100),
      .steps = halvings(1.0 / 960, quick ? 2 : 5)};
  BodySpec bob = ball("bob", 10.0, 0.12, 10 * kBobLink * direction, Vector3d::Zero(), 1.0);
  bob.collides = false;
  bench.scene.effects.of<effects::JointSpec>().push_back({"last", effects::JointKind::kHinge,
                                                          bob.name, bench.scene.bodies.back().name,
                                                          bob.position_m, Vector3d::UnitY()});
  bench.scene.bodies.push_back(bob);
  bench.scene.duration_s = bench.sample_times.back();
  return bench;
}

/// The same where the bob weighs a million links, for a tenth of the time: ten times as fast
/// across, so that steps are a tenth as long.
BenchCase heaviest_bob() {
  BenchCase bench = heavy_bob(true);
  bench.id = "S6-1e6";
  bench.name = "1:10^6";
  bench.title = "A bob of 1,000 kg swings on 10 links of 1 g, 1 s";
  bench.goals = {{.words = "joints and energy 1e-8", .error = 1e-8}};
  bench.note =
      "Mass ratio 10^6: the links swing across at some 30,000 rad/s. Where angles are the "
      "coordinates joints cannot open; where joints are rows a direct solver keeps them, and "
      "sweeps do not come to an end.";
  bench.scene.name = bench.id;
  bench.scene.bodies.back().mass_kg = 1000.0;
  bench.sample_times = times(0.1, 10);
  bench.scene.duration_s = bench.sample_times.back();
  bench.steps = halvings(1.0 / 7680, 4);
  return bench;
}

BenchCase bullet(double speed, const std::string& id, bool quick) {
  const double end = 0.1;  // s
  BenchCase bench{
      .id = id,
      .name = std::to_string(static_cast<int>(speed)) + " m/s",
      .title =
          "A bullet at " + std::to_string(static_cast<int>(speed)) + " m/s against a wall of 1 cm",
      .error_name = "error of the place after 0.1 s",
      .error_unit = "m",
      .truth = "closed form: there and back",
      .goals = {{.words = "1e-9 m at 1/60 s", .error = 1e-9, .step = 1.0 / 60}},
      .note =
          "80 m (980 m at 5,000 m/s) is a bullet that went through the wall. With its continuous "
          "mode Bullet holds it, and lets it wait at the wall for the next step.",
      .scene = empty_scene("S7", end, 1e-3),
      .sample_times = {end},
      .steps = halvings(1.0 / 60, quick ? 3 : 12)};
  BodySpec wall = solid_box("wall", Vector3d(kBulletWall / 2, 2, 2), 1.0, Vector3d::Zero());
  wall.mass_kg.reset();
  wall.immovable = true;
  wall.restitution = 1.0;
  bench.scene.bodies = {
      ball("bullet", 0.1, kBulletRadius, Vector3d(kBulletStart, 0, 0), Vector3d(speed, 0, 0), 1.0),
      wall};
  return bench;
}

BenchCase rocks(int n, double duration, bool quick) {
  // m: rocks reach 0.52 m from their middles
  constexpr double kSlope = 30 * std::numbers::pi / 180, kApart = 1.1, kAbove = 0.7;
  BenchCase bench{
      .id = "S8",
      .name = "rocks",
      .title = std::to_string(n) + " rocks tumble down a slope of 30 degrees",
      .error_name = "deepest overlap",
      .error_unit = "m",
      .truth =
          "solids do not overlap: separating axes over all faces and edges of every near pair, at "
          "ten instants a second",
      .goals = {{.words = "no overlap", .error = 1e-12},
                {.words = "1/240 s for one and a half times Bullet's price",
                 .step = 1.0 / 240,
                 .ratio = 1.5,
                 .peer = "Bullet"}},
      .note =
          "Tumble's two curves treat impacts that do not bounce with the step they fall into, or "
          "at their instants. Its price is that of never overlapping: of a pile of 20 rocks a "
          "fifth of a step solves for forces, a third finds near points and keeps solids apart, a "
          "sixth lays the paths between two steps and a tenth looks for touches midway "
          "(callgrind); the others let them sink in. DART's own collision detector has no hulls.",
      .scene = empty_scene("S8", duration, 1e-3),
      .sample_times = times(0.1, static_cast<int>(std::lround(duration * 10))),
      .steps =
          quick ? std::vector{1.0 / 120} : std::vector{1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480}};
  effects::set_gravity(bench.scene, kDown);
  bench.scene.contact.emplace();
  bench.scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  const Vector3d up(std::sin(kSlope), 0, std::cos(kSlope)),
      down(std::cos(kSlope), 0, -std::sin(kSlope)), across(0, 1, 0);
  Random random(8);
  for (int k = 0; k < n; ++k) {
    const Vector3d place = (kAbove + kApart * (k / 100)) * up + kApart * (k % 10) * down +
                           kApart * ((k / 10) % 10) * across;
    BodySpec rock = ball("rock" + std::to_string(k), 1.0, 1.0, place, Vector3d::Zero(), 0.0);
    rock.shape = scene::ModelSpec{"rock_2.3ds", "", 1.0};
    rock.mass_kg.reset();
    rock.density_kg_m3 = 2500.0;
    rock.friction = kFloorFriction;
    const double a = random.between(-1, 1), b = random.between(-1, 1), c = random.between(-1, 1),
                 d = random.between(-1, 1);
    rock.world_from_body = Quaterniond(a, b, c, d).normalized();
    bench.scene.bodies.push_back(rock);
  }
  BodySpec slope = wall("slope", Vector3d::Zero(), up, 0.0);
  slope.friction = kFloorFriction;
  bench.scene.bodies.push_back(slope);
  return bench;
}

/// Two hundred of the same rocks, smaller, into a bowl of eight slanting walls (the course's bowl,
/// with one kind of convex solid, and nobody asleep).
BenchCase bowl() {
  // m
  constexpr double kPerUnit = 0.3, kRadius = 1.328053374, kHeight = 0.535966076, kApart = 0.41,
                   kLayer = 0.42, kFirst = 1.35, kJitter = 0.02;
  constexpr double kSlant = 40 * std::numbers::pi / 180;
  BenchCase bench = rocks(0, 5.0, false);
  bench.id = "S8-bowl";
  bench.name = "bowl";
  bench.title = "200 rocks fall into a bowl, 5 s";
  bench.goals = {{.words = "no overlap", .error = 1e-12},
                 {.words = "5 s for 20 s", .error = 1e-12, .price_s = 20.0}};
  bench.note =
      "Rocks come to lie three deep on each other and on slanting walls. Nobody falls asleep, so "
      "that all contacts of the heap are solved in every step.";
  bench.scene.name = bench.id;
  bench.scene.bodies.clear();
  Random random(200);
  for (int k = 0; k < 200; ++k) {
    const double dx = random.between(-kJitter, kJitter), dy = random.between(-kJitter, kJitter),
                 dz = random.between(-kJitter, kJitter);
    const Vector3d place(kApart * (k % 5 - 2) + dx, kApart * ((k / 5) % 5 - 2) + dy,
                         kFirst + kLayer * (k / 25) + dz);
    BodySpec rock = ball("rock" + std::to_string(k), 1.0, 1.0, place, Vector3d::Zero(), 0.0);
    rock.shape = scene::ModelSpec{"rock_2.3ds", "", kPerUnit};
    rock.mass_kg.reset();
    rock.density_kg_m3 = 1000.0;
    rock.friction = kFloorFriction;
    rock.world_from_body =
        Quaterniond(Eigen::AngleAxisd(0.35 * (k / 25), Vector3d(1, 2, 3).normalized()));
    bench.scene.bodies.push_back(rock);
  }
  for (int k = 0; k < 8; ++k) {
    const double about = k * std::numbers::pi / 4;
    BodySpec side =
        solid_box("wall" + std::to_string(k), Vector3d(0.06, 0.775, 0.75), 1.0,
                  Vector3d(kRadius * std::cos(about), kRadius * std::sin(about), kHeight));
    side.mass_kg.reset();
    side.immovable = true;
    side.friction = kFloorFriction;
    side.world_from_body = Quaterniond(Eigen::AngleAxisd(about, Vector3d::UnitZ()) *
                                       Eigen::AngleAxisd(kSlant, Vector3d::UnitY()));
    bench.scene.bodies.push_back(side);
  }
  BodySpec floor = wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.0);
  floor.friction = kFloorFriction;
  bench.scene.bodies.push_back(floor);
  return bench;
}

}  // namespace

double bullet_speed(const BenchCase& bench) { return bench.scene.bodies.front().velocity_m_s.x(); }

std::vector<BenchCase> all_cases(bool quick) {
  std::vector<BenchCase> all{free_top(quick), chain(quick)};
  if (!quick) all.insert(all.end(), {long_chain(100, 2.0), long_chain(1000, 0.5)});
  all.push_back(elastic_balls(100, quick));
  if (!quick) all.insert(all.end(), {elastic_balls(200, quick), elastic_balls(1000, quick)});
  all.insert(all.end(), {bouncing_ball(quick), stack(10, quick)});
  if (!quick) all.push_back(stack(50, quick));
  all.insert(all.end(),
             {heavy_bob(quick), bullet(500, "S7-500", quick), bullet(5000, "S7-5000", quick)});
  all.push_back(quick ? rocks(20, 0.5, quick) : rocks(300, 5.0, quick));
  if (!quick) all.insert(all.end(), {heaviest_bob(), bowl()});
  return all;
}

}  // namespace tumble::peers
