#include "framework/geometry/mesh_edges.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

namespace tumble {

std::vector<EdgeUse> edge_uses(const TriangleMesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.faces.size());
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int from = mesh.faces[f][corner];
      const int to = mesh.faces[f][(corner + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), f, corner, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
  });
  return uses;
}

std::string show_point(const Vector3d& point) {
  const Vector3d p = point + Vector3d::Zero();  // -0 becomes 0
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string show_edge(const TriangleMesh& mesh, int from, int to) {
  return show_point(mesh.vertices[from]) + "-" + show_point(mesh.vertices[to]);
}

}  // namespace tumble
