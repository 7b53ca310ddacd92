#include "framework/render/stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/error.h"
#include "framework/core/shortest_turn.h"
#include "framework/render/stage_geometries.h"
#include "framework/render/surfaces.h"
#include "framework/scene/build_shape.h"

namespace tumble::render {
namespace {

// frames sampled for the extent of the motion: enough, and fast for long runs
constexpr std::size_t kExtentFrames = 400;

// However far bodies move, the near plane stays close to the eye, and a far plane of finite
// distance keeps the projection within single precision. Of the sight.
constexpr double kNearest = 0.01, kFarthest = 1e4;

// Of the sight: this far from the world's origin, single precision is 6e-5 of the sight, a
// twentieth of a pixel. Usual scenes are nearer.
constexpr double kUsualReach = 1e3;

// Smallest cosine between a floor's normal and the vertical: within 0.008 degrees, 0.7 mm over 5 m,
// a plane is drawn as the level ground.
constexpr double kLevel = 1.0 - 1e-8;

// Colours distinguishable for every colour vision (Okabe and Ito 2008), as linear RGB; without
// yellow and black, which are hard to see on light ground and in shadow.
const Vector3d kPalette[] = {{0.000, 0.168, 0.445}, {0.665, 0.112, 0.000}, {0.000, 0.342, 0.171},
                             {0.791, 0.347, 0.000}, {0.604, 0.191, 0.386}, {0.093, 0.456, 0.815}};
const Vector3d kImmovableColor(0.42, 0.45, 0.48);

TriangleMesh two_sided(TriangleMesh mesh) {
  const std::vector<Face> front = mesh.faces;
  for (const auto& [a, b, c] : front) mesh.faces.push_back({a, c, b});
  return mesh;
}

// The smallest of 1, 2, 5, 10, ... at or above x.
double round_length(double x) {
  const double decade = std::pow(10.0, std::floor(std::log10(x)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= x * (1.0 - 1e-9)) return step * decade;
  return 10.0 * decade;
}

// A flat ball, sunk into the surface.
Instance pip_on(const BodyPose& pose, const scene::Pip& pip, const Drawing& drawing) {
  constexpr double kThickness = 0.05;  // of its radius: enough that the surface does not hide it
  const Vector3d black(0.01, 0.01, 0.01);
  const Quaterniond turn = pose.world_from_body * shortest_turn(Vector3d::UnitZ(), pip.normal_body);
  return placed(drawing.from_origin(pose.com_world + pose.world_from_body * pip.point_body),
                turn.toRotationMatrix(), pip.radius_m * Vector3d(1, 1, kThickness), black);
}

std::size_t stride_of(const Trajectory& run) {
  return std::max<std::size_t>(1, run.frames.size() / kExtentFrames);
}

}  // namespace

Stage::Stage(const scene::Scene& scene, const Trajectory& run, const PictureOptions& options)
    : scene_(scene), run_(run), options_(options) {
  if (run.frames.empty())
    throw UserError(scene.name, "the run has no frame to draw", run.stopped_by);
  if (run.bodies.size() != scene.bodies.size())
    throw UserError(scene.name,
                    "the run has " + std::to_string(run.bodies.size()) + " bodies and the scene " +
                        std::to_string(scene.bodies.size()),
                    "Draw a run with the scene that it was made from.");
  std::vector<Shape> shapes;
  for (const scene::Solid& solid : scene::build_solids(scene, options.root))
    shapes.push_back(solid.shape);
  add_actors(shapes);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.camera.follow == scene.bodies[i].name) followed_ = static_cast<int>(i);
  std::vector<double> radii;
  for (const Actor& actor : actors_) radii.push_back(actor.radius_m);
  drawables_ = effects::drawn(scene);
  links_ = SceneLinks(scene, run.frames.front(), sight_m(), radii);
  find_extent();
  turn_walls_to_glass();
  CommonScale alone;
  for (const Event& event : run.events)
    if (event.kind == EventKind::kCollision) alone.include({.strongest_impulse = event.impulse});
  alone.include({.lowest_m = extent_.min().z()});
  set_scale(alone);
  find_paths();
}

void Stage::set_scale(const CommonScale& scale) {
  scale_ = scale;
  lay_ground();
  place_scale_bar();
}

void Stage::add_actors(const std::vector<Shape>& shapes) {
  geometries_.resize(kFirstMesh);
  for (int level = 0; level < kBallLevels; ++level)
    geometries_[static_cast<std::size_t>(kBall + level)] = unit_ball(level + 1);
  geometries_[kBoxGeometry] = shaded_surface(surface_of(Box{Vector3d::Ones()}));
  geometries_[kPlate] = shaded_surface(two_sided(surface_of(HalfSpace{}, 1.0)));
  geometries_[kArrow] = unit_arrow();
  geometries_[kTube] = unit_tube();
  geometries_[kRod] = unit_rod();
  for (int level = 0; level < kCoilLevels; ++level)
    geometries_[static_cast<std::size_t>(kCoil + level)] = unit_coil(coil_turns(level));
  for (std::size_t i = 0; i < shapes.size(); ++i) add_actor(scene_.bodies[i], shapes[i], i);
}

void Stage::add_actor(const scene::BodySpec& spec, const Shape& shape, std::size_t index) {
  Actor actor;
  actor.immovable = spec.immovable;
  actor.color = spec.color       ? *spec.color
                : spec.immovable ? kImmovableColor
                                 : kPalette[index % std::size(kPalette)];
  actor.radius_m = bounding_radius(shape);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    // A point mass is drawn as a dot.
    const double radius = sphere->radius > 0.0 ? sphere->radius : 0.008 * sight_m();
    actor.geometry = kBall;
    actor.scale = Vector3d::Constant(radius);
    actor.radius_m = radius;
    actor.quartered = !spec.immovable && sphere->radius > 0.0;
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    actor.geometry = kBoxGeometry;
    actor.scale = box->half_extents_body;
    if (spec.drawn_as_die) actor.pips = scene::pips_of_die(box->half_extents_body);
  } else if (const auto* solid = std::get_if<MeshSolid>(&shape)) {
    actor.geometry = geometry_of(solid->mesh_body);
  } else if (std::holds_alternative<Ellipsoid>(shape)) {
    actor.geometry = geometry_of(surface_of(shape));
  } else {
    const auto* plane = std::get_if<scene::PlaneSpec>(&spec.shape);
    const double extent = plane != nullptr ? plane->drawn_half_extent_m : 5.0;
    const Vector3d normal_world = spec.world_from_body * Vector3d::UnitZ();
    const bool is_floor = normal_world.z() > kLevel && !spec.motion;
    if (is_floor && floor_ < 0) floor_ = static_cast<int>(index);
    actor.geometry = floor_ == static_cast<int>(index) ? -1 : static_cast<int>(kPlate);
    actor.scale = {extent, extent, 1.0};
    const bool is_upright = std::abs(normal_world.z()) < 0.5;
    if (is_upright) actor.pass = Pass::kGlass, actor.opacity = 0.22;
  }
  actors_.push_back(actor);
}

int Stage::geometry_of(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    if (meshes_[i].vertices == mesh.vertices && meshes_[i].faces == mesh.faces)
      return kFirstMesh + static_cast<int>(i);
  meshes_.push_back(mesh);
  geometries_.push_back(shaded_surface(mesh));
  return static_cast<int>(geometries_.size()) - 1;
}

void Stage::find_extent() {
  for (std::size_t f = 0; f < run_.frames.size(); f += stride_of(run_)) {
    for (std::size_t i = 0; i < actors_.size(); ++i) {
      const Vector3d& com = run_.frames[f].poses[i].com_world;
      if (!std::isfinite(actors_[i].radius_m) || !com.allFinite()) continue;
      const Actor& actor = actors_[i];
      // A box's extent along the world's axes is tighter than its ball: a floor made of a thin box
      // has little height.
      Vector3d reach = Vector3d::Constant(actor.radius_m);
      if (actor.geometry == kBoxGeometry)
        reach = run_.frames[f].poses[i].world_from_body.toRotationMatrix().cwiseAbs() * actor.scale;
      extent_.extend(com - reach).extend(com + reach);
    }
    for (const Link& link : links_.at(run_.frames[f]))
      extent_.extend(link.a_world).extend(link.b_world);
  }
  if (extent_.isEmpty()) extent_.extend(scene_.camera.target_m);
}

void Stage::lay_ground() {
  ground_.shown = scene_.grid_spacing_m.has_value() || floor_ >= 0;
  ground_.spacing_m = scene_.grid_spacing_m.value_or(round_length(sight_m() / 12.0));
  ground_.height_m = scene_.grid_height_m;
  if (floor_ >= 0)
    ground_.height_m = run_.frames.front().poses[static_cast<std::size_t>(floor_)].com_world.z();
  // A grid without a floor is only a scale: it lies below everything, so that no body seems to
  // penetrate it.
  else if (followed_ < 0)
    ground_.height_m = std::min(ground_.height_m, scale_.lowest_m);
  ground_.fade_m = 2.6 * sight_m();
}

View Stage::view_at(const Frame& frame) const {
  if (followed_ < 0) return view_of(scene_.camera);
  const auto i = static_cast<std::size_t>(followed_);
  return view_of(scene_.camera, frame.poses[i].com_world - run_.frames.front().poses[i].com_world);
}

Vector3d Stage::origin_near(const Vector3d& seen_world) const {
  if (!seen_world.allFinite() || seen_world.norm() <= kUsualReach * sight_m())
    return Vector3d::Zero();
  // On the crossing of two strong lines of the grid, which therefore stays where it is.
  const double step = ground_.spacing_m > 0.0 ? 5.0 * ground_.spacing_m : sight_m();
  return step * (seen_world / step).array().round().matrix();
}

TriangleMesh Stage::surface(const Actor& actor) const {
  if (actor.geometry == kBoxGeometry) return surface_of(Box{actor.scale});
  return actor.geometry >= kFirstMesh
             ? meshes_[static_cast<std::size_t>(actor.geometry - kFirstMesh)]
             : TriangleMesh{};
}

// An immovable body that occludes moving ones is drawn as glass for the whole run. Terrain that
// hides a body for a moment stays solid.
void Stage::turn_walls_to_glass() {
  constexpr std::size_t kSampledFrames = 40;
  constexpr double kMostHidden = 0.05;  // fraction of all tests
  const std::size_t stride = std::max<std::size_t>(1, run_.frames.size() / kSampledFrames);
  for (std::size_t wall = 0; wall < actors_.size(); ++wall) {
    Actor& actor = actors_[wall];
    if (!actor.immovable || actor.geometry < 0 || actor.pass == Pass::kGlass) continue;
    const TriangleMesh shape = surface(actor);
    std::size_t tests = 0, hidden = 0;
    for (std::size_t f = 0; f < run_.frames.size(); f += stride) {
      const Frame& frame = run_.frames[f];
      for (std::size_t i = 0; i < actors_.size(); ++i) {
        if (actors_[i].immovable) continue;
        ++tests;
        hidden +=
            hides(shape, frame.poses[wall], view_at(frame).eye_world, frame.poses[i].com_world) ? 1
                                                                                                : 0;
      }
    }
    if (static_cast<double>(hidden) > kMostHidden * static_cast<double>(tests))
      actor.pass = Pass::kGlass, actor.opacity = 0.25;
  }
}

std::size_t Stage::frame_at(double time_s) const {
  constexpr double kRoundOff = 1e-9;  // s: rounding of a frame's summed time
  const auto later =
      std::upper_bound(run_.frames.begin(), run_.frames.end(), time_s + kRoundOff,
                       [](double time, const Frame& frame) { return time < frame.time; });
  return later == run_.frames.begin() ? 0
                                      : static_cast<std::size_t>(later - run_.frames.begin()) - 1;
}

Moment Stage::moment(std::size_t index) const {
  const Frame& frame = run_.frames[index];
  Moment moment;
  Drawing& drawing = moment.drawing;
  drawing.view = view_at(frame);
  const View& view = drawing.view;
  // The key light is above, to the left of the eye and on its side, so that visible surfaces are
  // lit.
  drawing.to_light_world =
      (-0.55 * view.right_world + 0.35 * view.right_world.cross(Vector3d::UnitZ()) +
       0.95 * Vector3d::UnitZ())
          .normalized();
  drawing.shadow_centre_world = extent_.center();
  drawing.shadow_radius_m = 0.5 * extent_.diagonal().norm() + 1e-3 * sight_m();
  // Where bodies move far, only bodies near the centre of the picture cast shadows, so that shadows
  // stay sharp.
  if (drawing.shadow_radius_m > sight_m()) {
    drawing.shadow_centre_world = view.eye_world + sight_m() * view.forward_world;
    drawing.shadow_radius_m = sight_m();
  }
  drawing.ground = ground_;
  const Vector3d seen = view.eye_world + sight_m() * view.forward_world;
  drawing.origin_world = origin_near(seen);
  drawing.ground.centre_m = seen.head<2>();
  const double reach =
      sight_m() + std::max(ground_.shown ? ground_.fade_m : 0.0, extent_.diagonal().norm());
  drawing.far_m =
      std::min(kFarthest * sight_m(), 1.2 * reach + (view.eye_world - extent_.center()).norm());
  drawing.near_m = std::min(drawing.far_m / 2000.0, kNearest * sight_m());
  add_bodies(frame, drawing);
  add_sheets(drawing);
  draw_links(links_.at(frame), options_.height, drawing);
  add_paths(index, drawing);
  add_scale_bar(moment);
  if (options_.marks) {
    add_impacts(frame, drawing);
    add_forces(frame, moment);
  }
  return moment;
}

void Stage::add_bodies(const Frame& frame, Drawing& drawing) const {
  std::vector<Batch> solid, glass;
  for (int i = 0; i < static_cast<int>(geometries_.size()); ++i) {
    solid.push_back({i, Pass::kSolid, {}});
    glass.push_back({i, Pass::kGlass, {}});
  }
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    const Actor& actor = actors_[i];
    const BodyPose& pose = frame.poses[i];
    if (actor.geometry < 0 || !pose.com_world.allFinite()) continue;
    Instance instance =
        placed(drawing.from_origin(pose.com_world), pose.world_from_body.toRotationMatrix(),
               actor.scale, actor.color, actor.opacity);
    instance.quartered = actor.quartered ? 1.0f : 0.0f;
    const int geometry =
        actor.geometry == kBall
            ? kBall + ball_level(actor.radius_m /
                                 metres_per_pixel(drawing.view, options_.height, pose.com_world))
            : actor.geometry;
    (actor.pass == Pass::kGlass ? glass : solid)[static_cast<std::size_t>(geometry)]
        .instances.push_back(instance);
    for (const scene::Pip& pip : actor.pips)
      solid[kBall + 1].instances.push_back(pip_on(pose, pip, drawing));
  }
  for (auto* batches : {&solid, &glass})
    for (Batch& batch : *batches)
      if (!batch.instances.empty()) drawing.batches.push_back(std::move(batch));
}

}  // namespace tumble::render
