#include "framework/scene/die.h"

namespace tumble::scene {
namespace {

// Centres of the pips of a face as shares of the face's half edges.
std::vector<Vector2d> places_of(int count) {
  constexpr double a = 0.5;
  std::vector<Vector2d> places;
  if (count % 2 == 1) places.push_back({0, 0});
  if (count >= 2) places.insert(places.end(), {{a, a}, {-a, -a}});
  if (count >= 4) places.insert(places.end(), {{a, -a}, {-a, a}});
  if (count == 6) places.insert(places.end(), {{a, 0}, {-a, 0}});
  return places;
}

}  // namespace

std::vector<Pip> pips_of_die(const Vector3d& half_extents_body) {
  constexpr int kCount[3][2] = {{2, 5}, {4, 3}, {6, 1}};  // by axis; on its positive side, negative
  constexpr double kRadius = 0.17;                        // of the smallest half edge
  std::vector<Pip> pips;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const Vector3d normal = (side == 0 ? 1.0 : -1.0) * Vector3d::Unit(axis);
      for (const Vector2d& place : places_of(kCount[axis][side])) {
        Vector3d share = normal;
        share[(axis + 1) % 3] = place.x();
        share[(axis + 2) % 3] = place.y();
        pips.push_back({share.cwiseProduct(half_extents_body), normal,
                        kRadius * half_extents_body.minCoeff()});
      }
    }
  return pips;
}

}  // namespace tumble::scene
