#include "framework/collision/piece_pairs.h"

#include <algorithm>
#include <cmath>

#include "framework/collision/inline_vector.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Margin for the rounding of bounds: with it the result does not depend on the order of the
// traversal.
constexpr double kRoundings = 64;
// Relative to the smaller solid: the cache covers so much more than the reach of the query, at
// least and at most, and stays valid until the solids have moved that far.
constexpr double kSkin = 0.02, kThickSkin = 0.1;
// Queries to wait before a cache is filled again that answered none, because its solids move fast.
constexpr int kPause = 8;

double rounding(const Query& query) { return kRoundings * kEpsilon * query.size; }

// Lower bound of the distance between nodes of the two trees: by their balls, and by their boxes
// along the axes of either.
class NodeDistance {
 public:
  explicit NodeDistance(const Query& query)
      : nodes_a_(query.a.nodes()),
        nodes_b_(query.b.nodes()),
        a_from_b_(query.rotation_a.transpose() * query.rotation_b),
        absolute_(a_from_b_.cwiseAbs()),
        offset_a_(query.rotation_a.transpose() * query.offset) {}

  double operator()(int i, int j, double enough) const {
    const BallNode &a = nodes_a_[i], &b = nodes_b_[j];
    const Vector3d between = offset_a_ + a.center_body - a_from_b_ * b.center_body;  // axes of A
    const double balls = between.norm() - a.radius - b.radius;
    if (balls > enough) return balls;
    // To the box with A's axes around B's box, and vice versa.
    const Vector3d out_a =
        (between.cwiseAbs() - a.half_extents_body - absolute_ * b.half_extents_body).cwiseMax(0.0);
    const Vector3d out_b = ((a_from_b_.transpose() * between).cwiseAbs() - b.half_extents_body -
                            absolute_.transpose() * a.half_extents_body)
                               .cwiseMax(0.0);
    return std::max(balls, std::sqrt(std::max(out_a.squaredNorm(), out_b.squaredNorm())));
  }

 private:
  const std::vector<BallNode>& nodes_a_;
  const std::vector<BallNode>& nodes_b_;
  Matrix3d a_from_b_, absolute_;
  Vector3d offset_a_;
};

// Calls visit_pair(piece_a, piece_b) for every pair whose bound is within reach(), which may shrink
// between calls; near pairs first.
template <class Reach, class Visit>
void visit(const Query& query, Reach&& reach, Visit&& visit_pair) {
  struct Entry {
    double bound;
    int node_a, node_b;
  };
  const auto &nodes_a = query.a.nodes(), &nodes_b = query.b.nodes();
  const NodeDistance distance(query);
  InlineVector<Entry, 128> stack;
  stack.push_back({distance(0, 0, reach()), 0, 0});
  while (!stack.empty()) {
    const Entry top = stack.back();
    stack.shrink(stack.size() - 1);
    const double enough = reach();
    if (top.bound > enough) continue;
    const BallNode &a = nodes_a[top.node_a], &b = nodes_b[top.node_b];
    if (a.piece >= 0 && b.piece >= 0) {
      visit_pair(a.piece, b.piece);
      continue;
    }
    // Descends into the node with the larger ball, first into the nearer child.
    const bool open_a = b.piece >= 0 || (a.piece < 0 && a.radius >= b.radius);
    const auto entry = [&](int i, int j) { return Entry{distance(i, j, enough), i, j}; };
    Entry first = open_a ? entry(a.first_child, top.node_b) : entry(top.node_a, b.first_child);
    Entry second = open_a ? entry(a.second_child, top.node_b) : entry(top.node_a, b.second_child);
    if (second.bound < first.bound) std::swap(first, second);
    if (second.bound <= enough) stack.push_back(second);
    if (first.bound <= enough) stack.push_back(first);
  }
}

// Keeps the nearest of the pairs tested, independent of their order.
class Nearest {
 public:
  Nearest(const Query& query, double limit, Points points)
      : query_(query), limit_(limit), rounding_(rounding(query)), points_(points) {}

  double reach() const { return std::max(std::min(limit_, best_.gap.distance), 0.0) + rounding_; }
  void test(int i, int j) {
    const PolytopeGap found =
        surface_gap(query_.piece_of_a(i), query_.piece_of_b(j), query_.size, reach(), points_);
    if (found.beyond || found.grazes || found.distance > limit_) return;
    const bool first = std::pair(i, j) < std::pair(best_.piece_a, best_.piece_b);
    if (found.distance < best_.gap.distance || (found.distance == best_.gap.distance && first))
      best_ = {i, j, found};
  }
  const NearestPieces& best() const { return best_; }

 private:
  const Query& query_;
  double limit_, rounding_;
  Points points_;
  NearestPieces best_;
};

// Bound on the decrease of any distance between points of the solids since the cache was filled.
double moved_since(const Query& query, const PairCache& cache) {
  const Matrix3d a_from_b = query.rotation_a.transpose() * query.rotation_b;
  // largest |(R - R') x| / |x|
  const double turn = (a_from_b - cache.a_from_b).norm() / std::sqrt(2.0);
  const double of_b = (query.rotation_a.transpose() * -query.offset - cache.b_in_a).norm() +
                      turn * query.b.bounding_radius();
  const double of_a = (query.rotation_b.transpose() * query.offset - cache.a_in_b).norm() +
                      turn * query.a.bounding_radius();
  return std::min(of_a, of_b) + rounding(query);
}

bool one_pair(const Query& query) {
  return query.a.pieces().size() == 1 && query.b.pieces().size() == 1;
}

// Fills the cache, unless it did not pay the last time.
void fill(const Query& query, double reach, PairCache& cache) {
  if (cache.unused > 0) {
    --cache.unused;
    return;
  }
  if (cache.reach >= 0 && cache.served == 0) {
    cache.reach = -1.0;
    cache.unused = kPause;
    return;
  }
  const double size = std::min(query.a.bounding_radius(), query.b.bounding_radius());
  // pieces are cores without the rounding radius
  const double apart = reach - query.a.radius() - query.b.radius();
  cache.reach = reach + std::clamp(0.5 * apart, kSkin * size, kThickSkin * size);
  cache.served = 0;
  cache.near.clear();
  const double widened_reach = cache.reach + rounding(query);
  visit(
      query, [&] { return widened_reach; },
      [&](int i, int j) {
        const PolytopeGap gap = polytope_gap(query.piece_of_a(i), query.piece_of_b(j), query.size,
                                             widened_reach, Points::kUnwanted);
        if (!gap.beyond && gap.distance <= widened_reach)
          cache.near.push_back({i, j, gap.distance});
      });
  std::sort(cache.near.begin(), cache.near.end(),
            [](const PairCache::Near& p, const PairCache::Near& q) {
              return std::pair(p.piece_a, p.piece_b) < std::pair(q.piece_a, q.piece_b);
            });
  cache.a_from_b = query.rotation_a.transpose() * query.rotation_b;
  cache.b_in_a = query.rotation_a.transpose() * -query.offset;
  cache.a_in_b = query.rotation_b.transpose() * query.offset;
}

// Tests the pairs of the cache, the formerly nearest first. @return whether the result is certain:
// no pair outside the cache is nearer
bool search_cache(const Query& query, double limit, PairCache& cache, Nearest& nearest) {
  if (cache.reach < 0) return false;
  const double moved = moved_since(query, cache), certain = cache.reach - moved;
  if (certain < 0) return false;
  const auto first = std::min_element(
      cache.near.begin(), cache.near.end(),
      [](const PairCache::Near& p, const PairCache::Near& q) { return p.distance < q.distance; });
  if (first != cache.near.end()) nearest.test(first->piece_a, first->piece_b);
  for (auto near = cache.near.begin(); near != cache.near.end(); ++near)
    if (near != first && near->distance - moved <= nearest.reach())
      nearest.test(near->piece_a, near->piece_b);
  return std::min(limit, nearest.best().gap.distance) + rounding(query) < certain;
}

// Whether the last answer holds for these poses. Where it is at the limit to rounding, a search may
// end at its lower bound.
bool is_known(const Query& query, double limit, Points points, const PairCache& cache) {
  return cache.last && cache.last->offset == query.offset &&
         std::abs(cache.last->gap.distance - limit) > rounding(query) &&
         cache.last->rotation_a == query.rotation_a && cache.last->rotation_b == query.rotation_b &&
         (cache.last->has_points || points == Points::kUnwanted);
}

// What the next query of two convex solids begins with.
void keep(const Query& query, const PlacedPolytope& a, const PlacedPolytope& b,
          const PolytopeGap& gap, Points points, PairCache& cache) {
  if (!gap.beyond)
    cache.last = {query.rotation_a, query.rotation_b, query.offset, gap,
                  points == Points::kWanted || gap.point_a != gap.point_b};
  cache.apart_along_world = gap.normal_b_to_a;
  cache.apart_by = gap.distance;
  if (gap.beyond || gap.point_a == gap.point_b) return;  // points that were not looked for
  cache.near_body_a = a.in_body(gap.point_a - a.translation);
  cache.near_body_b = b.in_body(gap.point_b - b.translation);
}

}  // namespace

PolytopeGap convex_gap(const Query& query, double limit, PairCache* cache, Points points) {
  if (cache && is_known(query, limit, points, *cache)) return cache->last->gap;
  const PlacedPolytope a = query.piece_of_a(0), b = query.piece_of_b(0);
  // Above the limit by more than rounding: without the cached axis the answer would be the same.
  // Where the two were nearer than that along it, it would hardly be.
  const double certain = std::max(limit, 0.0) + rounding(query);
  if (cache && cache->apart_by > certain) {
    const Vector3d& axis = cache->apart_along_world;
    cache->apart_by = separation_along(a, b, axis);
    if (cache->apart_by > certain)
      return {cache->apart_by, Vector3d::Zero(), Vector3d::Zero(), axis, true};
  }
  const PolytopeGap gap = polytope_gap(a, b, query.size, limit, points);
  if (cache) keep(query, a, b, gap, points, *cache);
  return gap;
}

NearestPieces nearest_pieces(const Query& query, double limit, PairCache* cache, Points points) {
  Nearest nearest(query, limit, points);
  if (one_pair(query)) {
    const PolytopeGap gap = convex_gap(query, limit, cache, points);
    return gap.beyond || gap.distance > limit ? NearestPieces{} : NearestPieces{0, 0, gap};
  }
  if (cache && search_cache(query, limit, *cache, nearest)) {
    ++cache->served;
    return nearest.best();
  }
  visit(
      query, [&] { return nearest.reach(); }, [&](int i, int j) { nearest.test(i, j); });
  const double size = std::min(query.a.bounding_radius(), query.b.bounding_radius()),
               touch = query.a.radius() + query.b.radius();
  if (cache && nearest.best().gap.distance < touch + kSkin * size)
    fill(query, std::max(nearest.best().gap.distance, touch), *cache);
  return nearest.best();
}

std::vector<std::pair<int, int>> pieces_within(const Query& query, double reach, PairCache* cache) {
  std::vector<std::pair<int, int>> pairs;
  if (one_pair(query)) {
    pairs.emplace_back(0, 0);
    return pairs;
  }
  const double widened_reach = reach + rounding(query);
  const auto from_cache = [&] {
    if (!cache || cache->reach < 0) return false;
    const double moved = moved_since(query, *cache);
    if (widened_reach + moved > cache->reach) return false;
    for (const PairCache::Near& near : cache->near)
      if (near.distance - moved <= widened_reach) pairs.emplace_back(near.piece_a, near.piece_b);
    ++cache->served;
    return true;
  };
  if (from_cache()) return pairs;
  if (cache) {
    fill(query, reach, *cache);
    if (from_cache()) {
      cache->served = 0;  // the query that filled it does not count
      return pairs;
    }
  }
  visit(
      query, [&] { return widened_reach; }, [&](int i, int j) { pairs.emplace_back(i, j); });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace tumble::collision
