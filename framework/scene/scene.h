/// The content of a scene file as plain data. Nothing here moves; `load_scene` (load_scene.h) reads
/// and checks it.
///
/// SI units, world frame right-handed with z up. An effect without an entry is absent (an empty
/// optional or list), and then has no code at run time.
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

struct SphereSpec {
  double radius_m;
};
struct BoxSpec {
  Vector3d half_extents_m;
};
/// Half-space: the solid on the negative side of the plane through the body's position; the body's
/// +z is the normal.
struct PlaneSpec {
  double drawn_half_extent_m = 5.0;
};
/// Axes along the body's; collides with planes only. A centre other than the centre of mass needs
/// explicit moments of inertia.
struct EllipsoidSpec {
  Vector3d semi_axes_m;
  Vector3d center_m = Vector3d::Zero();  // body frame
};
struct ModelSpec {
  std::string file;    // relative to the scene file, then to models/
  std::string object;  // empty: the file must hold exactly one
  double metres_per_unit = 1.0;
};
using ShapeSpec = std::variant<SphereSpec, BoxSpec, PlaneSpec, ModelSpec, EllipsoidSpec>;

/// Motion of an immovable body along its own law: position = start + velocity t + amplitude
/// sin(angular_frequency t).
struct PrescribedMotion {
  Vector3d velocity_m_s = Vector3d::Zero();
  Vector3d amplitude_m = Vector3d::Zero();
  double angular_frequency_rad_s = 0.0;
};

struct BodySpec {
  std::string name;
  ShapeSpec shape;
  bool immovable = false;               // infinite mass
  std::optional<double> density_kg_m3;  // one of density and mass for a movable body
  std::optional<double> mass_kg;
  // overrides that of the shape (a free top given by its moments)
  std::optional<Matrix3d> inertia_body_kg_m2;
  std::optional<PrescribedMotion> motion;  // immovable bodies only
  Vector3d position_m = Vector3d::Zero();  // of the centre of mass, world
  Quaterniond world_from_body = Quaterniond::Identity();
  Vector3d velocity_m_s = Vector3d::Zero();       // world
  Vector3d omega_world_rad_s = Vector3d::Zero();  // world
  double restitution = 1.0;                       // of a pair: the smaller of the two
  // Coulomb's coefficient; of a pair: the smaller of the two
  double friction = 0.0;
  // false: it has no contacts, and no collision code visits it
  bool collides = true;
  // collides with immovable bodies only, where the other body has it too
  bool passes_movable = false;
  std::optional<Vector3d> color;  // linear RGB in [0, 1]
  bool drawn_as_die = false;      // pips on a box, see die.h
  // JSON pointer of its entry, for messages; empty: made in memory
  std::string pointer{};
};

/// A point fixed in a body or, with an empty name, in the world. For a body it may be given as a
/// vertex of its model.
struct AnchorSpec {
  std::string body;  // "": the world
  // body frame (origin at the centre of mass); world frame for the world
  Vector3d point_m = Vector3d::Zero();
};

// several impacts at one instant: in sequence, or together
enum class ImpactLaw { kSequential, kSimultaneous };
// perfectly inelastic impacts: at their instant, or within their step; automatic: within the step
// in busy islands only
enum class PlasticImpacts { kAutomatic, kLocated, kInStep };

/// Persistent contact: bodies that rest, slide, roll and are stacked.
struct ContactSpec {
  ImpactLaw impact_law = ImpactLaw::kSequential;
  PlasticImpacts plastic_impacts = PlasticImpacts::kAutomatic;
  bool sleep = false;  // bodies at rest are skipped until something touches them
};

enum class StabilisationKind { kNone, kBaumgarte, kProjection };
/// The correction of drift of rods and joints.
struct StabilisationSpec {
  StabilisationKind kind = StabilisationKind::kProjection;
  double time_constant_s = 0.1;  // of Baumgarte's
};

/// In which coordinates rods and joints are integrated: six a body and their rows, or those that
/// they leave free; automatic: the latter where nothing else is to be seen of them.
enum class Coordinates { kMaximal, kReduced, kAutomatic };
/// @throws UserError naming `where` for another word than maximal, reduced, auto
Coordinates coordinates_named(const std::string& word, const std::string& where);

struct CameraSpec {
  Vector3d eye_m{6.0, -8.0, 4.0};
  Vector3d target_m = Vector3d::Zero();
  double field_of_view_deg = 40.0;    // vertical
  std::optional<std::string> follow;  // a body's name: eye and target move with it
};

/// One number by which a run of the scene is judged. `kind` is one of the checks of
/// engines/judging/judge.h.
struct CheckSpec {
  // e.g. "energy", "momentum", "angular_momentum", "gap", "final_position", "impact_times"
  std::string kind;
  double tolerance = 0.0;
  std::string unit;
  std::string why;                  // the tolerance's reason
  std::string body;                 // for a check of one body
  std::string other;                // for a check of a pair: the second body
  std::string link;                 // for a check of a spring, rod or joint: its name
  std::vector<std::string> bodies;  // for a check of several bodies in order
  std::optional<Vector3d> axis;     // for a check along a direction: unit, in the frame of the kind
  std::vector<double> expected;     // for a comparison with expected values
  double at_s = 0.0;                // for a check at an instant, or from it on; 0: the end, or all
};

struct Scene {
  std::string name;  // file name without .json
  std::string title;
  std::string about;  // what to observe
  std::filesystem::path file;
  // by JSON pointer: the line of the file with the value or its key; empty: made in memory
  std::map<std::string, int> lines;
  // of the file's bytes (core/digest.h), or a name and size, for records
  std::string digest;
  std::vector<std::uint64_t> seeds;  // of the random numbers with which the scene was made
  double duration_s = 0.0;
  double step_s = 1.0 / 60.0;
  // impacts with a smaller separation speed end in rest (restitution threshold)
  double rest_speed_m_s = 1e-3;
  // false: engines take less where bodies are small or slow (engines/base/rest_speed.h)
  bool gives_rest_speed = true;
  std::vector<BodySpec> bodies;
  // entries of effects: lists of the types in framework/effects/NAME/NAME.h, such as
  // effects.of<SpringSpec>()
  TypedLists effects;
  // absent: bodies bounce until they rest, without resting, sliding or rolling contact
  std::optional<ContactSpec> contact;
  // present exactly where an effect constrains bodies (words.h: rods, joints)
  std::optional<StabilisationSpec> stabilisation;
  Coordinates coordinates = Coordinates::kMaximal;
  // pairs that do not collide (links of a chain); joined bodies never do
  std::vector<std::pair<std::string, std::string>> apart;
  CameraSpec camera;
  std::optional<double> grid_spacing_m;  // drawn on the ground plane z = grid_height_m
  double grid_height_m = 0.0;
  std::vector<CheckSpec> checks;
  std::string engine;              // the engine for which the scene is made ("tw"); empty: any
  std::vector<std::string> needs;  // ids of modules whose laws the scene is about, e.g. {"a1"}
};

/// The line of the scene's file with an entry, or with its parent where it has none of its own; 0
/// for a scene made in memory.
/// @param pointer  JSON pointer, such as "/bodies/1/friction"
int line_of(const Scene& scene, std::string pointer);

/// The same in words: "FILE:LINE: /bodies/1/friction", or the scene's name for one made in memory.
std::string place_of(const Scene& scene, const std::string& pointer);

}  // namespace tumble::scene
