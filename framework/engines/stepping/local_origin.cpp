#include "framework/engines/stepping/local_origin.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "framework/scene/words.h"

namespace tumble::engines {
namespace {

// Farther off than this many times its extent, a scene loses three digits and more: that is where
// local coordinates begin.
constexpr double kFar = 1000.0;

// A scene that says 1000000.1 means a tenth more than 10^6, not the nearest number that a double
// can hold, which is 2e-11 less: a box would start in its floor. So what is before the point and
// what is behind it are taken apart, where a decimal says the place that every double can tell from
// its neighbours (15 digits); a place of more digits was worked out, and is what it is.
double difference_as_written(double place, double origin) {
  std::array<char, 400> digits{};  // longer than any double without an exponent
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), std::abs(place),
                                 std::chars_format::fixed)
                       .ptr;
  const std::string text(digits.data(), end);
  const std::size_t point = text.find('.');
  if (point == std::string::npos ||
      text.size() - text.find_first_not_of("0.") > std::numeric_limits<double>::digits10 + 1)
    return place - origin;
  double fraction = 0.0;
  const std::string behind = "0" + text.substr(point);
  std::from_chars(behind.data(), behind.data() + behind.size(), fraction);
  return (std::trunc(place) - origin) + std::copysign(fraction, place);
}

// Whether some link spans from one place to another.
bool spans_places(const scene::Scene& scene) {
  const auto& words = scene::all_words();
  return std::any_of(words.begin(), words.end(), [&](const scene::Words* one) {
    const std::vector<scene::Link> links = one->links(scene);
    return std::any_of(links.begin(), links.end(),
                       [](const scene::Link& link) { return !std::isnan(link.length_m); });
  });
}

}  // namespace

Vector3d local_origin(const scene::Scene& scene) {
  if (scene.bodies.empty()) return Vector3d::Zero();
  Vector3d low = scene.bodies.front().position_m, high = low;
  const auto take = [&](const Vector3d& place) {
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  };
  for (const scene::BodySpec& body : scene.bodies) take(body.position_m);
  TypedLists effects = scene.effects;  // visitors may change places
  for (const scene::Words* words : scene::all_words())
    words->visit_places(effects, [&](const Vector3d& place, scene::PlaceKind kind) {
      if (kind == scene::PlaceKind::kHolds) take(place);
    });
  double extent = (high - low).maxCoeff();
  // one body: its way
  if (extent == 0.0) extent = scene.duration_s * scene.bodies.front().velocity_m_s.norm();
  const Vector3d middle = low + 0.5 * (high - low);
  if (!(extent > 0.0) || !(middle.cwiseAbs().maxCoeff() > kFar * extent)) return Vector3d::Zero();
  // A whole multiple of a power of two not below the extent: places near it differ from it exactly,
  // and those near 0 stay as they are.
  const double grid = std::exp2(std::ceil(std::log2(extent)));
  return (middle / grid).array().round() * grid;
}

scene::Scene seen_from(const Vector3d& origin_world, scene::Scene scene) {
  // Lengths and points of bodies that a file leaves to be measured were measured between the
  // doubles.
  const bool as_written = !spans_places(scene);
  const auto see = [&](Vector3d& place) {
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = as_written ? difference_as_written(place[axis], origin_world[axis])
                               : place[axis] - origin_world[axis];
  };
  for (scene::BodySpec& body : scene.bodies) see(body.position_m);
  for (const scene::Words* words : scene::all_words())
    words->visit_places(scene.effects, [&](Vector3d& place, scene::PlaceKind) { see(place); });
  return scene;
}

void WorldSink::frame(const Frame& frame) {
  Frame moved = frame;
  for (BodyPose& pose : moved.poses) pose.com_world += origin_world_;
  for (ContactPoint& contact : moved.contacts) contact.point_world += origin_world_;
  moved.potential_energy += potential_energy_;
  moved.angular_momentum_world += origin_world_.cross(frame.momentum_world);
  sink_.frame(moved);
}

void WorldSink::event(const Event& event) {
  Event moved = event;
  moved.point_world += origin_world_;
  sink_.event(moved);
}

}  // namespace tumble::engines
