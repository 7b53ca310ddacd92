#include "framework/geometry/crossings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/geometry/mass_properties.h"
#include "framework/geometry/mesh_edges.h"
#include "framework/geometry/parts.h"

namespace tumble {
namespace {

constexpr int kCrossingLeaf = 4;
// Spacing of float32 coordinates relative to the largest, with a factor 2 for a transform after
// rounding (as in solid.cpp).
constexpr double kCrossingRounding = 0x1.0p-22;
// Planes whose normals differ by less [rad] have a common line that is lost in rounding.
constexpr double kParallel = 1e-6;
// roundings: distance from a face at which the winding number is evaluated
constexpr double kAside = 16.0;
// pairs of parts: a tree of a thousand leaves needs no thousand messages
constexpr std::size_t kMostNamed = 3;
// pairs of faces, 2 s; a bundle of needles through one place would take hours
constexpr std::size_t kMostFacePairs = 20'000'000;
// solid angles, about 5 s; further parts that lie on each other are not tested
constexpr double kMostCrossingAngles = 5e7;

struct Interval {
  double low, high;
};

/// A face with its plane.
struct Plate {
  Vector3d corners[3];
  Vector3d normal;  // unit
  bool has_plane;   // false for a sliver

  Plate(const TriangleMesh& mesh, const Face& face, double tolerance) {
    for (int i = 0; i < 3; ++i) corners[i] = mesh.vertices[face[i]];
    const Vector3d u = corners[1] - corners[0], v = corners[2] - corners[0], area = u.cross(v);
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
    has_plane = area.norm() > tolerance * longest;  // height above the longest edge
    normal = has_plane ? Vector3d(area.normalized()) : Vector3d::Zero();
  }

  /// Heights of the other's corners above this plane; nothing unless they lie on both sides of it
  /// by more than the tolerance.
  std::optional<Vector3d> cut(const Plate& other, double tolerance) const {
    const Vector3d heights(normal.dot(other.corners[0] - corners[0]),
                           normal.dot(other.corners[1] - corners[0]),
                           normal.dot(other.corners[2] - corners[0]));
    if (heights.maxCoeff() <= tolerance || heights.minCoeff() >= -tolerance) return std::nullopt;
    return heights;
  }

  /// The interval, along a direction, in which a plane cuts this face; the corners have these
  /// heights above the plane.
  Interval along(const Vector3d& direction, const Vector3d& heights) const {
    Interval interval{std::numeric_limits<double>::infinity(),
                      -std::numeric_limits<double>::infinity()};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if ((heights[i] < 0) == (heights[j] < 0)) continue;
      const double part = heights[i] / (heights[i] - heights[j]);
      const double at = direction.dot(corners[i] + part * (corners[j] - corners[i]));
      interval = {std::min(interval.low, at), std::max(interval.high, at)};
    }
    return interval;
  }
};

/// A point on the line along which two faces pass through each other; nothing where they are apart
/// or only touch.
std::optional<Vector3d> crossing_point(const Plate& a, const Plate& b, double tolerance) {
  if (!a.has_plane || !b.has_plane) return std::nullopt;
  const auto of_b = a.cut(b, tolerance);
  if (!of_b) return std::nullopt;
  const auto of_a = b.cut(a, tolerance);
  if (!of_a) return std::nullopt;
  const Vector3d across = a.normal.cross(b.normal);
  const double sine = across.norm();
  if (!(sine > kParallel)) return std::nullopt;
  const Vector3d direction = across / sine;
  const Interval in_a = a.along(direction, *of_a), in_b = b.along(direction, *of_b);
  const double low = std::max(in_a.low, in_b.low), high = std::min(in_a.high, in_b.high);
  // each of the four ends has an error of tolerance / sine
  if (!(high - low > 4.0 * tolerance / sine)) return std::nullopt;
  // The point of the common line that is nearest to a's corner, then moved along the line.
  const Vector3d down = a.normal.cross(direction);
  const Vector3d on_line =
      a.corners[0] + down * (b.normal.dot(b.corners[0] - a.corners[0]) / b.normal.dot(down));
  return on_line + direction * (0.5 * (low + high) - direction.dot(on_line));
}

struct Crossing {
  int face_a, face_b;
  Vector3d point;
};
using PairOfParts = std::pair<int, int>;  // first <= second

/// A tree of bounding boxes over the faces, traversed against itself.
class CrossingSearch {
 public:
  CrossingSearch(const TriangleMesh& mesh, const std::vector<int>& part_of_face)
      : mesh_(mesh), part_of_face_(part_of_face) {
    const Bounds bounds = bounds_of(mesh);
    tolerance_ = kCrossingRounding *
                 std::max(bounds.low.cwiseAbs().maxCoeff(), bounds.high.cwiseAbs().maxCoeff());
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
      order_.push_back(f);
      plates_.emplace_back(mesh, mesh.faces[f], tolerance_);
    }
    build(0, static_cast<int>(order_.size()));
    search();
  }

  /// By pair of parts: the crossing with the lowest face indices.
  const std::map<PairOfParts, Crossing>& crossings() const { return crossings_; }
  /// Distance between faces that rounding of coordinates can cause. [m]
  double tolerance() const { return tolerance_; }
  /// Whether all faces that may cross were compared.
  bool is_complete() const { return compared_ < kMostFacePairs; }
  /// Pairs of different parts with faces whose boxes overlap.
  const std::map<PairOfParts, bool>& close() const { return close_; }

 private:
  struct Node {
    Vector3d low, high;
    int first, count, right = -1;  // the left child is the next node; right is -1 for a leaf
  };

  int build(int first, int count) {
    const int index = static_cast<int>(nodes_.size());
    Node node{plate(first).corners[0], plate(first).corners[0], first, count};
    for (int k = first; k < first + count; ++k)
      for (const Vector3d& corner : plate(k).corners) {
        node.low = node.low.cwiseMin(corner);
        node.high = node.high.cwiseMax(corner);
      }
    nodes_.push_back(node);
    if (count <= kCrossingLeaf) return index;
    Eigen::Index axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const auto middle = [&](int face) {
      const Plate& p = plates_[face];
      return p.corners[0][axis] + p.corners[1][axis] + p.corners[2][axis];
    };
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count, [&](int f, int g) {
      return std::pair(middle(f), f) < std::pair(middle(g), g);
    });
    build(first, count / 2);
    const int right = build(first + count / 2, count - count / 2);
    nodes_[index].right = right;
    return index;
  }

  void search() {
    std::vector<std::pair<int, int>> to_do{{0, 0}};
    while (!to_do.empty() && compared_ < kMostFacePairs) {
      const auto [i, j] = to_do.back();
      to_do.pop_back();
      const Node &a = nodes_[i], &b = nodes_[j];
      if (i != j && ((a.low.array() > b.high.array() + tolerance_).any() ||
                     (b.low.array() > a.high.array() + tolerance_).any()))
        continue;
      if (a.right < 0 && b.right < 0) {
        compare(a, b, i == j);
      } else if (i == j) {
        to_do.insert(to_do.end(), {{i + 1, i + 1}, {a.right, a.right}, {i + 1, a.right}});
      } else if (b.right < 0 || (a.right >= 0 && a.count >= b.count)) {
        to_do.insert(to_do.end(), {{i + 1, j}, {a.right, j}});
      } else {
        to_do.insert(to_do.end(), {{i, j + 1}, {i, b.right}});
      }
    }
  }

  void compare(const Node& a, const Node& b, bool is_same) {
    for (int k = a.first; k < a.first + a.count; ++k)
      for (int l = is_same ? k + 1 : b.first; l < b.first + b.count; ++l) {
        const auto [f, g] = std::minmax(order_[k], order_[l]);
        test_pair(f, g);
      }
  }

  void test_pair(int f, int g) {
    ++compared_;
    const PairOfParts parts = std::minmax(part_of_face_[f], part_of_face_[g]);
    if (parts.first != parts.second) close_[parts] = true;
    const auto known = crossings_.find(parts);
    if (known != crossings_.end() &&
        std::pair(known->second.face_a, known->second.face_b) < std::pair(f, g))
      return;
    if (share_an_edge(f, g)) return;
    if (const auto point = crossing_point(plates_[f], plates_[g], tolerance_))
      crossings_.insert_or_assign(parts, Crossing{f, g, *point});
  }

  bool share_an_edge(int f, int g) const {
    int shared = 0;
    for (const int v : mesh_.faces[f])
      for (const int w : mesh_.faces[g]) shared += v == w ? 1 : 0;
    return shared >= 2;
  }

  const Plate& plate(int k) const { return plates_[order_[k]]; }

  const TriangleMesh& mesh_;
  const std::vector<int>& part_of_face_;
  double tolerance_ = 0.0;
  std::size_t compared_ = 0;   // pairs of faces
  std::vector<Plate> plates_;  // by face
  std::vector<int> order_;
  std::vector<Node> nodes_;
  std::map<PairOfParts, Crossing> crossings_;
  std::map<PairOfParts, bool> close_;
};

TriangleMesh faces_of(int part, const TriangleMesh& mesh, const std::vector<int>& part_of_face) {
  TriangleMesh result{mesh.vertices, {}};
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (part_of_face[f] == part) result.faces.push_back(mesh.faces[f]);
  return result;
}

Bounds bounds_of_faces(const TriangleMesh& mesh) {
  Bounds bounds{mesh.vertices[mesh.faces[0][0]], mesh.vertices[mesh.faces[0][0]]};
  for (const Face& face : mesh.faces)
    for (const int v : face) {
      bounds.low = bounds.low.cwiseMin(mesh.vertices[v]);
      bounds.high = bounds.high.cwiseMax(mesh.vertices[v]);
    }
  return bounds;
}

/// Whether some faces of one part lie inside the other and some outside; if so, the centroid of one
/// that lies inside. Points a little in front of a face and behind it are tested: a face on the
/// other's surface has one of them inside and one outside, and decides nothing.
/// @param step  distance of these points from the face, above rounding [m]
std::optional<Vector3d> half_inside(const TriangleMesh& inner, const TriangleMesh& outer,
                                    double step) {
  const Bounds box = bounds_of_faces(outer);
  const auto is_inside = [&](const Vector3d& point) {
    const bool is_in_box =
        (point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all();
    return is_in_box && std::abs(winding_number(outer, point)) > 0.5;
  };
  std::optional<Vector3d> inside;
  bool any_outside = false;
  for (const Face& face : inner.faces) {
    const Vector3d &a = inner.vertices[face[0]], &b = inner.vertices[face[1]],
                   &c = inner.vertices[face[2]];
    const Vector3d middle = (a + b + c) / 3.0, aside = step * (b - a).cross(c - a).normalized();
    const bool before = is_inside(middle + aside), behind = is_inside(middle - aside);
    if (before && behind) inside = inside.value_or(middle);
    if (!before && !behind) any_outside = true;
    if (inside && any_outside) return inside;
  }
  return std::nullopt;
}

std::string name_of(int part, const TriangleMesh& mesh, const std::vector<int>& part_of_face) {
  const TriangleMesh faces = faces_of(part, mesh, part_of_face);
  const Bounds bounds = bounds_of_faces(faces);
  return fmt::format("the part of {} faces about {}", faces.faces.size(),
                     show_point(0.5 * (bounds.low + bounds.high)));
}

}  // namespace

std::vector<Defect> find_crossings(const TriangleMesh& mesh, const std::vector<int>& part_of_face,
                                   std::vector<std::string>& notices) {
  const CrossingSearch search(mesh, part_of_face);
  bool is_complete = search.is_complete();
  std::vector<std::pair<PairOfParts, std::string>> found;
  for (const auto& [parts, crossing] : search.crossings())
    found.emplace_back(parts, fmt::format("faces {} and {} at {}", crossing.face_a, crossing.face_b,
                                          show_point(crossing.point)));

  // Shells with faces that only lie on each other.
  double work = 0.0;
  for (const auto& [parts, is_close] : search.close()) {
    if (search.crossings().contains(parts)) continue;
    const TriangleMesh a = faces_of(parts.first, mesh, part_of_face),
                       b = faces_of(parts.second, mesh, part_of_face);
    work += 2.0 * static_cast<double>(a.faces.size()) * static_cast<double>(b.faces.size());
    if (work > kMostCrossingAngles) {
      is_complete = false;
      break;
    }
    auto inside = half_inside(a, b, kAside * search.tolerance());
    if (!inside) inside = half_inside(b, a, kAside * search.tolerance());
    if (inside)
      found.emplace_back(
          parts, fmt::format("one has a face about {} inside the other", show_point(*inside)));
  }

  if (!is_complete && found.empty())
    notices.push_back("too many faces overlap: not all of them were tested for crossings");
  std::vector<Defect> defects;
  for (const auto& [parts, place] : found) {
    if (defects.size() == kMostNamed) {
      defects.back().problem +=
          fmt::format("; and {} more crossings like it", found.size() - kMostNamed);
      break;
    }
    if (parts.first == parts.second)
      defects.push_back(
          {DefectKind::kSelfCrossing,
           fmt::format(
               "{} passes through itself, first {}: the volume would not be that of a solid",
               name_of(parts.first, mesh, part_of_face), place),
           "Separate the crossing faces in the modelling program, or unite what they bound (a "
           "boolean union)."});
    else
      defects.push_back(
          {DefectKind::kSelfCrossing,
           fmt::format("two shells pass through each other: {} and {}, first {}: what lies in both "
                       "would count twice",
                       name_of(parts.first, mesh, part_of_face),
                       name_of(parts.second, mesh, part_of_face), place),
           "Unite the two in the modelling program (a boolean union), or move them apart."});
  }
  return defects;
}

}  // namespace tumble
