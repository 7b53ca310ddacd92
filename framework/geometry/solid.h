/// From a surface to a body's shape: checked to be closed, moved to its centre of mass, with its
/// mass properties.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/geometry/shape.h"

namespace tumble {

/// A closed surface as a shape, with the mass properties that a body needs.
struct SolidModel {
  // body frame: origin at the centre of mass, axes of the mesh
  MeshSolid solid;
  Vector3d com_mesh{kUnset, kUnset, kUnset};  // (3), body origin in the mesh frame [m]
  double volume = kUnset;                     // [m^3]; mass = density * volume
  // (3, 3), about the centre of mass [m^5]; times density [kg m^2]
  Matrix3d inertia_per_density_body = Matrix3d::Constant(kUnset);
  std::vector<std::string> notices;  // repairs
};

/// The solid that a surface bounds.
/// @param mesh   mesh frame [m]
/// @param where  file and object, for errors
/// @throws UserError with every defect and its place when the surface is not closed
SolidModel solid_from_mesh(const TriangleMesh& mesh, const std::string& where);

/// One object of a .3ds file as a solid.
/// @param object           its name in the file; empty: the file must hold exactly one
/// @param metres_per_unit  length of the file's unit [m], > 0
/// @throws UserError when the file cannot be read, the object does not exist, or it is not closed
SolidModel load_solid(const std::filesystem::path& path, const std::string& object = "",
                      double metres_per_unit = 1.0);

/// Whether a closed surface bounds a convex solid: no vertex lies above a face's plane by more than
/// the rounding of float32 coordinates explains (see the .cpp).
bool is_convex(const TriangleMesh& closed_mesh);

}  // namespace tumble
