// Forces of resting contacts without friction (A3.9).
#include "tests/a3_constraints/a3_contacts.h"

namespace tumble::a3_testing {
namespace {

TEST(ContactForces, HoldABallOnTheFloor) {
  const VectorXd found = forces_of(MatrixXd::Constant(1, 1, 0.5), vector({-kGravity}));
  expect_near(
      found, vector({2 * kGravity}), 10 * kEps * 2 * kGravity, "N",
      {.scene = "a ball of 2 kg rests on the floor: A = 0.5 / kg, b = -9.81 m/s^2",
       .slip = likely<VectorXd>(
           found,
           Slips<VectorXd>{
               {vector({-2 * kGravity}),
                "the sign of the force is wrong: the floor pushes, f = -b / A"},
               {vector({0}), "the sign of b is wrong: b < 0 is a contact that would be entered"}},
           "A f + b = 0"),
       .handout = equation(9)});
}

TEST(ContactForces, DoNotHoldBackWhatLeaves) {
  if (!something_is_held()) return;
  const VectorXd found = forces_of(MatrixXd::Constant(1, 1, 0.5), vector({3}));
  expect_near(found, vector({0}), 0.0, "N",
              {.scene = "a ball of 2 kg is lifted off the floor: A = 0.5 / kg, b = +3 m/s^2",
               .slip = "negative forces: a contact pushes, it never pulls",
               .handout = equation(9)});
}

TEST(ContactForces, PushOnlyAtTheEndThatWouldSink) {
  const MatrixXd A = (MatrixXd(2, 2) << 2, 1, 1, 2).finished();
  const VectorXd found = forces_of(A, vector({-1, 1}));
  expect_near(
      found, vector({0.5, 0}), 20 * kEps, "N",
      {.scene = "A = (2, 1; 1, 2), b = (-1, 1): a plank of which one end sinks and the other lifts",
       .slip = likely<VectorXd>(
           found,
           Slips<VectorXd>{
               {vector({1, -1}),
                "negative forces: a contact pushes, it never pulls; A f = -b is not the problem"},
               {vector({1, 0}),
                "the solution of A f = -b, cut off at 0: once the second force is gone, the first "
                "must be found anew"},
               {vector({1.0 / 2, 1.0 / 2}), "the absolute values of forces"}},
           "f . a = 0: where a force acts, nothing parts"),
       .handout = equation(9)});
}

TEST(ContactForces, ChooseWhoPushesAmongThree) {
  // By hand: 1 and 3 push. An algorithm that removes contacts in the wrong order ends with 2.
  const MatrixXd A = (MatrixXd(3, 3) << 4, 3, 1, 3, 4, 3, 1, 3, 4).finished();
  const VectorXd b = vector({-5, -4, -5});
  const VectorXd found = forces_of(A, b);
  expect_near(found, vector({1, 0, 1}), 50 * kEps, "N",
              {.scene = "A = (4, 3, 1; 3, 4, 3; 1, 3, 4), b = (-5, -4, -5): three contacts, the "
                        "middle one of which parts as the outer ones are held",
               .slip = found.size() == 3 && found.allFinite() && found.minCoeff() < 0
                           ? "negative forces: a contact pushes, it never pulls"
                           : "which contacts push: f >= 0, A f + b >= 0 and f . a = 0, all three",
               .handout = equation(9)});
}

TEST(ContactForces, CarryABoxOnFourCorners) {
  const Contacts box = stack_of_boxes(1);
  const VectorXd found = forces_of(box.A, box.b);
  const Story story{
      .scene = "a box of 1 kg rests on its four corners: A has rank 3",
      .slip = "redundant contacts: any share is right, but the sum is the weight",
      .handout = equation(9),
      .no_number = "redundant contacts: A is singular, and a pivot of 0 is divided by",
      .iterates = true};
  expect_near(found.sum(), kGravity, 1e-10 * kGravity, "N (sum)", story);
  expect_true(found.minCoeff() >= 0, "no force < 0", show(found) + " N", story);
  expect_near(VectorXd(box.A * found + box.b), VectorXd::Zero(4), 1e-10 * kGravity, "m/s^2 (a)",
              story);
}

TEST(ContactForces, CarryAStackOfTen) {
  const Contacts stack = stack_of_boxes(10);
  expect_complementary(stack,
                       "ten boxes of 1 kg on each other, four contacts each: 40 contacts, rank 30");
  const VectorXd found = forces_of(stack.A, stack.b);
  expect_near(found.head(4).sum(), 10 * kGravity, 1e-9 * kGravity, "N",
              {.scene = "ten boxes of 1 kg on each other: the four contacts at the bottom",
               .slip = "an iteration that stops too early, or the wrong contacts push",
               .handout = equation(9)});
}

TEST(ContactForces, CarryAHeavyBoxOnALightOne) {
  // A ton on ten grams, on four corners each. Sweeps over single contacts transfer 1e-5 of the
  // weight each: after 10,000 a tenth is carried.
  constexpr double kLight = 1e-2, kHeavy = 1e3;
  Rig rig;
  rig.bodies = {ceiling(), movable(kLight, Matrix3d::Identity() * 6 / kLight),
                movable(kHeavy, Matrix3d::Identity() * 6 / kHeavy)};
  for (int i = 1; i <= 2; ++i)
    for (int corner = 0; corner < 4; ++corner) {
      const Vector3d below((corner & 1) - 0.5, (corner >> 1) - 0.5, -0.5);
      rig.rows.push_back(
          rod_between(i, below, i - 1, Vector3d(below.x(), below.y(), 0.5), Vector3d::UnitZ()));
    }
  const VectorXd f = forces_of(dense_matrix(rig), accelerations_of_rows(rig, VectorXd::Zero(8)));
  const double weight = (kLight + kHeavy) * kGravity;
  // A's numbers are some 400 / kg: rounding of 1e-16 * 400 * 1e4 N over 1 / 1e-2 kg is 1e-15 of the
  // weight.
  expect_near(
      Vector2d(f.head(4).sum(), f.tail(4).sum()), Vector2d(weight, kHeavy * kGravity),
      1e-8 * weight, "N (sum of the lower four, of the upper four)",
      {.scene = "a box of 1,000 kg on a box of 10 g on the floor, four contacts each",
       .slip = "an iteration that stops too early: find which contacts push, and solve directly"
               " for their forces",
       .handout = equation(9),
       .no_number = "redundant contacts: A is singular, and a pivot of 0 is divided by",
       .iterates = true});
}

TEST(ContactForces, AreRightInEveryUnit) {
  // A gram and a ton beside each other, each on its own contact.
  const VectorXd apart =
      forces_of(Vector2d(1e3, 1e-3).asDiagonal().toDenseMatrix(), Vector2d::Constant(-kGravity));
  if (apart.size() == 2)
    expect_near(
        Vector2d(apart[0] / (1e-3 * kGravity), apart[1] / (1e3 * kGravity)), Vector2d(1, 1), 1e-9,
        "(over the weight of each)",
        {.scene = "1 g and 1,000 kg beside each other on the floor, a contact each",
         .slip = "what is small is measured against the largest A_ii, not against the contact's "
                 "own",
         .handout = equation(9)});
  const Contacts stack = stack_of_boxes(2);
  const auto is_right = [&](const VectorXd& f) {
    return std::abs(f.head(4).sum() - 2 * kGravity) < 1e-9;
  };
  const bool plain = is_right(forces_of(stack.A, stack.b));
  for (const auto& [mass, acceleration] :
       {std::pair{0x1p-100, 1.0}, {0x1p100, 1.0}, {1.0, 0x1p-100}, {1.0, 0x1p100}}) {
    const VectorXd f = forces_of(stack.A / mass, stack.b * acceleration) / (mass * acceleration);
    const Story story{
        .scene = "two boxes on each other on the floor, four contacts each; masses times " +
                 show(mass) + ", gravity times " + show(acceleration),
        .slip = plain ? "an absolute threshold: nothing can be moved where A_ii is exactly 0, and "
                        "nothing sinks where a >= 0, to rounding of its own terms"
                      : "the same in plain units is wrong, too: see the tests before this one",
        .handout = equation(9),
        .iterates = true};
    expect_near(Vector2d(f.head(4).sum(), f.tail(4).sum()), Vector2d(2, 1) * kGravity,
                1e-9 * kGravity, "N, in that unit (sum of the lower four, of the upper four)",
                story);
    expect_near(VectorXd(stack.A * f + stack.b), VectorXd::Zero(8), 1e-9 * kGravity,
                "m/s^2, in that unit (a)", story);
  }
}

TEST(ContactForces, PushOnlyAndOnlyWhereNothingParts) {
  Random random(304);
  for (int i = 0; i < 150; ++i)
    expect_complementary(random_contacts(random, 1 + i % 20),
                         "random contacts, number " + std::to_string(i));
}

TEST(ContactForces, LeaveAloneWhatCannotMove) {
  if (!something_is_held()) return;
  const MatrixXd A = (MatrixXd(3, 3) << 0.5, 0, 0, 0, 0, 0, 0, 0, 2).finished();
  expect_near(
      forces_of(A, vector({-1, -1, -4})), vector({2, 0, 2}), 50 * kEps, "N",
      {.scene = "A = diag(0.5, 0, 2), b = (-1, -1, -4): the second contact is between two walls",
       .slip = "nothing there can be moved: f_i = 0",
       .handout = equation(9),
       .no_number = "a division by A_ii = 0: nothing there can be moved, f_i = 0"});
}

}  // namespace
}  // namespace tumble::a3_testing
