// Drawings of assignment 1: from a click to a force, surfaces, the inertia tensor, contacts,
// impulses.
#include <cmath>
#include <numbers>

#include "handouts/drawings/drawing.h"

namespace tumble::handouts {
namespace {

const Pen kThin{color::soft, 1.0};
const Pen kDashed{color::soft, 1.2, "4 3"};

Drawing click_to_force() {
  Drawing d(640, 270);
  const Point eye{60, 40}, a{300, 210}, b{420, 70}, c{470, 225}, p{388, 168}, x{520, 160};
  // The body: the triangle that is hit, and the rest of its surface.
  d.area({a, b, {540, 62}, {600, 130}, {590, 215}, c}, color::b_wash, {color::b, 1.5});
  d.area({a, b, c}, "#bcd2e4", {color::b, 2.0});
  for (const Point far : {Point{540, 62}, Point{600, 130}, Point{590, 215}})
    d.line(far, far.y > 200 ? c : b, {color::b, 0.8});
  // The ray.
  d.line(eye, p, {color::ink, 1.2});
  d.arrow(eye, eye + 0.34 * (p - eye), {color::ink, 2.4});
  d.area({{118, 38}, {118, 96}, {132, 112}, {132, 54}}, "#ffffffcc", kThin);
  d.dot(eye);
  // Force, arm.
  d.arrow({280, 108}, p, {color::a, 3.0});
  d.line(x, p, {color::d, 1.2});
  d.arrow(x, p, {color::d, 2.2});
  d.dot(p);
  d.dot(x, color::d);
  d.words({60, 28}, "eye o");
  d.words({166, 74}, "d", Align::kLeft, color::ink, 14);
  d.words({126, 128}, "pixel", Align::kMiddle, color::soft, 12);
  d.words({288, 216}, "a", Align::kRight);
  d.words({414, 60}, "b");
  d.words({474, 242}, "c");
  d.words({376, 190}, "p = o + t d");
  d.words({300, 100}, "F", Align::kRight, color::a, 15, true);
  d.words({460, 152}, "r = p − x", Align::kMiddle, color::d);
  d.words({530, 176}, "x", Align::kLeft, color::d);
  d.words({60, 196}, "force on the centre of mass: F, all of it", Align::kLeft, color::a, 12.5);
  d.words({60, 218}, "torque about it: τ = r × F", Align::kLeft, color::d, 12.5);
  d.words({60, 240}, "nearest hit: the smallest t ≥ 0", Align::kLeft, color::ink, 12.5);
  return d;
}

Drawing contact_normals_2d() {
  Drawing d(640, 240);
  // (a) a corner of A on an edge of B
  d.area({{30, 150}, {190, 150}, {190, 200}, {30, 200}}, color::b_wash, {color::b, 1.5});
  d.area({{110, 148}, {60, 72}, {150, 60}}, color::a_wash, {color::a, 1.5});
  d.arrow({110, 149}, {110, 92}, {color::ink, 2.2});
  d.words({118, 104}, "n", Align::kLeft, color::ink, 14);
  d.words({76, 76}, "A", Align::kMiddle, color::a, 14, true);
  d.words({46, 192}, "B", Align::kMiddle, color::b, 14, true);
  // (b) an edge on an edge
  d.area({{240, 150}, {400, 150}, {400, 200}, {240, 200}}, color::b_wash, {color::b, 1.5});
  d.area({{275, 148}, {275, 70}, {365, 70}, {365, 148}}, color::a_wash, {color::a, 1.5});
  d.line({275, 149}, {365, 149}, {color::ink, 3.2});
  d.arrow({320, 149}, {320, 92}, {color::ink, 2.2});
  d.words({328, 104}, "n", Align::kLeft, color::ink, 14);
  d.words({287, 88}, "A", Align::kMiddle, color::a, 14, true);
  d.words({256, 192}, "B", Align::kMiddle, color::b, 14, true);
  // (c) a corner on a corner: two choices
  const Point corner{520, 128}, xa{560, 52}, xb{500, 196};
  d.area({corner, {474, 170}, {452, 214}, {560, 214}, {606, 148}}, color::b_wash, {color::b, 1.5});
  d.area({corner, {520, 40}, {606, 40}, {606, 84}}, color::a_wash, {color::a, 1.5});
  d.line(xb, xa, kDashed);
  const Point along = xa - xb;
  const double length = std::hypot(along.x, along.y);
  d.arrow(corner, corner + (56 / length) * along, {color::ink, 2.2});
  // The mean of the outward normals of B's two edges there.
  const Point left = turned({474 - 520.0, 170 - 128.0}, -90),
              right = turned({606 - 520.0, 148 - 128.0}, 90);
  const Point sum =
      (1 / std::hypot(left.x, left.y)) * left + (1 / std::hypot(right.x, right.y)) * right;
  d.arrow(corner, corner + (56 / std::hypot(sum.x, sum.y)) * sum, {color::d, 2.2, "5 3"});
  d.dot(corner);
  d.dot(xa, color::a);
  d.dot(xb, color::b);
  d.words({570, 48}, "x_a", Align::kLeft, color::a);
  d.words({490, 206}, "x_b", Align::kRight, color::b);
  d.words({552, 98}, "n", Align::kLeft, color::ink, 14);
  d.words({500, 84}, "n_2", Align::kRight, color::d, 14);
  d.caption({110, 228}, "(a) vertex on edge");
  d.caption({320, 228}, "(b) edge on edge");
  d.caption({530, 234}, "(c) vertex on vertex: two choices");
  return d;
}

Drawing inertia_tensor() {
  Drawing d(640, 250);
  // Left: a body as masses m_i at arms r_i.
  const Point x{165, 140};
  std::vector<Point> outline;
  for (int i = 0; i < 60; ++i) {
    const double t = 2 * std::numbers::pi * i / 60,
                 r = 1 + 0.12 * std::cos(3 * t + 0.6) + 0.06 * std::sin(2 * t);
    outline.push_back({x.x + 112 * r * std::cos(t), x.y + 74 * r * std::sin(t)});
  }
  d.area(outline, color::b_wash, {color::b, 1.5});
  for (const Point m : {Point{105, 112}, Point{140, 175}, Point{205, 100}, Point{235, 150},
                        Point{190, 182}, Point{130, 86}})
    d.ball(m, 4, "#9db9d0", {color::b, 0.8});
  const Point m{238, 118};
  d.ball(m, 6, color::a, {color::a, 1});
  d.arrow(x, m, {color::d, 2.2});
  d.arrow(m, m + Point{20, -48}, {color::a, 2.2});
  d.dot(x);
  d.arc(x, 26, 200, 330, {color::ink, 1.8});
  d.words({158, 132}, "x", Align::kRight);
  d.words({156, 186}, "ω", Align::kMiddle, color::ink, 14);
  d.words({204, 122}, "r_i", Align::kMiddle, color::d, 14);
  d.words({250, 128}, "m_i", Align::kLeft, color::a);
  d.words({266, 74}, "v_i = ω × r_i", Align::kLeft, color::a);
  d.caption({165, 240}, "L = Σ r_i × m_i v_i = I ω");
  // Right: parallel axes.
  d.area({{430, 90}, {520, 90}, {520, 190}, {430, 190}}, color::b_wash, {color::b, 1.5});
  const Point c{475, 140}, p{585, 140};
  d.line({475, 50}, {475, 212}, {color::ink, 1.3, "7 3 2 3"});
  d.line({585, 50}, {585, 212}, {color::a, 1.3, "7 3 2 3"});
  d.arrow(c, p, {color::d, 2.2});
  d.arrow(p, c, {color::d, 2.2});
  d.dot(c);
  d.dot(p, color::a);
  d.words({530, 130}, "d", Align::kMiddle, color::d, 14);
  d.words({455, 40}, "I about the centre of mass");
  d.words({636, 40}, "I + m d^2", Align::kRight, color::a);
  d.caption({520, 240}, "parallel axes");
  return d;
}

/// Faces of a unit cube that stand before the eye, each as four corners; what is left out shows the
/// inside.
void cube(Drawing& d, const Oblique& view, const std::vector<int>& faces,
          const std::string& outside = color::b_wash, const std::string& inside = "#c9d9e6",
          const std::string& edges = color::b) {
  const std::vector<std::vector<Point>> all = {
      {view.at(0, 0, 0), view.at(1, 0, 0), view.at(1, 1, 0), view.at(0, 1, 0)},
      {view.at(0, 1, 0), view.at(1, 1, 0), view.at(1, 1, 1), view.at(0, 1, 1)},
      {view.at(0, 0, 0), view.at(0, 1, 0), view.at(0, 1, 1), view.at(0, 0, 1)},
      {view.at(0, 0, 0), view.at(1, 0, 0), view.at(1, 0, 1), view.at(0, 0, 1)},
      {view.at(1, 0, 0), view.at(1, 1, 0), view.at(1, 1, 1), view.at(1, 0, 1)},
      {view.at(0, 0, 1), view.at(1, 0, 1), view.at(1, 1, 1), view.at(0, 1, 1)}};
  for (const int face : faces)
    d.area(all[static_cast<std::size_t>(face)], face < 3 ? inside : outside, {edges, 1.3});
}

Drawing broken_surfaces() {
  Drawing d(640, 190);
  const Pen wrong{color::a, 3.0};
  const auto name = [&](double x, const std::string& first, const std::string& second) {
    d.words({x, 158}, first, Align::kMiddle, color::ink, 12.5);
    d.words({x, 175}, second, Align::kMiddle, color::soft, 11);
  };
  // One polygon: four open edges.
  const Oblique one{{18, 96}, 66};
  d.area({one.at(0, 0, 0), one.at(1, 0, 0), one.at(1, 1, 0), one.at(0, 1, 0)}, color::b_wash,
         {color::b, 1.3});
  d.path({one.at(0, 0, 0), one.at(1, 0, 0), one.at(1, 1, 0), one.at(0, 1, 0), one.at(0, 0, 0)},
         wrong);
  name(66, "single polygon", "single\\_polygon.3ds");
  // A terrain: open all round.
  const Oblique land{{140, 104}, 68};
  const auto height = [](double x, double y) { return 0.18 * std::sin(6 * x) * std::cos(5 * y); };
  constexpr int kCells = 6;
  for (int j = kCells - 1; j >= 0; --j)
    for (int i = 0; i < kCells; ++i) {
      const auto at = [&](int k, int l) {
        return land.at(k / 6.0, l / 6.0, height(k / 6.0, l / 6.0));
      };
      d.area({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)},
             (i + j) % 2 == 0 ? color::b_wash : "#c9d9e6", {color::b, 0.7});
    }
  std::vector<Point> rim;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < 12; ++i) {
      const double s = i / 12.0,
                   x = side == 0   ? s
                       : side == 1 ? 1
                       : side == 2 ? 1 - s
                                   : 0,
                   y = side == 0   ? 0
                       : side == 1 ? s
                       : side == 2 ? 1
                                   : 1 - s;
      rim.push_back(land.at(x, y, height(x, y)));
    }
  rim.push_back(rim.front());
  d.path(rim, wrong);
  name(190, "terrain", "terrain.3ds");
  // A box without its lid.
  const Oblique open{{272, 112}, 58};
  cube(d, open, {0, 1, 2, 3, 4});
  d.path({open.at(0, 0, 1), open.at(1, 0, 1), open.at(1, 1, 1), open.at(0, 1, 1), open.at(0, 0, 1)},
         wrong);
  name(315, "a face is missing", "missing\\_face.3ds");
  // A lampshade: open at both ends.
  const Point mid{445, 90};
  const auto ring = [&](double y, double r, double from, double to) {
    std::vector<Point> points;
    for (int i = 0; i <= 30; ++i) {
      const double t = (from + (to - from) * i / 30) * std::numbers::pi / 180;
      points.push_back({mid.x + r * std::cos(t), mid.y + y + 0.32 * r * std::sin(t)});
    }
    return points;
  };
  std::vector<Point> shade = ring(40, 46, 0, 180), top = ring(-46, 22, 180, 0);
  shade.insert(shade.end(), top.begin(), top.end());
  d.area(ring(40, 46, 0, 360), "#c9d9e6", {color::b, 1});
  d.area(shade, color::b_wash, {color::b, 1.3});
  d.area(ring(-46, 22, 0, 360), "#c9d9e6", {color::b, 1});
  d.path(ring(-46, 22, 0, 360), wrong);
  d.path(ring(40, 46, 0, 360), wrong);
  name(445, "lampshade", "lampshade.3ds");
  // Three faces at one edge.
  const Oblique fin{{522, 112}, 58};
  cube(d, fin, {3, 4, 5});
  d.area({fin.at(1, 0, 1), fin.at(1, 1, 1), fin.at(1.1, 1, 1.62), fin.at(1.1, 0, 1.62)},
         color::c_wash, {color::c, 1.3});
  d.line(fin.at(1, 0, 1), fin.at(1, 1, 1), wrong);
  name(566, "three faces at an edge", "edge\\_of\\_three\\_faces.3ds");
  return d;
}

Drawing contact_types_3d() {
  Drawing d(640, 190);
  const Pen edge_a{color::a, 1.3}, edge_b{color::b, 1.3};
  const auto floor = [&](double x) {
    d.area({{x - 50, 118}, {x + 10, 138}, {x + 52, 104}, {x - 8, 86}}, color::b_wash, edge_b);
  };
  const auto normal = [&](Point from, double length = 46) {
    d.arrow(from, from - Point{0, length}, {color::ink, 2.0});
  };
  const auto name = [&](double x, const std::string& text, const std::string& points) {
    d.words({x, 164}, text, Align::kMiddle, color::ink, 12);
    d.words({x, 180}, points, Align::kMiddle, color::soft, 11);
  };
  // vertex on face
  floor(56);
  d.area({{58, 112}, {32, 66}, {64, 54}}, color::a_wash, edge_a);
  d.area({{58, 112}, {64, 54}, {90, 70}}, "#efc4ca", edge_a);
  normal({58, 112}, 82);
  d.dot({58, 112}, color::a);
  name(56, "vertex–face", "1 point");
  // edge across edge
  d.area({{108, 118}, {206, 94}, {210, 118}, {112, 142}}, color::b_wash, edge_b);
  d.line({108, 118}, {206, 94}, {color::b, 2.6});
  d.area({{128, 84}, {182, 126}, {186, 100}, {132, 58}}, color::a_wash, edge_a);
  d.line({128, 84}, {182, 126}, {color::a, 2.6});
  normal({153, 106}, 74);
  d.dot({153, 106});
  name(160, "edge–edge, crossed", "1 point");
  // edge on face
  floor(266);
  d.area({{240, 112}, {280, 120}, {286, 72}, {246, 64}}, color::a_wash, edge_a);
  d.area({{280, 120}, {286, 72}, {304, 62}}, "#efc4ca", edge_a);
  d.line({240, 112}, {280, 120}, {color::ink, 3});
  normal({260, 116}, 84);
  d.dot({240, 112}, color::a);
  d.dot({280, 120}, color::a);
  name(266, "edge–face", "2 points");
  // face on face
  floor(374);
  const Oblique box{{346, 108}, 34};
  cube(d, box, {3, 4, 5}, color::a_wash, "#efc4ca", color::a);
  d.area({box.at(0, 0, 0), box.at(1, 0, 0), box.at(1, 1, 0), box.at(0, 1, 0)}, "#d1495b55",
         {color::a, 1.5});
  for (const Point p : {box.at(0, 0, 0), box.at(1, 0, 0), box.at(1, 1, 0), box.at(0, 1, 0)})
    d.dot(p, color::a);
  normal(box.at(0.5, 0.5, 0.3), 80);
  name(374, "face–face", "3 or more points");
  // degenerate: vertex on edge
  d.area({{432, 122}, {530, 98}, {534, 122}, {436, 146}}, color::b_wash, edge_b);
  d.line({432, 122}, {530, 98}, {color::b, 2.6});
  d.area({{482, 109}, {458, 62}, {500, 54}}, color::a_wash, edge_a);
  d.dot({482, 109});
  d.arrow({482, 109}, {466, 56}, {color::ink, 1.6, "4 3"});
  d.arrow({482, 109}, {504, 62}, {color::ink, 1.6, "4 3"});
  name(484, "vertex–edge", "degenerate");
  // degenerate: vertex on vertex
  d.area({{590, 100}, {558, 136}, {616, 142}}, color::b_wash, edge_b);
  d.area({{590, 100}, {566, 54}, {612, 60}}, color::a_wash, edge_a);
  d.dot({590, 100});
  d.arrow({590, 100}, {570, 48}, {color::ink, 1.6, "4 3"});
  d.arrow({590, 100}, {614, 52}, {color::ink, 1.6, "4 3"});
  name(590, "vertex–vertex", "degenerate");
  d.line({426, 24}, {426, 150}, {color::line, 1, "3 3"});
  d.words({210, 18}, "n is determined", Align::kMiddle, color::soft, 12);
  d.words({536, 18}, "a choice of n", Align::kMiddle, color::soft, 12);
  return d;
}

Drawing force_and_impulse() {
  Drawing d(640, 250);
  const Axes force{{50, 200}, {290, 40}, 0, 1, 0, 8.4},
      speed{{370, 200}, {610, 40}, 0, 1, -1.3, 1.3};
  force.draw(d, "t", "force on the ball", {}, {});
  speed.draw(d, "t", "velocity of the ball", {}, {});
  d.line({370, 120}, {615, 120}, {color::line, 1});
  const struct {
    double duration;
    std::string color, name;
  } pushes[] = {{0.5, color::b, "0.5"}, {0.25, color::d, "0.25"}, {0.125, color::c, "0.125"}};
  for (const auto& push : pushes) {
    const double from = 0.5 - push.duration / 2, to = 0.5 + push.duration / 2,
                 height = 1.0 / push.duration;
    d.area({force.at(from, 0), force.at(from, height), force.at(to, height), force.at(to, 0)},
           push.color + "30", {push.color, 1.6});
    d.path({speed.at(0, -1), speed.at(from, -1), speed.at(to, 1), speed.at(1, 1)},
           {push.color, 1.8});
  }
  d.words(force.at(0.5, 8.15) + Point{16, 4}, "a quarter of the time: 4 F", Align::kLeft, color::c,
          11);
  d.words(force.at(0.65, 4.3), "half of the time: 2 F", Align::kLeft, color::d, 11);
  d.words(force.at(0.78, 2.25), "F; area = J", Align::kLeft, color::b, 11);
  d.path({speed.at(0, -1), speed.at(0.5, -1), speed.at(0.5, 1), speed.at(1, 1)},
         {color::a, 2.6, "6 4"});
  d.words(speed.at(0.53, -0.9), "impulse: at once", Align::kLeft, color::a, 12);
  d.words(speed.at(0, 0) - Point{6, -4}, "0", Align::kRight, color::soft, 11.5);
  d.caption({170, 236}, "the same area, ever shorter");
  d.caption({490, 236}, "the same change J/m of the velocity");
  return d;
}

}  // namespace

std::vector<Figure> figures_of_a1() {
  return {{"click_to_force", click_to_force},     {"broken_surfaces", broken_surfaces},
          {"inertia_tensor", inertia_tensor},     {"contact_normals_2d", contact_normals_2d},
          {"contact_types_3d", contact_types_3d}, {"force_and_impulse", force_and_impulse}};
}

}  // namespace tumble::handouts
