// Contacts of bodies that hang on rods and joints, by closed form and by the referee who knows only
// the law, on all rows.
#include <gtest/gtest.h>

#include "framework/dynamics/contact_links.h"
#include "tests/dynamics/contact_scenes.h"

namespace tumble::testing {
namespace {

void add_row(ContactProblem& problem, int a, int b, const Vector6d& of_a, const Vector6d& of_b) {
  Constraint& row = problem.rows.emplace_back();
  row.body_a = a;
  row.body_b = b;
  row.row.jacobian_a = of_a;
  row.row.jacobian_b = of_b;
}

/// The point of both bodies stays one; with an axis they turn about it alone.
void add_joint(ContactProblem& problem, int a, int b, const Vector3d& point,
               const Vector3d& axis = Vector3d::Zero()) {
  Vector6d of_a, of_b;
  for (int k = 0; k < 3; ++k) {
    const Vector3d e = Vector3d::Unit(k);
    of_a << e, (point - problem.bodies[static_cast<std::size_t>(a)].com_world).cross(e);
    of_b << -e, -(point - problem.bodies[static_cast<std::size_t>(b)].com_world).cross(e);
    add_row(problem, a, b, of_a, of_b);
  }
  if (axis.isZero(0.0)) return;
  const Vector3d across = axis.unitOrthogonal();
  for (const Vector3d& t : {across, Vector3d(axis.cross(across))}) {
    of_a << Vector3d::Zero(), t;
    add_row(problem, a, b, of_a, -of_a);
  }
}

void hold_rows_still(ContactProblem& problem) {
  problem.row_targets = VectorXd::Zero(static_cast<Eigen::Index>(problem.rows.size()));
}

/// An arm of `links` boxes from the wall (body 0) along x, bent a little at each hinge, the axes by
/// turns along y and z; on its hand, the last, lies a block of a third of its mass. It falls for a
/// step and moves besides.
ContactProblem arm_with_a_block(int links, double friction) {
  ContactProblem problem;
  problem.bodies.push_back(fixed_body());
  constexpr double kLength = 0.2, kHalfHigh = 0.05;
  Vector3d end = Vector3d::Zero();
  for (int i = 1; i <= links; ++i) {
    // the hand is level, and wide enough for the block
    const double lean = i < links ? 0.3 * std::sin(1.0 * i) : 0.0;
    const Matrix3d turn = Eigen::AngleAxisd(lean, Vector3d::UnitY()).toRotationMatrix();
    const Vector3d joint = end, way = turn * Vector3d(kLength, 0, 0);
    problem.bodies.push_back(box_body(1.0, {kLength, 0.2, 2 * kHalfHigh}, joint + 0.5 * way, turn));
    add_joint(problem, i, i - 1, joint, i % 2 == 1 ? Vector3d::UnitY() : Vector3d::UnitZ());
    end = joint + way;
  }
  const Vector3d on_hand = problem.bodies.back().com_world + Vector3d(0, 0, kHalfHigh);
  const int hand = links, block = links + 1;
  problem.bodies.push_back(box_body(0.3, {0.1, 0.1, 0.1}, on_hand + Vector3d(0, 0, 0.05)));
  add_patch(problem, block, hand, on_hand, {0.05, 0, 0}, {0, 0.05, 0}, Vector3d::UnitZ(), friction);
  let_fall(problem);
  problem.bodies.back().velocity_world += Vector3d(0.1, 0.02, 0);
  hold_rows_still(problem);
  return problem;
}

// A ball of mass M falls at speed v on the end of a rod of mass m and length L that is hinged at
// the other end: the rod is there a mass of m / 3.
TEST(ContactsOfLinks, BallOnTheEndOfAHingedRodMeetsAThirdOfItsMass) {
  constexpr double kMass = 2.0, kRod = 3.0, kLength = 1.5, kSpeed = 4.0, kRadius = 0.1;
  ContactProblem problem;
  problem.bodies = {
      fixed_body(),
      body_at(kRod, kRod * kLength * kLength / 12 * Matrix3d::Identity(), {0.5 * kLength, 0, 0}),
      ball_body(kMass, kRadius, {kLength, 0, kRadius})};
  add_joint(problem, 1, 0, Vector3d::Zero(), Vector3d::UnitY());
  hold_rows_still(problem);
  problem.contacts = {contact_at(2, 1, {kLength, 0, 0}, Vector3d::UnitZ(), 0.0)};
  problem.bodies[2].velocity_world.z() = -kSpeed;
  const ContactSolution solution = solve_contacts(problem);
  const double together = kMass / (kMass + kRod / 3) * kSpeed;
  // a few roundings of numbers of the size of the speed
  constexpr double kTolerance = 1e-14 * kSpeed;
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(solution.velocities[2].linear_world.z(), -together, kTolerance);
  EXPECT_NEAR(solution.velocities[1].angular_world.y(), together / kLength, kTolerance);
  EXPECT_NEAR(solution.impulses_world[0].z(), kRod / 3 * together, kRod * kTolerance);
  // without links it is one contact, which one sweep solves and another confirms
  EXPECT_LE(solution.sweeps, 2);
  EXPECT_EQ(solution.factorisations, 0);
}

TEST(ContactsOfLinks, BlockOnAnArmObeysTheLawWithAllRows) {
  for (const double friction : {0.0, 0.05, 0.5})
    for (const int links : {1, 2, 8, 50}) {
      const ContactProblem problem = arm_with_a_block(links, friction);
      const ContactSolution solution = solve_contacts(problem);
      EXPECT_TRUE(solution.converged) << links << " links, friction " << friction;
      // 1e-12 of the speed is asked for; the referee's unit is another by the contact's levers
      EXPECT_LE(judge(problem, solution).worst(), 1e-11)
          << links << " links, friction " << friction << ": " << judge(problem, solution);
    }
}

TEST(ContactsOfLinks, LinksLeftOutOrKeptMoveAlike) {
  ContactOptions with_rows;
  with_rows.eliminates_links = false;
  const ContactProblem problem = arm_with_a_block(8, 0.5);
  const ContactSolution without = solve_contacts(problem),
                        kept = solve_contacts(problem, with_rows);
  ASSERT_TRUE(without.converged && kept.converged);
  // what sticks moves in one way; both are solved to 1e-12 of speeds below 1 m/s
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    EXPECT_LE((without.velocities[i].linear_world - kept.velocities[i].linear_world).norm(), 1e-11);
    EXPECT_LE((without.velocities[i].angular_world - kept.velocities[i].angular_world).norm(),
              1e-10);
  }
  EXPECT_LE((without.row_impulses - kept.row_impulses).norm(), 1e-10);
}

// From the impulses of the contacts alone: those of rows follow.
TEST(ContactsOfLinks, WarmStartOfTheContactsIsTheAnswer) {
  ContactProblem problem = arm_with_a_block(8, 0.5);
  const ContactSolution solution = solve_contacts(problem);
  for (std::size_t i = 0; i < problem.contacts.size(); ++i)
    problem.contacts[i].warm_start_world = solution.impulses_world[i];
  const ContactSolution again = solve_contacts(problem);
  EXPECT_TRUE(again.converged);
  EXPECT_EQ(again.sweeps + again.factorisations, 0);
}

// Trees, loops, doubled rows, balls and hinges, with the wall or without; contacts anywhere, also
// on what joints hold.
ContactProblem random_linkage(Random& random) {
  ContactProblem problem;
  problem.bodies.push_back(fixed_body());
  const int bodies = 2 + static_cast<int>(random.below(7));
  for (int i = 1; i <= bodies; ++i) {
    const Matrix3d turn = random_rotation(random).toRotationMatrix();
    problem.bodies.push_back(box_body(random.between(0.2, 5), {0.2, 0.3, 0.4},
                                      Vector3d(0.4 * i, 0, 0) + random_vector(random, 0.1), turn));
    problem.bodies.back().velocity_world = random_vector(random, 0.3);
    problem.bodies.back().omega_world = random_vector(random, 0.3);
  }
  const auto near = [&](int body) -> Vector3d {
    return problem.bodies[static_cast<std::size_t>(body)].com_world + random_vector(random, 0.2);
  };
  const auto link = [&](int a, int b) {
    const Vector3d point = near(a), axis = random_rotation(random) * Vector3d::UnitZ();
    add_joint(problem, a, b, point, random.unit() < 0.6 ? axis : Vector3d(Vector3d::Zero()));
  };
  for (int i = 1; i <= bodies; ++i)
    if (random.unit() < 0.85) link(i, static_cast<int>(random.below(static_cast<unsigned>(i))));
  if (random.unit() < 0.3) link(bodies, 0);  // a loop
  if (random.unit() < 0.3 && !problem.rows.empty())
    problem.rows.push_back(Constraint(problem.rows.front()));
  for (int i = 1; i <= bodies; ++i)
    if (random.unit() < 0.4) {
      const int other = random.unit() < 0.5 ? 0 : 1 + i % bodies;
      const Vector3d point = near(i), normal = random_rotation(random) * Vector3d::UnitZ();
      problem.contacts.push_back(
          contact_at(i, other, point, normal, random.unit() < 0.3 ? 0.0 : 0.4));
    }
  hold_rows_still(problem);
  return problem;
}

TEST(ContactsOfLinks, RandomLinkagesObeyTheLawOrSayThatTheyDoNot) {
  int converged = 0, without_links = 0;
  constexpr int kLinkages = 400;
  Random random(41);
  for (int k = 0; k < kLinkages; ++k) {
    const ContactProblem problem = random_linkage(random);
    const contacts::System system = contacts::build_system(problem);
    if (contacts::LinkElimination(system, 0.0).is_of_use()) ++without_links;
    const ContactSolution solution = solve_contacts(problem);
    if (!solution.converged) continue;
    ++converged;
    // of 1e-12 of the speed; the referee divides by masses, of which the largest is 25 times the
    // smallest
    EXPECT_LE(judge(problem, solution).worst(), 1e-10) << k << ": " << judge(problem, solution);
  }
  EXPECT_GE(without_links, kLinkages / 4);
  // some are jammed: a contact presses a body that joints hold
  EXPECT_GE(converged, kLinkages * 9 / 10);
}

}  // namespace
}  // namespace tumble::testing
