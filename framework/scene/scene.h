/// What a scene file says, as plain data. Nothing here moves; `load_scene` (load_scene.h) reads it and checks it.
///
/// Units SI, world frame right-handed with z up. An effect that no entry calls for is absent (an empty optional or list),
/// and then does not exist at run time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "framework/core/math.h"

namespace tumble::scene {

struct SphereSpec { double radius_m; };
struct BoxSpec { Vector3d half_extents_m; };
/// Half-space: the solid on the negative side of the plane through the body's position; the body's +z is the normal.
struct PlaneSpec { double drawn_half_extent_m = 5.0; };
struct ModelSpec {
  std::string file;            // relative to the scene file, then to models/
  std::string object;          // empty: the file must hold exactly one
  double metres_per_unit = 1.0;
};
using ShapeSpec = std::variant<SphereSpec, BoxSpec, PlaneSpec, ModelSpec>;

/// Motion of an immovable body along its own law: position = start + velocity t + amplitude sin(angular_frequency t).
struct PrescribedMotion {
  Vector3d velocity_m_s = Vector3d::Zero();
  Vector3d amplitude_m = Vector3d::Zero();
  double angular_frequency_rad_s = 0.0;
};

struct BodySpec {
  std::string name;
  ShapeSpec shape;
  bool immovable = false;                          // infinite mass
  std::optional<double> density_kg_m3;             // one of density and mass for a movable body
  std::optional<double> mass_kg;
  std::optional<Matrix3d> inertia_body_kg_m2;      // overrides the shape's own (a free top given by its moments)
  std::optional<PrescribedMotion> motion;          // immovable bodies only
  Vector3d position_m = Vector3d::Zero();          // of the centre of mass, world
  Quaterniond world_from_body = Quaterniond::Identity();
  Vector3d velocity_m_s = Vector3d::Zero();        // world
  Vector3d omega_world_rad_s = Vector3d::Zero();   // world
  double restitution = 1.0;                        // of a pair: the smaller of the two
  std::optional<Vector3d> color;                   // linear RGB in [0, 1]
};

/// A force on a point of a body for a while (what a user's click makes). The point is fixed in the body.
struct PointForceSpec {
  std::string body;
  Vector3d force_n;                 // world frame, constant
  Vector3d point_m;                 // world position of the point at start_s
  double start_s = 0.0;
  double duration_s = 0.0;
};

struct CameraSpec {
  Vector3d eye_m{6.0, -8.0, 4.0};
  Vector3d target_m = Vector3d::Zero();
  double field_of_view_deg = 40.0;  // vertical
  std::optional<std::string> follow;  // a body's name: eye and target move along with it
};

/// One number by which a run of the scene is judged. `kind` is one of the checks that engines/judge.h knows.
struct CheckSpec {
  std::string kind;                 // e.g. "energy", "momentum", "angular_momentum", "gap", "final_position", "impact_times"
  double tolerance = 0.0;
  std::string unit;
  std::string why;                  // the tolerance's reason
  std::string body;                 // where the check is about one body
  std::string other;                // where it is about a pair: the second body
  std::optional<Vector3d> axis;     // where it is about a direction: unit, in the frame that the kind says
  std::vector<double> expected;     // where it compares with a truth
  double at_s = 0.0;                // where it is about an instant; 0: the end
};

struct Scene {
  std::string name;                 // file name without .json
  std::string title;
  std::string about;                // what a viewer should notice
  std::filesystem::path file;
  std::string hash;                 // hex digest of the file's bytes, for records
  double duration_s = 0.0;
  double step_s = 1.0 / 60.0;
  double rest_speed_m_s = 1e-3;     // an impact that separates more slowly than this ends in rest
  std::optional<Vector3d> gravity_m_s2;
  std::vector<BodySpec> bodies;
  std::vector<PointForceSpec> point_forces;
  CameraSpec camera;
  std::optional<double> grid_spacing_m;   // drawn on the ground plane z = grid_height_m
  double grid_height_m = 0.0;
  std::vector<CheckSpec> checks;
  std::vector<std::string> needs;   // module ids whose laws the scene is about, e.g. {"a1"}
};

}  // namespace tumble::scene
