#include "framework/scene/sized_process_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "framework/core/random.h"
#include "framework/core/shortest_turn.h"
#include "framework/scene/lots.h"
#include "framework/scene/write_entries.h"

namespace tumble::scene {
namespace {

const Vector3d kColors[] = {{0.93, 0.68, 0.29},
                            {0.82, 0.29, 0.36},
                            {0.19, 0.39, 0.56},
                            {0.0, 0.47, 0.55},
                            {0.37, 0.65, 0.35}};
const Vector3d kGrey(0.55, 0.6, 0.65);

BodySpec body_at(const std::string& name, const ShapeSpec& shape, double mass,
                 const Vector3d& position, int color) {
  BodySpec body;
  body.name = name;
  body.shape = shape;
  body.mass_kg = mass;
  body.position_m = position;
  body.color = kColors[color % 5];
  return body;
}

BodySpec ground(const std::string& name, const Vector3d& point, const Vector3d& normal,
                double drawn) {
  BodySpec body;
  body.name = name;
  body.shape = PlaneSpec{drawn};
  body.immovable = true;
  body.position_m = point;
  body.world_from_body = shortest_turn(Vector3d::UnitZ(), normal);
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
  EntryWriter{scene}("gravity_m_s2", Vector3d(0, 0, -9.81));
  scene.needs = {"a1", "a2", "a3"};
  scene.duration_s = duration;
  scene.step_s = step;
  scene.checks.push_back(no_overlap());
  return scene;
}

}  // namespace

// ---- Cars --------------------------------------------------------------------------------------

namespace {

constexpr double kWheel = 0.22;  // radius [m]
// between pendula [m]: those with a large swing collide with their neighbours
constexpr double kLane = 1.0;
constexpr double kRod = 1.5;   // [m]
constexpr double kBob = 0.12;  // [m]
// between vehicles side by side or behind each other [m]: one is 1.54 m wide and 1.28 m long
constexpr double kBay = 1.8;

// The motor's target is never reached: full torque at a standstill, none at 10 rad/s.
void add_vehicle(int number, const Vector3d& at, Scene& scene, EntryWriter& write) {
  const auto part = [&](const char* what) { return fmt::format("{}_{}", what, number); };
  BodySpec chassis =
      body_at(part("car"), BoxSpec{{0.6, 0.3, 0.08}}, 20.0, at + Vector3d(0, 0, 0.36), number);
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
      const std::string axle = "axle of " + name;
      write("joints", {{"name", axle},
                       {"kind", "hinge"},
                       {"body_a", chassis.name},
                       {"body_b", name},
                       {"point_m", ball.position_m},
                       {"axis", Vector3d(Vector3d::UnitY())}});
      write("motors", {{"joint", axle},
                       {"offset_rad", 1000.0},
                       {"stiffness_n_m_rad", 1.0},
                       {"damping_n_m_s_rad", 100.0},
                       {"largest_torque_n_m", 3.0}});
    }
}

}  // namespace

Scene cars(int n) {
  Scene scene = scene_of(2.0, 1.0 / 240.0);
  scene.contact = ContactSpec{};
  scene.stabilisation = StabilisationSpec{};
  scene.coordinates = Coordinates::kAutomatic;  // half the price: pendula and axles that few meet
  Random random = lots(21, scene);
  const int across = std::max(1, static_cast<int>(std::lround(std::sqrt(n)))),
            vehicles = std::max(1, n / 100);
  BodySpec floor = ground("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.6 * kLane * across + 3.0);
  floor.restitution = 0.5;
  floor.friction = 1.0;
  scene.bodies.push_back(floor);
  EntryWriter write(scene);
  // start positions: two that swing towards each other must not overlap at the start
  std::vector<Vector3d> bobs;
  // Vehicles start in front of the pendula, spread over their width; in several ranks where one is
  // too short.
  const int most_abreast = std::max(1, static_cast<int>(kLane * across / kBay)),
            ranks = (vehicles - 1) / most_abreast + 1, abreast = (vehicles - 1) / ranks + 1;
  for (int v = 0; v < vehicles; ++v)
    add_vehicle(v + 1,
                {-0.5 * kLane * across - 0.9 - kBay * (v / abreast),
                 ((v % abreast + 0.5) / abreast - 0.5) * kLane * across, 0},
                scene, write);
  for (int i = 0; i < n; ++i) {
    const Vector3d pivot((i / across - 0.5 * (across - 1)) * kLane,
                         (i % across - 0.5 * (across - 1)) * kLane, 0.42 + kRod);
    Vector3d place;
    do {
      const double lean = random.between(0.25, 0.6),
                   way = random.between(0.0, 2 * std::numbers::pi);
      place = pivot + kRod * Vector3d(std::sin(lean) * std::cos(way),
                                      std::sin(lean) * std::sin(way), -std::cos(lean));
    } while (std::any_of(bobs.begin(), bobs.end(), [&](const Vector3d& other) {
      return (other - place).norm() < 2.2 * kBob;
    }));
    bobs.push_back(place);
    BodySpec bob = body_at(fmt::format("bob_{}", i + 1), SphereSpec{kBob}, 0.5, place, i);
    bob.restitution = 0.9;
    scene.bodies.push_back(bob);
    write("rods", {{"name", fmt::format("rod_{}", i + 1)},
                   {"a", AnchorSpec{"", pivot}},
                   {"b", AnchorSpec{bob.name}},
                   {"length_m", kRod}});
  }
  scene.camera.eye_m = {-0.9 * kLane * across - 2, -0.9 * kLane * across - 2,
                        0.5 * kLane * across + 1.5};
  scene.camera.target_m = {0, 0, 0.3};
  return scene;
}

// ---- Robots ------------------------------------------------------------------------------------

namespace {

constexpr int kLinks = 8;
constexpr double kLink = 0.2;      // length [m]
constexpr double kShoulder = 0.9;  // above the floor [m]
// between arms [m]: an arm never reaches another, a thrown block may
constexpr double kCell = 4.4;
constexpr double kSwing = 1.75;  // of the hand about the shoulder [rad]
// The model scoop.3ds: half its width, of its pocket, height, floor [m]. Its centre of mass above
// its underside is that of the block minus the pocket.
constexpr double kScoop = 0.125, kPocket = 0.1015625, kScoopHigh = 0.1015625,
                 kScoopFloor = 0.015625;
constexpr double kBlock = 0.0703125;  // half a block's side [m]: smaller than the pocket

// Whether a hinge of the arm, counted from the shoulder, has an upright axis; the others lift.
bool turns_aside(int hinge) { return hinge == 0 || hinge == 4; }

// of the swing, by hinge: those near the hand have the smallest torque
constexpr double kShares[kLinks] = {0.0, 0.35, 0.25, 0.2, 0.0, 0.1, 0.06, 0.04};
constexpr double kLinkMass = 1.0, kBlockMass = 0.3;  // kg

double scoop_centre() {
  const double whole = kScoop * kScoop * kScoopHigh,
               pocket = kPocket * kPocket * (kScoopHigh - kScoopFloor);
  return (0.5 * whole * kScoopHigh - 0.5 * pocket * (kScoopHigh + kScoopFloor)) / (whole - pocket);
}

BodySpec block_at(const std::string& name, const Vector3d& place, int color) {
  BodySpec block = body_at(name, BoxSpec{{kBlock, kBlock, kBlock}}, kBlockMass, place, color);
  block.restitution = 0.0;
  block.friction = 0.5;
  return block;
}

// Distance of a link's centre from the shoulder; the hand is the last. [m]
double arm_of(int link) { return (link + 0.5) * kLink + (link == kLinks - 1 ? 0.05 : 0.0); }

// Torque of gravity on a hinge with the arm stretched out. [N m]
double weight_on(int hinge) {
  double torque = kBlockMass * (arm_of(kLinks - 1) - hinge * kLink);
  for (int k = hinge; k < kLinks; ++k) torque += kLinkMass * (arm_of(k) - hinge * kLink);
  return 9.81 * torque;
}

// From rest, carrying its weight, to the far end and back: target = weight / stiffness + a (1 -
// cos(2 pi f t)).
void add_motor(const std::string& hinge, int k, double turn, double rate, EntryWriter& write) {
  // stiffness in proportion to the load
  const double share = std::pow(static_cast<double>(kLinks - k) / kLinks, 2.5);
  // more would make the links vibrate: a torque is held until the next sample
  const double stiffness = 6000.0 * share, damping = 4.0 * std::sqrt(share);
  // s: held longer, such a torque would make the light links unstable
  const double period = 1.0 / 960.0;
  write("motors", {{"joint", hinge},
                   {"amplitude_rad", 0.5 * turn},
                   {"frequency_hz", rate},
                   {"phase_rad", -0.5 * std::numbers::pi},
                   {"stiffness_n_m_rad", stiffness},
                   {"damping_n_m_s_rad", damping},
                   {"offset_rad", 0.5 * turn + (turns_aside(k) ? 0.0 : weight_on(k) / stiffness)},
                   {"period_s", period}});
}

// Stretched out backward along -x, its hand a scoop with a block in it. The lifting hinges swing it
// up and over; where the hand decelerates the block flies on. The other two turn the arm to its
// sides.
void add_arm(int number, const Vector3d& foot, Random& random, Scene& scene, EntryWriter& write) {
  // swings per second; the angle to the side [rad]
  const double rate = random.between(0.55, 0.7), side = random.between(-0.2, 0.2);
  const Vector3d shoulder = foot + Vector3d(0, 0, kShoulder);
  std::vector<std::string> names;
  for (int k = 0; k < kLinks; ++k) {
    const bool is_hand = k == kLinks - 1;
    names.push_back(is_hand ? fmt::format("hand_{}", number)
                            : fmt::format("arm_{}_{}", number, k + 1));
    BodySpec link = body_at(names.back(), BoxSpec{{0.5 * kLink, 0.035, 0.045}}, kLinkMass,
                            shoulder - Vector3d(arm_of(k), 0, 0), number);
    if (is_hand) link.shape = ModelSpec{"scoop.3ds", "", 1.0};
    link.friction = 0.5;
    link.restitution = 0.0;
    scene.bodies.push_back(link);
    const std::string hinge = fmt::format("hinge_{}_{}", number, k + 1);
    std::vector<std::pair<std::string, EntryWriter::Value>> entry{
        {"name", hinge},
        {"kind", "hinge"},
        {"body_a", names[static_cast<std::size_t>(std::max(0, k - 1))]},
        {"point_m", Vector3d(shoulder - Vector3d(k * kLink, 0, 0))},
        {"axis", Vector3d(turns_aside(k) ? Vector3d::UnitZ() : Vector3d::UnitY())}};
    if (k > 0) entry.emplace_back("body_b", names.back());
    write("joints", entry);
    add_motor(hinge, k, turns_aside(k) ? side : kSwing * kShares[k], rate, write);
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j) scene.apart.emplace_back(names[i], names[j]);
  const Vector3d& hand = scene.bodies.back().position_m;
  scene.bodies.push_back(block_at(fmt::format("block_{}_1", number),
                                  hand + Vector3d(0, 0, kScoopFloor - scoop_centre() + kBlock),
                                  number + 1));
}

}  // namespace

Scene robots(int n) {
  Scene scene = scene_of(2.0, 1.0 / 240.0);
  EntryWriter write(scene);
  scene.stabilisation = StabilisationSpec{};
  scene.contact = ContactSpec{};
  scene.contact->plastic_impacts = PlasticImpacts::kInStep;
  Random random = lots(22, scene);
  const int across = std::max(1, static_cast<int>(std::lround(std::sqrt(n))));
  BodySpec floor = ground("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.6 * kCell * across + 2);
  floor.friction = 0.6;
  floor.restitution = 0.5;
  scene.bodies.push_back(floor);
  for (int i = 0; i < n; ++i) {
    const Vector3d foot((i / across - 0.5 * (across - 1)) * kCell,
                        (i % across - 0.5 * (across - 1)) * kCell, 0);
    add_arm(i + 1, foot, random, scene, write);
    // where the first one is thrown
    scene.bodies.push_back(block_at(
        fmt::format("block_{}_2", i + 1),
        foot + Vector3d(random.between(1.6, 2.2), random.between(-0.3, 0.3), kBlock), i + 3));
  }
  const int rows = (n - 1) / across + 1;
  const double middle = 0.5 * (rows - across) * kCell, wide = kCell * std::max(rows, across);
  scene.camera.eye_m = {middle + 0.2 * wide + 0.5, -0.78 * wide - 1.6, 0.36 * wide + 0.7};
  scene.camera.target_m = {middle + 0.4, 0, 0.8};
  return scene;
}

// ---- Avalanche ---------------------------------------------------------------------------------

namespace {

// The model mountainside.3ds: downhill along x, a flat valley at z = 0.
// its centre of mass in its own frame, by which bodies are placed [m]
const Vector3d kMountainCentre(-6.93285, -0.00113, 2.33035);
// width of a piece: pieces are placed side by side without a seam [m]
constexpr double kMountainWide = 6.6;
constexpr double kRockApart = 0.7;  // of rocks at the start [m]
constexpr double kFirstRow = 5.6;   // uphill of the valley [m]
constexpr double kSteep = 0.7;      // tangent of the slope
// height of the ground above the even slope, with its step, and a margin [m]
constexpr double kRelief = 1.45;
// of ground beside the outermost rocks, both sides together [m]
constexpr double kGround = 2.2;

void add_mountain(double width, Scene& scene) {
  const int pieces = std::max(1, static_cast<int>(std::ceil((width + kGround) / kMountainWide)));
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
  Random random = lots(23, scene);
  const int along = std::clamp(static_cast<int>(std::lround(std::sqrt(0.5 * n))), 1, 10),
            across = (n + along - 1) / along;
  const double width = kRockApart * across;
  BodySpec valley = ground("valley", Vector3d::Zero(), Vector3d::UnitZ(), 0.5 * width + 12.0);
  valley.friction = 0.5;
  scene.bodies.push_back(valley);
  add_mountain(width, scene);
  for (int i = 0; i < n; ++i) {
    const double size = random.between(0.3, 0.5), azimuth = random.between(0.0, 6.28),
                 tilt = random.between(0.0, 3.0);
    const double x = -kFirstRow - (i / across) * kRockApart * 0.82,
                 y = (i % across - 0.5 * (across - 1)) * kRockApart;
    BodySpec rock = body_at(fmt::format("rock_{}", i + 1),
                            ModelSpec{fmt::format("rock_{}.3ds", i % 3 + 1), "", size}, 1.0,
                            {x, y, -kSteep * x + kRelief + random.between(0.0, 0.3)}, i);
    rock.mass_kg.reset();
    rock.density_kg_m3 = 2600.0;
    rock.world_from_body = Quaterniond(Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) *
                                       Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
    rock.restitution = 0.3;
    rock.friction = 0.5;
    scene.bodies.push_back(rock);
  }
  const double far = std::max(8.0, 0.5 * width + 5.0);
  scene.camera.eye_m = {1.2 * far, -1.15 * far, 0.85 * far};
  scene.camera.target_m = {-2.2, 0.0, 1.2};
  return scene;
}

// ---- Dominoes and cradle -----------------------------------------------------------------------

Scene dominoes(int n) {
  constexpr double kApart = 0.28, kFall = 0.15;  // [m]; from one to the next [s]
  Scene scene = scene_of(1.0 + kFall * n, 1.0 / 480.0);
  scene.contact = ContactSpec{};
  scene.contact->plastic_impacts = PlasticImpacts::kInStep;
  BodySpec floor = ground("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.6 * kApart * n + 1);
  floor.friction = 0.6;
  floor.restitution = 0.0;
  scene.bodies.push_back(floor);
  const double first = -0.5 * kApart * (n - 1);
  for (int i = 0; i < n; ++i) {
    BodySpec domino = body_at(fmt::format("domino_{}", i + 1), BoxSpec{{0.04, 0.125, 0.25}}, 1.0,
                              {first + kApart * i, 0, 0.25}, i);
    domino.restitution = 0.0;
    domino.friction = 0.6;
    scene.bodies.push_back(domino);
  }
  EntryWriter{scene}("point_forces", {{"body", "domino_1"},
                                      {"force_n", Vector3d(40, 0, 0)},
                                      {"point_m", Vector3d(first - 0.04, 0, 0.48)},
                                      {"duration_s", 0.04}});
  scene.camera.eye_m = {0.3 * kApart * n, -0.7 * kApart * n - 2, 0.3 * kApart * n + 1};
  scene.camera.target_m = {0, 0, 0.15};
  return scene;
}

Scene cradle(int n) {
  Scene scene = scene_of(2.0, 1.0 / 480.0);
  scene.stabilisation = StabilisationSpec{};
  constexpr double kBall = 0.1, kGap = 1e-6, kSide = 0.4, kDrop = 1.0, kLift = 0.7;  // m; rad
  EntryWriter write(scene);
  for (int i = 0; i < n; ++i) {
    const double x = (i - 0.5 * (n - 1)) * (2 * kBall + kGap), lift = i == 0 ? kLift : 0.0;
    const Vector3d place(x - kDrop * std::sin(lift), 0, -kDrop * std::cos(lift));
    const BodySpec ball =
        body_at(fmt::format("ball_{}", i + 1), SphereSpec{kBall}, 1.0, place, i == 0 ? 1 : 2);
    scene.bodies.push_back(ball);
    for (const double side : {-kSide, kSide}) {
      const Vector3d pivot(x, side, 0);
      write("rods", {{"name", fmt::format("rod_{}_{}", i + 1, side < 0 ? "near" : "far")},
                     {"a", AnchorSpec{"", pivot}},
                     {"b", AnchorSpec{ball.name}},
                     {"length_m", (place - pivot).norm()}});
    }
  }
  scene.camera.eye_m = {0.1 * n, -0.25 * n - 3, -0.3};
  scene.camera.target_m = {0, 0, -0.7};
  return scene;
}

}  // namespace tumble::scene
