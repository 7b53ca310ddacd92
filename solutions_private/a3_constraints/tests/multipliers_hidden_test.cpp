// Hidden: multipliers and corrections of systems that nobody solves by hand, and of those that are
// hard to solve.
#include <algorithm>

#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

const Vector3d kNoArm = Vector3d::Zero();

void expect_fulfilled(const Rig& rig, const VectorXd& lambda, double tolerance,
                      const std::string& slip) {
  const Story story{.scene = rig.scene,
                    .slip = slip,
                    .handout = equation(7),
                    .no_number = "singular rows: a pivot of 0 is divided by",
                    .iterates = true};
  const VectorXd found = lambda.size() == rig.size()
                             ? accelerations_of_rows(rig, lambda)
                             : VectorXd(VectorXd::Constant(rig.size(), kUnset));
  expect_near(found, rig.wanted, tolerance * size_of_terms(rig), "m/s^2 (C'')", story);
}

TEST(ConstraintMultipliers, FulfilRandomSystems) {
  Random random(341);
  for (int i = 0; i < 40; ++i) {
    const int bodies = 1 + static_cast<int>(random.between(0, 12));
    const Rig rig = random_rig(random, bodies, static_cast<int>(random.between(0, bodies)));
    // condition below 1e4
    expect_fulfilled(
        rig, rig.multipliers(), 1e-11,
        "C'' is not what is wanted: a term of the right-hand side, or a side of a row");
  }
  // Bodies of finite mass that no torque turns: they couple their rows all the same.
  for (int i = 0; i < 10; ++i) {
    Rig rig = random_rig(random, 6, 2);
    rig.scene += "; every other body does not turn (inverse inertia 0)";
    for (std::size_t k = 1; k < rig.bodies.size(); k += 2)
      rig.bodies[k].inverse_inertia_world.setZero();
    expect_fulfilled(rig, rig.multipliers(), 1e-10,
                     "a body that can be shifted, though not turned, couples its rows");
  }
}

/// Numbers 0 to n - 1 in no order: every `stride`-th of them, round and round. n and stride share
/// no factor.
std::vector<int> out_of_order(int n, int stride) {
  std::vector<int> numbers;
  for (int i = 0; i < n; ++i) numbers.push_back(i * stride % n);
  return numbers;
}

/// The same rods and what is wanted of them, listed in another order.
Rig relisted(const Rig& rig, const std::vector<int>& order) {
  Rig other = rig;
  for (std::size_t i = 0; i < order.size(); ++i)
    other.rows[i] = rig.rows[static_cast<std::size_t>(order[i])];
  other.wanted = rig.wanted(order);
  return other;
}

TEST(ConstraintMultipliers, FindAChainInAnyOrder) {
  constexpr int kLinks = 300;
  const std::vector<int> order = out_of_order(kLinks, 77);
  Rig rig = relisted(hanging_chain(std::vector<double>(kLinks, 1.0)), order);
  rig.scene = "a chain of 300 links of 1 kg hangs at rest, its rods listed in no order";
  VectorXd expected(kLinks);
  for (int i = 0; i < kLinks; ++i)
    expected[i] = -(kLinks - order[static_cast<std::size_t>(i)]) * kGravity;
  // condition (4 n / pi)^2 = 1.5e5
  expect_near(
      rig.multipliers(), expected, 1e-9 * kLinks * kGravity, "N",
      {.scene = rig.scene,
       .slip = "what is counted on is that neighbours in the list are neighbours in the chain",
       .handout = equation(7)});
}

// Small pivots are no redundant rows: 50 links of 1 kg above 50 of 1,000 t, listed from below, and
// a gram beside a ton.
void expect_no_light_row_is_left_out() {
  constexpr int kHalf = 50, kLinks = 2 * kHalf;
  std::vector<double> masses(kLinks, 1.0);
  std::fill(masses.begin() + kHalf, masses.end(), 1e6);
  Rig rig = hanging_chain(masses);
  std::reverse(rig.rows.begin(), rig.rows.end());
  VectorXd expected(kLinks);
  double below = 0;
  for (int i = 0; i < kLinks; ++i)
    expected[i] = -(below += masses[static_cast<std::size_t>(kLinks - 1 - i)]) * kGravity;
  const std::string slip =
      "a small pivot is taken for that of a redundant row: what is small is measured against the "
      "row's own A_ii";
  // 1e-5: not digits are asked for here, but that no row is left out
  expect_near(rig.multipliers(), expected, 1e-5 * -expected.minCoeff(), "N",
              {.scene = "50 links of 1 kg above 50 links of 1,000 t, rods listed from below",
               .slip = slip,
               .handout = equation(7)});
  Rig apart;
  apart.bodies = {ceiling(), point_mass(1e-3), point_mass(1e3)};
  for (const int i : {1, 2})
    apart.rows.push_back(rod_between(i, kNoArm, 0, kNoArm, Vector3d(0, 0, -1)));
  apart.wanted = VectorXd::Zero(2);
  const VectorXd found = apart.multipliers();
  if (found.size() == 2)
    expect_near(Vector2d(found[0] / 1e-3, found[1] / 1e3), Vector2d::Constant(-kGravity), 1e-9,
                "m/s^2 (lambda over the mass of each)",
                {.scene = "1 g and 1,000 kg hang at rest, each on a rod of its own",
                 .slip = slip,
                 .handout = equation(7)});
}

TEST(ConstraintMultipliers, CarryTonsOnGrams) {
  for (const double heavy : {1e4, 1e6}) {
    for (const int links : {1, 2, 8, 60}) {
      std::vector<double> masses(static_cast<std::size_t>(links), 1.0);
      masses.back() = heavy;
      const Rig rig = hanging_chain(masses);
      const VectorXd found = rig.multipliers();
      VectorXd expected(links);
      for (int i = 0; i < links; ++i) expected[i] = -(heavy + (links - 1 - i)) * kGravity;
      expect_near(
          found, expected, 1e-8 * heavy * kGravity, "N",
          {.scene = show(heavy) + " kg below " + std::to_string(links - 1) + " links of 1 kg",
           .slip = "an iteration that stops too early, or a regularisation that is not small "
                   "against the heavy body's 1/m",
           .handout = equation(7),
           .iterates = true});
    }
  }
  expect_no_light_row_is_left_out();
}

TEST(ConstraintMultipliers, CarryLightAndHeavyInTurn) {
  // 1 kg, 1,000 t, 1 kg, ...: each rod carries what hangs below it, to 1e-6 of the largest.
  for (const int links : {3, 20, 100}) {
    std::vector<double> masses;
    for (int i = 0; i < links; ++i) masses.push_back(i % 2 == 0 ? 1.0 : 1e6);
    VectorXd expected(links);
    double below = 0;
    for (int i = links; i-- > 0;)
      expected[i] = -(below += masses[static_cast<std::size_t>(i)]) * kGravity;
    for (const int stride : {1, 37}) {
      const std::vector<int> order = out_of_order(links, stride);
      expect_near(relisted(hanging_chain(masses), order).multipliers(), VectorXd(expected(order)),
                  1e-6 * below * kGravity, "N",
                  {.scene = "a chain of " + std::to_string(links) +
                            " links of 1 kg and 1,000 t in turn hangs at rest, its rods listed " +
                            (stride == 1 ? "from the top" : "in no order"),
                   .slip = "digits are lost where a light body hangs between heavy ones: compute "
                           "what is left of the right-hand side by way of the bodies, solve for "
                           "it, and add",
                   .handout = equation(7),
                   .iterates = true});
    }
  }
}

TEST(ConstraintMultipliers, CloseLoopsWithRowsTooMany) {
  // Four masses in a square, all six distances held, in a plane: one row too many. Two corners hang
  // on rods.
  Rig rig;
  rig.scene =
      "a square of four masses with both diagonals, hung by two corners: 8 rods, of which one is "
      "redundant";
  const Vector3d corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}};
  rig.bodies.push_back(ceiling());
  for (int i = 0; i < 4; ++i) {
    ConstrainedBody mass = point_mass(1 + i);
    mass.free_acceleration.head<3>() += Vector3d(0.3 * i, 0, -0.1 * i * i);
    rig.bodies.push_back(mass);
  }
  for (int i = 0; i < 4; ++i)
    for (int k = i + 1; k < 4; ++k)
      rig.rows.push_back(
          rod_between(i + 1, kNoArm, k + 1, kNoArm, (corners[i] - corners[k]).normalized()));
  rig.rows.push_back(rod_between(1, kNoArm, 0, kNoArm, -Vector3d::UnitZ()));
  rig.rows.push_back(rod_between(2, kNoArm, 0, kNoArm, -Vector3d::UnitZ()));
  rig.wanted = VectorXd::Zero(rig.size());
  expect_fulfilled(rig, rig.multipliers(), 1e-10,
                   "singular rows: a pivot of round-off is divided by");
}

TEST(ConstraintMultipliers, DoNotCareHowOftenARodIsThere) {
  Random random(342);
  for (int i = 0; i < 20; ++i) {
    Rig rig = random_rig(random, 5, 3);
    const VectorXd once = forces_on_bodies(rig, rig.multipliers());
    expect_true(once.norm() > 0.1, "forces", "none",
                {.scene = rig.scene,
                 .slip = "the function gives nothing (0 or NaN) whatever it is asked",
                 .handout = equation(7)});
    const std::size_t rows = rig.rows.size();
    for (std::size_t k = 0; k < rows; k += 2) rig.rows.push_back(rig.rows[k]);
    const VectorXd wanted = rig.wanted;
    rig.wanted.conservativeResize(rig.size());
    for (std::size_t k = 0, at = rows; k < rows; k += 2, ++at)
      rig.wanted[static_cast<Eigen::Index>(at)] = wanted[static_cast<Eigen::Index>(k)];
    const VectorXd found = forces_on_bodies(rig, rig.multipliers());
    expect_near(found, once, 1e-8 * (1 + once.cwiseAbs().maxCoeff()), "N (and N m) on all bodies",
                {.scene = rig.scene + ", every other one of them twice",
                 .slip = "singular rows: a pivot of round-off is divided by",
                 .handout = equation(7)});
  }
}

TEST(ConstraintMultipliers, AnswerSomethingFiniteToAContradiction) {
  Rig rig = hanging_chain({1, 2});
  rig.rows.push_back(rig.rows[0]);
  rig.wanted = vector({0, 0, 1});  // the same rod, and another C''
  const VectorXd found = rig.multipliers();
  expect_true(found.size() == 3 && found.allFinite() && found.norm() > 1, "three finite numbers",
              show(found),
              {.scene = "a rod twice, with C'' wanted 0 and 1 m/s^2",
               .slip = "singular rows: NaN or nothing",
               .handout = equation(7)});
}

TEST(ConstraintMultipliers, HoldWhatTheCeilingHoldsAlone) {
  // A thousand pendulums on one ceiling share nothing that moves: every rod for itself.
  Rig rig;
  rig.bodies.push_back(ceiling());
  for (int i = 1; i <= 1000; ++i) {
    rig.bodies.push_back(point_mass(i));
    rig.rows.push_back(rod_between(0, kNoArm, i, kNoArm, Vector3d::UnitZ()));
  }
  rig.wanted = VectorXd::Zero(rig.size());
  const VectorXd found = rig.multipliers();
  VectorXd expected(1000);
  for (int i = 0; i < 1000; ++i) expected[i] = -(i + 1) * kGravity;
  expect_near(found, expected, 1e-10 * 1000 * kGravity, "N",
              {.scene = "1,000 weights of 1 to 1,000 kg, each on its own rod below one ceiling",
               .slip = "a body of infinite mass couples no rows",
               .handout = equation(7)});
}

TEST(ConstraintMultipliers, HaveNothingToSayAboutNothing) {
  const Rig one = hanging_chain({1});
  expect_near(one.multipliers(), vector({-kGravity}), 1e-12, "N",
              {.scene = "asked first: 1 kg on a rod",
               .slip = "the function gives nothing whatever it is asked",
               .handout = equation(7)});
  Rig rig;
  rig.bodies = {ceiling(), point_mass(1)};
  rig.wanted = VectorXd(0);
  expect_near(
      static_cast<double>(rig.multipliers().size()), 0.0, 0.0, "multipliers",
      {.scene = "two bodies without any row", .slip = "an empty list", .handout = equation(7)});
  const VectorXd x = a3_module().constraint_correction(rig.rows, rig.bodies, rig.wanted);
  expect_near(x, VectorXd::Zero(12), 0.0, "m (and rad)",
              {.scene = "two bodies without any row: the correction",
               .slip = "an empty list",
               .handout = equation(8)});
}

TEST(ConstraintCorrection, RemovesErrorsOfRandomSystems) {
  Random random(343);
  for (int i = 0; i < 30; ++i) {
    const int bodies = 1 + static_cast<int>(random.between(0, 10));
    Rig rig = random_rig(random, bodies, static_cast<int>(random.between(0, bodies)));
    const VectorXd x = a3_module().constraint_correction(rig.rows, rig.bodies, rig.wanted);
    // Seen as accelerations: bodies that accelerate by x, and nothing else, change C'' by J x.
    Rig moved = rig;
    for (Constraint& c : moved.rows) c.row.velocity_product = 0;
    const bool right_size = x.size() == 6 * static_cast<Eigen::Index>(rig.bodies.size());
    for (std::size_t k = 0; k < rig.bodies.size(); ++k)
      moved.bodies[k].free_acceleration =
          right_size ? Vector6d(x.segment<6>(6 * static_cast<Eigen::Index>(k)))
                     : Vector6d(Vector6d::Constant(kUnset));
    const VectorXd changes = accelerations_of_rows(moved, VectorXd::Zero(rig.size()));
    expect_near(changes, VectorXd(-rig.wanted), 1e-10 * (1 + x.cwiseAbs().maxCoeff()), "m (J x)",
                {.scene = rig.scene + ", number " + std::to_string(i),
                 .slip = "J x = -error in every row at once",
                 .handout = equation(8)});
    expect_near(
        right_size ? Vector6d(x.head<6>()) : Vector6d(Vector6d::Constant(kUnset)), Vector6d::Zero(),
        0.0, "m (the ceiling)",
        {.scene = rig.scene, .slip = "a body of infinite mass moves", .handout = equation(8)});
  }
}

TEST(ConstraintCorrection, TightensAChainInAnyOrder) {
  // 300 rods, each 1 mm too long: every body rises by 1 mm for each rod above it, whatever the
  // masses are.
  constexpr int kLinks = 300;
  constexpr double kTooLong = 1e-3;  // m
  const Rig in_order = hanging_chain(std::vector<double>(kLinks, 1.0));
  VectorXd expected = VectorXd::Zero(6 * (kLinks + 1));
  for (int body = 1; body <= kLinks; ++body) expected[6 * body + 2] = body * kTooLong;
  for (const int stride : {1, 77}) {
    const Rig rig = relisted(in_order, out_of_order(kLinks, stride));
    const VectorXd found = a3_module().constraint_correction(rig.rows, rig.bodies,
                                                             VectorXd::Constant(kLinks, kTooLong));
    // condition 1.5e5; every row to round-off of its terms, of which 300 add up
    expect_near(
        found, expected, 1e-10, "m (and rad)",
        {.scene = std::string("a chain of 300 links of 1 kg, every rod 1 mm too long, ") +
                  (stride == 1 ? "listed from the top" : "listed in no order"),
         .slip = "J x = -error to round-off in every row: what a regularisation leaves over "
                 "is solved for, and added",
         .handout = equation(8),
         .iterates = true});
  }
}

TEST(ConstraintCorrection, IsWhatTheMultipliersDo) {
  // Multipliers for C'' = -error from rest make the accelerations that the correction makes of
  // places.
  Random random(344);
  for (int i = 0; i < 10; ++i) {
    Rig rig = random_rig(random, 6, 2);
    for (ConstrainedBody& body : rig.bodies) body.free_acceleration.setZero();
    for (Constraint& c : rig.rows) c.row.velocity_product = 0;
    const VectorXd x = a3_module().constraint_correction(rig.rows, rig.bodies, rig.wanted);
    expect_true(x.norm() > 0.01, "a change", "none",
                {.scene = rig.scene,
                 .slip = "the function gives nothing (0 or NaN) whatever it is asked",
                 .handout = equation(8)});
    Rig other = rig;
    other.wanted = -rig.wanted;
    VectorXd forces = forces_on_bodies(other, other.multipliers());
    for (std::size_t k = 0; k < rig.bodies.size(); ++k) {
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(k);
      forces.segment<3>(at) *= rig.bodies[k].inverse_mass;
      forces.segment<3>(at + 3) =
          (rig.bodies[k].inverse_inertia_world * forces.segment<3>(at + 3)).eval();
    }
    expect_near(x, forces, 1e-10 * (1 + forces.cwiseAbs().maxCoeff()), "m (and rad)",
                {.scene = rig.scene,
                 .slip = "mass for inverse mass, or a sign: x = -M^-1 J^T lambda",
                 .handout = equation(8)});
  }
}

}  // namespace
}  // namespace tumble::a3_testing
