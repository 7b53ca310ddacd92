#include "framework/report/arms.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/report/html_text.h"

namespace tumble::report {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kArmsWidth = 240,
                 kArmsRoom = 34;      // units of the drawing; room for names at its border
constexpr double kArrowLength = 52;   // length of a direction
constexpr double kAlmostZero = 1e-9;  // relative: what rounding leaves of a zero
constexpr const char* kArmColours[] = {"#005a96", "#a82c00"};

struct ArmsPlane {
  Vector3d up, across, out;
};

// The first direction, and the part across it of the longest arm that has one.
ArmsPlane plane_of(const Arms& arms) {
  ArmsPlane plane;
  plane.up = arms.directions.front().along_world.normalized();
  Vector3d across = Vector3d::Zero();
  double longest = 0.0;
  for (const Arms::Arm& arm : arms.arms) {
    const Vector3d part = arm.arm_world - arm.arm_world.dot(plane.up) * plane.up;
    longest = std::max(longest, arm.arm_world.norm());
    if (part.norm() > across.norm() * (1.0 + kAlmostZero)) across = part;
  }
  if (across.norm() <=
      kAlmostZero * longest)  // all along the direction: any plane through it shows them
    across = plane.up.cross(std::abs(plane.up.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY());
  plane.across = across.normalized();
  plane.out = plane.across.cross(plane.up);
  return plane;
}

Vector2d in_plane(const ArmsPlane& plane, const Vector3d& v) {
  return {v.dot(plane.across), -v.dot(plane.up)};  // y of the drawing points down
}

// Where names stand, and lines that they must not cover.
class FreePlaces {
 public:
  void add_line(const Vector2d& from, const Vector2d& to) { lines_.emplace_back(from, to); }

  /// The first of the wished places that covers neither a name nor a line; else the one that is
  /// farthest from what it covers.
  Vector2d take(const std::vector<Vector2d>& wished) {
    Vector2d best = wished.front();
    double most = -1.0;
    for (const Vector2d& at : wished) {
      const double room = room_at(at);
      if (room <= most) continue;
      best = at;
      most = room;
      if (most >= kEnough) break;
    }
    names_.push_back(best);
    return best;
  }

 private:
  static constexpr double kEnough = 11.0;  // half of a name, and a little

  double room_at(const Vector2d& at) const {
    double room = kEnough;
    for (const Vector2d& name : names_) room = std::min(room, 0.5 * (at - name).norm());
    for (const auto& [from, to] : lines_) {
      const Vector2d along = to - from;
      const double length2 = along.squaredNorm(),
                   part =
                       length2 > 0.0 ? std::clamp((at - from).dot(along) / length2, 0.0, 1.0) : 0.0;
      room = std::min(room, (at - from - part * along).norm());
    }
    return room;
  }

  std::vector<Vector2d> names_;
  std::vector<std::pair<Vector2d, Vector2d>> lines_;
};

// Places around one, nearest first.
std::vector<Vector2d> around(const Vector2d& at, double distance) {
  std::vector<Vector2d> places;
  for (const double far : {1.0, 1.6})
    for (const auto& [x, y] : {std::pair{0.0, 1.0},
                               {0.0, -1.0},
                               {-1.0, 0.0},
                               {1.0, 0.0},
                               {-0.8, 0.8},
                               {0.8, 0.8},
                               {-0.8, -0.8},
                               {0.8, -0.8}})
      places.push_back(at + far * distance * Vector2d(x, y));
  return places;
}

std::string words_at(const Vector2d& at, const std::string& words, const char* colour) {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" class=\"halo\" "
      "fill=\"{}\">{}</text>\n",
      at.x(), at.y() + 4, colour, html_escape(words));
}

std::string arrow_of(const Vector2d& from, const Vector2d& to, const char* colour, double width) {
  const Vector2d along = to - from;
  if (along.norm() < 1e-6) return "";
  constexpr double kHead = 9;
  const Vector2d ahead = along.normalized(), side(-ahead.y(), ahead.x()),
                 neck = to - std::min(kHead, along.norm()) * ahead;
  const Vector2d left = neck + 0.4 * kHead * side, right = neck - 0.4 * kHead * side;
  return fmt::format(
      "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>"
      "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}z\" fill=\"{}\"/>\n",
      from.x(), from.y(), neck.x(), neck.y(), colour, width, to.x(), to.y(), left.x(), left.y(),
      right.x(), right.y(), colour);
}

// A centre of mass: a circle of four quarters, as drawings have it.
std::string centre_of(const Vector2d& at, const char* colour) {
  constexpr double r = 6;
  return fmt::format(
      "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2}\" fill=\"#fff\" stroke=\"{3}\"/>"
      "<path d=\"M{0:.1f} {1:.1f}v-{2}a{2} {2} 0 0 1 {2} {2}zM{0:.1f} {1:.1f}v{2}a{2} {2} 0 "
      "0 1 -{2} -{2}z\" fill=\"{3}\"/>\n",
      at.x(), at.y(), r, colour);
}

}  // namespace

bool can_be_drawn(const Arms& arms) {
  if (arms.arms.empty() || arms.directions.empty()) return false;
  const bool has_arm = std::any_of(arms.arms.begin(), arms.arms.end(),
                                   [](const Arms::Arm& arm) { return arm.arm_world.norm() > 0.0; });
  return has_arm &&
         std::all_of(arms.arms.begin(), arms.arms.end(),
                     [](const Arms::Arm& arm) { return arm.arm_world.allFinite(); }) &&
         std::all_of(arms.directions.begin(), arms.directions.end(),
                     [](const Arms::Direction& direction) {
                       const double size = direction.along_world.norm();
                       return std::isfinite(size) && size > 0.0;
                     });
}

std::string out_of_plane_words(const Arms& arms) {
  const ArmsPlane plane = plane_of(arms);
  std::string words;
  for (const Arms::Arm& arm : arms.arms) {
    const double out = arm.arm_world.dot(plane.out);
    if (std::abs(out) > 1e-6 * arm.arm_world.norm())
      words += fmt::format("{}{} stands {:.3g} m out of this plane", words.empty() ? "" : ", ",
                           arm.name, std::abs(out));
  }
  return words;
}

std::string svg_of(const Arms& arms) {
  require(can_be_drawn(arms), "report: arms need a direction and an arm that are not zero");
  const ArmsPlane plane = plane_of(arms);
  // the point of the blow is the origin; a centre of mass lies one arm back
  Vector2d low = Vector2d::Zero(), high = Vector2d::Zero();
  std::vector<Vector2d> centres;
  for (const Arms::Arm& arm : arms.arms) {
    centres.push_back(-in_plane(plane, arm.arm_world));
    low = low.cwiseMin(centres.back());
    high = high.cwiseMax(centres.back());
  }
  const double widest = std::max((high - low).maxCoeff(), 1e-300),
               scale = (kArmsWidth - 2.0 * kArmsRoom) / widest;
  const double tall = scale * (high - low).y();
  // above the point there is room for the directions
  const double top = std::max(kArmsRoom, kArmsRoom + kArrowLength + scale * low.y());
  const Vector2d origin(0.5 * kArmsWidth - scale * 0.5 * (low + high).x(), top - scale * low.y());
  const double height = top + tall + kArmsRoom;

  std::string body = fmt::format(
      "<line x1=\"8\" y1=\"{0:.1f}\" x2=\"{1}\" y2=\"{0:.1f}\" stroke=\"#5b6875\" "
      "stroke-dasharray=\"5 4\"/>\n",
      origin.y(), kArmsWidth - 8);
  FreePlaces free;
  free.add_line({8, origin.y()}, {kArmsWidth - 8, origin.y()});
  for (const Vector2d& centre : centres) free.add_line(origin + scale * centre, origin);
  for (const Arms::Direction& direction : arms.directions)
    free.add_line(origin,
                  origin + kArrowLength * in_plane(plane, direction.along_world.normalized()));
  std::string names;  // above all lines
  for (std::size_t i = 0; i < arms.arms.size(); ++i) {
    const char* colour = kArmColours[i % std::size(kArmColours)];
    const Vector2d from = origin + scale * centres[i], middle = 0.5 * (from + origin),
                   along = origin - from;
    body += arrow_of(from, origin, colour, 1.8);
    const Vector2d side = along.norm() > 1.0
                              ? Vector2d(Vector2d(-along.y(), along.x()).normalized() * 15.0)
                              : Vector2d(22.0, 0.0);
    body += centre_of(from, colour);
    names += words_at(free.take(around(from, 16)),
                      arms.arms[i].body.empty() ? "x" : arms.arms[i].body, colour);
    std::vector<Vector2d> places = {middle + side, middle - side, middle + 1.5 * side,
                                    middle - 1.5 * side};
    for (const double part : {0.3, 0.7})
      for (const double sign : {1.0, -1.0}) places.push_back(from + part * along + sign * side);
    for (const Vector2d& place : around(middle, 20)) places.push_back(place);  // of a short arm
    names += words_at(free.take(places), arms.arms[i].name, colour);
  }
  for (const Arms::Direction& direction : arms.directions) {
    const Vector2d along = in_plane(plane, direction.along_world.normalized());
    const Vector2d end = origin + (kArrowLength + 10.0) * along;
    body += arrow_of(origin, origin + kArrowLength * along, "#1c2733", 2.2);
    names += words_at(free.take({end + Vector2d(9, 0), end - Vector2d(9, 0), end}), direction.name,
                      "#1c2733");
  }
  body += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.4\" fill=\"#1c2733\"/>\n",
                      origin.x(), origin.y()) +
          names + words_at(free.take(around(origin, 15)), "p", "#1c2733");
  return fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"arms and direction "
      "of the blow\">\n{}</svg>\n",
      kArmsWidth, height, body);
}

}  // namespace tumble::report
