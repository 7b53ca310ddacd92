#include "framework/engines/contact/impact_detection.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/collision/contact_patch.h"
#include "framework/core/error.h"
#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/start_overlaps.h"

namespace tumble::engines {
ImpactDetection::ImpactDetection(MovingWorld& moving, const Laws& laws, RunCounters& counters)
    : moving_(moving), laws_(laws), counters_(counters) {
  for (int i = 0; i < moving_.size(); ++i)
    if (moving_.world().bodies[i].collides) colliding_.push_back(i);
}

std::optional<Earliest> ImpactDetection::earliest(const std::vector<Pair>& pairs) {
  const StageTimer timer(counters_.collision_seconds);
  apart_at_target_ = false;
  counters_.pair_checks += pairs.size();
  const auto found = find_earliest(pairs);
  return found ? found : find_missed(pairs, moving_.target());
}

void ImpactDetection::refuse_overlap(const std::string& where, const scene::Scene& scene) const {
  std::vector<collision::SweptBox> boxes;
  for (const int body : colliding_)
    boxes.push_back(start_box(moving_.shape(body), moving_.motion_at(body, 0.0).pose,
                              !moving_.world().bodies[body].immovable()));
  std::vector<StartPair> near;
  for (const auto& [place_a, place_b] : collision::overlapping_pairs(boxes)) {
    const int a = colliding_[place_a], b = colliding_[place_b];
    if (!moving_.may_collide(a, b)) continue;
    const collision::Pose pose_a = moving_.motion_at(a, 0.0).pose,
                          pose_b = moving_.motion_at(b, 0.0).pose;
    look_at_start(
        a, b, moving_.shape(a), pose_a, moving_.shape(b), pose_b,
        kRoundOff * collision::gap_scale(moving_.shape(a), pose_a, moving_.shape(b), pose_b), near);
  }
  refuse_overlaps(where, scene, near);
}

// A half-space in the step under way: how high it reaches at most along its normal.
struct ImpactDetection::Plane {
  int box;            // its place among the boxes
  Vector3d up_world;  // unit
  double start, end;  // heights at the step's ends [m]
  double shake;       // farther than there between them, at most [m]
  bool reaches(const collision::SweptBox& box_of_other) const {
    const Vector3d middle = 0.5 * (box_of_other.low + box_of_other.high),
                   half = 0.5 * (box_of_other.high - box_of_other.low);
    const double lowest = up_world.dot(middle) - up_world.cwiseAbs().dot(half);
    return lowest <= std::max(start, end) + shake;
  }
};

ImpactDetection::Plane ImpactDetection::plane_of(int box) {
  const int body = colliding_[box];
  const collision::Pose start = moving_.pose_at(body, moving_.time()),
                        end = moving_.pose_at(body, moving_.target());
  const Vector3d n = start.world_from_body.toRotationMatrix().col(2);
  const scene::PrescribedMotion& m = moving_.world().bodies[body].motion;
  const double shake =
      m.amplitude_m.norm() *
      std::min(2.0, std::pow(m.angular_frequency_rad_s * (moving_.target() - moving_.time()), 2));
  return {box, n, n.dot(start.com_world), n.dot(end.com_world), shake};
}

std::vector<ImpactDetection::Pair> ImpactDetection::candidates() {
  if (colliding_.size() < 2 || std::none_of(colliding_.begin(), colliding_.end(), [&](int body) {
        return moving_.can_move(body) || moving_.is_driven(body);
      }))
    return {};
  const StageTimer timer(counters_.collision_seconds);
  std::vector<Pair> pairs = pairs_of_boxes();
  if (ask_for_ends(pairs)) pairs = pairs_of_boxes();
  counters_.candidate_pairs += pairs.size();
  return pairs;
}

std::vector<ImpactDetection::Pair> ImpactDetection::pairs_of_boxes() {
  boxes_.clear();
  std::vector<Plane> planes;
  for (const int body : colliding_) {
    if (moving_.shape(body).is_half_space())
      planes.push_back(plane_of(static_cast<int>(boxes_.size())));
    boxes_.push_back(moving_.swept_box(body));
  }
  // Planes without end are in every box: whether one reaches the box of a body is asked directly.
  const auto is_missed = [&](const Pair& places) {
    return std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
      return (plane.box == places.second && !plane.reaches(boxes_[places.first])) ||
             (plane.box == places.first && !plane.reaches(boxes_[places.second]));
    });
  };
  auto pairs = near_boxes_.overlapping_pairs(boxes_);
  std::erase_if(pairs, [&](const Pair& pair) {
    return !moving_.may_collide(colliding_[pair.first], colliding_[pair.second]) || is_missed(pair);
  });
  for (auto& [a, b] : pairs) {
    a = colliding_[a];
    b = colliding_[b];
  }
  return pairs;
}

// In a step that has begun again a body without contacts still has the box of the longer one: where
// that met no box, neither does the shorter one's.
// @return whether one of these met another, so that the end of its path matters now
bool ImpactDetection::ask_for_ends(const std::vector<Pair>& pairs) {
  bool any = false;
  for (const auto& [a, b] : pairs)
    for (const int body : {a, b})
      if (moving_.has_roomy_box(body)) {
        moving_.path_end(body);
        any = true;
      }
  return any;
}

std::optional<Earliest> ImpactDetection::find_earliest(const std::vector<Pair>& pairs) {
  collision::ImpactOptions options{laws_.find_impact_time};
  std::optional<Earliest> earliest;
  double until = moving_.target();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto [a, b] = pairs[k];
    options.cache = moving_.pair_cache(a, b);
    const auto impact = collision::first_impact(moving_.shape(a), moving_.motion(a),
                                                moving_.shape(b), moving_.motion(b), moving_.time(),
                                                until, options, &counters_.collision);
    if (!impact || (earliest && impact->time >= earliest->time)) continue;
    earliest = Earliest{impact->time, k};
    until = impact->time;
    if (until <= moving_.time()) break;
  }
  return earliest;
}

// Of those that are farther apart than what counts as touching a bound from below.
double ImpactDetection::gap_on_path(Pair pair, double t) {
  const auto [a, b] = pair;
  const collision::Pose pose_a = moving_.pose_at(a, t), pose_b = moving_.pose_at(b, t);
  const double least = collision::least_gap(moving_.shape(a), pose_a, moving_.shape(b), pose_b);
  const double touching = touching_distance(pair);
  if (least > touching) return least;
  ++counters_.collision.gap_evaluations;
  return collision::gap_distance(moving_.shape(a), pose_a, moving_.shape(b), pose_b,
                                 moving_.pair_cache(a, b), touching);
}

collision::Gap ImpactDetection::gap(Pair pair) const {
  return collision::compute_gap(moving_.shape(pair.first), pose_of(pair.first),
                                moving_.shape(pair.second), pose_of(pair.second),
                                moving_.pair_cache(pair.first, pair.second));
}

double ImpactDetection::touching_distance(Pair pair) const {
  // Times are doubles too: within one spacing of the time a pair moves by its speed times that.
  const double speed = moving_.velocity_of(pair.first, moving_.time()).norm() +
                       moving_.velocity_of(pair.second, moving_.time()).norm();
  return kRoundOff * (collision::gap_scale(moving_.shape(pair.first), pose_of(pair.first),
                                           moving_.shape(pair.second), pose_of(pair.second))) +
         kFewRoundings * kEpsilon * moving_.time() * speed;
}

namespace {

// The middle of where two lie flat on each other, as far as that is known: the push acts along the
// line through a centre of mass that passes as near as what lies flat leans, and between two such
// lines nearer to that of the lighter body. Beside it the push would turn a body that rebounds
// straight: tilted by d, it is struck off that line by d times half its height, on the side that
// tilts it further, which makes thirty of d at each bounce.
Vector3d below_the_mass(const Vector3d& middle, const Vector3d& n, const collision::Pose& pose_a,
                        const collision::Pose& pose_b, const Moved& moved, double leans) {
  Vector3d sum = Vector3d::Zero();
  double weight = 0.0;
  for (const auto& [moves, pose] : {std::pair{moved.a, &pose_a}, std::pair{moved.b, &pose_b}}) {
    const Vector3d beside = pose->com_world - middle, off = beside - n.dot(beside) * n;
    if (!(moves > 0) || off.norm() > leans) continue;
    sum += moves * off;
    weight += moves;
  }
  return weight > 0 ? Vector3d(middle + sum / weight) : middle;
}

}  // namespace

// Sizes say what lies flat; how far from the world's origin the two are only adds what their places
// are rounded by.
std::vector<Vector3d> touching_points(const collision::CollisionShape& a,
                                      const collision::Pose& pose_a,
                                      const collision::CollisionShape& b,
                                      const collision::Pose& pose_b, const collision::Gap& gap,
                                      const Moved& moved, double rounding) {
  const Vector3d point_world = 0.5 * (gap.point_a_world + gap.point_b_world);
  if (a.is_ball() || b.is_ball()) return {point_world};
  double size = 0.0;
  for (const collision::CollisionShape* shape : {&a, &b})
    if (!shape->is_half_space()) size += shape->bounding_radius();
  // A face that leans by a billionth lies flat.
  const double leans = kNegligible * size + rounding;
  const collision::FlatHull patch = collision::contact_patch(a, pose_a, b, pose_b, gap, leans);
  if (patch.corners.size() < 2) return {point_world};
  std::vector<Vector3d> points{
      below_the_mass(patch.middle, gap.normal_b_to_a_world, pose_a, pose_b, moved, leans)};
  points.insert(points.end(), patch.corners.begin(), patch.corners.end());
  return points;
}

std::vector<Vector3d> ImpactDetection::touching_points(Pair pair, const collision::Gap& gap,
                                                       double band) const {
  return engines::touching_points(moving_.shape(pair.first), pose_of(pair.first),
                                  moving_.shape(pair.second), pose_of(pair.second), gap,
                                  {moving_.world().bodies[pair.first].inertia.inverse_mass,
                                   moving_.world().bodies[pair.second].inertia.inverse_mass},
                                  touching_distance(pair) + band);
}

// The last guard: bounds hold for every method of integration that moves bodies smoothly, but what
// a student wrote may not. An overlap at the end that is deeper than round-off is traced back to
// where it began.
std::optional<Earliest> ImpactDetection::find_missed(const std::vector<Pair>& pairs,
                                                     double target) {
  std::optional<Earliest> earliest;
  apart_at_target_ = true;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    double low = moving_.time(), high = target;
    const double touching = touching_distance(pairs[k]), gap = gap_on_path(pairs[k], high);
    apart_at_target_ = apart_at_target_ && gap > touching;
    if (gap >= -touching) continue;
    for (double middle = 0.5 * (low + high); middle > low && middle < high;
         middle = 0.5 * (low + high))
      (gap_on_path(pairs[k], middle) < 0 ? high : low) = middle;
    if (!earliest || low < earliest->time) earliest = Earliest{low, k};
  }
  return earliest;
}

// An overlap that rounding leaves is removed by moving the lighter body along the normal; a few
// roundings at most.
void ImpactDetection::separate(const std::vector<Pair>& pairs) {
  for (int round = 0; round < 20; ++round) {
    bool clean = true;
    for (const auto& pair : pairs) {
      const auto [a, b] = pair;
      if (collision::least_gap(moving_.shape(a), pose_of(a), moving_.shape(b), pose_of(b)) > 0)
        continue;
      if (collision::gap_distance(moving_.shape(a), pose_of(a), moving_.shape(b), pose_of(b),
                                  moving_.pair_cache(a, b), 0.0) >= 0)
        continue;
      const collision::Gap gap = this->gap(pair);
      clean = false;
      const double mass_a = moving_.can_move(pair.first)
                                ? moving_.world().bodies[pair.first].inertia.inverse_mass
                                : 0.0;
      const double mass_b = moving_.can_move(pair.second)
                                ? moving_.world().bodies[pair.second].inertia.inverse_mass
                                : 0.0;
      // The other one in every second round: a body between two others is not moved to and fro.
      const bool swap = round % 2 == 1 && mass_a > 0 && mass_b > 0;
      const int mover = (mass_a >= mass_b) != swap ? pair.first : pair.second;
      RigidBodyState state = moving_.state(mover);
      const double spacing = kEpsilon * state.com_world.cwiseAbs().maxCoeff();
      const double way = -gap.distance + spacing * round;
      state.com_world += (mover == pair.first ? way : -way) * gap.normal_b_to_a_world;
      moving_.set_state(mover, state);
      ++counters_.position_corrections;
    }
    if (clean) return;
  }
  note_overlaps(pairs);
}

// Rounds have run out: bodies that others press together from all sides have nowhere to go.
void ImpactDetection::note_overlaps(const std::vector<Pair>& pairs) {
  for (const Pair& pair : pairs) {
    const double size = std::min(moving_.shape(pair.first).bounding_radius(),
                                 moving_.shape(pair.second).bounding_radius());
    if (!(size > 0) ||
        collision::least_gap(moving_.shape(pair.first), pose_of(pair.first),
                             moving_.shape(pair.second), pose_of(pair.second)) >= -kApart * size)
      continue;
    const double overlap = -gap(pair).distance;
    if (!(overlap > kApart * size)) continue;
    counters_.watch.note(RunWatch::Kind::kOverlapLeft,
                         names_of(moving_.world(), {pair.first, pair.second}),
                         {overlap / size, kApart, moving_.time(), 0.0});
  }
}

}  // namespace tumble::engines
