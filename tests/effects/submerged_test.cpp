// How much of a solid lies under a plane, against closed forms and against itself.
#include "tests/support/places.h"
#include "framework/effects/water/submerged.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/scene/build_shape.h"

namespace tumble::effects {
namespace {

constexpr double kEps = 2.3e-16;
constexpr double kRounding = 1e-13;  // of a moment: some hundred roundings of a sum over faces

Vector3d drawn_direction(Random& random) {
  Vector3d direction;
  do direction = Vector3d(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  while (direction.norm() < 0.1 || direction.norm() > 1.0);
  return direction.normalized();
}

Floatable model(const char* file) {
  scene::BodySpec spec;
  spec.name = file;
  spec.shape = scene::ModelSpec{file, "", 1.0};
  spec.mass_kg = 1.0;
  return Floatable(scene::build_solid(spec, {}, test::source_dir()).shape);
}

TEST(Submerged, BallIsTheSphericalCap) {
  const double R = 0.7;
  for (const double h : {0.0, 0.1, 0.35, 0.7, 1.0, 1.4}) {
    const Submerged cap = submerged_ball(R, Vector3d::UnitZ(), h - R);
    // below the centre
    const double volume = std::numbers::pi * h * h * (3 * R - h) / 3,
                 middle = h > 0 ? 0.75 * (2 * R - h) * (2 * R - h) / (3 * R - h) : 0.0;
    EXPECT_NEAR(cap.volume, volume, 20 * kEps * R * R * R) << h;
    EXPECT_NEAR(cap.first.z(), -volume * middle, 20 * kEps * std::pow(R, 4)) << h;
  }
  const Submerged whole = submerged_ball(R, Vector3d::UnitX(), 5.0);
  EXPECT_LE((whole.second - whole.volume * R * R / 5 * Matrix3d::Identity()).norm(),
            20 * kEps * std::pow(R, 5));
}

TEST(Submerged, CornerOfACubeIsATetrahedron) {
  const double edge = 0.3;
  const Floatable cube(Box{Vector3d::Constant(0.5)});
  const Submerged corner =
      cube.under(Vector3d::Ones().normalized(), (-1.5 + edge) / std::sqrt(3.0));
  EXPECT_NEAR(corner.volume, std::pow(edge, 3) / 6, kRounding);
  EXPECT_LE((corner.first / corner.volume - Vector3d::Constant(-0.5 + edge / 4)).norm(),
            kRounding / corner.volume);
}

TEST(Submerged, BoxUnderALevelIsABox) {
  const Floatable box(Box{{0.5, 0.4, 0.15}});
  const Submerged lower = box.under(Vector3d::UnitZ(), 0.03);  // 0.18 m high, its middle at -0.06
  const Vector3d size(1.0, 0.8, 0.18);
  EXPECT_NEAR(lower.volume, size.prod(), kRounding);
  EXPECT_LE((lower.first / lower.volume - Vector3d(0, 0, -0.06)).norm(), kRounding);
  const Matrix3d about_middle =
      lower.second - lower.volume * Vector3d(0, 0, -0.06) * Vector3d(0, 0, -0.06).transpose();
  EXPECT_LE((about_middle - Matrix3d((size.prod() / 12 * size.cwiseAbs2()).asDiagonal())).norm(),
            kRounding);
}

// What lies on both sides of a plane makes the whole, in every moment; of solids that are hollow in
// places, too.
TEST(Submerged, BothSidesMakeTheWhole) {
  Random random(7);
  for (const Floatable& solid :
       {Floatable(Box{{0.5, 0.2, 0.1}}), model("gear.3ds"), model("chess_pawn.3ds"),
        Floatable(Ellipsoid{{0.5, 0.3, 0.2}, {0.1, 0, -0.1}})}) {
    const Submerged& whole = solid.whole();
    const double r = solid.radius();
    for (int i = 0; i < 50; ++i) {
      const Vector3d normal = drawn_direction(random);
      const double offset = random.between(-1.2, 1.2) * r;
      const Submerged below = solid.under(normal, offset), above = solid.under(-normal, -offset);
      EXPECT_NEAR(below.volume + above.volume, whole.volume, kRounding * r * r * r);
      EXPECT_LE((below.first + above.first - whole.first).norm(), kRounding * std::pow(r, 4));
      EXPECT_LE((below.second + above.second - whole.second).norm(), kRounding * std::pow(r, 5));
    }
  }
}

// An ellipsoid of equal axes is a ball.
TEST(Submerged, EllipsoidOfEqualAxesIsABall) {
  const Vector3d normal = Vector3d(1, 2, -2).normalized();
  const Submerged ball = submerged_ball(0.4, normal, 0.1),
                  same = submerged_ellipsoid({Vector3d::Constant(0.4)}, normal, 0.1);
  EXPECT_NEAR(ball.volume, same.volume, 50 * kEps);
  EXPECT_LE((ball.first - same.first).norm() + (ball.second - same.second).norm(), 50 * kEps);
}

}  // namespace
}  // namespace tumble::effects
