#include "framework/scene/sized_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/random.h"
#include "framework/core/shortest_turn.h"
#include "framework/scene/lots.h"
#include "framework/scene/sized_process_scenes.h"

namespace tumble::scene {
namespace {

constexpr int kMostBodies = 2'000'000;

// ---- Atoms: balls and molecules of water in a box, divided by a wall down the middle -----------

// Balls fill 5 % of the room: a ball of speed 1.5 m/s then collides about sqrt(2) pi d^2 v rho =
// 3.2 times per second (d its diameter, rho the bodies per volume; R. Clausius' mean free path),
// which is w h = 0.1 at steps of 1/30 s.
constexpr double kBall = 0.1;  // radius [m]
// of the lattice of start positions [m]: 11.7 bodies per cubic metre
constexpr double kApart = 0.44;
constexpr double kSpeed = 1.5;  // of every body at the start [m/s]
constexpr double kSpin = 2.0;   // of every molecule at the start [rad/s]
// metres per unit of the model: it reaches 0.16 m from its centre
constexpr double kMolecule = 0.22;
constexpr double kMoleculeReach = 0.18;  // [m]
constexpr double kDivider = 0.05;        // half the thickness of the wall in the middle [m]

Vector3d direction(Random& random) {
  const double azimuth = random.between(0.0, 2.0 * std::numbers::pi),
               height = random.between(-1.0, 1.0);
  const double radius = std::sqrt(1.0 - height * height);
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), height};
}

BodySpec wall(const std::string& name, const Vector3d& point, const Vector3d& normal,
              double drawn) {
  BodySpec body;
  body.name = name;
  body.shape = PlaneSpec{drawn};
  body.immovable = true;
  body.position_m = point;
  body.world_from_body = shortest_turn(Vector3d::UnitZ(), normal);
  body.color = Vector3d(0.55, 0.6, 0.65);
  return body;
}

void add_room(const Vector3d& half, Scene& scene) {
  const char* names[] = {"left", "right", "near", "far", "floor", "ceiling"};
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? -1.0 : 1.0;
    scene.bodies.push_back(wall(names[side], sign * half[axis] * Vector3d::Unit(axis),
                                -sign * Vector3d::Unit(axis), half.maxCoeff()));
  }
}

BodySpec ball_at(const std::string& name, double radius, const Vector3d& position,
                 const Vector3d& velocity, int color) {
  static const Vector3d colors[] = {{0.93, 0.68, 0.29},
                                    {0.82, 0.29, 0.36},
                                    {0.19, 0.39, 0.56},
                                    {0.0, 0.47, 0.55},
                                    {0.37, 0.65, 0.35}};
  BodySpec body;
  body.name = name;
  body.shape = SphereSpec{radius};
  body.mass_kg = 1.0;
  body.position_m = position;
  body.velocity_m_s = velocity;
  body.color = colors[color % 5];
  return body;
}

BodySpec molecule_at(const std::string& name, const Vector3d& position, Random& random) {
  BodySpec body = ball_at(name, 1.0, position, kSpeed * direction(random), 0);
  body.shape = ModelSpec{"water_hull.3ds", "", kMolecule};
  body.color = Vector3d(0.75, 0.85, 0.95);
  body.world_from_body =
      Quaterniond(Eigen::AngleAxisd(random.between(0.0, 3.0), direction(random)));
  body.omega_world_rad_s = kSpin * direction(random);
  return body;
}

// Positions of a lattice of at least `count` cells in a block as deep and high as `across` cells,
// from x = from to the right.
struct Block {
  double from;
  int across;
  Vector3d place(int index) const {
    const int layer = index / (across * across), rest = index % (across * across);
    const double side = 0.5 * (across - 1);
    return {from + (layer + 0.5) * kApart, (rest / across - side) * kApart,
            (rest % across - side) * kApart};
  }
  double length(int count) const {
    return kApart * std::ceil(static_cast<double>(count) / (across * across));
  }
};

void add_balls(int count, const Block& block, Random& random, Scene& scene) {
  constexpr double kFree = 0.5 * kApart - kBall;
  for (int i = 0; i < count; ++i) {
    const Vector3d shift(random.between(-kFree, kFree), random.between(-kFree, kFree),
                         random.between(-kFree, kFree));
    const Vector3d place = block.place(i) + shift;
    scene.bodies.push_back(
        ball_at(fmt::format("ball_{}", i + 1), kBall, place, kSpeed * direction(random), i));
  }
}

int across_for(int n) { return std::max(1, static_cast<int>(std::lround(std::cbrt(n)))); }

void look_at_room(const Vector3d& half, Scene& scene) {
  scene.camera.target_m = Vector3d::Zero();
  scene.camera.eye_m = Vector3d(0.35 * half.x(), -3.6 * half.maxCoeff(), 1.5 * half.maxCoeff());
}

CheckSpec check(const std::string& kind, double tolerance, const std::string& why) {
  CheckSpec spec;
  spec.kind = kind;
  spec.tolerance = tolerance;
  spec.why = why;
  return spec;
}

void add_gas_checks(Scene& scene) {
  scene.needs = {"a1"};
  scene.checks.push_back(check("energy", 1e-9, "elastic: round-off of some thousand collisions"));
  scene.checks.push_back(check("gap", 0.0, "no two bodies overlap, and none enters a wall"));
}

Scene gas(int n) {
  Scene scene;
  Random random = lots(11, scene);
  const Block block{0.0, across_for(n)};
  const double length = block.length(n);
  const Vector3d half(0.5 * length, 0.5 * kApart * block.across, 0.5 * kApart * block.across);
  add_room(half, scene);
  Block centred = block;
  centred.from = -half.x();
  add_balls(n, centred, random, scene);
  look_at_room(half, scene);
  add_gas_checks(scene);
  return scene;
}

// Two thirds balls on the left of the dividing wall, one third molecules on its right.
Scene atoms(int n) {
  Scene scene;
  Random random = lots(12, scene);
  const int molecules = n / 3, balls = n - molecules, across = across_for(n);
  const double left = Block{0.0, across}.length(balls),
               right = Block{0.0, across}.length(molecules);
  const double length = left + right + 2 * kDivider;
  const Vector3d half(0.5 * length, 0.5 * kApart * across, 0.5 * kApart * across);
  add_room(half, scene);
  const double middle = -half.x() + left + kDivider;
  BodySpec divider;
  divider.name = "divider";
  divider.shape = BoxSpec{{kDivider, half.y() + kApart, half.z() + kApart}};
  divider.immovable = true;
  divider.position_m = {middle, 0, 0};
  divider.color = Vector3d(0.55, 0.6, 0.65);
  scene.bodies.push_back(divider);
  add_balls(balls, {-half.x(), across}, random, scene);
  const Block there{middle + kDivider, across};
  constexpr double kFree = 0.5 * kApart - kMoleculeReach;
  for (int i = 0; i < molecules; ++i) {
    const Vector3d shift(random.between(-kFree, kFree), random.between(-kFree, kFree),
                         random.between(-kFree, kFree));
    scene.bodies.push_back(
        molecule_at(fmt::format("water_{}", i + 1), there.place(i) + shift, random));
  }
  look_at_room(half, scene);
  add_gas_checks(scene);
  return scene;
}

// ---- Pong: balls on a table between four walls -------------------------------------------------

constexpr double kPongBall = 0.07;   // radius [m]
constexpr double kPongApart = 0.41;  // [m]

Scene pong(int n, bool pass) {
  Scene scene;
  Random random = lots(13, scene);
  const int across = std::max(1, static_cast<int>(std::lround(std::sqrt(0.5 * n)))),
            along = (n + across - 1) / across;
  const double x = 0.5 * kPongApart * (along + 1), y = 0.5 * kPongApart * (across + 1);
  const auto side = [&](const char* name, const Vector3d& half, const Vector3d& at) {
    BodySpec body;
    body.name = name;
    body.shape = BoxSpec{half};
    body.immovable = true;
    body.position_m = at;
    body.color = Vector3d(0.27, 0.32, 0.38);
    scene.bodies.push_back(body);
  };
  constexpr double kHalf = 0.04;
  side("left", {kHalf, y + 2 * kHalf, kPongBall}, {-x - kHalf, 0, kPongBall});
  side("right", {kHalf, y + 2 * kHalf, kPongBall}, {x + kHalf, 0, kPongBall});
  side("near", {x, kHalf, kPongBall}, {0, -y - kHalf, kPongBall});
  side("far", {x, kHalf, kPongBall}, {0, y + kHalf, kPongBall});
  constexpr double kFree = 0.5 * kPongApart - kPongBall;
  for (int i = 0; i < n; ++i) {
    const double azimuth = random.between(0.0, 2.0 * std::numbers::pi);
    const Vector3d place((i / across - 0.5 * (along - 1)) * kPongApart,
                         (i % across - 0.5 * (across - 1)) * kPongApart, kPongBall);
    const Vector3d shift(random.between(-kFree, kFree), random.between(-kFree, kFree), 0);
    BodySpec body = ball_at(fmt::format("ball_{}", i + 1), kPongBall, place + shift,
                            {std::cos(azimuth), std::sin(azimuth), 0}, i);
    body.passes_movable = pass;
    scene.bodies.push_back(body);
  }
  scene.camera.eye_m = {0, -1.7 * std::max(x, y), 2.0 * std::max(x, y)};
  scene.camera.target_m = {0, -0.05 * y, 0};
  scene.grid_spacing_m = 0.5;
  add_gas_checks(scene);
  return scene;
}

Scene make(const std::string& name, int n) {
  if (name == "atoms") return atoms(n);
  if (name == "gas") return gas(n);
  if (name == "cars") return cars(n);
  if (name == "robots") return robots(n);
  if (name == "avalanche") return avalanche(n);
  if (name == "dominoes_row") return dominoes(n);
  if (name == "cradle") return cradle(n);
  return pong(n, name == "pong_ghosts");
}

}  // namespace

const std::vector<SizedScene>& sized_scenes() {
  static const std::vector<SizedScene> scenes = {
      {"pong", "Pong: balls on a table", "balls", 200,
       "Elastic balls on a table without friction. Far apart, they have nothing to do with each "
       "other: what happens in one corner is no reason to stop in another."},
      {"pong_ghosts", "Pong: balls that ignore each other", "balls", 200,
       "The balls meet the walls only. Each is a simulation of its own, and an engine that knows "
       "it does the same work for each, however many there are."},
      {"gas", "Gas: balls in a box", "balls", 200,
       "Elastic balls without weight. The energy stays, the order of the first collisions is the "
       "same by every engine, and chaos takes over after some ten collisions a ball."},
      {"atoms", "Atoms: balls and molecules of water in a divided box",
       "bodies, a third of them molecules", 300,
       "Elastic balls on the left of the wall, molecules that spin on its right: collisions come "
       "at random and concern two bodies each, which is what timewarp is for."},
      {"cars", "Cars: vehicles among pendula",
       "pendula; a vehicle of five bodies for every hundred", 400,
       "Vehicles on motors drive into pendula that swing into each other. A vehicle with its "
       "wheels is one process, each pendulum another."},
      {"robots", "Robots: arms that throw blocks", "arms of eight links, with two blocks each", 20,
       "Each arm carries a block in its hand and throws it. As long as the block lies in the hand, "
       "arm and block are one process; in flight it is one of its own, and no arm waits for "
       "another."},
      {"avalanche", "Avalanche: rocks come down a mountainside", "rocks", 300,
       "Rocks fall, bounce, slide, roll and pile up. Those in persistent contact move as one "
       "process "
       "until they part."},
      {"dominoes_row", "Dominoes: a row of them", "dominoes", 20,
       "One push, and a wave goes down the row: each domino matters to its neighbours only, one "
       "after the other."},
      {"cradle", "Newton's cradle", "balls", 20,
       "Hung a millionth of a metre apart, so that the blow goes through ball by ball and the last "
       "leaves with the speed of the first."}};
  return scenes;
}

const SizedScene* sized_scene_named(const std::string& name) {
  for (const SizedScene& sized : sized_scenes())
    if (sized.name == name) return &sized;
  return nullptr;
}

Scene make_sized_scene(const std::string& name, int n) {
  std::vector<std::string> names;
  for (const SizedScene& sized : sized_scenes()) names.push_back(sized.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw UserError(name, "is no scene with a size." + did_you_mean(name, names),
                    "Use one of " + fmt::format("{}", fmt::join(names, ", ")) + ".");
  if (n < 1 || n > kMostBodies)
    throw UserError(fmt::format("--n {}", n), fmt::format("expected from 1 to {}", kMostBodies),
                    "Give the number of bodies.");
  Scene scene = make(name, n);
  const SizedScene& sized = sized_scenes()[static_cast<std::size_t>(found - names.begin())];
  scene.name = name;
  scene.about = sized.about;
  scene.title = fmt::format("{} (n = {})", sized.title, n);
  scene.digest = fmt::format("{} n={}", name, n);
  if (scene.duration_s > 0) return scene;  // a scene with its own duration
  scene.duration_s = 2.0;
  scene.step_s = 1.0 / 30.0;
  return scene;
}

}  // namespace tumble::scene
