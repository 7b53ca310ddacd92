// One body, or a few, in contact: every number known on paper.
#include <gtest/gtest.h>

#include "tests/dynamics/contact_scenes.h"

namespace tumble::testing {
namespace {

constexpr double kRelative = 1e-12;  // the solver's own tolerance

TEST(ContactProblem, BlockBelowTheFrictionAngleSticks) {
  const double angle = 0.4, mass = 3;
  const ContactProblem problem = box_on_slope(mass, angle, std::tan(angle) * 1.1);
  const ContactSolution solution = solve_contacts(problem);
  EXPECT_TRUE(solution.converged);
  const double weight = mass * kGravity * kStep;
  const Vector3d total = sum_of_impulses(solution, 0, 4);
  const Vector3d down_slope(std::cos(angle), 0, -std::sin(angle));
  EXPECT_NEAR(total.dot(down_slope), -weight * std::sin(angle), kRelative * weight);
  EXPECT_NEAR(total.z(), weight, kRelative * weight);
  EXPECT_LE(solution.velocities[1].linear_world.norm(), kRelative * kGravity * kStep);
  EXPECT_LE(judge(problem, solution).worst(), 4 * kRelative * kGravity * kStep);
}

TEST(ContactProblem, BlockAtTheFrictionAngleSticks) {
  const double angle = std::atan(0.5);
  const ContactProblem problem = box_on_slope(3, angle, 0.5);
  const ContactSolution solution = solve_contacts(problem);
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(solution.velocities[1].linear_world.norm(), 1e-11 * kGravity * kStep);
}

TEST(ContactProblem, BlockAboveTheFrictionAngleSlides) {
  const double angle = std::atan(0.5), mass = 3, mu = 0.49;
  const ContactProblem problem = box_on_slope(mass, angle, mu);
  const ContactSolution solution = solve_contacts(problem);
  EXPECT_TRUE(solution.converged);
  const Vector3d down_slope(std::cos(angle), 0, -std::sin(angle));
  const double speed = kGravity * kStep * (std::sin(angle) - mu * std::cos(angle));  // a = g (sin a - mu cos a)
  EXPECT_NEAR(solution.velocities[1].linear_world.dot(down_slope), speed, kRelative * kGravity * kStep);
  EXPECT_NEAR(sum_of_impulses(solution, 0, 4).dot(down_slope), -mu * mass * kGravity * kStep * std::cos(angle), kRelative * mass);
  EXPECT_LE(judge(problem, solution).worst(), 4 * kRelative * kGravity * kStep);
}

TEST(ContactProblem, StackOfTenCarriesItsWeight) {
  const ContactProblem problem = stack_of_boxes(std::vector<double>(10, 1.0));
  const ContactSolution solution = solve_contacts(problem);
  EXPECT_TRUE(solution.converged) << solution.residual;
  const double weight = 10 * kGravity * kStep;
  EXPECT_NEAR(sum_of_impulses(solution, 0, 4).z(), weight, 1e-9 * weight);
  EXPECT_LE(judge(problem, solution).worst(), 1e-11 * kGravity * kStep);
}

}  // namespace
}  // namespace tumble::testing
