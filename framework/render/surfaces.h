/// Triangle meshes for drawing: corners with normals. Internal to framework/render.
#pragma once

#include "framework/geometry/triangle_mesh.h"
#include "framework/render/drawing.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {

/// Faces at less than the crease angle to each other are shaded as one smooth surface; other edges
/// stay sharp. The normal of a face's corner is the mean over the faces around the vertex within
/// the crease angle of this face, weighted by their angles at the vertex (Thuermer and Wuethrich,
/// Journal of Graphics Tools 3(1), 1998). Faces without area are left out.
Geometry shaded_surface(const TriangleMesh& mesh, double crease_angle_deg = 40.0);

/// Ball of radius 1 about the origin; 20 * 4^level faces.
Geometry unit_ball(int level);
/// Arrow from the origin to (0, 0, 1): shaft of radius 0.04, head of radius 0.11.
Geometry unit_arrow();
/// Tube of radius 1 from the origin to (0, 0, 1), open at its ends: a segment of a path.
Geometry unit_tube();
/// The same with caps and more sides.
Geometry unit_rod();

/// An instance with position, rotation and scale. Points are given from the drawing's origin
/// (Drawing::from_origin), along the world's axes.
/// @param scale  along the local axes
Instance placed(const Vector3d& place, const Eigen::Matrix3d& world_from_local,
                const Vector3d& scale, const Vector3d& color, double opacity = 1.0);
/// An instance with its local z axis from one point to another.
/// @param width  scale across that axis
/// @pre the points differ
Instance laid_between(const Vector3d& from, const Vector3d& to, double width, const Vector3d& color,
                      double opacity = 1.0);

/// Whether a body's surface occludes a point from the eye; the result is arbitrary for degenerate
/// triangles.
/// Source: T. Moeller, B. Trumbore, Journal of Graphics Tools 2(1), 1997.   Cost: O(faces)
bool hides(const TriangleMesh& mesh_body, const BodyPose& pose, const Vector3d& eye_world,
           const Vector3d& point_world);

}  // namespace tumble::render
