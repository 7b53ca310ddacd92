/// From a scene and its run to the drawing of each instant. Internal to framework/render; without
/// OpenGL.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "framework/effects/registry.h"
#include "framework/geometry/shape.h"
#include "framework/render/drawing.h"
#include "framework/render/links.h"
#include "framework/render/picture_options.h"
#include "framework/scene/die.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {

/// How a body is drawn: geometry, scale and colour.
struct Actor {
  int geometry = -1;                  // -1: not drawn as a body (the floor is the ground)
  Vector3d scale = Vector3d::Ones();  // along the geometry's axes
  Vector3d color;                     // linear RGB
  Pass pass = Pass::kSolid;
  double opacity = 1.0;
  bool quartered = false;
  bool immovable = false;
  std::vector<scene::Pip> pips{};
  // of its bounding ball about the origin; infinite for planes
  double radius_m = 0.0;
};

/// Text at a point of the world.
struct Label {
  Vector3d point_world;
  std::string text;
  double drop_pixels = 0.0;  // additional distance below the point
};

/// The drawing and labels of one instant.
struct Moment {
  Drawing drawing;
  std::vector<Label> labels;  // forces, the scale of the grid
};

/// What views side by side have in common, so that lengths and heights can be compared.
struct CommonScale {
  double strongest_impulse = 0.0;                             // of all collisions [N s]
  double lowest_m = std::numeric_limits<double>::infinity();  // point of all bodies, by world z

  void include(const CommonScale& other) {
    strongest_impulse = std::max(strongest_impulse, other.strongest_impulse);
    lowest_m = std::min(lowest_m, other.lowest_m);
  }
};

class Stage {
 public:
  /// @throws UserError when the run is of another scene or has no frame
  Stage(const scene::Scene& scene, const Trajectory& run, const PictureOptions& options);

  /// That of this run alone, until another one is set.
  const CommonScale& scale() const { return scale_; }
  /// The length of arrows of impulses, and the height of a grid without a floor, follow from it.
  void set_scale(const CommonScale& scale);

  const std::vector<Geometry>& geometries() const { return geometries_; }
  /// Index of the last frame that is not later than `time_s`.
  std::size_t frame_at(double time_s) const;
  Moment moment(std::size_t frame) const;
  /// Distance between the lines of the grid; 0 where there is none. [m]
  double grid_spacing_m() const { return ground_.shown ? ground_.spacing_m : 0.0; }
  /// Whether the grid's scale is shown on the ground; otherwise the caption must state it.
  bool has_scale_bar() const { return scale_bar_m_ > 0.0; }

 private:
  struct Path {
    std::size_t body;
    std::vector<std::size_t> frames;  // see path.h
  };

  void add_actors(const std::vector<Shape>& shapes);
  void add_actor(const scene::BodySpec& spec, const Shape& shape, std::size_t index);
  int geometry_of(const TriangleMesh& mesh);
  void find_extent();
  void lay_ground();
  void turn_walls_to_glass();
  void place_scale_bar();
  void find_paths();

  void add_bodies(const Frame& frame, Drawing& drawing) const;
  void add_scale_bar(Moment& moment) const;
  void add_paths(std::size_t last, Drawing& drawing) const;
  void add_forces(const Frame& frame, Moment& moment) const;
  void add_sheets(Drawing& drawing) const;
  void add_impacts(const Frame& frame, Drawing& drawing) const;
  View view_at(const Frame& frame) const;
  // of a drawing that looks at this point
  Vector3d origin_near(const Vector3d& seen_world) const;
  TriangleMesh surface(const Actor& actor) const;  // body frame; empty for balls and planes
  double sight_m() const { return (scene_.camera.eye_m - scene_.camera.target_m).norm(); }

  const scene::Scene& scene_;
  const Trajectory& run_;
  PictureOptions options_;
  std::vector<Geometry> geometries_;
  // of geometries_ from kFirstMesh on, to find models that are used twice
  std::vector<TriangleMesh> meshes_;
  std::vector<Actor> actors_;  // by body index
  std::vector<Path> paths_;    // of moving bodies, where there are few
  SceneLinks links_;
  effects::Drawables drawables_;
  Eigen::AlignedBox3d extent_;  // of all finite bodies, over the run
  Ground ground_;
  int floor_ = -1;  // the body whose plane is the ground
  int followed_ = -1;
  Vector3d scale_bar_from_ = Vector3d::Zero();
  double scale_bar_m_ = 0.0;  // its length; 0: none
  CommonScale scale_;
};

}  // namespace tumble::render
