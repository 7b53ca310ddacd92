/// What a scene file says, as plain data. Nothing here moves; `load_scene` (load_scene.h) reads it and checks it.
///
/// Units SI, world frame right-handed with z up. An effect that no entry calls for is absent (an empty optional or list),
/// and then does not exist at run time.
#pragma once

#include <filesystem>
#include <limits>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/math.h"
#include "framework/core/typed_lists.h"

namespace tumble::scene {

struct SphereSpec { double radius_m; };
struct BoxSpec { Vector3d half_extents_m; };
/// Half-space: the solid on the negative side of the plane through the body's position; the body's +z is the normal.
struct PlaneSpec { double drawn_half_extent_m = 5.0; };
/// Axes along the body's; meets planes only. A middle beside the centre of mass needs moments of inertia of its own.
struct EllipsoidSpec {
  Vector3d semi_axes_m;
  Vector3d center_m = Vector3d::Zero();   // body frame
};
struct ModelSpec {
  std::string file;            // relative to the scene file, then to models/
  std::string object;          // empty: the file must hold exactly one
  double metres_per_unit = 1.0;
};
using ShapeSpec = std::variant<SphereSpec, BoxSpec, PlaneSpec, ModelSpec, EllipsoidSpec>;

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
  double friction = 0.0;                           // Coulomb's coefficient; of a pair: the smaller of the two
  bool collides = true;                            // false: nothing touches it and no collision code looks at it
  bool passes_movable = false;                     // meets immovable bodies only, where the other one passes too
  std::optional<Vector3d> color;                   // linear RGB in [0, 1]
  std::string pointer{};                           // JSON pointer of its entry, for messages; empty: made in memory
};

/// A point fixed in a body or, with an empty name, in the world. Of a body it may be given as a vertex of its model.
struct AnchorSpec {
  std::string body;                 // "": the world
  Vector3d point_m = Vector3d::Zero();   // body frame (origin at the centre of mass); world frame for the world
};

enum class ImpactLaw { kSequential, kSimultaneous };      // several impacts at one instant: one after the other, or together
enum class PlasticImpacts { kAutomatic, kLocated, kInStep };   // impacts that do not bounce: at their instant, or with the step they fall into; or so in busy heaps only

/// Lasting contact: bodies that lie, slide, roll and are stacked.
struct ContactSpec {
  ImpactLaw impact_law = ImpactLaw::kSequential;
  PlasticImpacts plastic_impacts = PlasticImpacts::kAutomatic;
  bool sleep = false;               // bodies at rest are left alone until something touches them
};

enum class StabilisationKind { kNone, kBaumgarte, kProjection };
/// What keeps rods and joints from drifting apart.
struct StabilisationSpec {
  StabilisationKind kind = StabilisationKind::kProjection;
  double time_constant_s = 0.1;     // of Baumgarte's
};

struct CameraSpec {
  Vector3d eye_m{6.0, -8.0, 4.0};
  Vector3d target_m = Vector3d::Zero();
  double field_of_view_deg = 40.0;  // vertical
  std::optional<std::string> follow;  // a body's name: eye and target move along with it
};

/// One number by which a run of the scene is judged. `kind` is one of the checks that engines/judging/judge.h knows.
struct CheckSpec {
  std::string kind;                 // e.g. "energy", "momentum", "angular_momentum", "gap", "final_position", "impact_times"
  double tolerance = 0.0;
  std::string unit;
  std::string why;                  // the tolerance's reason
  std::string body;                 // where the check is about one body
  std::string other;                // where it is about a pair: the second body
  std::string link;                 // where it is about a spring, rod or joint: its name
  std::vector<std::string> bodies;  // where it is about several bodies in order
  std::optional<Vector3d> axis;     // where it is about a direction: unit, in the frame that the kind says
  std::vector<double> expected;     // where it compares with a truth
  double at_s = 0.0;                // where it is about an instant; 0: the end
};

struct Scene {
  std::string name;                 // file name without .json
  std::string title;
  std::string about;                // what a viewer should notice
  std::filesystem::path file;
  std::map<std::string, int> lines; // by JSON pointer: the line of the file where the value or its key begins; empty: made in memory
  std::string digest;               // of the file's bytes (core/digest.h), or a name and size, for records
  std::vector<std::uint64_t> seeds; // of what was drawn by lot when the scene was made
  double duration_s = 0.0;
  double step_s = 1.0 / 60.0;
  double rest_speed_m_s = 1e-3;     // an impact that separates more slowly than this ends in rest
  std::vector<BodySpec> bodies;
  TypedLists effects;               // what it says of effects: lists of the types in framework/effects/NAME/NAME.h, such as effects.of<SpringSpec>()
  std::optional<ContactSpec> contact;     // absent: bodies bounce until they rest, nothing lies, slides or rolls
  std::optional<StabilisationSpec> stabilisation;   // present exactly where something constrains (words.h: rods, joints)
  std::vector<std::pair<std::string, std::string>> apart;   // pairs that do not collide (links of a chain); joined bodies never do
  CameraSpec camera;
  std::optional<double> grid_spacing_m;   // drawn on the ground plane z = grid_height_m
  double grid_height_m = 0.0;
  std::vector<CheckSpec> checks;
  std::string engine;               // that the scene is about ("tw"); empty: any
  std::vector<std::string> needs;   // module ids whose laws the scene is about, e.g. {"a1"}
};

/// The line of the scene's file where an entry begins, or what holds it where it has none of its own; 0 for a scene made in memory.
/// @param pointer  JSON pointer, such as "/bodies/1/friction"
int line_of(const Scene& scene, std::string pointer);

/// The same in words: "FILE:LINE: /bodies/1/friction", or the scene's name for one made in memory.
std::string place_of(const Scene& scene, const std::string& pointer);

}  // namespace tumble::scene
