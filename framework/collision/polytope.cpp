#include "framework/collision/polytope.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace tumble::collision {

void Polytope::prepare() {
  const int n = static_cast<int>(vertices.size());
  columns.clear();
  for (int i = 0; i < n; i += kLanes)
    for (int axis = 0; axis < 3; ++axis)
      for (int k = i; k < i + kLanes; ++k) columns.push_back(vertices[std::min(k, n - 1)][axis]);
  arms.clear();
  for (const Vector3d& v : vertices) arms.push_back(v.norm());
  face_offsets.clear();
  for (const Vector3d& m : face_normals) {
    double offset = -std::numeric_limits<double>::infinity();
    for (const Vector3d& v : vertices) offset = std::max(offset, m.dot(v));
    face_offsets.push_back(offset);
  }
  face_columns.clear();
  const int faces = static_cast<int>(face_normals.size());
  for (int f = 0; f < faces; f += kLanes)
    for (int row = 0; row < 4; ++row)
      for (int k = f; k < f + kLanes; ++k) {
        const int face = std::min(k, faces - 1);
        face_columns.push_back(row < 3 ? face_normals[face][row] : face_offsets[face]);
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

// Searches of a few vertices or faces by registers of two or of four numbers: both take the same
// products and sums, to the bit. All is inlined: the caller says which machine it is compiled for.
template <class Lanes>
class LaneSearch {
 public:
  [[gnu::always_inline]] static double lowest_height(const double* columns, std::size_t n,
                                                     const Vector3d& direction) {
    Lanes unused[kParts], least[kParts];
    find_heights(columns, direction, least);
    for (std::size_t k = 1; k < n; ++k)
      lower(least, columns + 3 * Polytope::kLanes * k, direction, unused);
    return lowest_of(least);
  }
  // First the lowest height, then its index.
  [[gnu::always_inline]] static int lowest(const double* columns, std::size_t n,
                                           const Vector3d& direction, double& height) {
    Lanes kept[kParts * Polytope::kMostColumns], least[kParts];
    find_heights(columns, direction, least);
    for (int part = 0; part < kParts; ++part) kept[part] = least[part];
    for (std::size_t k = 1; k < n; ++k)
      lower(least, columns + 3 * Polytope::kLanes * k, direction, kept + kParts * k);
    height = lowest_of(least);
    return first_at(kept, kParts * n, height);
  }
  // m . (point + s direction) = offset at a face
  [[gnu::always_inline]] static double entry(const double* columns, std::size_t n,
                                             const Vector3d& direction, const Vector3d& point,
                                             double steep) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    Lanes nearest[kParts];  // against the direction
    for (int part = 0; part < kParts; ++part) nearest[part] = Lanes{} + kNone;
    for (std::size_t k = 0; k < n; ++k) {
      Lanes leans[kParts], heights[kParts];
      const double* column = columns + 4 * Polytope::kLanes * k;
      find_heights(column, direction, leans);
      find_heights(column, point, heights);
      const Lanes* offsets = reinterpret_cast<const Lanes*>(column + 3 * Polytope::kLanes);
      for (int part = 0; part < kParts; ++part) {
        const Lanes back = (heights[part] - offsets[part]) / leans[part];
        const Lanes facing = leans[part] <= -steep ? back : Lanes{} + kNone;
        nearest[part] = facing < nearest[part] ? facing : nearest[part];
      }
    }
    return -lowest_of(nearest);
  }

 private:
  using Bits = decltype(Lanes{} == Lanes{});
  static constexpr int kWidth = sizeof(Lanes) / sizeof(double), kParts = Polytope::kLanes / kWidth;

  // Of the vertices of one column.
  [[gnu::always_inline]] static void find_heights(const double* column, const Vector3d& direction,
                                                  Lanes* heights) {
    const Lanes* c = reinterpret_cast<const Lanes*>(column);
    for (int part = 0; part < kParts; ++part)
      heights[part] = c[part] * direction.x() + c[kParts + part] * direction.y() +
                      c[2 * kParts + part] * direction.z();
  }
  [[gnu::always_inline]] static void lower(Lanes* least, const double* column,
                                           const Vector3d& direction, Lanes* heights) {
    find_heights(column, direction, heights);
    for (int part = 0; part < kParts; ++part)
      least[part] = heights[part] < least[part] ? heights[part] : least[part];
  }
  [[gnu::always_inline]] static double lowest_of(const Lanes* least) {
    double lowest = least[0][0];
    for (int k = 1; k < Polytope::kLanes; ++k)
      if (const double height = least[k / kWidth][k % kWidth]; height < lowest) lowest = height;
    return lowest;
  }
  // The first of the heights that equals `height`: one bit a vertex, set without a branch, because
  // a branch could not be predicted.
  [[gnu::always_inline]] static int first_at(const Lanes* heights, std::size_t n, double height) {
    constexpr std::size_t kMost = 64 / kWidth;  // that one word has bits for
    for (std::size_t from = 0; from < n; from += kMost) {
      constexpr std::int64_t kFirst[] = {1, 2, 4, 8};
      Bits bit, found = {};
      std::memcpy(&bit, kFirst, sizeof bit);
      const std::size_t to = std::min(n, from + kMost);
      for (std::size_t k = from; k < to; ++k, bit <<= kWidth) found |= (heights[k] == height) & bit;
      std::uint64_t any = 0;
      for (int k = 0; k < kWidth; ++k) any |= static_cast<std::uint64_t>(found[k]);
      if (any != 0) return static_cast<int>(kWidth * from) + std::countr_zero(any);
    }
    return 0;  // all heights are NaN
  }
};

static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= 16, "columns are read two numbers at a time");
using Two = double __attribute__((vector_size(16), may_alias));
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

#if defined(__x86_64__)
const bool has_four = __builtin_cpu_supports("avx2");

[[gnu::target("avx2")]] int lowest_by_four(const double* columns, std::size_t n,
                                           const Vector3d& direction, double& height) {
  return LaneSearch<Four>::lowest(columns, n, direction, height);
}
[[gnu::target("avx2")]] double lowest_height_by_four(const double* columns, std::size_t n,
                                                     const Vector3d& direction) {
  return LaneSearch<Four>::lowest_height(columns, n, direction);
}
[[gnu::target("avx2")]] double entry_by_four(const double* columns, std::size_t n,
                                             const Vector3d& direction, const Vector3d& point,
                                             double steep) {
  return LaneSearch<Four>::entry(columns, n, direction, point, steep);
}
#endif

}  // namespace

int Polytope::lowest(const Vector3d& direction, double& height) const {
  const std::size_t n = columns.size() / (3 * kLanes);
  if (n > kMostColumns) return lowest_of_many(direction, height);
#if defined(__x86_64__)
  if (has_four) return lowest_by_four(columns.data(), n, direction, height);
#endif
  return LaneSearch<Two>::lowest(columns.data(), n, direction, height);
}

double Polytope::lowest_height(const Vector3d& direction) const {
  const std::size_t n = columns.size() / (3 * kLanes);
#if defined(__x86_64__)
  if (has_four) return lowest_height_by_four(columns.data(), n, direction);
#endif
  return LaneSearch<Two>::lowest_height(columns.data(), n, direction);
}

double Polytope::entry_along(const Vector3d& direction, const Vector3d& point, double steep) const {
  const std::size_t n = face_columns.size() / (4 * kLanes);
#if defined(__x86_64__)
  if (has_four) return entry_by_four(face_columns.data(), n, direction, point, steep);
#endif
  return LaneSearch<Two>::entry(face_columns.data(), n, direction, point, steep);
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
