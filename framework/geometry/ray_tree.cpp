#include "framework/geometry/ray_tree.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/numbers.h"

namespace tumble {
namespace {

constexpr int kLeafFaces = 4;
// Roundings between a corner and its sheared coordinates (a difference, a product, a difference)
// and in the slab test (a difference, a quotient), each at most eps times the distance: 5, doubled
// for the three axes together and rounded up.
constexpr double kBoxRounding = 16 * kEpsilon;

}  // namespace

// The ray's frame: its origin at 0, its direction (0, 0, 1). The transform is a shear, not a
// rotation.
struct RayTree::Shear {
  Shear(const Vector3d& origin_in, const Vector3d& direction_in)
      : origin(origin_in), direction(direction_in) {
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    z = static_cast<int>(largest);
    x = (z + 1) % 3;
    y = (x + 1) % 3;
    slope_x = direction[x] / direction[z];
    slope_y = direction[y] / direction[z];
  }

  /// x, y: position of the corner beside the ray; z: position along it [lengths of the direction]
  Vector3d operator()(const Vector3d& corner) const {
    const Vector3d from_origin = corner - origin;
    return {from_origin[x] - slope_x * from_origin[z], from_origin[y] - slope_y * from_origin[z],
            from_origin[z] / direction[z]};
  }

  /// Smallest t at which the ray is in the widened box; infinity where it misses the box.
  double entry(const Vector3d& low, const Vector3d& high, double margin, double t_most) const {
    double enter = 0.0, leave = t_most;
    for (int i = 0; i < 3; ++i) {
      double near = (low[i] - margin - origin[i]) / direction[i];
      double far = (high[i] + margin - origin[i]) / direction[i];
      if (direction[i] < 0.0) std::swap(near, far);
      // A ray in the plane of a slab (0 / 0) is not limited by it: comparisons with NaN are false
      // and leave the interval unchanged.
      if (near > enter) enter = near;
      if (far < leave) leave = far;
    }
    return enter <= leave * (1.0 + 4.0 * kEpsilon) ? enter
                                                   : std::numeric_limits<double>::infinity();
  }

  Vector3d origin, direction;
  int x, y, z;
  double slope_x, slope_y;
};

RayTree::RayTree(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  require(!mesh_.faces.empty(), "RayTree: the surface has no faces");
  const int n = static_cast<int>(mesh_.vertices.size());
  std::vector<Vector3d> middles;
  for (const auto& [a, b, c] : mesh_.faces) {
    require(std::min({a, b, c}) >= 0 && std::max({a, b, c}) < n,
            "RayTree: a face refers to a vertex that does not exist");
    middles.push_back((mesh_.vertices[a] + mesh_.vertices[b] + mesh_.vertices[c]) / 3.0);
    require(middles.back().allFinite(), "RayTree: a vertex is not finite");
  }
  for (int f = 0; f < static_cast<int>(mesh_.faces.size()); ++f) faces_.push_back(f);
  build(0, static_cast<int>(faces_.size()), middles);
}

// Splits the faces at the median of their centroids, along the axis of largest extent.
int RayTree::build(int first, int count, const std::vector<Vector3d>& middles) {
  const int index = static_cast<int>(nodes_.size());
  const auto begin = faces_.begin() + first, end = begin + count;
  Node node{mesh_.vertices[mesh_.faces[*begin][0]], mesh_.vertices[mesh_.faces[*begin][0]]};
  Vector3d low = middles[*begin], high = low;
  for (auto f = begin; f != end; ++f) {
    for (int v : mesh_.faces[*f]) {
      node.low = node.low.cwiseMin(mesh_.vertices[v]);
      node.high = node.high.cwiseMax(mesh_.vertices[v]);
    }
    low = low.cwiseMin(middles[*f]);
    high = high.cwiseMax(middles[*f]);
  }
  node.first = first;
  node.count = count <= kLeafFaces ? count : 0;
  nodes_.push_back(node);
  if (node.count > 0) return index;

  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(begin, begin + half, end, [&](int f, int g) {
    return std::pair(middles[f][axis], f) < std::pair(middles[g][axis], g);
  });
  build(first, half, middles);
  const int right = build(first + half, count - half, middles);
  nodes_[index].right = right;
  return index;
}

void RayTree::try_face(int face, const Shear& shear, double t_most,
                       std::optional<SurfaceHit>& best) const {
  const Vector3d a = shear(mesh_.vertices[mesh_.faces[face][0]]);
  const Vector3d b = shear(mesh_.vertices[mesh_.faces[face][1]]);
  const Vector3d c = shear(mesh_.vertices[mesh_.faces[face][2]]);

  // Twice the signed areas between the ray and each edge; the neighbour's value for the same edge
  // is exactly the negative.
  const double u = c.x() * b.y() - c.y() * b.x();
  const double v = a.x() * c.y() - a.y() * c.x();
  const double w = b.x() * a.y() - b.y() * a.x();
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return;
  const double whole = u + v + w;
  if (whole == 0.0) return;  // edge-on, or without area

  const Vector3d weights = Vector3d(u, v, w) / whole;
  // Clamped to the range of the corners, against rounding of the weights.
  const double t = std::clamp(weights.dot(Vector3d(a.z(), b.z(), c.z())),
                              std::min({a.z(), b.z(), c.z()}), std::max({a.z(), b.z(), c.z()}));
  if (!(t >= 0.0) || t > t_most) return;
  if (best && (t > best->t || (t == best->t && face > best->face))) return;
  best = SurfaceHit{face, t, weights};
}

std::optional<SurfaceHit> RayTree::nearest(const Vector3d& origin, const Vector3d& direction,
                                           double t_most) const {
  require(origin.allFinite() && direction.allFinite() && !direction.isZero(0.0),
          "RayTree::nearest: the ray must be finite, with a direction");
  const Shear shear(origin, direction);
  const Node& root = nodes_.front();
  const double farthest =
      (root.low - origin).cwiseAbs().cwiseMax((root.high - origin).cwiseAbs()).sum();
  const double margin = kBoxRounding * (farthest + origin.cwiseAbs().maxCoeff());

  std::optional<SurfaceHit> best;
  const auto limit = [&] { return best ? best->t : t_most; };
  std::vector<std::pair<double, int>> to_do{{0.0, 0}};  // (entry, node); the nearer child on top
  while (!to_do.empty()) {
    const auto [enter, index] = to_do.back();
    to_do.pop_back();
    if (enter > limit()) continue;
    const Node& node = nodes_[index];
    for (int i = node.first; i < node.first + node.count; ++i)
      try_face(faces_[i], shear, t_most, best);
    if (node.count > 0) continue;
    std::pair<double, int> children[2];
    for (int side = 0; side < 2; ++side) {
      const int child = side == 0 ? index + 1 : node.right;
      children[side] = {shear.entry(nodes_[child].low, nodes_[child].high, margin, limit()), child};
    }
    if (children[0].first < children[1].first) std::swap(children[0], children[1]);
    for (const auto& child : children) {
      if (std::isfinite(child.first)) to_do.push_back(child);
    }
  }
  return best;
}

}  // namespace tumble
