#include "models/mountainside.h"

#include <cmath>
#include <numbers>

#include "framework/core/random.h"

namespace tumble::models {
namespace {

constexpr int kAlong = 24, kAcross = 10;                 // cells
constexpr double kTop = -11.4, kToe = 4.2, kWide = 6.6;  // m
constexpr double kBottom = -0.6;                         // m

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// Height of the ground without the roughness of its vertices. [m]
double height(double x, double y) {
  // tangent of the slope; half the length over which it flattens [m]
  constexpr double kSteep = 0.7, kBend = 1.2;
  const double slope = kSteep * kBend * std::log1p(std::exp(-x / kBend)) - 0.15;
  const double step = 0.3 * (1.0 + std::tanh((-4.8 - x) / 0.5));
  const double round = 2.0 * std::numbers::pi * y / kWide;
  const double relief = 0.26 * std::cos(round + 0.8 * std::sin(0.5 * x)) +
                        0.15 * std::cos(2.0 * round + 1.3 * x) +
                        0.1 * std::sin(3.0 * round - 1.9 * x);
  return slope + step + relief * sigmoid((1.0 - x) / 0.7);
}

}  // namespace

TriangleMesh mountainside() {
  Random random(5);
  TriangleMesh mesh;
  // Ground: rows downhill, the last column as rough as the first.
  const auto ground = [](int i, int j) { return i * (kAcross + 1) + j; };
  for (int i = 0; i <= kAlong; ++i) {
    const double x = kTop + (kToe - kTop) * i / kAlong;
    double first = 0.0;
    for (int j = 0; j <= kAcross; ++j) {
      const double y = kWide * (static_cast<double>(j) / kAcross - 0.5),
                   rough = j == kAcross ? first : random.between(-0.07, 0.07);
      if (j == 0) first = rough;
      mesh.vertices.push_back({x, y, height(x, y) + rough * sigmoid((1.0 - x) / 0.7)});
    }
  }
  const int base = static_cast<int>(mesh.vertices.size());
  for (const double x : {kTop, kToe})
    for (const double y : {-0.5 * kWide, 0.5 * kWide}) mesh.vertices.push_back({x, y, kBottom});
  // low and high y
  const int top_low = base, top_high = base + 1, toe_low = base + 2, toe_high = base + 3;
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const int a = ground(i, j), b = ground(i + 1, j), c = ground(i + 1, j + 1),
                d = ground(i, j + 1);
      if ((i + j) % 2 == 0) {
        mesh.faces.push_back({a, b, c});
        mesh.faces.push_back({a, c, d});
      } else {
        mesh.faces.push_back({a, b, d});
        mesh.faces.push_back({b, c, d});
      }
    }
  // Sides, ends and underside, each a fan about a corner of the bottom.
  for (int i = 0; i < kAlong; ++i) {
    mesh.faces.push_back({top_low, ground(i + 1, 0), ground(i, 0)});
    mesh.faces.push_back({top_high, ground(i, kAcross), ground(i + 1, kAcross)});
  }
  mesh.faces.push_back({top_low, toe_low, ground(kAlong, 0)});
  mesh.faces.push_back({top_high, ground(kAlong, kAcross), toe_high});
  for (int j = 0; j < kAcross; ++j) {
    mesh.faces.push_back({top_low, ground(0, j), ground(0, j + 1)});
    mesh.faces.push_back({toe_low, ground(kAlong, j + 1), ground(kAlong, j)});
  }
  mesh.faces.push_back({top_low, ground(0, kAcross), top_high});
  mesh.faces.push_back({toe_low, toe_high, ground(kAlong, kAcross)});
  mesh.faces.push_back({top_low, top_high, toe_high});
  mesh.faces.push_back({top_low, toe_high, toe_low});
  return mesh;
}

}  // namespace tumble::models
