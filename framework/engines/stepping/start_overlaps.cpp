#include "framework/engines/stepping/start_overlaps.h"

#include "framework/engines/base/tolerances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include <fmt/format.h>

namespace tumble::engines {
namespace {

constexpr double kUnseen = 1e-4;   // of the smaller body: a displacement below what is seen
constexpr int kMostSweeps = 1000;  // over the pairs: stacks take one, grids some tens

double extent(const collision::CollisionShape& shape) {
  return shape.is_half_space() ? 0.0 : shape.bounding_radius();
}

// of the gap that rounding explains: of surfaces that are one, the rounding of the gap itself
constexpr double kSurfacesCross = 1e-3;

std::string both(const scene::Scene& scene, const StartPair& pair) {
  return fmt::format("bodies '{}' and '{}'",
                     scene.bodies[static_cast<std::size_t>(pair.body_a)].name,
                     scene.bodies[static_cast<std::size_t>(pair.body_b)].name);
}

std::string refusal(const scene::Scene& scene, const StartPair& pair) {
  // Their surfaces do not cross: the gap is one of surfaces, and says nothing of their insides.
  if (!(pair.gap < -kSurfacesCross * pair.explained))
    return fmt::format("at the start one of the {} is inside the other, or where it is",
                       both(scene, pair));
  return fmt::format(
      "{} overlap at the start, by about {:.3g} m; the rounding of decimals and of "
      "single-precision models explains {:.2g} m here",
      both(scene, pair), -pair.gap, pair.explained);
}

/// The pair that a refusal is about: of what rounding does not explain the first, else the first
/// overlap.
const StartPair& worst_of(const std::vector<StartPair>& near) {
  const auto unexplained = std::find_if(near.begin(), near.end(), [](const StartPair& pair) {
    return pair.overlaps && !(pair.gap < 0 && -pair.gap <= pair.explained);
  });
  return unexplained != near.end()
             ? *unexplained
             : *std::find_if(near.begin(), near.end(),
                             [](const StartPair& pair) { return pair.overlaps; });
}

/// Where the scene says of the body that can be moved, of two the later one.
std::string place_of_overlap(const std::string& where, const scene::Scene& scene,
                             const StartPair& pair) {
  const scene::BodySpec &a = scene.bodies[static_cast<std::size_t>(pair.body_a)],
                        &b = scene.bodies[static_cast<std::size_t>(pair.body_b)];
  const scene::BodySpec& moves = b.immovable ? a : b;
  return scene.lines.empty() || moves.pointer.empty() ? where
                                                      : scene::place_of(scene, moves.pointer);
}

/// How many pairs away from an immovable body; those that no chain of pairs leads to come last.
std::vector<int> steps_from_support(const scene::Scene& scene, const std::vector<StartPair>& near) {
  std::vector<int> steps(scene.bodies.size(), std::numeric_limits<int>::max());
  std::queue<int> to_do;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i)
    if (scene.bodies[static_cast<std::size_t>(i)].immovable)
      steps[static_cast<std::size_t>(i)] = 0, to_do.push(i);
  while (!to_do.empty()) {
    const int at = to_do.front();
    to_do.pop();
    for (const StartPair& pair : near) {
      if (pair.body_a != at && pair.body_b != at) continue;
      const auto other = static_cast<std::size_t>(pair.body_a == at ? pair.body_b : pair.body_a);
      if (steps[other] <= steps[static_cast<std::size_t>(at)] + 1) continue;
      steps[other] = steps[static_cast<std::size_t>(at)] + 1;
      to_do.push(static_cast<int>(other));
    }
  }
  return steps;
}

}  // namespace

double explained_overlap(const collision::CollisionShape& a, const collision::Pose& pose_a,
                         const collision::CollisionShape& b, const collision::Pose& pose_b) {
  const double scale = pose_a.com_world.cwiseAbs().maxCoeff() + extent(a) +
                       pose_b.com_world.cwiseAbs().maxCoeff() + extent(b);
  const double smaller = a.is_half_space()   ? extent(b)
                         : b.is_half_space() ? extent(a)
                                             : std::min(extent(a), extent(b));
  return std::min(static_cast<double>(std::numeric_limits<float>::epsilon()) * scale,
                  kUnseen * smaller);
}

OverlapAtStart::OverlapAtStart(const std::string& where, const scene::Scene& scene,
                               std::vector<StartPair> near)
    : UserError(place_of_overlap(where, scene, worst_of(near)), refusal(scene, worst_of(near)),
                "move one of them away (\"position_m\") until they are apart or just touch"),
      near_(std::move(near)) {}

bool OverlapAtStart::is_explained() const {
  return std::all_of(near_.begin(), near_.end(), [](const StartPair& pair) {
    return !pair.overlaps || (pair.gap < 0 && -pair.gap <= pair.explained);
  });
}

// The rounding that explains an overlap is at most the sum of what it is for each of the two.
collision::SweptBox start_box(const collision::CollisionShape& shape, const collision::Pose& pose,
                              bool can_move) {
  const double explained = static_cast<double>(std::numeric_limits<float>::epsilon()) *
                           (pose.com_world.cwiseAbs().maxCoeff() + extent(shape));
  const Vector3d margin = Vector3d::Constant(shape.bounding_radius() * (1 + kCoordinateRounding) +
                                             kFewRoundings * explained) +
                          kCoordinateRounding * pose.com_world.cwiseAbs();
  return {pose.com_world - margin, pose.com_world + margin, can_move};
}

void look_at_start(int a, int b, const collision::CollisionShape& shape_a,
                   const collision::Pose& pose_a, const collision::CollisionShape& shape_b,
                   const collision::Pose& pose_b, double touching, std::vector<StartPair>& near) {
  const double explained = explained_overlap(shape_a, pose_a, shape_b, pose_b);
  if (collision::least_gap(shape_a, pose_a, shape_b, pose_b) > kFewRoundings * explained) return;
  const bool overlaps = collision::overlapping(shape_a, pose_a, shape_b, pose_b, touching);
  const collision::Gap gap = collision::compute_gap(shape_a, pose_a, shape_b, pose_b);
  if (overlaps || gap.distance <= kFewRoundings * explained)
    near.push_back({a, b, gap.distance, explained, overlaps, gap.normal_b_to_a_world});
}

void refuse_overlaps(const std::string& where, const scene::Scene& scene,
                     const std::vector<StartPair>& near) {
  if (std::any_of(near.begin(), near.end(), [](const StartPair& pair) { return pair.overlaps; }))
    throw OverlapAtStart(where, scene, near);
}

// Each pair asks for n . (dx_a - dx_b) >= -gap; of its bodies the one farther from the support
// gives way, of two alike the later one. Sweeps outward from the support settle a stack at once.
std::optional<MovedApart> moved_apart(const scene::Scene& scene,
                                      const std::vector<StartPair>& near) {
  const std::vector<int> steps = steps_from_support(scene, near);
  const auto steps_of = [&](int body) { return steps[static_cast<std::size_t>(body)]; };
  std::vector<StartPair> pairs = near;
  std::stable_sort(pairs.begin(), pairs.end(), [&](const StartPair& p, const StartPair& q) {
    return std::min(steps_of(p.body_a), steps_of(p.body_b)) <
           std::min(steps_of(q.body_a), steps_of(q.body_b));
  });
  std::vector<Vector3d> shift(scene.bodies.size(), Vector3d::Zero());
  bool is_settled = false;
  for (int sweep = 0; sweep < kMostSweeps && !is_settled; ++sweep) {
    is_settled = true;
    for (const StartPair& pair : pairs) {
      const auto a = static_cast<std::size_t>(pair.body_a),
                 b = static_cast<std::size_t>(pair.body_b);
      const bool moves_a =
          !scene.bodies[a].immovable && (steps[a] > steps[b] || scene.bodies[b].immovable);
      const double room = kFewRoundings * kEpsilon *
                          (scene.bodies[a].position_m.cwiseAbs().maxCoeff() +
                           scene.bodies[b].position_m.cwiseAbs().maxCoeff());
      const double missing = -pair.gap - pair.normal_b_to_a_world.dot(shift[a] - shift[b]);
      if (!(missing > 0)) continue;
      is_settled = false;
      if (moves_a)
        shift[a] += (missing + room) * pair.normal_b_to_a_world;
      else
        shift[b] -= (missing + room) * pair.normal_b_to_a_world;
    }
  }
  if (!is_settled) return std::nullopt;

  MovedApart moved{scene, ""};
  int overlaps = 0, bodies = 0;
  double deepest = 0.0, farthest = 0.0;
  const StartPair* first = nullptr;
  for (const StartPair& pair : near) {
    if (!pair.overlaps) continue;
    ++overlaps;
    deepest = std::max(deepest, -pair.gap);
    if (first == nullptr || pair.gap < first->gap) first = &pair;
  }
  std::string names;
  for (std::size_t i = 0; i < shift.size(); ++i) {
    if (shift[i].isZero(0.0)) continue;
    moved.scene.bodies[i].position_m += shift[i];
    farthest = std::max(farthest, shift[i].norm());
    if (++bodies <= 3)
      names += (names.empty() ? "'" : ", '") + scene.bodies[i].name + "'";
    else if (bodies == 4)
      names += " and others";
  }
  moved.notice = fmt::format(
      "{} overlapped at the start by {:.3g} m{}, which the rounding of decimals or of "
      "single-precision models explains (up to {:.2g} m here): moved apart ({}, by at most {:.3g} "
      "m); "
      "to start exactly where the scene says, move them apart by that much there",
      both(scene, *first), deepest,
      overlaps > 1
          ? fmt::format(", and {} more pair{} by less", overlaps - 1, overlaps > 2 ? "s" : "")
          : "",
      first->explained, names, farthest);
  return moved;
}

}  // namespace tumble::engines
