// The drawing of a blow: which plane, which way up, and what is left out of it.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "framework/report/arms.h"

namespace tumble::report {
namespace {

// A stands 2 m above the point along n, B 1 m below it and 1 m beside.
Arms blow() {
  Arms arms;
  arms.arms = {{"r_a", {0, 0, -2}, "A"}, {"r_b", {-1, 0, 1}, "B"}};
  arms.directions = {{"n", {0, 0, 3}}};
  return arms;
}

// y of the circle that stands for a centre of mass: the n-th of the drawing.
double y_of_centre(const std::string& svg, int n) {
  std::size_t at = 0;
  for (int i = 0; i <= n; ++i) at = svg.find("<circle", at + 1);
  return std::stod(svg.substr(svg.find("cy=\"", at) + 4));
}

TEST(Arms, TheDirectionPointsUpAndLengthsAreTrue) {
  const std::string svg = svg_of(blow());
  const double a = y_of_centre(svg, 0), b = y_of_centre(svg, 1), p = y_of_centre(svg, 2);
  EXPECT_LT(a, p);  // A lies along n: above the point
  EXPECT_GT(b, p);
  EXPECT_NEAR(p - a, 2.0 * (b - p), 0.2);  // a tenth of a unit is the last digit of each
}

TEST(Arms, WhatStandsOutOfThePlaneIsSaid) {
  Arms arms = blow();
  EXPECT_EQ(out_of_plane_words(arms), "");
  arms.arms[0].arm_world = {-3, 0, -2};  // the longer part across n: it spans the plane
  arms.arms[1].arm_world = {-1, 0.5, 1};
  EXPECT_EQ(out_of_plane_words(arms), "r_b stands 0.5 m out of this plane");
}

TEST(Arms, ArmsAlongTheDirectionHaveAPlaneToo) {
  Arms arms = blow();
  arms.arms[1].arm_world = {0, 0, 1};
  EXPECT_NE(svg_of(arms).find(">r_b</text>"), std::string::npos);
  EXPECT_EQ(svg_of(arms).find("nan"), std::string::npos);
}

// A short arm beside a long one, arms along the direction, arms across it: no name covers another.
TEST(Arms, NamesStandApart) {
  for (const Eigen::Vector3d& of_a :
       {Eigen::Vector3d(0, 0, -2), {0.1, 0, 0}, {0.3, 0, -0.2}, {1, 0, -1}, {-1, 0, 0}})
    for (const Eigen::Vector3d& of_b : {Eigen::Vector3d(-1, 0, 1), {6, 3, 0}, {0, 0, 1}}) {
      Arms arms = blow();
      arms.arms[0].arm_world = of_a;
      arms.arms[1].arm_world = of_b;
      const std::string svg = svg_of(arms);
      std::vector<Eigen::Vector2d> names;
      for (std::size_t at = svg.find("<text"); at != svg.npos; at = svg.find("<text", at + 1))
        names.emplace_back(std::stod(svg.substr(svg.find("x=\"", at) + 3)),
                           std::stod(svg.substr(svg.find("y=\"", at) + 3)));
      ASSERT_EQ(names.size(), 6u);
      for (std::size_t i = 0; i < names.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          EXPECT_GT((names[i] - names[j]).norm(), 9.0)
              << i << ' ' << j << " of " << of_a.transpose() << ", " << of_b.transpose();
    }
}

TEST(Arms, NamesAreText) {
  Arms arms = blow();
  arms.arms[0].body = "<A>";
  EXPECT_NE(svg_of(arms).find("&lt;A&gt;"), std::string::npos);
}

TEST(Arms, NothingIsDrawnOfZerosOrInfinities) {
  EXPECT_TRUE(can_be_drawn(blow()));
  Arms arms = blow();
  arms.directions[0].along_world.setZero();
  EXPECT_FALSE(can_be_drawn(arms));
  arms = blow();
  arms.arms[1].arm_world.x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(can_be_drawn(arms));
  arms = blow();
  for (Arms::Arm& arm : arms.arms) arm.arm_world.setZero();
  EXPECT_FALSE(can_be_drawn(arms));
}

}  // namespace
}  // namespace tumble::report
