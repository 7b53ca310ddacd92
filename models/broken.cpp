// One surface for each way not to be a solid: what `tumble inspect` says of them teaches what a
// solid is.
#include <cmath>
#include <numbers>

#include "models/catalogue.h"
#include "models/surfaces.h"

namespace tumble::models {
namespace {

TriangleMesh cube() { return box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}); }

TriangleMesh single_polygon() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

TriangleMesh terrain() {
  constexpr int kSide = 9;
  TriangleMesh mesh;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      mesh.vertices.push_back({0.25 * x, 0.25 * y, 0.15 * std::sin(1.1 * x) * std::cos(0.8 * y)});
  }
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const int a = y * kSide + x;
      mesh.faces.push_back({a, a + 1, a + kSide + 1});
      mesh.faces.push_back({a, a + kSide + 1, a + kSide});
    }
  }
  return mesh;
}

TriangleMesh without_lid() {
  TriangleMesh mesh = cube();
  std::erase_if(mesh.faces, [&](const Face& face) {
    return mesh.vertices[face[0]].z() > 0 && mesh.vertices[face[1]].z() > 0 &&
           mesh.vertices[face[2]].z() > 0;
  });
  return mesh;
}

/// The lid stands 1 mm above the walls: corners that should be one are two.
TriangleMesh cracked() {
  TriangleMesh mesh = without_lid();
  const int first = static_cast<int>(mesh.vertices.size());
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    mesh.vertices.push_back({x, y, 0.501});
  mesh.faces.push_back({first, first + 1, first + 2});
  mesh.faces.push_back({first, first + 2, first + 3});
  return mesh;
}

TriangleMesh lampshade() {
  constexpr int kSegments = 16;
  TriangleMesh mesh;
  for (const auto& [r, z] : {std::pair{0.5, 0.0}, {0.25, 0.6}}) {
    for (int s = 0; s < kSegments; ++s) {
      const double angle = 2 * std::numbers::pi * s / kSegments;
      mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  for (int s = 0; s < kSegments; ++s) {
    const int next = (s + 1) % kSegments;
    mesh.faces.push_back({s, next, kSegments + next});
    mesh.faces.push_back({s, kSegments + next, kSegments + s});
  }
  return mesh;
}

/// A cube with a fin: the fin's root is an edge of three faces.
TriangleMesh edge_of_three() {
  TriangleMesh mesh = cube();
  mesh.vertices.push_back({1.0, 0.0, 1.0});
  mesh.faces.push_back({5, 7, 8});
  return mesh;
}

TriangleMesh mixed_winding() {
  TriangleMesh mesh = cube();
  for (int f : {2, 3}) std::swap(mesh.faces[f][1], mesh.faces[f][2]);  // the top looks inward
  return mesh;
}

/// A closed pillow without a filling: two sheets in one plane, cut along different diagonals.
TriangleMesh zero_volume() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
          {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
}

TriangleMesh inside_out() {
  TriangleMesh mesh = cube();
  for (Face& face : mesh.faces) std::swap(face[1], face[2]);
  return mesh;
}

}  // namespace

std::vector<Model> broken_catalogue() {
  return {
      {"broken/single_polygon.3ds", {{"polygon", single_polygon()}}},
      {"broken/terrain.3ds", {{"terrain", terrain()}}},
      {"broken/missing_face.3ds", {{"open_box", without_lid()}}},
      {"broken/cracked.3ds", {{"cracked", cracked()}}},
      {"broken/lampshade.3ds", {{"lampshade", lampshade()}}},
      {"broken/edge_of_three_faces.3ds", {{"finned", edge_of_three()}}},
      {"broken/mixed_winding.3ds", {{"mixed", mixed_winding()}}},
      {"broken/zero_volume.3ds", {{"pillow", zero_volume()}}},
      {"broken/no_faces.3ds", {{"points", {cube().vertices, {}}}}},
      // not refused: turned, with a notice
      {"broken/inside_out.3ds", {{"inside_out", inside_out()}}},
  };
}

}  // namespace tumble::models
