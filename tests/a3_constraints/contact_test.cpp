// Forces of resting contacts without friction (A3.9).
#include "tests/a3_constraints/a3_contacts.h"

namespace tumble::a3_testing {
namespace {

TEST(ContactForces, HoldABallOnTheFloor) {
  const VectorXd found = forces_of(MatrixXd::Constant(1, 1, 0.5), vector({-kGravity}));
  expect_near(found, vector({2 * kGravity}), 10 * kEps * 2 * kGravity, "N",
              {.scene = "a ball of 2 kg rests on the floor: A = 0.5 / kg, b = -9.81 m/s^2",
               .slip = likely<VectorXd>(found, Slips<VectorXd>{{vector({-2 * kGravity}), "the sign of the force: the floor pushes, f = -b / A"}, {vector({0}), "the sign of b: b < 0 is a contact that would be entered"}}, "A f + b = 0"),
               .handout = equation(9)});
}

TEST(ContactForces, DoNotHoldBackWhatLeaves) {
  if (!something_is_held()) return;
  const VectorXd found = forces_of(MatrixXd::Constant(1, 1, 0.5), vector({3}));
  expect_near(found, vector({0}), 0.0, "N",
              {.scene = "a ball of 2 kg is lifted off the floor: A = 0.5 / kg, b = +3 m/s^2", .slip = "negative forces: a contact pushes, it never pulls", .handout = equation(9)});
}

TEST(ContactForces, PushOnlyAtTheEndThatWouldSink) {
  const MatrixXd A = (MatrixXd(2, 2) << 2, 1, 1, 2).finished();
  const VectorXd found = forces_of(A, vector({-1, 1}));
  expect_near(found, vector({0.5, 0}), 20 * kEps, "N",
              {.scene = "A = (2, 1; 1, 2), b = (-1, 1): a plank of which one end sinks and the other lifts",
               .slip = likely<VectorXd>(found,
                              Slips<VectorXd>{{vector({1, -1}), "negative forces: a contact pushes, it never pulls; A f = -b is not the problem"},
                                              {vector({1, 0}), "the solution of A f = -b, cut off at 0: once the second force is gone, the first must be found anew"},
                                              {vector({1.0 / 2, 1.0 / 2}), "the absolute values of forces"}},
                              "f . a = 0: where a force acts, nothing parts"),
               .handout = equation(9)});
}

TEST(ContactForces, ChooseWhoPushesAmongThree) {
  // By hand: 1 and 3 push. Whoever lets go in the wrong order ends with 2.
  const MatrixXd A = (MatrixXd(3, 3) << 4, 3, 1, 3, 4, 3, 1, 3, 4).finished();
  const VectorXd b = vector({-5, -4, -5});
  const VectorXd found = forces_of(A, b);
  expect_near(found, vector({1, 0, 1}), 50 * kEps, "N",
              {.scene = "A = (4, 3, 1; 3, 4, 3; 1, 3, 4), b = (-5, -4, -5): three contacts, the middle one of which parts as the outer ones are held",
               .slip = found.size() == 3 && found.allFinite() && found.minCoeff() < 0 ? "negative forces: a contact pushes, it never pulls" : "who pushes: f >= 0, A f + b >= 0 and f . a = 0, all three",
               .handout = equation(9)});
}

TEST(ContactForces, CarryABoxOnFourCorners) {
  const Contacts box = stack_of_boxes(1);
  const VectorXd found = forces_of(box.A, box.b);
  const Story story{.scene = "a box of 1 kg rests on its four corners: A has rank 3",
                    .slip = found.allFinite() ? "redundant contacts: any share is right, but the sum is the weight" : "redundant contacts: A is singular, and a pivot of 0 is divided by",
                    .handout = equation(9)};
  expect_near(found.sum(), kGravity, 1e-10 * kGravity, "N (sum)", story);
  expect_true(found.minCoeff() >= 0, "no force < 0", show(found) + " N", story);
  expect_near(VectorXd(box.A * found + box.b), VectorXd::Zero(4), 1e-10 * kGravity, "m/s^2 (a)", story);
}

TEST(ContactForces, CarryAStackOfTen) {
  const Contacts stack = stack_of_boxes(10);
  expect_complementary(stack, "ten boxes of 1 kg on each other, four contacts each: 40 contacts, rank 30");
  const VectorXd found = forces_of(stack.A, stack.b);
  expect_near(found.head(4).sum(), 10 * kGravity, 1e-9 * kGravity, "N",
              {.scene = "ten boxes of 1 kg on each other: the four contacts at the bottom", .slip = "an iteration that stops too early, or who pushes", .handout = equation(9)});
}

TEST(ContactForces, PushOnlyAndOnlyWhereNothingParts) {
  Random random(304);
  for (int i = 0; i < 150; ++i) expect_complementary(random_contacts(random, 1 + i % 20), "random contacts, number " + std::to_string(i));
}

TEST(ContactForces, LeaveAloneWhatCannotMove) {
  if (!something_is_held()) return;
  const MatrixXd A = (MatrixXd(3, 3) << 0.5, 0, 0, 0, 0, 0, 0, 0, 2).finished();
  expect_near(forces_of(A, vector({-1, -1, -4})), vector({2, 0, 2}), 50 * kEps, "N",
              {.scene = "A = diag(0.5, 0, 2), b = (-1, -1, -4): the second contact is between two walls", .slip = "a division by A_ii = 0: nothing there can be moved, f_i = 0", .handout = equation(9)});
}

}  // namespace
}  // namespace tumble::a3_testing
