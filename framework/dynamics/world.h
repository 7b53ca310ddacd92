/// The bodies of a scene and the effects on them, ready to be advanced. Plain data: engines move
/// it, nothing here does.
///
/// An effect that the scene does not ask for is absent (an empty optional or list): no code of it
/// runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/body.h"
#include "framework/dynamics/constraint.h"
#include "framework/geometry/shape.h"
#include "framework/scene/scene.h"

namespace tumble {

/// A body of a world. Its state is where it is at the world's time.
struct WorldBody {
  std::string name;
  Inertia inertia;
  Shape shape;
  double restitution = 1.0;
  double friction = 0.0;
  bool collides = true;
  bool passes_movable = false;                 // two movable bodies that both do never meet
  RigidBodyState state;                        // of a movable body
  scene::PrescribedMotion motion;              // of an immovable one, about com_at_0
  Vector3d com_at_0_world = Vector3d::Zero();  // [m]
  // a point mass: its moment of inertia only keeps equations regular (scene/build_shape.h)
  bool has_no_size = false;

  bool immovable() const { return inertia.inverse_mass == 0.0; }
};

/// A point fixed in a body, or in the world.
struct Anchor {
  int body;             // -1: the world
  Vector3d point_body;  // body frame; world frame for the world [m]
};

struct World {
  std::vector<WorldBody> bodies;
  // what acts on them: lists of the types in framework/effects/NAME/NAME.h, such as
  // effects.of<SpringLink>()
  TypedLists effects;
  std::optional<Vector3d> gravity_world;  // [m/s^2]
  // persistent contact; absent where the scene does not ask for it
  std::optional<scene::ContactSpec> contact;
  std::optional<scene::StabilisationSpec> stabilisation;
  // in which rods and joints are integrated
  scene::Coordinates coordinates = scene::Coordinates::kMaximal;
  // (i, j), i < j, sorted: pairs that do not collide; joined bodies are among them
  std::vector<std::pair<int, int>> apart;
};

/// Whether an immovable body with this law of its own ever moves.
bool is_driven(const scene::PrescribedMotion& motion);
/// Place of an immovable body at a time: start + v t + A sin(w t). [m]
Vector3d prescribed_position(const WorldBody& body, double time);
/// Its velocity, exact. [m/s]
Vector3d prescribed_velocity(const WorldBody& body, double time);

/// Angular velocity that belongs to a state. World frame. [rad/s]
Vector3d omega_of(const RigidBodyState& state, const Inertia& inertia);
/// Whether a state is made of numbers.
bool is_finite(const RigidBodyState& state);
/// Angular momentum of a body turning at omega_world. [kg m^2/s]
Vector3d angular_momentum_of(const Vector3d& omega_world, const Quaterniond& world_from_body,
                             const Inertia& inertia);

/// Of one movable body. [J]
double kinetic_energy(const RigidBodyState& state, const Inertia& inertia);

}  // namespace tumble
