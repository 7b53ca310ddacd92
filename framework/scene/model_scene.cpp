#include "framework/scene/model_scene.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <numbers>

#include <fmt/format.h>

#include "framework/core/digest.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/solid.h"
#include "framework/scene/write_entries.h"

namespace tumble::scene {
namespace {

constexpr double kGravity = 9.81;      // m/s^2
constexpr double kFieldOfView = 36.0;  // degrees, vertical
// of the model's radius: the extent of the picture
constexpr double kMargin = 1.25;
// m: outside this range the model's unit is probably not the metre
constexpr double kSmallest = 5e-3, kLargest = 50.0;
constexpr double kModelSpin = 1.2;                              // rad/s: a turn in five seconds
constexpr double kFreeDuration = 8.0, kFreeStep = 1.0 / 240.0;  // s: 0.005 rad per step

/// An object of the file, about its centre of mass.
struct Object {
  std::string name;
  // of the smallest ball about the centre of mass that contains it [m]
  double radius = 0.0;
  double mass = 0.0;                    // [kg]
  Matrix3d inertia = Matrix3d::Zero();  // mesh axes [kg m^2]
  Vector3d size = Vector3d::Zero();     // of its bounding box [m]
};

std::vector<Object> read_objects(const std::filesystem::path& file,
                                 const ModelSceneOptions& options) {
  std::vector<Object> objects;
  for (const LoadedObject& loaded : load_3ds(file, {options.metres_per_unit}).objects) {
    // refuses meshes that are not closed
    const SolidModel model = load_solid(file, loaded.name, options.metres_per_unit);
    Object object{loaded.name, 0.0, options.density_kg_m3 * model.volume,
                  options.density_kg_m3 * model.inertia_per_density_body, Vector3d::Zero()};
    for (const Vector3d& vertex : model.solid.mesh_body.vertices)
      object.radius = std::max(object.radius, vertex.norm());
    const Bounds bounds = bounds_of(model.solid.mesh_body);
    object.size = bounds.high - bounds.low;
    objects.push_back(object);
  }
  return objects;
}

CheckSpec check(const std::string& kind, double tolerance, const std::string& why) {
  CheckSpec spec;
  spec.kind = kind;
  spec.tolerance = tolerance;
  spec.why = why;
  return spec;
}

/// 1, 2 or 5 times a power of ten, at most the given length: a grid that is easy to count.
double round_length(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= length) return factor * power;
  return power;
}

/// Adds bodies in a row along x, with the origin in the middle and a gap between neighbours.
void add_bodies(const std::vector<Object>& objects, const std::filesystem::path& file,
                const ModelSceneOptions& options, Scene& scene) {
  static const std::array<Vector3d, 4> colors = {
      Vector3d(0.82, 0.09, 0.05), Vector3d(0.03, 0.13, 0.27), Vector3d(0.84, 0.42, 0.07),
      Vector3d(0.05, 0.38, 0.30)};
  constexpr double kClear = 1.1;  // of the radius
  double length = 0.0;
  for (const Object& object : objects) length += 2.0 * kClear * object.radius;
  double x = -0.5 * length;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Object& object = objects[i];
    BodySpec body;
    body.name = object.name.empty() ? "model" : object.name;
    body.shape = ModelSpec{file.filename().string(), object.name, options.metres_per_unit};
    body.density_kg_m3 = options.density_kg_m3;
    body.position_m = {x + kClear * object.radius, 0.0, 0.0};
    body.color = colors[i % colors.size()];
    body.restitution = options.is_dropped ? 0.3 : 1.0;
    body.friction = options.is_dropped ? 0.4 : 0.0;
    scene.bodies.push_back(body);
    x += 2.0 * kClear * object.radius;
  }
}

/// Without forces: momentum, angular momentum and energy are constant.
void set_free(const std::vector<Object>& objects, const ModelSceneOptions& options, Scene& scene) {
  const Vector3d spin = options.turns
                            ? Vector3d(kModelSpin * Vector3d(0.25, 0.35, 0.9).normalized())
                            : Vector3d(Vector3d::Zero());
  double angular = 0.0, mass = 0.0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    scene.bodies[i].omega_world_rad_s = spin;
    angular += (objects[i].inertia * spin).norm();
    mass += objects[i].mass;
  }
  scene.duration_s = kFreeDuration;
  scene.step_s = kFreeStep;
  scene.checks = {
      check("momentum", 1e-12 * mass, "nothing acts: 1e-12 m/s of the whole mass for rounding"),
      check(
          "angular_momentum", 1e-8 * angular,
          "no torque acts: truncation of a fourth-order method, 0.005 rad a step, over 2000 steps"),
      check("energy", 1e-8, "no force does work: the same truncation")};
}

/// It falls by its own radius, lands, and comes to rest within about fifteen times the duration of
/// that fall.
void set_dropped(double radius, Scene& scene) {
  const double fall = std::sqrt(radius / kGravity);  // s: the scale of all times here
  EntryWriter{scene}("gravity_m_s2", Vector3d(0, 0, -kGravity));
  scene.contact = ContactSpec{};
  scene.needs = {"a1", "a3"};
  scene.duration_s = 15.0 * fall;
  scene.step_s = std::min(fall / 48.0, 1.0 / 60.0);
  scene.rest_speed_m_s = 5e-4 * std::sqrt(kGravity * radius);
  for (BodySpec& body : scene.bodies) {
    body.position_m.z() = 2.2 * radius;
    body.world_from_body = Eigen::AngleAxisd(0.35, Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(0.44, Vector3d::UnitY()) *
                           Eigen::AngleAxisd(0.7, Vector3d::UnitX());
  }
  BodySpec floor;
  floor.name = "floor";
  floor.shape = PlaneSpec{5.0 * radius};
  floor.immovable = true;
  floor.friction = 0.4;
  floor.color = Vector3d(0.26, 0.33, 0.38);
  scene.bodies.insert(scene.bodies.begin(), floor);
  scene.checks = {check("energy_not_rising", 1e-4,
                        "impacts and friction only take energy; steps in contact are of second "
                        "order, 5e-6 at this one where a body rolls over its corners"),
                  check("gap", 0.0, "nothing ever enters the floor")};
}

/// The description for a viewer: size, mass, and the flags that change them.
std::string about(const std::vector<Object>& objects, const ModelSceneOptions& options) {
  double mass = 0.0, largest = 0.0;
  Vector3d size = Vector3d::Zero();
  for (const Object& object : objects) {
    mass += object.mass;
    if (object.size.maxCoeff() > largest) size = object.size;
    largest = std::max(largest, object.size.maxCoeff());
  }
  std::string text = fmt::format(
      "{}{:.4g} x {:.4g} x {:.4g} m, {:.4g} kg, with 1 unit = {:g} m (--scale; the format does not "
      "say it) and {:g} kg/m^3 (--density).",
      objects.size() > 1 ? fmt::format("{} objects side by side, the largest ", objects.size())
                         : "",
      size.x(), size.y(), size.z(), mass, options.metres_per_unit, options.density_kg_m3);
  if (largest < kSmallest || largest > kLargest)
    text += fmt::format(
        " Is it meant to be so {}? Where the file's unit is a millimetre: --scale 0.001, an inch: "
        "--scale 0.0254.",
        largest < kSmallest ? "small" : "large");
  return text;
}

}  // namespace

bool names_model(const std::string& word) {
  std::string ending = std::filesystem::path(word).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".3ds") return true;
  if (!std::filesystem::is_regular_file(word)) return false;
  char first[2] = {};  // magic number of the main chunk, 0x4D4D
  std::ifstream(word, std::ios::binary).read(first, sizeof first);
  return first[0] == 'M' && first[1] == 'M';
}

Scene make_model_scene(const std::filesystem::path& file, const ModelSceneOptions& options) {
  const std::vector<Object> objects = read_objects(file, options);
  Scene scene;
  scene.name = file.stem().string();
  scene.title = fmt::format("{}, {}", file.filename().string(),
                            options.is_dropped ? "dropped on a floor" : "free in space");
  scene.file = std::filesystem::absolute(file);  // the model is searched beside it
  scene.digest = digest_of_file(file);
  scene.about = about(objects, options);
  add_bodies(objects, file, options, scene);

  // All moving bodies stay within `reach` of the middle.
  double radius = 0.0, reach = 0.0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    radius = std::max(radius, objects[i].radius);
    reach = std::max(reach, std::abs(scene.bodies[i].position_m.x()) + objects[i].radius);
  }
  if (options.is_dropped)
    set_dropped(radius, scene);
  else
    set_free(objects, options, scene);

  const double distance = kMargin * std::max(reach, options.is_dropped ? 1.7 * radius : 0.0) /
                          std::sin(0.5 * kFieldOfView * std::numbers::pi / 180.0);
  scene.camera.field_of_view_deg = kFieldOfView;
  scene.camera.target_m = {0.0, 0.0, options.is_dropped ? 1.2 * radius : 0.0};
  scene.camera.eye_m = scene.camera.target_m + distance * Vector3d(0.4, -0.85, 0.35).normalized();
  scene.grid_spacing_m = round_length(radius);
  scene.grid_height_m = options.is_dropped ? 0.0 : -1.2 * radius;
  return scene;
}

}  // namespace tumble::scene
