#include "framework/collision/touching_normal.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Relative to the query's size: pieces closer than this touch. Far above rounding, below the gap
// that persistent contacts keep.
constexpr double kInContact = 1e-12;
// Relative to the query's size: a direction separates two pieces that overlap by less than this
// along it. Models store coordinates in single precision: faces that should lie in one plane, or
// be mirror images, do so to 1e-7.
constexpr double kOfModels = 2e-7;
// rad: normals closer than this are one, for the same reason.
constexpr double kOneNormal = 1e-5;

struct PiecesInTouch {
  int i, j;
  Vector3d normal_b_to_a;
};

bool is_one_normal(const Vector3d& n, const Vector3d& m) { return (n - m).norm() <= kOneNormal; }

class TouchingPieces {
 public:
  TouchingPieces(const Query& query, double distance, PairCache* cache)
      : query_(query), slack_(kOfModels * query.size) {
    const double reach = std::max(distance, 0.0) + kInContact * query.size;
    for (const auto& [i, j] : pieces_within(query, reach, cache)) {
      const PolytopeGap found = surface_gap(query.piece_of_a(i), query.piece_of_b(j), query.size,
                                            reach, Points::kUnwanted);
      if (!found.beyond && !found.grazes && found.distance <= reach)
        pairs_.push_back({i, j, found.normal_b_to_a});
    }
  }
  const std::vector<PiecesInTouch>& pairs() const { return pairs_; }
  bool all_have(const Vector3d& n) const {
    return std::all_of(pairs_.begin(), pairs_.end(), [&](const PiecesInTouch& pair) {
      return is_one_normal(pair.normal_b_to_a, n);
    });
  }
  /// How many pairs a direction does not separate; of more than `most`, some number above it.
  std::size_t crossed(const Vector3d& n, std::size_t most) {
    std::size_t count = 0;
    // the pair that ended the last count first
    if (last_ > 0 && last_ < pairs_.size()) std::swap(pairs_[0], pairs_[last_]);
    for (std::size_t k = 0; k < pairs_.size() && count <= most; ++k) {
      last_ = k;
      const PlacedPolytope a = query_.piece_of_a(pairs_[k].i), b = query_.piece_of_b(pairs_[k].j);
      if (separation_along(a, b, n) < -slack_) ++count;
    }
    return count;
  }
  /// Normals of the faces that touch, from B to A, each once.
  std::vector<Vector3d> of_faces() const {
    std::vector<Vector3d> normals;
    for (const PiecesInTouch& pair : pairs_) {
      const PlacedPolytope a = query_.piece_of_a(pair.i), b = query_.piece_of_b(pair.j);
      for (const auto& [piece, side] : {std::pair{&a, -1.0}, std::pair{&b, 1.0}})
        if (piece->polytope->is_face)
          add(side * (piece->query_from_body * piece->polytope->face_normals.front()), normals);
    }
    return normals;
  }
  std::vector<Vector3d> of_pairs() const {
    std::vector<Vector3d> normals;
    for (const PiecesInTouch& pair : pairs_) add(pair.normal_b_to_a, normals);
    return normals;
  }

 private:
  static void add(const Vector3d& n, std::vector<Vector3d>& normals) {
    if (std::none_of(normals.begin(), normals.end(),
                     [&](const Vector3d& m) { return is_one_normal(m, n); }))
      normals.push_back(n);
  }

  const Query& query_;
  double slack_;  // [m]
  std::vector<PiecesInTouch> pairs_;
  std::size_t last_ = 0;
};

}  // namespace

PolytopeGap with_common_normal(const Query& query, const NearestPieces& nearest, PairCache* cache) {
  const PolytopeGap& gap = nearest.gap;
  if (!(std::abs(gap.distance) <= kInContact * query.size)) return gap;
  TouchingPieces touching(query, gap.distance, cache);
  if (touching.all_have(gap.normal_b_to_a)) return gap;

  std::size_t fewest = touching.crossed(gap.normal_b_to_a, touching.pairs().size());
  std::vector<Vector3d> best{gap.normal_b_to_a};
  bool are_of_faces = false;
  for (const bool of_faces : {true, false}) {
    if (!of_faces && are_of_faces) break;
    for (const Vector3d& n : of_faces ? touching.of_faces() : touching.of_pairs()) {
      const std::size_t count = touching.crossed(n, fewest);
      if (count > fewest) continue;
      if (count < fewest || are_of_faces != of_faces) best.clear();
      fewest = count;
      are_of_faces = of_faces;
      best.push_back(n);
    }
  }
  Vector3d normal = best.front();
  if (best.size() > 1) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& n : best) sum += n;
    const Vector3d middle = sum.normalized();
    if (sum.norm() > kOneNormal && touching.crossed(middle, fewest) <= fewest) normal = middle;
  }
  if (is_one_normal(normal, gap.normal_b_to_a)) return gap;
  PolytopeGap found = gap;
  found.normal_b_to_a = normal;
  const auto& pairs = touching.pairs();
  const auto pair = std::min_element(
      pairs.begin(), pairs.end(), [&](const PiecesInTouch& p, const PiecesInTouch& q) {
        const bool has_p = is_one_normal(p.normal_b_to_a, normal),
                   has_q = is_one_normal(q.normal_b_to_a, normal);
        return has_p != has_q ? has_p : std::pair(p.i, p.j) < std::pair(q.i, q.j);
      });
  if (is_one_normal(pair->normal_b_to_a, normal))
    found.point_a = surface_gap(query.piece_of_a(pair->i), query.piece_of_b(pair->j), query.size,
                                kInfinity, Points::kWanted)
                        .point_a;
  found.point_b = found.point_a - found.distance * normal;
  return found;
}

}  // namespace tumble::collision
