#include "framework/render/surfaces.h"

#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/shortest_turn.h"

namespace tumble::render {
namespace {

constexpr double kPi = std::numbers::pi;

Vertex make_vertex(const Vector3d& position, const Vector3d& normal) {
  Vertex vertex;
  for (int i = 0; i < 3; ++i) {
    vertex.position[i] = static_cast<float>(position[i]);
    vertex.normal[i] = static_cast<float>(normal[i]);
  }
  return vertex;
}

void add_triangle(Geometry& geometry, const Vertex& a, const Vertex& b, const Vertex& c) {
  for (const Vertex& corner : {a, b, c}) {
    geometry.indices.push_back(static_cast<std::uint32_t>(geometry.vertices.size()));
    geometry.vertices.push_back(corner);
  }
}

// Unit normal of a face; zero for a face without area.
Vector3d normal_of(const TriangleMesh& mesh, const Face& face) {
  const Vector3d& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).stableNormalized();
}

double angle_at(const TriangleMesh& mesh, const Face& face, int corner) {
  const Vector3d& here = mesh.vertices[face[corner]];
  const Vector3d a = mesh.vertices[face[(corner + 1) % 3]] - here,
                 b = mesh.vertices[face[(corner + 2) % 3]] - here;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The lateral surface of a cone around the z axis, from radius r0 at z0 to r1 at z1.
void add_cone(Geometry& geometry, double r0, double z0, double r1, double z1, int sides) {
  const Vector3d slope(z1 - z0, 0, r0 - r1);
  for (int i = 0; i < sides; ++i) {
    Vertex ring[2][2];
    for (int k = 0; k < 2; ++k) {
      const double angle = 2 * kPi * (i + k) / sides;
      const Vector3d out(std::cos(angle), std::sin(angle), 0);
      const Vector3d normal = (slope.x() * out + Vector3d(0, 0, slope.z())).stableNormalized();
      ring[0][k] = make_vertex(r0 * out + Vector3d(0, 0, z0), normal);
      ring[1][k] = make_vertex(r1 * out + Vector3d(0, 0, z1), normal);
    }
    add_triangle(geometry, ring[0][0], ring[0][1], ring[1][1]);
    add_triangle(geometry, ring[0][0], ring[1][1], ring[1][0]);
  }
}

}  // namespace

Geometry shaded_surface(const TriangleMesh& mesh, double crease_angle_deg) {
  const double cos_crease = std::cos(crease_angle_deg * kPi / 180.0);
  std::vector<Vector3d> normals;
  // (face, corner) by vertex
  std::vector<std::vector<std::pair<int, int>>> around(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    normals.push_back(normal_of(mesh, mesh.faces[f]));
    for (int corner = 0; corner < 3; ++corner)
      around[mesh.faces[f][corner]].emplace_back(static_cast<int>(f), corner);
  }
  Geometry geometry;
  // equal corners share a vertex, which is processed once
  std::map<std::array<float, 6>, std::uint32_t> known;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (normals[f].isZero(0.5)) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = mesh.faces[f][corner];
      Vector3d sum = Vector3d::Zero();
      for (const auto& [other, place] : around[vertex])
        if (normals[other].dot(normals[f]) >= cos_crease)
          sum += angle_at(mesh, mesh.faces[other], place) * normals[other];
      const Vertex made = make_vertex(mesh.vertices[vertex], sum.stableNormalized());
      const auto [place, is_new] =
          known.try_emplace(std::bit_cast<std::array<float, 6>>(made),
                            static_cast<std::uint32_t>(geometry.vertices.size()));
      if (is_new) geometry.vertices.push_back(made);
      geometry.indices.push_back(place->second);
    }
  }
  return geometry;
}

Geometry unit_ball(int level) {
  // From an icosahedron, whose faces stay of similar size; rings of longitude and latitude would
  // crowd at the poles.
  constexpr double g = std::numbers::phi;
  std::vector<Vector3d> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                  {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                  {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (Vector3d& point : points) point.normalize();
  std::vector<Face> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                             {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                             {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                             {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int i = 0; i < level; ++i) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (is_new) points.push_back((points[a] + points[b]).normalized());
      return place->second;
    };
    std::vector<Face> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(),
                   {Face{a, ab, ca}, Face{b, bc, ab}, Face{c, ca, bc}, Face{ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  Geometry geometry;
  for (const Vector3d& point : points) geometry.vertices.push_back(make_vertex(point, point));
  for (const Face& face : faces)
    for (const int corner : face) geometry.indices.push_back(static_cast<std::uint32_t>(corner));
  return geometry;
}

Geometry unit_arrow() {
  constexpr int kSides = 16;
  constexpr double kShaft = 0.04, kHead = 0.11, kNeck = 0.72;
  Geometry arrow;
  add_cone(arrow, 0.0, 0.0, kShaft, 0.0, kSides);
  add_cone(arrow, kShaft, 0.0, kShaft, kNeck, kSides);
  add_cone(arrow, kShaft, kNeck, kHead, kNeck, kSides);
  add_cone(arrow, kHead, kNeck, 0.0, 1.0, kSides);
  return arrow;
}

Geometry unit_tube() {
  Geometry tube;
  add_cone(tube, 1.0, 0.0, 1.0, 1.0, 6);
  return tube;
}

Geometry unit_rod() {
  constexpr int kSides = 12;
  Geometry rod;
  add_cone(rod, 0.0, 0.0, 1.0, 0.0, kSides);
  add_cone(rod, 1.0, 0.0, 1.0, 1.0, kSides);
  add_cone(rod, 1.0, 1.0, 0.0, 1.0, kSides);
  return rod;
}

Instance placed(const Vector3d& place, const Eigen::Matrix3d& world_from_local,
                const Vector3d& scale, const Vector3d& color, double opacity) {
  Instance instance{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      instance.world_from_local[4 * row + column] =
          static_cast<float>(world_from_local(row, column) * scale[column]);
    instance.world_from_local[4 * row + 3] = static_cast<float>(place[row]);
    instance.color[row] = static_cast<float>(color[row]);
  }
  instance.color[3] = static_cast<float>(opacity);
  return instance;
}

Instance laid_between(const Vector3d& from, const Vector3d& to, double width, const Vector3d& color,
                      double opacity) {
  const Vector3d along = to - from;
  require(along.norm() > 0.0, "laid_between: the two points coincide");
  const Eigen::Matrix3d turned = shortest_turn(Vector3d::UnitZ(), along).toRotationMatrix();
  return placed(from, turned, {width, width, along.norm()}, color, opacity);
}

bool hides(const TriangleMesh& mesh_body, const BodyPose& pose, const Vector3d& eye_world,
           const Vector3d& point_world) {
  const Quaterniond body_from_world = pose.world_from_body.conjugate();
  const Vector3d from = body_from_world * (eye_world - pose.com_world),
                 along = body_from_world * (point_world - eye_world);
  for (const auto& [i, j, k] : mesh_body.faces) {
    const Vector3d& a = mesh_body.vertices[i];
    const Vector3d ab = mesh_body.vertices[j] - a, ac = mesh_body.vertices[k] - a,
                   p = along.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0.0) continue;
    const Vector3d s = from - a, q = s.cross(ab);
    const double u = s.dot(p) / determinant, v = along.dot(q) / determinant,
                 t = ac.dot(q) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1) return true;
  }
  return false;
}

}  // namespace tumble::render
