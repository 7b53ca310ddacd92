// Hidden: contact problems by the thousand, and those that stacks pose.
#include "tests/a3_constraints/a3_contacts.h"

namespace tumble::a3_testing {
namespace {

Vector3d no_arm() { return Vector3d::Zero(); }

TEST(ContactForces, SolveAThousandRandomProblems) {
  Random random(351);
  for (int i = 0; i < 1000; ++i)
    expect_complementary(random_contacts(random, 1 + i % 60),
                         "random contacts, number " + std::to_string(i));
}

TEST(ContactForces, GiveTheSameMotionHoweverContactsAreListed) {
  // a = A f + b is unique although f is not: the same contacts in reverse order, and with one of
  // them listed twice.
  if (!something_is_held()) return;
  Random random(352);
  for (int i = 0; i < 60; ++i) {
    const Contacts c = random_contacts(random, 2 + i % 20);
    const Eigen::Index m = c.b.size();
    const VectorXd a = c.A * forces_of(c.A, c.b) + c.b;
    const MatrixXd reversed = c.A.reverse();
    const VectorXd b_reversed = c.b.reverse(),
                   a_reversed = (reversed * forces_of(reversed, b_reversed) + b_reversed).reverse();
    const double allowed = 1e-9 * (1 + c.b.cwiseAbs().maxCoeff());
    const Story story{
        .scene = "random contacts, number " + std::to_string(i) + ", and in reverse order",
        .slip = "who pushes depends on the order of the contacts: one of (A3.9) is not fulfilled",
        .handout = equation(9)};
    expect_near(a_reversed, a, allowed, "m/s^2 (A f + b)", story);
    MatrixXd twice(m + 1, m + 1);
    twice << c.A, c.A.col(0), c.A.row(0), c.A(0, 0);
    const VectorXd b_twice = (VectorXd(m + 1) << c.b, c.b[0]).finished(),
                   a_twice = twice * forces_of(twice, b_twice) + b_twice;
    Story other = story;
    other.scene =
        "random contacts, number " + std::to_string(i) + ", the first of them listed twice";
    expect_near(VectorXd(a_twice.head(m)), a, allowed, "m/s^2 (A f + b)", other);
  }
}

TEST(ContactForces, CarryAStackOfForty) {
  const Contacts stack = stack_of_boxes(40);
  expect_complementary(stack, "forty boxes of 1 kg on each other, four contacts each");
  expect_near(forces_of(stack.A, stack.b).head(4).sum(), 40 * kGravity, 1e-8 * 40 * kGravity, "N",
              {.scene = "forty boxes on each other: the four contacts at the bottom",
               .slip = "an iteration that stops too early",
               .handout = equation(9)});
}

TEST(ContactForces, HoldTwoHundredBallsBesideEachOther) {
  // All of them push, each with its own weight: who lets one more push at a time needs 200 rounds.
  constexpr int kBalls = 200;
  const VectorXd masses = VectorXd::LinSpaced(kBalls, 1, kBalls);
  const VectorXd found = forces_of(masses.cwiseInverse().asDiagonal().toDenseMatrix(),
                                   VectorXd::Constant(kBalls, -kGravity));
  expect_near(found, VectorXd(masses * kGravity), 1e-10 * kBalls * kGravity, "N",
              {.scene = "200 balls of 1 to 200 kg lie beside each other on the floor",
               .slip = "an iteration that stops too early: any number of contacts may have to push",
               .handout = equation(9)});
}

/// Plates of 1 m beside each other, each above points of a bumpy floor, pushed and turned: gaps are
/// left at most points, and let the plate come down there still. 3 forces hold a plate, and which 3
/// depends on the gaps.
Contacts plates_on_a_bumpy_floor(Random& random, int plates, int points) {
  Rig rig;
  rig.bodies = {ceiling()};
  for (int plate = 1; plate <= plates; ++plate) {
    const double mass = random.between(0.5, 2);
    rig.bodies.push_back(movable(mass, Vector3d(12, 12, 6).asDiagonal().toDenseMatrix() / mass));
    rig.bodies.back().free_acceleration.tail<3>() = random_vector(random, 15);
    for (int i = 0; i < points; ++i) {
      const double x = random.between(-0.5, 0.5), y = random.between(-0.5, 0.5);
      rig.rows.push_back(rod_between(plate, {x, y, 0}, 0, no_arm(), Vector3d::UnitZ()));
    }
  }
  Contacts contacts{dense_matrix(rig), accelerations_of_rows(rig, VectorXd::Zero(rig.size()))};
  for (double& b : contacts.b) b += random.between(0, 4);
  return contacts;
}

TEST(ContactForces, HoldPlatesOnABumpyFloor) {
  Random random(353);
  for (int i = 0; i < 200; ++i)
    expect_complementary(plates_on_a_bumpy_floor(random, 1 + i % 3, 8),
                         "plates on a bumpy floor, eight points each, number " + std::to_string(i));
}

TEST(ContactForces, LetABoxTipOverItsEdge) {
  // A box of 1 kg and 1 m is pushed sideways at its top: beyond half its weight it tips; the two
  // rear corners lift.
  for (const double push : {2.0, 4.9, 5.0, 8.0}) {
    Rig rig;
    rig.bodies = {ceiling(), movable(1, Matrix3d::Identity() * 6)};
    // torque about y of a force along x half a metre above the centre
    rig.bodies[1].free_acceleration[4] = push * 0.5 * 6;
    // The floor's grip, a force along -x half a metre below it, is part of what is given: no
    // sliding.
    rig.bodies[1].free_acceleration[4] += push * 0.5 * 6;
    for (int corner = 0; corner < 4; ++corner)
      rig.rows.push_back(rod_between(1, Vector3d((corner & 1) - 0.5, (corner >> 1) - 0.5, -0.5), 0,
                                     no_arm(), Vector3d::UnitZ()));
    const Contacts box{dense_matrix(rig), accelerations_of_rows(rig, VectorXd::Zero(4))};
    expect_complementary(box, "a box pushed sideways at its top with " + show(push) + " N");
    const VectorXd a = box.A * forces_of(box.A, box.b) + box.b;
    const bool tips = push > kGravity / 2;
    expect_true((a[0] > 1e-6) == tips, tips ? "its rear corners lift" : "it stands",
                "a = " + show(a) + " m/s^2",
                {.scene = "a box of 1 kg and 1 m, pushed sideways at its top with " + show(push) +
                          " N; it tips above m g / 2 = 4.905 N",
                 .slip = "who pushes: f >= 0, A f + b >= 0 and f . a = 0, all three",
                 .handout = equation(9)});
  }
}

TEST(ContactForces, BearMassesOneToAMillion) {
  // A ton on a gram on the floor: the gram's contacts carry the ton.
  Rig rig;
  rig.bodies = {ceiling(), point_mass(1e-3), point_mass(1e3)};
  rig.rows = {rod_between(1, no_arm(), 0, no_arm(), Vector3d::UnitZ()),
              rod_between(2, no_arm(), 1, no_arm(), Vector3d::UnitZ())};
  const VectorXd f = forces_of(dense_matrix(rig), accelerations_of_rows(rig, VectorXd::Zero(2)));
  expect_near(f, vector({1000.001 * kGravity, 1000 * kGravity}), 1e-8 * 1e4, "N",
              {.scene = "1,000 kg rest on 1 g, which rests on the floor",
               .slip = "a threshold that takes 1e-6 for 0, or an iteration that stops too early",
               .handout = equation(9),
               .iterates = true});
}

}  // namespace
}  // namespace tumble::a3_testing
