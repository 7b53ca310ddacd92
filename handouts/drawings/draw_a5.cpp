// Drawings of assignment 5: the densities of proposals.
#include <cmath>
#include <numbers>

#include "handouts/drawings/drawing.h"

namespace tumble::handouts {
namespace {

constexpr double kShare = 0.2, kFactor = 4.0;  // of wide steps

double bell(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi); }
double mixture(double step, double size) {
  const double wide = kFactor * size;
  return (1 - kShare) * bell(step / size) / size + kShare * bell(step / wide) / wide;
}
double added(double to, double from) { return mixture(to - from, 0.3); }
double multiplied(double to, double from) { return mixture(std::log(to / from), 0.4) / to; }

Drawing proposals() {
  Drawing d(690, 270);
  const Axes left{{50, 215}, {320, 40}, -1.5, 3.5, 0, 1.2},
      right{{390, 215}, {660, 40}, 0, 4, 0, 1.2};
  left.draw(d, "x'", "q", {-1, 1, 3}, {0.5, 1});
  right.draw(d, "x'", "q", {1, 2, 3}, {0.5, 1});
  d.title({185, 24}, "add");
  d.title({525, 24}, "multiply");
  d.path(left.curve([](double to) { return added(to, 1); }, -1.5, 3.5, 200), {color::b, 2.0});
  d.path(right.curve([](double to) { return multiplied(to, 1); }, 0.02, 4, 200), {color::b, 2.0});
  d.path(right.curve([](double to) { return multiplied(to, 2); }, 0.02, 4, 200),
         {color::a, 1.6, "5 3"});
  d.dot(right.at(2, multiplied(2, 1)), color::b);
  d.dot(right.at(1, multiplied(1, 2)), color::a);
  d.line(right.at(2, 0), right.at(2, multiplied(2, 1)), {color::b, 1.0, "3 3"});
  d.line(right.at(1, 0), right.at(1, multiplied(1, 2)), {color::a, 1.0, "3 3"});
  d.words(right.at(1.15, 1.06), "q(x' | 1)", Align::kLeft, color::b, 12.5);
  d.words(right.at(2.3, 0.45), "q(x' | 2)", Align::kLeft, color::a, 12.5);
  d.words(left.at(1.45, 1.02), "q(x' | 1)", Align::kLeft, color::b, 12.5);
  d.caption({185, 256}, "a narrow and a wide proposal, mixed 4 : 1");
  d.caption({525, 256}, "back is not as probable as forth");
  return d;
}

}  // namespace

std::vector<Figure> figures_of_a5() { return {{"proposals_and_their_densities", proposals}}; }

}  // namespace tumble::handouts
