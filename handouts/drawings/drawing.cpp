#include "handouts/drawings/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace tumble::handouts {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value == 0.0 ? 0.0 : value);  // no "-0"
  return text;
}

std::string stroke(const Pen& pen) {
  std::string text = " stroke=\"" + pen.color + "\" stroke-width=\"" + number(pen.width) +
                     "\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
  return pen.dashes.empty() ? text : text + " stroke-dasharray=\"" + pen.dashes + "\"";
}

std::string places(const std::vector<Point>& points) {
  std::string text;
  for (const Point& p : points) text += number(p.x) + "," + number(p.y) + " ";
  return text;
}

std::string escaped(char c) {
  return c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
}

/// What stands after "_" or "^" at text[i], smaller; i goes to its last letter.
std::string lowered_or_raised(const std::string& text, std::size_t& i, double size) {
  const double shift = (text[i] == '_' ? 0.28 : -0.38) * size;
  std::string small;
  if (text[++i] == '{')
    while (++i < text.size() && text[i] != '}') small += escaped(text[i]);
  else {
    small = escaped(text[i]);
    // the rest of a letter in UTF-8
    while (i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xC0) == 0x80)
      small += text[++i];
  }
  return "<tspan dy=\"" + number(shift) + "\" font-size=\"" + number(0.74 * size) + "\">" + small +
         "</tspan><tspan dy=\"" + number(-shift) + "\">\u200b</tspan>";
}

/// "v_a^2" with its subscripts lowered and superscripts raised.
std::string typeset(const std::string& text, double size) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size())
      ++i;  // "\\_" is the letter itself
    else if ((text[i] == '_' || text[i] == '^') && i + 1 < text.size()) {
      out += lowered_or_raised(text, i, size);
      continue;
    }
    out += escaped(text[i]);
  }
  return out;
}

}  // namespace

Point turned(Point a, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
  return {c * a.x + s * a.y, -s * a.x + c * a.y};  // y points down
}

void Drawing::line(Point from, Point to, const Pen& pen) { path({from, to}, pen); }

void Drawing::head(Point tip, Point direction, const Pen& pen) {
  const double length = std::hypot(direction.x, direction.y), size = 5.0 + 2.0 * pen.width;
  if (length == 0.0) return;
  const Point back = (size / length) * direction;
  area({tip, tip - turned(back, 22), tip - 0.75 * back, tip - turned(back, -22)}, pen.color,
       {pen.color, 0.5});
}

void Drawing::arrow(Point from, Point to, const Pen& pen) {
  const Point way = to - from;
  const double length = std::hypot(way.x, way.y);
  if (length > 0.0) line(from, to - (std::min(4.0, length) / length) * way, pen);
  head(to, way, pen);
}

void Drawing::path(const std::vector<Point>& points, const Pen& pen) {
  body_ += "<polyline fill=\"none\"" + stroke(pen) + " points=\"" + places(points) + "\"/>\n";
}

void Drawing::area(const std::vector<Point>& corners, const std::string& fill, const Pen& pen) {
  body_ +=
      "<polygon fill=\"" + fill + "\"" + stroke(pen) + " points=\"" + places(corners) + "\"/>\n";
}

void Drawing::ball(Point middle, double radius, const std::string& fill, const Pen& pen) {
  body_ += "<circle cx=\"" + number(middle.x) + "\" cy=\"" + number(middle.y) + "\" r=\"" +
           number(radius) + "\" fill=\"" + fill + "\"" + stroke(pen) + "/>\n";
}

void Drawing::arc(Point middle, double radius, double from, double to, const Pen& pen) {
  std::vector<Point> points;
  constexpr int kPieces = 24;
  for (int i = 0; i <= kPieces; ++i)
    points.push_back(middle + turned({radius, 0.0}, from + (to - from) * i / kPieces));
  path(points, pen);
  head(points.back(), points.back() - points[kPieces - 3], pen);
}

void Drawing::words(Point at, const std::string& text, Align align, const std::string& fill,
                    double size, bool bold) {
  const char* anchor = align == Align::kLeft ? "start" : align == Align::kRight ? "end" : "middle";
  body_ += "<text x=\"" + number(at.x) + "\" y=\"" + number(at.y) + "\" text-anchor=\"" + anchor +
           "\" fill=\"" + fill + "\" font-size=\"" + number(size) + "\"" +
           (bold ? " font-weight=\"bold\"" : "") + ">" + typeset(text, size) + "</text>\n";
}

std::string Drawing::svg() const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
         "width=\"" +
         number(width_) + "\" height=\"" + number(height_) + "\" viewBox=\"0 0 " + number(width_) +
         " " + number(height_) +
         "\" font-family=\"DejaVu Sans\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         body_ + "</svg>\n";
}

void Axes::draw(Drawing& drawing, const std::string& x_name, const std::string& y_name,
                const std::vector<double>& x_marks, const std::vector<double>& y_marks) const {
  const auto shown = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return std::string(text);
  };
  const Pen thin{color::line, 1.0};
  for (const double x : x_marks) {
    drawing.line({at(x, y0).x, low.y}, {at(x, y0).x, high.y}, thin);
    drawing.words({at(x, y0).x, low.y + 16}, shown(x), Align::kMiddle, color::soft, 11.5);
  }
  for (const double y : y_marks) {
    drawing.line({low.x, at(x0, y).y}, {high.x, at(x0, y).y}, thin);
    drawing.words({low.x - 6, at(x0, y).y + 4}, shown(y), Align::kRight, color::soft, 11.5);
  }
  drawing.arrow(low, {high.x + 10, low.y}, {color::soft, 1.2});
  drawing.arrow(low, {low.x, high.y - 10}, {color::soft, 1.2});
  drawing.words({high.x + 14, low.y + 4}, x_name, Align::kLeft, color::ink, 12.5);
  drawing.words({low.x + 6, high.y - 4}, y_name, Align::kLeft, color::ink, 12.5);
}

std::vector<Point> Axes::curve(const std::function<double(double)>& f, double from, double to,
                               int pieces) const {
  std::vector<Point> points;
  for (int i = 0; i <= pieces; ++i) {
    const double x = from + (to - from) * i / pieces;
    points.push_back(at(x, f(x)));
  }
  return points;
}

}  // namespace tumble::handouts
