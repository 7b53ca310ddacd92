// A solid with a feature that is small compared with the other's path during its approach: the
// nearest part is not hit first.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "framework/collision/first_impact.h"

namespace tumble::testing {
namespace {

using collision::CollisionShape;
using collision::Motion;
using collision::MotionState;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Brick {
  Vector3d low, high;

  double distance(const Vector3d& p) const { return (p - p.cwiseMax(low).cwiseMin(high)).norm(); }
  void append_to(TriangleMesh& mesh) const {
    TriangleMesh surface = surface_of(Box{0.5 * (high - low)});
    const int first = static_cast<int>(mesh.vertices.size());
    for (const Vector3d& v : surface.vertices) mesh.vertices.push_back(v + 0.5 * (low + high));
    for (const Face& f : surface.faces)
      mesh.faces.push_back({first + f[0], first + f[1], first + f[2]});
  }
};

/// A ball that skims a slab and may hit a ridge on it, 1 mm wide. At t = 0 the ball is half a metre
/// before x = 0.
struct Flight {
  double radius, height, sinking, ridge_x, ridge_top;  // [m], [m], [m/s], [m], [m]
  static constexpr double kSpeed = 300.0, kStep = 1.0 / 60;

  Brick slab() const { return {{-10, -5, -1}, {10, 5, 0}}; }
  Brick ridge() const { return {{ridge_x, -5, -0.5}, {ridge_x + 0.001, 5, ridge_top}}; }
  Vector3d place(double t) const { return {-0.5 + kSpeed * t, 0.1, radius + height - sinking * t}; }

  /// By sphere tracing with the closed-form distance: it never shrinks faster than the ball's
  /// speed, so an advance by distance / speed never passes an impact.
  double truth() const {
    const double speed = std::hypot(kSpeed, sinking);
    for (double t = 0.0; t < kStep;) {
      const double gap = std::min(slab().distance(place(t)), ridge().distance(place(t))) - radius;
      if (gap < 1e-13) return t;
      t += gap / speed;
    }
    return kNever;
  }

  double found() const {
    TriangleMesh mesh;
    slab().append_to(mesh);
    ridge().append_to(mesh);
    const CollisionShape ground{MeshSolid{mesh, false}}, ball{Sphere{radius}};
    const Motion flying{[this](double t) {
                          MotionState state;
                          state.pose.com_world = place(t);
                          state.velocity_world = {kSpeed, 0, -sinking};
                          return state;
                        },
                        {}};
    const Motion still{[](double) { return MotionState{}; }, {}};
    const auto impact = collision::first_impact(ball, flying, ground, still, 0.0, kStep);
    return impact ? impact->time : kNever;
  }
};

TEST(Ridge, BallThatSkimsASlabHitsTheRidgeFirst) {
  int on_ridge = 0, cases = 0;
  for (const double radius : {0.0005, 0.01, 0.1})
    for (const double height : {0.0005, 0.002, 0.01})
      for (const double sinking : {0.05, 0.3, 2.0})
        for (const double part : {0.05, 0.25, 0.5, 0.9})
          for (const double ridge_x : {0.5, 1.24, 1.98, 2.72}) {
            const Flight flight{radius, height, sinking, ridge_x, height + part * radius};
            const double truth = flight.truth(), found = flight.found();
            ++cases;
            if (truth < kNever && flight.ridge().distance(flight.place(truth)) - radius < 1e-9)
              ++on_ridge;
            // The reference stops within 1e-13 m of touching; at an angle of incidence of 1e-2 or
            // more that is 1e-11 m along the path, at 300 m/s.
            if (found == truth) continue;  // also where neither finds an impact
            EXPECT_NEAR(found, truth, 1e-11)
                << "radius " << radius << ", height " << height << ", sinking " << sinking
                << ", ridge at " << ridge_x << " up to " << flight.ridge_top;
          }
  EXPECT_EQ(cases, 432);
  EXPECT_GT(on_ridge, 200);
}

}  // namespace
}  // namespace tumble::testing
