#include "framework/collision/polytope.h"

#include <algorithm>
#include <limits>

namespace tumble::collision {

void Polytope::prepare() {
  const int n = static_cast<int>(vertices.size());
  columns.clear();
  for (int i = 0; i < n; i += 2) {
    const Vector3d &v = vertices[i], &w = vertices[std::min(i + 1, n - 1)];
    columns.push_back({Lanes{v.x(), w.x()}, Lanes{v.y(), w.y()}, Lanes{v.z(), w.z()}});
  }
  arms.clear();
  for (const Vector3d& v : vertices) arms.push_back(v.norm());
  face_offsets.clear();
  for (const Vector3d& m : face_normals) {
    double offset = -std::numeric_limits<double>::infinity();
    for (const Vector3d& v : vertices) offset = std::max(offset, m.dot(v));
    face_offsets.push_back(offset);
  }
  first_neighbour.assign(n + 1, 0);
  for (const auto& [i, j] : edges) {
    ++first_neighbour[i + 1];
    ++first_neighbour[j + 1];
  }
  for (int i = 0; i < n; ++i) first_neighbour[i + 1] += first_neighbour[i];
  neighbours.resize(2 * edges.size());
  std::vector<int> next(first_neighbour.begin(), first_neighbour.end() - 1);
  for (const auto& [i, j] : edges) {
    neighbours[next[i]++] = j;
    neighbours[next[j]++] = i;
  }
}

int Polytope::lowest(const Vector3d& direction, double& height) const {
  const Lanes x = {direction.x(), direction.x()}, y = {direction.y(), direction.y()}, z = {direction.z(), direction.z()};
  Lanes best = columns[0][0] * x + columns[0][1] * y + columns[0][2] * z;
  using Places = long long __attribute__((vector_size(16)));
  Places place = {0, 1};
  Places at = place;
  const Places two = {2, 2};
  for (std::size_t k = 1; k < columns.size(); ++k) {
    at += two;
    const Lanes h = columns[k][0] * x + columns[k][1] * y + columns[k][2] * z;
    const Places lower = h < best;
    best = lower ? h : best;
    place = lower ? at : place;
  }
  const int lane = best[1] < best[0] || (best[1] == best[0] && place[1] < place[0]) ? 1 : 0;
  height = best[lane];
  return std::min(static_cast<int>(place[lane]), static_cast<int>(vertices.size()) - 1);
}

double separation_along(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n) {
  return a.lowest_height(n) + b.lowest_height(-n);
}

}  // namespace tumble::collision
