// Surfaces of the shapes, for drawing and picking. Collision uses the shapes themselves, never
// these triangles.
#include "framework/geometry/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "framework/core/error.h"

namespace tumble {
namespace {

// 1280 faces: the outline departs from the circle by 0.3 % of the radius
constexpr int kSphereSubdivisions = 3;

// An edge's midpoint, projected to the unit sphere; created once for the two faces that share it.
int midpoint(int a, int b, std::map<std::pair<int, int>, int>& known,
             std::vector<Vector3d>& vertices) {
  const std::pair<int, int> edge = std::minmax(a, b);
  const auto [place, is_new] = known.try_emplace(edge, static_cast<int>(vertices.size()));
  if (is_new) vertices.push_back((vertices[edge.first] + vertices[edge.second]).normalized());
  return place->second;
}

TriangleMesh icosahedron() {
  constexpr double g = 1.6180339887498949;  // golden ratio
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vector3d& vertex : mesh.vertices) vertex.normalize();
  return mesh;
}

}  // namespace

TriangleMesh subdivided_sphere(int subdivisions) {
  require(subdivisions >= 0, "subdivided_sphere: subdivisions must not be negative");
  TriangleMesh mesh = icosahedron();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> known;
    std::vector<Face> finer;
    finer.reserve(4 * mesh.faces.size());
    for (const auto& [a, b, c] : mesh.faces) {
      const int ab = midpoint(a, b, known, mesh.vertices);
      const int bc = midpoint(b, c, known, mesh.vertices);
      const int ca = midpoint(c, a, known, mesh.vertices);
      finer.insert(finer.end(),
                   {Face{a, ab, ca}, Face{b, bc, ab}, Face{c, ca, bc}, Face{ab, bc, ca}});
    }
    mesh.faces = std::move(finer);
  }
  return mesh;
}

namespace {

TriangleMesh surface(const Sphere& sphere, double) {
  if (sphere.radius <= 0.0) return {};  // a point has no surface
  TriangleMesh mesh = subdivided_sphere(kSphereSubdivisions);
  for (Vector3d& vertex : mesh.vertices) vertex *= sphere.radius;
  return mesh;
}

TriangleMesh surface(const Box& box, double) {
  TriangleMesh mesh;
  // Vertex i has the signs of i's three bits: x from bit 0, y from bit 1, z from bit 2.
  for (int i = 0; i < 8; ++i) {
    const Vector3d signs((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
    mesh.vertices.push_back(signs.cwiseProduct(box.half_extents_body));
  }
  mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh surface(const Ellipsoid& ellipsoid, double) {
  TriangleMesh mesh = subdivided_sphere(kSphereSubdivisions);
  for (Vector3d& vertex : mesh.vertices)
    vertex = ellipsoid.center_body + ellipsoid.semi_axes_body.cwiseProduct(vertex);
  return mesh;
}

TriangleMesh surface(const HalfSpace&, double extent) {
  return {{{-extent, -extent, 0}, {extent, -extent, 0}, {extent, extent, 0}, {-extent, extent, 0}},
          {{0, 1, 2}, {0, 2, 3}}};
}

TriangleMesh surface(const MeshSolid& solid, double) { return solid.mesh_body; }

double radius(const Sphere& sphere) { return sphere.radius; }
double radius(const Box& box) { return box.half_extents_body.norm(); }
// Exact where the centre lies on the longest axis or at the origin.
double radius(const Ellipsoid& ellipsoid) {
  return ellipsoid.center_body.norm() + ellipsoid.semi_axes_body.maxCoeff();
}
double radius(const HalfSpace&) { return std::numeric_limits<double>::infinity(); }
double radius(const MeshSolid& solid) {
  double largest_squared = 0.0;
  for (const Vector3d& vertex : solid.mesh_body.vertices)
    largest_squared = std::max(largest_squared, vertex.squaredNorm());
  return std::sqrt(largest_squared);
}

}  // namespace

TriangleMesh surface_of(const Shape& shape, double extent) {
  require(extent > 0.0, "surface_of: extent must be positive");
  return std::visit([extent](const auto& one) { return surface(one, extent); }, shape);
}

double bounding_radius(const Shape& shape) {
  return std::visit([](const auto& one) { return radius(one); }, shape);
}

}  // namespace tumble
