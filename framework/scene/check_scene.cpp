#include "framework/scene/check_scene.h"

#include <algorithm>

#include "framework/core/decompositions.h"
#include "framework/scene/anchors.h"
#include "framework/scene/check_checks.h"
#include "framework/scene/check_links.h"
#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

void check_mass(const BodySpec& body, const Refuse& refuse) {
  if (body.immovable) {
    if (body.density_kg_m3)
      refuse("density_kg_m3", "it is immovable and has a density",
             "An immovable body has infinite mass: delete density_kg_m3, or \"immovable\".");
    if (body.mass_kg)
      refuse("mass_kg", "it is immovable and has a mass",
             "An immovable body has infinite mass: delete mass_kg, or \"immovable\".");
    if (body.inertia_body_kg_m2)
      refuse("inertia_body_kg_m2", "it is immovable and has moments of inertia",
             "Delete inertia_body_kg_m2, or \"immovable\".");
    return;
  }
  if (std::holds_alternative<PlaneSpec>(body.shape))
    refuse("shape/plane", "a plane has no end, so it cannot move freely",
           "Add \"immovable\": true, or use a box.");
  if (body.density_kg_m3 && body.mass_kg)
    refuse("mass_kg", "it has both a density and a mass", "Keep the one that you mean.");
  if (!body.density_kg_m3 && !body.mass_kg)
    refuse("", "it has neither density_kg_m3 nor mass_kg",
           "Give one of the two, or \"immovable\": true.");
  if (body.inertia_body_kg_m2 && !body.mass_kg)
    refuse("inertia_body_kg_m2", "moments of inertia of its own need a mass of its own",
           "Give mass_kg instead of density_kg_m3.");
  const auto* sphere = std::get_if<SphereSpec>(&body.shape);
  const auto* ellipsoid = std::get_if<EllipsoidSpec>(&body.shape);
  if (ellipsoid != nullptr && !ellipsoid->center_m.isZero(0) && !body.inertia_body_kg_m2)
    refuse("shape/ellipsoid/center_m",
           "an ellipsoid whose middle is not its centre of mass is not of one density",
           "Give mass_kg and inertia_body_kg_m2, about the centre of mass.");
  if (sphere != nullptr && sphere->radius_m == 0.0 && !body.mass_kg)
    refuse("density_kg_m3", "a point (radius 0) has no volume", "Give mass_kg.");
}

void check_inertia(const Matrix3d& inertia, const Refuse& refuse) {
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > 1e-12 * inertia.cwiseAbs().maxCoeff())
    refuse("inertia_body_kg_m2", "the matrix is not symmetric",
           "An inertia tensor is: check the entries beside the diagonal, whose sign is that of "
           "-sum m x y.");
  const Vector3d moments = symmetric_eigen(inertia).values;  // ascending
  if (!(moments[0] > 0))
    refuse("inertia_body_kg_m2", "a principal moment is not above 0",
           "Every moment of a solid is positive.");
  // Equality is a flat plate; 1e-9 allows for its rounding.
  if (moments[0] + moments[1] < moments[2] * (1 - 1e-9))
    refuse("inertia_body_kg_m2",
           "no solid has these moments: the largest exceeds the sum of the two others",
           "Ixx + Iyy >= Izz must hold, in any order.");
}

}  // namespace

void check_body(const BodySpec& body, const Refuse& refuse) {
  check_mass(body, refuse);
  if (body.inertia_body_kg_m2) check_inertia(*body.inertia_body_kg_m2, refuse);
  if (body.motion && !body.immovable)
    refuse("motion", "a movable body moves by the laws, not by a motion of its own",
           "Add \"immovable\": true, or give velocity_m_s.");
  if (body.motion && !body.motion->amplitude_m.isZero(0) &&
      body.motion->angular_frequency_rad_s == 0.0)
    refuse("motion/amplitude_m", "it swings with an angular frequency of 0: it would stand still",
           "Give angular_frequency_rad_s, or delete amplitude_m.");
  if (body.immovable && !body.velocity_m_s.isZero(0))
    refuse("velocity_m_s", "it is immovable and has a velocity",
           "Give \"motion\": {\"velocity_m_s\": ...} to move it along its own law.");
  if (body.immovable && !body.omega_world_rad_s.isZero(0))
    refuse("angular_velocity_rad_s", "it is immovable and spins",
           "An immovable body does not turn: delete angular_velocity_rad_s.");
  if (body.drawn_as_die && !std::holds_alternative<BoxSpec>(body.shape))
    refuse("drawn_as", "only a box can be drawn as a die", "Give it \"shape\": {\"box\": ...}.");
}

void check_ellipsoids(const Scene& scene, const Refuse& refuse) {
  const auto is_named = [](const auto& pair, const std::string& a, const std::string& b) {
    return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
  };
  std::vector<std::pair<std::string, std::string>> apart = scene.apart;
  for (const Words* words : all_words())
    for (auto& pair : words->pairs_apart(scene)) apart.push_back(std::move(pair));
  for (const BodySpec& body : scene.bodies) {
    if (!body.collides || !std::holds_alternative<EllipsoidSpec>(body.shape)) continue;
    for (const BodySpec& other : scene.bodies) {
      if (&other == &body || !other.collides || std::holds_alternative<PlaneSpec>(other.shape) ||
          (body.immovable && other.immovable))
        continue;
      if (std::any_of(apart.begin(), apart.end(),
                      [&](const auto& pair) { return is_named(pair, body.name, other.name); }))
        continue;
      refuse(body.pointer,
             "body '" + body.name + "' is an ellipsoid and may meet '" + other.name +
                 "', which is no plane: ellipsoids meet planes only",
             "Name the two under \"apart\", give one of them \"collides\": false, or use a convex "
             "model.");
    }
  }
}

namespace {

void check_friction(const Scene& scene, const Refuse& refuse) {
  for (const BodySpec& body : scene.bodies)
    if (body.friction > 0.0 && !scene.contact)
      refuse(body.pointer + "/friction",
             "body '" + body.name +
                 "' has friction, which acts in persistent contact only, and the scene has none",
             "Add \"contact\": {} to the scene, or delete friction.");
}

}  // namespace

void check_scene(const Scene& scene, const Refuse& refuse) {
  if (scene.bodies.empty())
    refuse("/bodies", "the scene has no body", "Add one, here or under \"repeat\".");
  if (scene.step_s > scene.duration_s)
    refuse("/step_s", "the step is longer than the whole run",
           "Give a shorter step_s or a longer duration_s.");
  const Names names = names_of_bodies(scene);
  check_ellipsoids(scene, refuse);
  check_links(scene, refuse);
  for (const Words* words : all_words()) words->check(scene, refuse);
  check_friction(scene, refuse);
  if ((scene.camera.eye_m - scene.camera.target_m).norm() == 0.0)
    refuse("/camera/target_m", "the camera stands where it looks", "Move eye_m or target_m.");
  if (scene.camera.follow) names.expect(*scene.camera.follow, "/camera/follow", refuse);
  check_checks(scene, refuse);
}

}  // namespace tumble::scene
