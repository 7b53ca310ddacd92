/// Triangle meshes as drawn: corners with normals. Internal to framework/render.
#pragma once

#include "framework/geometry/triangle_mesh.h"
#include "framework/render/drawing.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {

/// Faces that meet at less than the crease angle are shaded as one smooth surface, others keep their edge.
/// A corner's normal is the mean, weighted by the faces' angles at the vertex (Thuermer and Wuethrich, Journal of Graphics
/// Tools 3(1), 1998), over the faces around it that lie within the crease angle of its own. Faces without area are left out.
Geometry shaded_surface(const TriangleMesh& mesh, double crease_angle_deg = 40.0);

/// Ball of radius 1 about the origin; 20 * 4^level faces.
Geometry unit_ball(int level);
/// Arrow from the origin to (0, 0, 1), for scaling: its shaft has radius 0.04, its head 0.11.
Geometry unit_arrow();
/// Tube of radius 1 from the origin to (0, 0, 1), open at its ends: a segment of a path.
Geometry unit_tube();
/// The same with caps, and rounder.
Geometry unit_rod();

/// Local frame placed, turned and scaled. @param scale  along the local axes
Instance placed(const Vector3d& origin_world, const Eigen::Matrix3d& world_from_local, const Vector3d& scale, const Vector3d& color,
                double opacity = 1.0);
/// The local z axis laid from one point to another, `width` the scale across it. @pre the points differ
Instance laid_between(const Vector3d& from_world, const Vector3d& to_world, double width, const Vector3d& color, double opacity = 1.0);

/// Whether the segment from the eye to a point passes through a body's surface; degenerate triangles may answer either way.
/// Source: T. Moeller, B. Trumbore, Journal of Graphics Tools 2(1), 1997.   Cost: O(faces)
bool hides(const TriangleMesh& mesh_body, const BodyPose& pose, const Vector3d& eye_world, const Vector3d& point_world);

}  // namespace tumble::render
