#include "framework/collision/polytope.h"

#include <algorithm>
#include <limits>

namespace tumble::collision {

void Polytope::prepare() {
  const int n = static_cast<int>(vertices.size());
  columns.clear();
  for (int i = 0; i < n || columns.size() % 2 != 0; i += 2) {
    const Vector3d &v = vertices[std::min(i, n - 1)], &w = vertices[std::min(i + 1, n - 1)];
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
  const Lanes x = {direction.x(), direction.x()}, y = {direction.y(), direction.y()},
              z = {direction.z(), direction.z()};
  const auto heights = [&](const Columns& c) { return c[0] * x + c[1] * y + c[2] * z; };
  // First the lowest height, then its index: four vertices at a time, with no data dependence
  // between iterations.
  constexpr std::size_t kMost = 64;
  const std::size_t n = columns.size();
  if (n > kMost) return lowest_of_many(direction, height);
  Lanes kept[kMost];
  kept[0] = heights(columns[0]);
  kept[1] = heights(columns[1]);
  Lanes even = kept[0], odd = kept[1];
  for (std::size_t k = 2; k < n; k += 2) {
    kept[k] = heights(columns[k]);
    kept[k + 1] = heights(columns[k + 1]);
    even = kept[k] < even ? kept[k] : even;
    odd = kept[k + 1] < odd ? kept[k + 1] : odd;
  }
  even = odd < even ? odd : even;
  height = even[1] < even[0] ? even[1] : even[0];
  for (std::size_t k = 0; k < n; ++k) {
    if (kept[k][0] == height) return static_cast<int>(2 * k);
    if (kept[k][1] == height) return static_cast<int>(2 * k + 1);
  }
  return 0;  // all heights are NaN
}

int Polytope::lowest_of_many(const Vector3d& direction, double& height) const {
  int best = 0;
  height = direction.dot(vertices[0]);
  for (int i = 1; i < static_cast<int>(vertices.size()); ++i)
    if (const double h = direction.dot(vertices[i]); h < height) {
      height = h;
      best = i;
    }
  return best;
}

double separation_along(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n) {
  return a.lowest_height(n) + b.lowest_height(-n);
}

}  // namespace tumble::collision
