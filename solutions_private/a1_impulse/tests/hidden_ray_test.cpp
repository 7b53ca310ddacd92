// Rays against random triangles: hits and misses are built from weights chosen beforehand.
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

const std::string kHandout = "handouts/a1_impulse.md#hint-ray";

struct Shot {
  Ray ray;
  Triangle triangle;
  double t;
  Vector3d weights;
  double conditioning;  // how much the answer moves when the inputs move, both relative
};

/// A ray that meets the plane of a random triangle at t and at the given weights.
Shot random_shot(Random& random, const Vector3d& weights) {
  for (;;) {
    Shot shot;
    shot.triangle = {random_vector(random, 1), random_vector(random, 1), random_vector(random, 1)};
    const auto& [a, b, c] = shot.triangle;
    const Vector3d aim = weights[0] * a + weights[1] * b + weights[2] * c;
    shot.ray.origin_world = random_vector(random, 3);
    shot.t = random.between(0.2, 5.0);
    shot.ray.direction_world = (aim - shot.ray.origin_world) / shot.t;
    shot.weights = weights;
    const Vector3d normal = (b - a).cross(c - a);
    // twice the area that the ray sees
    const double seen = std::abs(normal.dot(shot.ray.direction_world.normalized()));
    shot.conditioning = 30.0 / seen;
    if (seen > 0.1) return shot;  // slivers and edge-on triangles have tests of their own
  }
}

Vector3d random_inside(Random& random) {
  // At least 0.01 from every edge: rounding cannot carry the aim across.
  Vector3d w(random.between(0.05, 1), random.between(0.05, 1), random.between(0.05, 1));
  return w / w.sum();
}

TEST(HiddenRayTriangle, FindsHitsBuiltFromWeights) {
  Random random(2001);
  for (int i = 0; i < 200 && !HasFailure(); ++i) {
    const Shot shot = random_shot(random, random_inside(random));
    const auto found = student().intersect_ray_triangle(shot.ray, shot.triangle);
    const Story story{.scene = "ray " + std::to_string(i) + " of seed 2001, aimed at weights " +
                               show(shot.weights) + " of a random triangle at t = " + show(shot.t),
                      .slip = "the order of the weights, or lost digits",
                      .handout = kHandout};
    expect_true(found.has_value(), "a hit", "a miss", story);
    if (!found) return;
    // The aim is rounded to eps of the scene's size 3, which the view of the triangle amplifies.
    expect_near(found->t, shot.t, 10 * kEps * shot.conditioning * shot.t, "lengths of d", story);
    expect_near(found->barycentric, shot.weights, 10 * kEps * shot.conditioning, "(weights)",
                story);
  }
}

TEST(HiddenRayTriangle, MissesBuiltFromNegativeWeights) {
  if (!gives_hits()) return;
  Random random(2002);
  for (int i = 0; i < 200 && !HasFailure(); ++i) {
    // One or two weights at least 0.01 below zero.
    Vector3d weights = random_inside(random);
    const int k = static_cast<int>(random.below(3));
    const double shift = weights[k] + random.between(0.01, 1.0);
    weights[k] -= shift;
    weights[(k + 1) % 3] += shift;
    const Shot shot = random_shot(random, weights);
    const auto found = student().intersect_ray_triangle(shot.ray, shot.triangle);
    expect_true(
        !found, "a miss", "a hit",
        {.scene = "ray " + std::to_string(i) +
                  " of seed 2002, aimed beside a random triangle at weights " + show(weights),
         .slip = "one of the three weights is not tested",
         .handout = kHandout});
  }
}

TEST(HiddenRayTriangle, NeverLooksBack) {
  if (!gives_hits()) return;
  Random random(2003);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    Shot shot = random_shot(random, random_inside(random));
    shot.ray.direction_world *= -1.0;
    const auto found = student().intersect_ray_triangle(shot.ray, shot.triangle);
    expect_true(
        !found, "a miss", "a hit",
        {.scene = "ray " + std::to_string(i) + " of seed 2003, turned away from its triangle",
         .slip = "hits behind the origin accepted",
         .handout = kHandout});
  }
}

TEST(HiddenRayTriangle, CornersMayBeListedFromAnyOfThem) {
  Random random(2004);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const Shot shot = random_shot(random, random_inside(random));
    const auto& [a, b, c] = shot.triangle;
    const auto found = student().intersect_ray_triangle(shot.ray, {b, c, a});
    const Vector3d turned(shot.weights[1], shot.weights[2], shot.weights[0]);
    const Story story{.scene = "ray " + std::to_string(i) +
                               " of seed 2004 against a triangle listed from its second corner",
                      .slip = "the weights do not follow the corners",
                      .handout = kHandout};
    expect_true(found.has_value(), "a hit", "a miss", story);
    if (found)
      expect_near(found->barycentric, turned, 10 * kEps * shot.conditioning, "(weights)", story);
  }
}

TEST(HiddenRayTriangle, SeesFromAMillionMetres) {
  Random random(2005);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    // The far eye and the aim are dyadic, so that the ray passes exactly through (x, y, 0).
    const double x = 0.25 + 0x1p-10 * static_cast<double>(random.below(100)),
                 y = 0.25 + 0x1p-10 * static_cast<double>(random.below(100));
    const double far = 0x1p20;
    const auto found = student().intersect_ray_triangle({{x + far, y - far, far}, {-1, 1, -1}},
                                                        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Story story{.scene = "a triangle of 1 m seen from 1 800 km away, aim (" + show(x) + ", " +
                               show(y) + ", 0)",
                      .slip = "an absolute epsilon, or a limit on t",
                      .handout = kHandout};
    expect_true(found.has_value(), "a hit", "a miss", story);
    // Nothing rounds but the divisions and, in some orders of evaluation, sums of size 2^20.
    if (found) expect_near(found->t, far, 8 * kEps * far, "lengths of d", story);
    if (found)
      expect_near(found->barycentric, Vector3d(1 - x - y, x, y), 8 * kEps * far, "(weights)",
                  story);
  }
}

}  // namespace
}  // namespace tumble::testing
