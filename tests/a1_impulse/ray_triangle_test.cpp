// A half-line against a closed triangle (A1.1).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

// Inputs here are small dyadic numbers, so that products and sums are exact; only a division or two
// rounds.
constexpr double kRayRoundoff = 8 * kEps;
const std::string kHandout = equation("1");

// in the plane z = 0, seen counter-clockwise from above
const Triangle kRightAngled{{0, 0, 0}, {4, 0, 0}, {0, 2, 0}};
Ray straight_down(double x, double y) { return {{x, y, 2}, {0, 0, -1}}; }

void expect_hit(const std::optional<RayHit>& found, double t, const Vector3d& weights, Story story,
                const Slips<double>& t_slips = {}, const Slips<Vector3d>& weight_slips = {}) {
  if (!found) {
    report_failure(tell(story, "a hit at t = " + show(t), "a miss", ""));
    return;
  }
  const Mistake words = story.slip;
  story.slip = likely(found->t, t_slips, words);
  expect_near(found->t, t, kRayRoundoff * std::abs(t), "lengths of d", story);
  story.slip = likely(found->barycentric, weight_slips, words);
  expect_near(found->barycentric, weights, kRayRoundoff, "(weights of a, b, c)", story);
}

void expect_miss(const Ray& ray, const Triangle& triangle, const Story& story) {
  const std::optional<RayHit> found = student().intersect_ray_triangle(ray, triangle);
  expect_true(
      !found, "a miss",
      found ? "a hit at t = " + show(found->t) + ", weights " + show(found->barycentric) : "",
      story);
}

TEST(RayTriangle, HitsInsideWithTheWeightsOfTheCorners) {
  const auto found = student().intersect_ray_triangle(straight_down(0.5, 0.75), kRightAngled);
  expect_hit(
      found, 2.0, {0.5, 0.125, 0.375},
      {.scene =
           "triangle a (0,0,0), b (4,0,0), c (0,2,0); ray from (0.5, 0.75, 2) along (0, 0, -1)",
       .slip = "the system (A1.1) or the sign of t",
       .handout = kHandout},
      {{-2.0, "the sign of t is wrong"}},
      {{{0.125, 0.375, 0.5},
        "the order of the weights is wrong: u and v of Moeller-Trumbore belong to b and c, 1 - u - "
        "v to a"},
       {{0.5, 0.375, 0.125}, "the weights of b and c are swapped"}});
}

TEST(RayTriangle, CountsInLengthsOfTheDirection) {
  const auto found = student().intersect_ray_triangle({{0.5, 0.75, 2}, {0, 0, -4}}, kRightAngled);
  expect_hit(found, 0.5, {0.5, 0.125, 0.375},
             {.scene = "triangle a (0,0,0), b (4,0,0), c (0,2,0); ray from (0.5, 0.75, 2) along "
                       "(0, 0, -4): half a length of d",
              .slip = "t counts in lengths of d as it was given",
              .handout = kHandout},
             {{2.0, "the direction was normalised: t must count in lengths of d as it was given"}});
}

TEST(RayTriangle, MissesBesideTheTriangle) {
  if (!gives_hits()) return;
  const Story story{.scene =
                        "rays straight down beside the triangle a (0,0,0), b (4,0,0), c (0,2,0), "
                        "through its plane",
                    .slip =
                        "all three weights must be >= 0: that of a (1 - u - v, beyond the long "
                        "side) is often forgotten",
                    .handout = kHandout};
  expect_miss(straight_down(3.0, 1.5), kRightAngled, story);
  expect_miss(straight_down(-0.5, 0.5), kRightAngled, story);
  expect_miss(straight_down(0.5, -0.5), kRightAngled, story);
}

TEST(RayTriangle, SeesTheBackAsWellAsTheFront) {
  const auto found = student().intersect_ray_triangle({{0.5, 0.75, -2}, {0, 0, 1}}, kRightAngled);
  expect_hit(found, 2.0, {0.5, 0.125, 0.375},
             {.scene = "the triangle from below",
              .slip = "only one sign of the determinant accepted: both faces count",
              .handout = kHandout});
}

TEST(RayTriangle, IgnoresWhatIsBehindTheOrigin) {
  if (!gives_hits()) return;
  expect_miss({{0.5, 0.75, 2}, {0, 0, 1}}, kRightAngled,
              {.scene = "a ray that starts 2 m above the triangle and goes up",
               .slip = "hits behind the origin accepted: t must be >= 0",
               .handout = kHandout});
}

TEST(RayTriangle, StartsAtItsOrigin) {
  const auto found = student().intersect_ray_triangle({{0.5, 0.75, 0}, {0, 0, 1}}, kRightAngled);
  expect_hit(found, 0.0, {0.5, 0.125, 0.375},
             {.scene = "a ray that starts on the triangle",
              .slip = "t = 0 refused: t >= 0 is a hit",
              .handout = kHandout});
}

TEST(RayTriangle, EdgesAndCornersBelongToTheTriangle) {
  const Story story{.scene =
                        "rays straight down through the middles of the edges ab, bc, ca and "
                        "through the corners a, b, c",
                    .slip = "edge hits missed: compare weights with >= 0, not > 0",
                    .handout = kHandout};
  const auto through = [&](double x, double y) {
    return student().intersect_ray_triangle(straight_down(x, y), kRightAngled);
  };
  expect_hit(through(2, 0), 2.0, {0.5, 0.5, 0}, story);
  expect_hit(through(2, 1), 2.0, {0, 0.5, 0.5}, story);
  expect_hit(through(0, 1), 2.0, {0.5, 0, 0.5}, story);
  expect_hit(through(0, 0), 2.0, {1, 0, 0}, story);
  expect_hit(through(4, 0), 2.0, {0, 1, 0}, story);
  expect_hit(through(0, 2), 2.0, {0, 0, 1}, story);
}

TEST(RayTriangle, MissesWhenParallel) {
  if (!gives_hits()) return;
  const Story story{
      .scene = "rays along x: 1 m above the plane of the triangle, and inside the plane",
      .slip = "division by zero: a ray parallel to the plane has determinant 0 and is a miss",
      .handout = kHandout};
  expect_miss({{-1, 0.5, 1}, {1, 0, 0}}, kRightAngled, story);
  expect_miss({{-1, 0.5, 0}, {1, 0, 0}}, kRightAngled, story);
}

TEST(RayTriangle, FindsATriangleOfAMicrometre) {
  // The second has a determinant of 6.6e-24: DBL_EPSILON is not small beside it, either.
  for (const double s : {0x1p-20, 0x1p-40}) {  // m
    const Triangle tiny{kRightAngled.a_world * s, kRightAngled.b_world * s,
                        kRightAngled.c_world * s};
    const auto found = student().intersect_ray_triangle(straight_down(0.5 * s, 0.75 * s), tiny);
    expect_hit(found, 2.0, {0.5, 0.125, 0.375},
               {.scene = "the triangle shrunk to " + show(4 * s) + " m",
                .slip = "an absolute epsilon on the determinant: it grows with the square of the "
                        "triangle's size, so neither 1e-9 nor DBL_EPSILON is small",
                .handout = kHandout});
  }
}

TEST(RayTriangle, FindsATriangleSeenNearlyEdgeOn) {
  const double slope = 0x1p-40;
  const auto found =
      student().intersect_ray_triangle({{-1, 0.5, 1.5 * slope}, {1, 0, -slope}}, kRightAngled);
  expect_hit(
      found, 1.5, {0.625, 0.125, 0.25},
      {.scene = "a ray that comes in along x at a slope of 2^-40 (9e-13) and meets the triangle at "
                "(0.5, 0.5, 0)",
       .slip = "an absolute epsilon on the determinant: only exactly parallel rays have none",
       .handout = kHandout});
}

// Any two triangles that share an edge; any ray aimed at a point of that edge. In exact arithmetic
// it may pass on either side by the rounding of its aim, but never between them. A test whose signs
// come from quantities that the two triangles round differently loses about one ray in ten here.
TEST(RayTriangle, LetsNothingThroughASeam) {
  Random random(1001);
  const int rays = 400;
  int lost = 0;
  for (int i = 0; i < rays; ++i) {
    const Vector3d p = random_vector(random, 1), q = random_vector(random, 1);
    const Vector3d left = random_vector(random, 1), from = random_vector(random, 3);
    const Vector3d aim = p + random.unit() * (q - p);
    // The other triangle is on the other side of the edge as seen from the eye.
    const Vector3d right = aim + (aim - left) + random.between(-0.2, 0.2) * (q - p);
    const Ray ray{from, aim - from};
    // The seam is at t = 1. The error of a hit depends on how flat the triangle is seen: 1e-3
    // distinguishes hits from arbitrary answers.
    const auto meets = [&](const Triangle& triangle) {
      const auto hit = student().intersect_ray_triangle(ray, triangle);
      return hit && std::abs(hit->t - 1.0) < 1e-3;
    };
    lost += meets({p, q, left}) || meets({q, p, right}) ? 0 : 1;
  }
  expect_true(lost == 0, "no ray lost",
              std::to_string(lost) + " of " + std::to_string(rays) + " rays lost",
              {.scene = "400 rays aimed at random points of the edge that two random triangles "
                        "share (seed 1001)",
               .slip = "the seam leaks: both triangles must compute the same number for their "
                       "common edge, up to its sign "
                       "(read about watertight tests in the hints)",
               .handout = "handouts/a1_impulse.md#hint-ray"});
}

}  // namespace
}  // namespace tumble::testing
