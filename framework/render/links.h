/// Drawing of springs, rods and joints. Internal to framework/render; without OpenGL.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/render/drawing.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {

enum class LinkKind : std::uint8_t { kSpring, kRod, kBallJoint, kHinge };

/// A link at one instant. A ball joint has one point; a hinge lies along its axis, from a to b.
struct Link {
  LinkKind kind;
  Vector3d a_world, b_world;  // [m]
  double width_m;             // radius of the coil, the rod or the ball
  double turned_m;            // length of the coil at which its turns are close together
};

/// Adds the links to a drawing: a spring is a coil (a line where it is less than two pixels wide),
/// a rod a thin cylinder with a small ball at each end, a joint a small ball, a hinge a pin. They
/// are solid and cast shadows.
/// @param height  of the picture [pixels]
void draw_links(const std::vector<Link>& links, int height, Drawing& drawing);

/// The links of a scene in the frames of its run.
class SceneLinks {
 public:
  SceneLinks() = default;
  /// @param sight_m   distance from the eye to its target, which sets the sizes
  /// @param radius_m  by body; links of small bodies are not drawn larger than the bodies
  SceneLinks(const scene::Scene& scene, const Frame& first, double sight_m,
             const std::vector<double>& radius_m);
  /// The links at a frame, without those of bodies whose pose is not finite.
  std::vector<Link> at(const Frame& frame) const;

 private:
  struct Anchor {
    int body = -1;   // -1: the world
    Vector3d point;  // body frame, or world
  };
  struct Placed {
    LinkKind kind;
    Anchor a, b;
    double width_m, turned_m;
  };
  std::vector<Placed> links_;
};

/// A coil of radius 1 about the z axis from the origin to (0, 0, 1), with its ends on the axis; its
/// wire is round at the length at which the turns are kPitch radii apart.
Geometry unit_coil(int turns);

}  // namespace tumble::render
