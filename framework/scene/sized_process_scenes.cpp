#include "framework/scene/sized_process_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "framework/core/random.h"

namespace tumble::scene {
namespace {

const Vector3d kColors[] = {{0.93, 0.68, 0.29}, {0.82, 0.29, 0.36}, {0.19, 0.39, 0.56}, {0.0, 0.47, 0.55}, {0.37, 0.65, 0.35}};
const Vector3d kGrey(0.55, 0.6, 0.65);

BodySpec body_at(const std::string& name, const ShapeSpec& shape, double mass, const Vector3d& position, int color) {
  BodySpec body;
  body.name = name;
  body.shape = shape;
  body.mass_kg = mass;
  body.position_m = position;
  body.color = kColors[color % 5];
  return body;
}

BodySpec ground(const std::string& name, const Vector3d& point, const Vector3d& normal, double drawn) {
  BodySpec body;
  body.name = name;
  body.shape = PlaneSpec{drawn};
  body.immovable = true;
  body.position_m = point;
  body.world_from_body = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal);
  body.color = kGrey;
  return body;
}

CheckSpec no_overlap() {
  CheckSpec spec;
  spec.kind = "gap";
  spec.why = "no two bodies overlap";
  return spec;
}

Scene scene_of(double duration, double step) {
  Scene scene;
  scene.gravity_m_s2 = Vector3d(0, 0, -9.81);
  scene.needs = {"a1", "a2", "a3"};
  scene.duration_s = duration;
  scene.step_s = step;
  scene.checks.push_back(no_overlap());
  return scene;
}

}  // namespace

// ---- Cars ----------------------------------------------------------------------------------------------------------------

namespace {

constexpr double kWheel = 0.22;          // radius [m]
constexpr double kLane = 1.0;            // between pendula [m]: those that swing far meet their neighbours
constexpr double kRod = 1.5;             // [m]
constexpr double kBob = 0.12;            // [m]

// A motor asks for a turn that is never reached: full torque at a standstill, none at 10 rad/s.
void add_vehicle(int number, const Vector3d& at, Scene& scene) {
  const auto part = [&](const char* what) { return fmt::format("{}_{}", what, number); };
  BodySpec chassis = body_at(part("car"), BoxSpec{{0.6, 0.3, 0.08}}, 20.0, at + Vector3d(0, 0, 0.36), number);
  chassis.restitution = 0.5;
  scene.bodies.push_back(chassis);
  int wheel = 0;
  for (const double x : {-0.42, 0.42})
    for (const double y : {-0.55, 0.55}) {
      const std::string name = part("wheel") + std::string(1, static_cast<char>('a' + wheel++));
      BodySpec ball = body_at(name, SphereSpec{kWheel}, 2.0, at + Vector3d(x, y, kWheel), 2);
      ball.restitution = 0.0;
      ball.friction = 0.8;
      scene.bodies.push_back(ball);
      JointSpec hinge;
      hinge.name = "axle of " + name;
      hinge.kind = JointKind::kHinge;
      hinge.body_a = chassis.name;
      hinge.body_b = name;
      hinge.point_m = ball.position_m;
      hinge.axis = Vector3d::UnitY();
      scene.joints.push_back(hinge);
      MotorSpec motor;
      motor.joint = hinge.name;
      motor.offset_rad = 1000.0;
      motor.stiffness_n_m_rad = 1.0;
      motor.damping_n_m_s_rad = 100.0;
      motor.largest_torque_n_m = 3.0;
      scene.motors.push_back(motor);
    }
}

}  // namespace

Scene cars(int n) {
  Scene scene = scene_of(2.0, 1.0 / 240.0);
  scene.contact = ContactSpec{};
  scene.stabilisation = StabilisationSpec{};
  Random random(21);
  const int across = std::max(1, static_cast<int>(std::lround(std::sqrt(n)))), vehicles = std::max(1, n / 100);
  BodySpec floor = ground("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.6 * kLane * across + 3.0);
  floor.restitution = 0.5;
  floor.friction = 1.0;
  scene.bodies.push_back(floor);
  std::vector<Vector3d> bobs;   // where they begin: two that swing towards each other must not begin in each other
  for (int v = 0; v < vehicles; ++v) add_vehicle(v + 1, {-0.5 * kLane * across - 0.6, ((v + 0.5) / vehicles - 0.5) * kLane * across, 0}, scene);
  for (int i = 0; i < n; ++i) {
    const Vector3d pivot((i / across - 0.5 * (across - 1)) * kLane, (i % across - 0.5 * (across - 1)) * kLane, 0.42 + kRod);
    Vector3d place;
    do {
      const double lean = random.between(0.1, 0.35), way = random.between(0.0, 2 * std::numbers::pi);
      place = pivot + kRod * Vector3d(std::sin(lean) * std::cos(way), std::sin(lean) * std::sin(way), -std::cos(lean));
    } while (std::any_of(bobs.begin(), bobs.end(), [&](const Vector3d& other) { return (other - place).norm() < 2.2 * kBob; }));
    bobs.push_back(place);
    BodySpec bob = body_at(fmt::format("bob_{}", i + 1), SphereSpec{kBob}, 0.5, place, i);
    bob.restitution = 0.9;
    scene.rods.push_back({fmt::format("rod_{}", i + 1), {"", pivot}, {bob.name, Vector3d::Zero()}, kRod});
    scene.bodies.push_back(bob);
  }
  scene.camera.eye_m = {-0.9 * kLane * across - 2, -0.9 * kLane * across - 2, 0.5 * kLane * across + 1.5};
  scene.camera.target_m = {0, 0, 0.3};
  return scene;
}

// ---- Robots --------------------------------------------------------------------------------------------------------------

namespace {

constexpr int kLinks = 8;
constexpr double kLink = 0.2;            // length [m]
constexpr double kCell = 4.2;            // between arms [m]: none reaches another

// Swings about its post; springs of its hinges are as stiff as what hangs on them is heavy.
void add_arm(int number, const Vector3d& foot, Random& random, Scene& scene) {
  const double phase = random.between(0.0, 2 * std::numbers::pi);
  std::vector<std::string> names;
  for (int k = 0; k < kLinks; ++k) {
    names.push_back(fmt::format("arm_{}_{}", number, k + 1));
    BodySpec link = body_at(names.back(), BoxSpec{{0.5 * kLink, 0.04, 0.06}}, 0.5, foot + Vector3d((k + 0.5) * kLink, 0, 0.7), number);
    scene.bodies.push_back(link);
    JointSpec hinge;
    hinge.name = fmt::format("hinge_{}_{}", number, k + 1);
    hinge.kind = JointKind::kHinge;
    if (k == 0) {
      hinge.body_a = names[0];
    } else {
      hinge.body_a = names[static_cast<std::size_t>(k) - 1];
      hinge.body_b = names.back();
    }
    hinge.point_m = foot + Vector3d(k * kLink, 0, 0.7);
    hinge.axis = k % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitY();
    scene.joints.push_back(hinge);
    const double weight = std::pow(static_cast<double>(kLinks - k) / kLinks, 2.5);
    MotorSpec motor;
    motor.joint = hinge.name;
    motor.amplitude_rad = k % 2 == 0 ? 0.8 : 0.25;
    motor.frequency_hz = 0.7;
    motor.phase_rad = phase + 0.4 * k;
    motor.stiffness_n_m_rad = 250.0 * weight;
    motor.damping_n_m_s_rad = 12.0 * weight;
    motor.period_s = 1.0 / 960.0;   // held longer, such a torque would throw the light links about
    scene.motors.push_back(motor);
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j) scene.apart.emplace_back(names[i], names[j]);
}

}  // namespace

Scene robots(int n) {
  Scene scene = scene_of(2.0, 1.0 / 240.0);
  scene.stabilisation = StabilisationSpec{};
  Random random(22);
  const int across = std::max(1, static_cast<int>(std::lround(std::sqrt(n))));
  scene.bodies.push_back(ground("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.6 * kCell * across));
  for (int i = 0; i < n; ++i) {
    const Vector3d foot((i / across - 0.5 * (across - 1)) * kCell, (i % across - 0.5 * (across - 1)) * kCell, 0);
    add_arm(i + 1, foot, random, scene);
    for (int k = 0; k < 2; ++k) {
      const double angle = k == 0 ? 0.5 : -0.5, distance = random.between(0.9, 1.4);
      BodySpec block = body_at(fmt::format("block_{}_{}", i + 1, k + 1), BoxSpec{{0.09, 0.09, 0.09}}, 0.3, foot + Vector3d(distance * std::cos(angle), distance * std::sin(angle), random.between(0.9, 1.3)), i + k + 1);
      block.omega_world_rad_s = {random.between(-3.0, 3.0), random.between(-3.0, 3.0), random.between(-3.0, 3.0)};
      block.restitution = 0.9;
      scene.bodies.push_back(block);
    }
  }
  const int rows = (n - 1) / across + 1;
  const double middle = 0.5 * (rows - across) * kCell + 0.5 * kLinks * kLink, wide = kCell * std::max(rows, across);   // arms reach out along x
  scene.camera.eye_m = {middle + 0.3 * wide, -1.15 * wide, 0.7 * wide};
  scene.camera.target_m = {middle, -0.05 * wide, 0.4};
  return scene;
}

// ---- Avalanche -----------------------------------------------------------------------------------------------------------

namespace {

// The model mountainside.3ds: downhill along x, a flat valley at z = 0.
const Vector3d kMountainCentre(-6.93285, -0.00113, 2.33035);   // its centre of mass in its own frame, where bodies are placed by [m]
constexpr double kMountainWide = 6.6;    // of a piece: pieces stand side by side without a seam [m]
constexpr double kRockApart = 0.55;      // of rocks at the start [m]
constexpr double kFirstRow = 5.6;        // uphill of the valley [m]
constexpr double kSteep = 0.7;           // tangent of the slope
constexpr double kRelief = 1.0;          // how high the ground reaches above the even slope, with its step, and some room [m]
constexpr double kMargin = 2.2;          // of ground beside the outermost rocks, both sides together [m]

void add_mountain(double width, Scene& scene) {
  const int pieces = std::max(1, static_cast<int>(std::ceil((width + kMargin) / kMountainWide)));
  for (int k = 0; k < pieces; ++k) {
    BodySpec piece;
    piece.name = fmt::format("mountain_{}", k + 1);
    piece.shape = ModelSpec{"mountainside.3ds", "", 1.0};
    piece.immovable = true;
    piece.position_m = kMountainCentre + Vector3d(0, (k - 0.5 * (pieces - 1)) * kMountainWide, 0);
    piece.friction = 0.5;
    piece.color = Vector3d(0.36, 0.33, 0.27);
    scene.bodies.push_back(piece);
  }
}

}  // namespace

Scene avalanche(int n) {
  Scene scene = scene_of(4.0, 1.0 / 240.0);
  scene.contact = ContactSpec{};
  Random random(23);
  const int along = std::clamp(static_cast<int>(std::lround(std::sqrt(0.5 * n))), 1, 10), across = (n + along - 1) / along;
  const double width = kRockApart * across;
  BodySpec valley = ground("valley", Vector3d::Zero(), Vector3d::UnitZ(), 0.5 * width + 12.0);
  valley.friction = 0.5;
  scene.bodies.push_back(valley);
  add_mountain(width, scene);
  for (int i = 0; i < n; ++i) {
    const double size = random.between(0.22, 0.42), azimuth = random.between(0.0, 6.28), tilt = random.between(0.0, 3.0);
    const double x = -kFirstRow - (i / across) * kRockApart * 0.82, y = (i % across - 0.5 * (across - 1)) * kRockApart;
    BodySpec rock = body_at(fmt::format("rock_{}", i + 1), ModelSpec{fmt::format("rock_{}.3ds", i % 3 + 1), "", size}, 1.0, {x, y, -kSteep * x + kRelief + random.between(0.0, 0.3)}, i);
    rock.mass_kg.reset();
    rock.density_kg_m3 = 2600.0;
    rock.world_from_body = Quaterniond(Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) * Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
    rock.restitution = 0.3;
    rock.friction = 0.5;
    scene.bodies.push_back(rock);
  }
  const double far = std::max(9.0, 0.62 * width + 5.0);
  scene.camera.eye_m = {0.75 * far, -1.05 * far, 0.62 * far};
  scene.camera.target_m = {-4.0, 0.0, 2.2};
  return scene;
}

// ---- Dominoes and cradle -------------------------------------------------------------------------------------------------

Scene dominoes(int n) {
  constexpr double kApart = 0.28, kFall = 0.15;   // [m]; from one to the next [s]
  Scene scene = scene_of(1.0 + kFall * n, 1.0 / 480.0);
  scene.contact = ContactSpec{};
  scene.contact->plastic_impacts = PlasticImpacts::kInStep;
  BodySpec floor = ground("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.6 * kApart * n + 1);
  floor.friction = 0.6;
  floor.restitution = 0.0;
  scene.bodies.push_back(floor);
  const double first = -0.5 * kApart * (n - 1);
  for (int i = 0; i < n; ++i) {
    BodySpec domino = body_at(fmt::format("domino_{}", i + 1), BoxSpec{{0.04, 0.125, 0.25}}, 1.0, {first + kApart * i, 0, 0.25}, i);
    domino.restitution = 0.0;
    domino.friction = 0.6;
    scene.bodies.push_back(domino);
  }
  scene.point_forces.push_back({"domino_1", {40, 0, 0}, {first - 0.04, 0, 0.48}, 0.0, 0.04});
  scene.camera.eye_m = {0.3 * kApart * n, -0.7 * kApart * n - 2, 0.3 * kApart * n + 1};
  scene.camera.target_m = {0, 0, 0.15};
  return scene;
}

Scene cradle(int n) {
  Scene scene = scene_of(2.0, 1.0 / 480.0);
  scene.stabilisation = StabilisationSpec{};
  constexpr double kBall = 0.1, kGap = 1e-6, kSide = 0.4, kDrop = 1.0, kLift = 0.7;   // m; rad
  for (int i = 0; i < n; ++i) {
    const double x = (i - 0.5 * (n - 1)) * (2 * kBall + kGap), lift = i == 0 ? kLift : 0.0;
    const Vector3d place(x - kDrop * std::sin(lift), 0, -kDrop * std::cos(lift));
    const BodySpec ball = body_at(fmt::format("ball_{}", i + 1), SphereSpec{kBall}, 1.0, place, i == 0 ? 1 : 2);
    for (const double side : {-kSide, kSide}) {
      const Vector3d pivot(x, side, 0);
      scene.rods.push_back({fmt::format("rod_{}_{}", i + 1, side < 0 ? "near" : "far"), {"", pivot}, {ball.name, Vector3d::Zero()}, (place - pivot).norm()});
    }
    scene.bodies.push_back(ball);
  }
  scene.camera.eye_m = {0.1 * n, -0.25 * n - 3, -0.3};
  scene.camera.target_m = {0, 0, -0.7};
  return scene;
}

}  // namespace tumble::scene
