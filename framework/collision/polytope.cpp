#include "framework/collision/polytope.h"

#include <algorithm>
#include <bit>
#include <cstdint>
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

namespace {

using Lanes = Polytope::Lanes;

// Heights of the vertices of a pair of columns along a direction.
class Heights {
 public:
  explicit Heights(const Vector3d& direction)
      : x_{direction.x(), direction.x()},
        y_{direction.y(), direction.y()},
        z_{direction.z(), direction.z()} {}
  Lanes operator()(const Polytope::Columns& c) const { return c[0] * x_ + c[1] * y_ + c[2] * z_; }

 private:
  Lanes x_, y_, z_;
};

double lower_of(const Lanes& pair) { return pair[1] < pair[0] ? pair[1] : pair[0]; }

// The first of the heights that equals `height`: one bit a vertex, set without a branch, because a
// branch could not be predicted.
int first_at(const Lanes* heights, std::size_t n, double height) {
  using Bits = std::uint64_t __attribute__((vector_size(16)));
  constexpr std::size_t kMost = 32;  // pairs of vertices that one word has bits for
  const Lanes wanted = {height, height};
  for (std::size_t from = 0; from < n; from += kMost) {
    Bits bit = {1, 2}, found = {0, 0};
    const std::size_t to = std::min(n, from + kMost);
    for (std::size_t k = from; k < to; ++k, bit <<= 2)
      found |= reinterpret_cast<Bits>(heights[k] == wanted) & bit;
    if (const std::uint64_t any = found[0] | found[1])
      return static_cast<int>(2 * from) + std::countr_zero(any);
  }
  return 0;  // all heights are NaN
}

}  // namespace

int Polytope::lowest(const Vector3d& direction, double& height) const {
  // First the lowest height, then its index: four vertices at a time, with no data dependence
  // between iterations.
  const Heights heights(direction);
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
  height = lower_of(odd < even ? odd : even);
  return first_at(kept, n, height);
}

double Polytope::lowest_height(const Vector3d& direction) const {
  const Heights heights(direction);
  Lanes even = heights(columns[0]), odd = heights(columns[1]);
  for (std::size_t k = 2; k < columns.size(); k += 2) {
    const Lanes first = heights(columns[k]), second = heights(columns[k + 1]);
    even = first < even ? first : even;
    odd = second < odd ? second : odd;
  }
  return lower_of(odd < even ? odd : even);
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
