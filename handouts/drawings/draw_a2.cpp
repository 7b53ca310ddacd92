// Drawings of assignment 2: slopes and curves of Euler's and Runge-Kutta's methods, rotations
// between two others, Euler angles.
#include <array>
#include <cmath>
#include <numbers>

#include "handouts/drawings/drawing.h"

namespace tumble::handouts {
namespace {

// The lecture's example: y' = 6 y - 0.007 y^2, y(0) = 10.
double slope(double y) { return 6.0 * y - 0.007 * y * y; }
double exact(double t) {
  constexpr double kLimit = 6.0 / 0.007, kStart = 10.0;
  return kLimit / (1.0 + (kLimit / kStart - 1.0) * std::exp(-6.0 * t));
}
double rk4_step(double y, double h) {
  const double k1 = slope(y), k2 = slope(y + 0.5 * h * k1), k3 = slope(y + 0.5 * h * k2),
               k4 = slope(y + h * k3);
  return y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

Drawing rk4_slopes() {
  Drawing d(640, 330);
  const Axes axes{{70, 280}, {540, 30}, 0, 0.56, 0, 190};
  axes.draw(d, "t", "y", {0.25, 0.5}, {50, 100, 150});
  constexpr double kStep = 0.5, kStart = 10.0;
  const double k1 = slope(kStart), y2 = kStart + 0.25 * k1, k2 = slope(y2), y3 = kStart + 0.25 * k2,
               k3 = slope(y3), y4 = kStart + kStep * k3, k4 = slope(y4);
  d.path(axes.curve(exact, 0, 0.52), {color::soft, 1.4});
  const struct {
    double t, y, k;
    const char* name;
    std::string ink;
    Point shift;
  } slopes[] = {{0, kStart, k1, "k_1 = 59.3", color::a, {20, 16}},
                {0.25, y2, k2, "k_2 = 144.6", color::b, {30, 16}},
                {0.25, y3, k3, "k_3 = 262.0", color::d, {-96, -22}},
                {0.5, y4, k4, "k_4 = 706.9", color::c, {-104, -4}}};
  // Each stage starts at the beginning and goes along the slope before it.
  d.line(axes.at(0, kStart), axes.at(0.25, y2), {color::a, 1.0, "4 3"});
  d.line(axes.at(0, kStart), axes.at(0.25, y3), {color::b, 1.0, "4 3"});
  d.line(axes.at(0, kStart), axes.at(0.5, y4), {color::d, 1.0, "4 3"});
  for (const auto& s : slopes) {
    const double reach = 0.055 / std::sqrt(1 + std::pow(s.k / 420.0, 2));
    d.line(axes.at(s.t - reach, s.y - reach * s.k), axes.at(s.t + reach, s.y + reach * s.k),
           {s.ink, 3.2});
    d.dot(axes.at(s.t, s.y), s.ink);
    d.words(axes.at(s.t, s.y) + s.shift, s.name, Align::kLeft, s.ink, 12.5);
  }
  const Point euler = axes.at(0.5, kStart + kStep * k1),
              runge = axes.at(0.5, rk4_step(kStart, kStep)), truth = axes.at(0.5, exact(0.5));
  d.line(axes.at(0.25, y2), euler, {color::a, 1.0, "4 3"});
  for (const auto& [at, text] :
       {std::pair{euler, "Euler 39.7"}, {runge, "Runge–Kutta 141.6"}, {truth, "exact 164.3"}}) {
    d.ball(at, 4.5, "#ffffff", {color::ink, 1.8});
    d.words(at + Point{10, at.y == runge.y ? 14.0 : 4.0}, text, Align::kLeft, color::ink, 11.5);
  }
  d.caption({325, 316}, "dashed: the way to the point where the next slope is taken");
  return d;
}

Drawing curves_side_by_side() {
  Drawing d(640, 300);
  const Axes axes{{60, 250}, {600, 30}, 0, 1.5, 0, 900};
  axes.draw(d, "t", "y", {0.25, 0.5, 0.75, 1.0, 1.25, 1.5}, {200, 400, 600, 800});
  constexpr double kStep = 0.25;
  std::vector<Point> euler, runge;
  double e = 10.0, r = 10.0;
  for (int i = 0; i <= 6; ++i) {
    euler.push_back(axes.at(kStep * i, e));
    runge.push_back(axes.at(kStep * i, r));
    e += kStep * slope(e);
    r = rk4_step(r, kStep);
  }
  d.path(axes.curve(exact, 0, 1.5, 150), {color::ink, 1.6});
  d.path(euler, {color::a, 1.6, "5 3"});
  for (const Point at : euler) d.dot(at, color::a);
  for (const Point at : runge) d.ball(at, 4.2, "#ffffff", {color::b, 2.2});
  d.words(axes.at(0.60, 420), "exact", Align::kRight, color::ink, 12.5);
  d.words(axes.at(1.02, 270), "Euler, h = 0.25", Align::kLeft, color::a, 12.5);
  d.words(axes.at(0.80, 690), "Runge–Kutta, h = 0.25", Align::kRight, color::b, 12.5);
  d.caption({330, 288}, "y' = 6 y − 0.007 y^2, y(0) = 10: the same six steps by both");
  return d;
}

/// An arrow-shaped body, which shows how it is turned and whether it was squeezed: m is its matrix,
/// by rows.
void body_by(Drawing& d, Point at, const std::array<double, 4>& m, const std::string& fill,
             const std::string& ink) {
  std::vector<Point> corners;
  for (const Point p : {Point{-22, -12}, Point{6, -12}, Point{6, -22}, Point{28, 0}, Point{6, 22},
                        Point{6, 12}, Point{-22, 12}})
    corners.push_back(at + Point{m[0] * p.x + m[1] * p.y, -(m[2] * p.x + m[3] * p.y)});
  d.area(corners, fill, {ink, 1.5});
}

Drawing interpolated_rotations() {
  Drawing d(640, 230);
  constexpr double kAngle = 150.0 * std::numbers::pi / 180.0;
  const char* const parts[] = {"0", "1/4", "1/2", "3/4", "1"};
  for (int i = 0; i < 5; ++i) {
    const double s = 0.25 * i, x = 150 + 108 * i, c = 1 - s + s * std::cos(kAngle),
                 n = s * std::sin(kAngle), w = s * kAngle;
    body_by(d, {x, 62}, {c, -n, n, c}, color::a_wash, color::a);
    body_by(d, {x, 158}, {std::cos(w), -std::sin(w), std::sin(w), std::cos(w)}, color::d_wash,
            color::d);
    d.words({x, 210}, std::string("s = ") + parts[i], Align::kMiddle, color::soft, 12);
  }
  d.words({16, 58}, "(1 − s) R_0", Align::kLeft, color::a, 13);
  d.words({16, 76}, "+ s R_1", Align::kLeft, color::a, 13);
  d.words({16, 162}, "slerp", Align::kLeft, color::d, 13);
  return d;
}

using Matrix = std::array<std::array<double, 3>, 3>;
Matrix product(const Matrix& a, const Matrix& b) {
  Matrix m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) m[i][j] += a[i][k] * b[k][j];
  return m;
}
/// A turn about axis 0, 1 or 2.
Matrix turn(std::size_t axis, double degrees) {
  const double a = degrees * std::numbers::pi / 180.0, c = std::cos(a), s = std::sin(a);
  Matrix m{};
  const std::size_t j = (axis + 1) % 3, k = (axis + 2) % 3;
  m[axis][axis] = 1;
  m[j][j] = m[k][k] = c;
  m[j][k] = -s;
  m[k][j] = s;
  return m;
}

Drawing euler_angles_example() {
  Drawing d(640, 270);
  const auto frame = [&](Point at, double z, double x, double y, const std::string& name) {
    const Matrix m = product(turn(1, y), product(turn(0, x), turn(2, z)));  // R_y R_x R_z
    // Seen from azimuth -30 and elevation 22 degrees, so that no axis of either frame points at the
    // eye.
    const auto seen = [&](double a, double b, double c) {
      return at + 100.0 * Point{0.5 * a + 0.866 * b, 0.325 * a - 0.1875 * b - 0.927 * c};
    };
    const char* const world[] = {"X", "Y", "Z"};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto along = [&](double length) {
        return seen(k == 0 ? length : 0, k == 1 ? length : 0, k == 2 ? length : 0);
      };
      d.arrow(at, along(0.9), {color::line, 1.4});
      d.words(along(1.05) + Point{0, 4}, world[k], Align::kMiddle, color::soft, 11.5);
    }
    const char* const names[] = {"x", "y", "z"};
    const std::string inks[] = {color::a, color::d, color::b};
    for (std::size_t k : {1, 2, 0}) {
      const Point tip = seen(m[0][k], m[1][k], m[2][k]),
                  past = seen(1.14 * m[0][k], 1.14 * m[1][k], 1.14 * m[2][k]);
      d.arrow(at, tip, {inks[k], k == 0 ? 3.4 : 2.2});
      d.words(past + Point{0, 4}, names[k], Align::kMiddle, inks[k], 13.5, k == 0);
    }
    d.words({at.x, 236}, name, Align::kMiddle, color::ink, 13);
  };
  frame({160, 140}, 90, 45, 45, "(90, 45, 45)");
  frame({470, 140}, 45, 0, -45, "(45, 0, −45)");
  d.caption({320, 260}, "R = R_y(third) R_x(second) R_z(first); grey: the world's axes");
  return d;
}

}  // namespace

std::vector<Figure> figures_of_a2() {
  return {{"rk4_slopes", rk4_slopes},
          {"curves_side_by_side", curves_side_by_side},
          {"interpolated_rotations", interpolated_rotations},
          {"euler_angles_example", euler_angles_example}};
}

}  // namespace tumble::handouts
