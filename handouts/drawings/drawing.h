/// A drawing as SVG: lines, arrows, areas and words, for figures of the handouts that are not
/// pictures of a run.
///
/// Unit: the pixel of a page, x to the right, y DOWN. Words know subscripts and superscripts:
/// "v_a", "I_{zz}", "y^2".
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace tumble::handouts {

struct Point {
  double x = 0.0, y = 0.0;
};
inline Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
inline Point operator*(double s, Point a) { return {s * a.x, s * a.y}; }
/// One turn of `degrees`, counter-clockwise as the eye sees it.
Point turned(Point a, double degrees);

namespace color {
inline const std::string ink = "#1c2733", soft = "#5b6875", line = "#c3ccd4", wash = "#eef2f5",
                         none = "none";
// told apart by any eye, also by brightness
inline const std::string a = "#d1495b", b = "#30638e", c = "#b9770e", d = "#2a7f62";
inline const std::string a_wash = "#f7dfe2", b_wash = "#dbe6ef", c_wash = "#faeccb",
                         d_wash = "#d8ece4";
}  // namespace color

struct Pen {
  std::string color = color::ink;
  double width = 1.5;
  std::string dashes{};  // "4 3"; empty: a full line
};

enum class Align { kLeft, kMiddle, kRight };

class Drawing {
 public:
  Drawing(double width, double height) : width_(width), height_(height) {}

  void line(Point from, Point to, const Pen& pen = {});
  void arrow(Point from, Point to, const Pen& pen = {});
  void path(const std::vector<Point>& points, const Pen& pen = {});
  void area(const std::vector<Point>& corners, const std::string& fill, const Pen& pen = {});
  void ball(Point middle, double radius, const std::string& fill, const Pen& pen = {});
  void dot(Point at, const std::string& fill = color::ink) { ball(at, 3.2, fill, {fill, 0.0}); }
  /// A part of a circle with an arrow's head: angles in degrees, counter-clockwise, 0 to the right.
  void arc(Point middle, double radius, double from, double to, const Pen& pen = {});
  void words(Point at, const std::string& text, Align align = Align::kMiddle,
             const std::string& fill = color::ink, double size = 13.0, bool bold = false);
  /// Words under a panel, soft.
  void caption(Point at, const std::string& text) {
    words(at, text, Align::kMiddle, color::soft, 12.5);
  }
  void title(Point at, const std::string& text) {
    words(at, text, Align::kMiddle, color::ink, 13.5, true);
  }

  /// The whole as an SVG document. The same calls give the same bytes.
  std::string svg() const;

 private:
  void head(Point tip, Point direction, const Pen& pen);

  double width_, height_;
  std::string body_;
};

/// Numbers on two axes, into a part of a drawing.
struct Axes {
  Point low, high;        // the corners in pixels: of the smallest numbers, of the largest
  double x0, x1, y0, y1;  // numbers there
  Point at(double x, double y) const {
    return {low.x + (x - x0) / (x1 - x0) * (high.x - low.x),
            low.y + (y - y0) / (y1 - y0) * (high.y - low.y)};
  }
  void draw(Drawing& drawing, const std::string& x_name, const std::string& y_name,
            const std::vector<double>& x_marks, const std::vector<double>& y_marks) const;
  /// A function as a curve of so many pieces.
  std::vector<Point> curve(const std::function<double(double)>& f, double from, double to,
                           int pieces = 80) const;
};

/// Three dimensions seen from above right: x to the lower right, y to the upper right, z up.
struct Oblique {
  Point origin;
  double scale;  // pixels a unit
  Point at(double x, double y, double z) const {
    return {origin.x + scale * (0.87 * x + 0.60 * y),
            origin.y + scale * (0.30 * x - 0.36 * y - 0.95 * z)};
  }
};

/// A figure: its file's name without ending, and what draws it.
struct Figure {
  std::string name;
  std::function<Drawing()> draw;
};
/// Those of each assignment that has drawings: figures_of_aN() of draw_aN.cpp (CMakeLists.txt finds
/// the files).
std::vector<std::vector<Figure>> all_figures();

}  // namespace tumble::handouts
