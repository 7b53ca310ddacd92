// Drawings of assignment 3: how a point of a turning body accelerates.
#include "handouts/drawings/drawing.h"

namespace tumble::handouts {
namespace {

Drawing point_acceleration() {
  Drawing d(640, 250);
  const Point x{170, 150}, p{290, 88};
  d.ball(x, 135, color::none, {color::line, 1.2, "4 4"});
  d.area({{70, 150}, {110, 90}, {200, 80}, {306, 74}, {300, 120}, {220, 210}, {120, 205}},
         color::b_wash, {color::b, 1.5});
  d.arrow(x, p, {color::d, 2.2});
  d.arrow(x, x + Point{74, 0}, {color::ink, 2.2});
  d.arrow(p, p + Point{74, 0}, {color::ink, 1.4, "5 3"});
  const Point arm = p - x, across = turned(arm, 90);
  d.arrow(p, p + 0.42 * across, {color::c, 2.4});
  d.arrow(p, p - 0.55 * arm, {color::a, 2.6});
  d.arc(x, 34, 120, 250, {color::ink, 1.8});
  d.dot(x);
  d.dot(p);
  d.words({164, 142}, "x", Align::kRight);
  d.words({298, 82}, "p", Align::kLeft);
  d.words({126, 180}, "ω, α", Align::kMiddle);
  d.words({238, 168}, "a", Align::kMiddle);
  d.words({368, 84}, "a", Align::kLeft);
  d.words({276, 30}, "α × r", Align::kLeft, color::c, 13.5);
  d.words({196, 104}, "ω × (ω × r)", Align::kMiddle, color::a, 12.5);
  d.words({214, 146}, "r", Align::kLeft, color::d, 13.5);
  d.words({410, 116}, "a: all points of the body alike", Align::kLeft, color::ink, 12.5);
  d.words({410, 140}, "α × r: along the circle", Align::kLeft, color::c, 12.5);
  d.words({410, 164}, "ω × (ω × r): to the axis, ω^2 r", Align::kLeft, color::a, 12.5);
  d.words({410, 188}, "it is there also when ω is constant", Align::kLeft, color::soft, 12.5);
  return d;
}

}  // namespace

std::vector<Figure> figures_of_a3() { return {{"point_acceleration", point_acceleration}}; }

}  // namespace tumble::handouts
