// Forces of rods by Lagrange multipliers (A3.7).
#include <algorithm>
#include <chrono>

#include "framework/core/decompositions.h"
#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

const Vector3d kDown = -Vector3d::UnitZ(), kNoArm = Vector3d::Zero();

/// Two kilograms on one rod below the ceiling. The hanging body is A or B of the row.
Rig weight_on_a_rod(bool weight_is_a, double velocity_product, double wanted) {
  Rig rig;
  rig.bodies = {ceiling(), point_mass(2)};
  rig.rows.push_back(weight_is_a ? rod_between(1, kNoArm, 0, kNoArm, kDown, velocity_product)
                                 : rod_between(0, kNoArm, 1, kNoArm, -kDown, velocity_product));
  rig.wanted = vector({wanted});
  return rig;
}

TEST(ConstraintMultipliers, RodCarriesAWeight) {
  for (const bool weight_is_a : {true, false}) {
    const double weight = 2 * kGravity;
    const VectorXd found = weight_on_a_rod(weight_is_a, 0, 0).multipliers();
    expect_near(
        found, vector({-weight}), 10 * kEps * weight, "N",
        {.scene = std::string("2 kg hang at rest on a rod below the ceiling; n points from B to A, "
                              "and the weight is ") +
                  (weight_is_a ? "A" : "B"),
         .slip = likely<VectorXd>(
             found,
             Slips<VectorXd>{{vector({weight}),
                              "the sign of the right-hand side is wrong: C''_wanted minus what C'' "
                              "is without the rods"},
                             {vector({-kGravity / 2}), "mass for inverse mass: A = J M^-1 J^T"},
                             {vector({kGravity / 2}), "mass for inverse mass: A = J M^-1 J^T"},
                             {vector({0}), "the free acceleration is forgotten: J u'_free"}},
             "a hanging weight gives lambda = -m g"),
         .handout = equation(7)});
  }
}

TEST(ConstraintMultipliers, APendulumAddsWhatBendsItsPath) {
  // At the bottom of its swing, 3 m/s on 0.5 m: J' u = 18 m/s^2, tension m (g + v^2 / L).
  const VectorXd found = weight_on_a_rod(true, 18, 0).multipliers();
  expect_near(
      found, vector({-2 * (kGravity + 18)}), 20 * kEps * 60, "N",
      {.scene = "2 kg swing through the lowest point at 3 m/s on 0.5 m: J' u = 18 m/s^2",
       .slip = likely<VectorXd>(
           found,
           Slips<VectorXd>{
               {vector({-2 * kGravity}),
                "the velocity product is missing: C''_wanted - (J u'_free + J' u)"},
               {vector({-2 * (kGravity - 18)}), "the sign of the velocity product is wrong"},
               {vector({2 * (kGravity + 18)}), "the sign of the right-hand side is wrong"}},
           "-m (g + v^2 / L)"),
       .handout = equation(7)});
}

TEST(ConstraintMultipliers, GiveTheWantedAcceleration) {
  const VectorXd found = weight_on_a_rod(true, 0, -4).multipliers();
  expect_near(
      found, vector({-2 * (kGravity + 4)}), 20 * kEps * 30, "N",
      {.scene = "2 kg on a rod that is too long: C'' = -4 m/s^2 is wanted, that is upwards",
       .slip = likely<VectorXd>(
           found,
           Slips<VectorXd>{
               {vector({-2 * kGravity}), "the wanted acceleration is not looked at"},
               {vector({-2 * (kGravity - 4)}), "the sign of the wanted acceleration is wrong"},
               {vector({2 * (kGravity + 4)}), "the sign of the right-hand side is wrong"}},
           "-m (g + 4)"),
       .handout = equation(7)});
}

TEST(ConstraintMultipliers, ADrivenCeilingLiftsWhatHangs) {
  for (const bool weight_is_a : {true, false}) {
    Rig rig = weight_on_a_rod(weight_is_a, 0, 0);
    rig.bodies[0].free_acceleration[2] = 3;
    const VectorXd found = rig.multipliers();
    expect_near(
        found, vector({-2 * (kGravity + 3)}), 20 * kEps * 26, "N",
        {.scene = std::string("2 kg on a rod below a ceiling that is driven upwards at 3 m/s^2; "
                              "the weight is ") +
                  (weight_is_a ? "A" : "B"),
         .slip = likely<VectorXd>(
             found,
             Slips<VectorXd>{{vector({-2 * kGravity}),
                              "a driven ceiling taken to be at rest: J u'_free counts bodies of "
                              "infinite mass, too"},
                             {vector({-2 * (kGravity - 3)}),
                              "the sign of one body's part of J u'_free is wrong"}},
             "-m (g + 3)"),
         .handout = equation(7)});
  }
}

TEST(ConstraintMultipliers, EachRodCarriesWhatHangsBelow) {
  const VectorXd found = hanging_chain({1, 2, 4}).multipliers();
  expect_near(
      found, vector({-7 * kGravity, -6 * kGravity, -4 * kGravity}), 200 * kEps * 7 * kGravity, "N",
      {.scene = "1, 2 and 4 kg hang one below the other from the ceiling",
       .slip = likely<VectorXd>(found,
                                Slips<VectorXd>{{vector({-kGravity, 0, 0}),
                                                 "each rod is solved alone: rods that share a body "
                                                 "push each other, A is not diagonal"}},
                                "where rows i and j share a body, A_ij = J_i M^-1 J_j^T, with the "
                                "side (a or b) that each has there"),
       .handout = equation(7)});
}

TEST(ConstraintMultipliers, ARodOffTheCentreTurnsTheBody) {
  // A bar of 3 kg and 2 m, held at one end by a vertical rod: it rotates as it falls. -g/lambda =
  // 1/m + r^2/I, I = m l^2 / 12.
  const double mass = 3, moment = mass * 4 / 12;
  Rig rig;
  rig.bodies = {ceiling(), movable(mass, Vector3d(1 / moment, 1 / moment, 1e3).asDiagonal())};
  rig.rows.push_back(rod_between(1, {1, 0, 0}, 0, kNoArm, kDown));
  rig.wanted = vector({0});
  const VectorXd found = rig.multipliers();
  expect_near(found, vector({-mass * kGravity / 4}), 20 * kEps * mass * kGravity, "N",
              {.scene = "a level bar of 3 kg and 2 m, let go while a rod holds one end: it carries "
                        "a quarter of the weight",
               .slip = likely<VectorXd>(
                   found,
                   Slips<VectorXd>{{vector({-mass * kGravity}),
                                    "the turning part is left out of A: inverse_inertia_world and "
                                    "the last three numbers of J"}},
                   "A = J M^-1 J^T with the inverse inertia"),
               .handout = equation(7)});
}

/// The same by a dense solution: the multipliers, or those of a rig with a mistake.
VectorXd dense_multipliers(const Rig& rig) {
  const VectorXd free = accelerations_of_rows(rig, VectorXd::Zero(rig.size()));
  return solve_symmetric(dense_matrix(rig), rig.wanted - free);
}

TEST(ConstraintMultipliers, ProductsOfInertiaCount) {
  // Full inverse inertias, skew arms and normals, bodies that share rods. Condition of A below 1e4.
  Random random(306);
  for (int i = 0; i < 5; ++i) {
    const Rig rig = random_rig(random, 5, 3);
    Rig diagonal = rig, still = rig, slow = rig;
    for (Constraint& c : slow.rows) c.row.velocity_product = 0.0;
    for (ConstrainedBody& body : diagonal.bodies)
      body.inverse_inertia_world =
          Matrix3d(Vector3d(body.inverse_inertia_world.diagonal()).asDiagonal());
    for (Constraint& c : still.rows)
      c.row.jacobian_a.tail<3>().setZero(), c.row.jacobian_b.tail<3>().setZero();
    const VectorXd found = rig.multipliers(), expected = dense_multipliers(rig);
    expect_near(
        found, expected, 1e-10 * (1 + expected.cwiseAbs().maxCoeff()), "N",
        {.scene = rig.scene + ", number " + std::to_string(i),
         .slip = likely(
             found,
             Slips<VectorXd>{{dense_multipliers(diagonal),
                              "the diagonal of the tensor alone: products of inertia count, so use "
                              "the whole inverse_inertia_world"},
                             {dense_multipliers(still),
                              "the turning part is left out of A: inverse_inertia_world and the "
                              "last three numbers of J"},
                             {dense_multipliers(slow),
                              "the right-hand side lacks each row's velocity_product, J' u"}},
             "A_ij = J_i M^-1 J_j^T over every body that rows i and j share"),
         .handout = equation(7),
         .iterates = true});
  }
}

TEST(ConstraintMultipliers, AreRightInEveryUnit) {
  const VectorXd weights = vector({-7 * kGravity, -6 * kGravity, -4 * kGravity});
  const bool plain = (hanging_chain({1, 2, 4}).multipliers() - weights).norm() < 1e-9;
  for (const double unit : {0x1p-100, 0x1p100}) {
    expect_near(
        VectorXd(hanging_chain({unit, 2 * unit, 4 * unit}).multipliers() / unit), weights,
        200 * kEps * 7 * kGravity, "N, in that unit",
        {.scene = "1, 2 and 4 units of mass hang one below the other from the ceiling; a unit is " +
                  show(unit) + " kg",
         .slip = plain ? "an absolute threshold: a row moves nothing where A_ii is exactly 0, and "
                         "a pivot is round-off against its own A_ii"
                       : "the same in kilograms is wrong, too: see the tests before this one",
         .handout = equation(7),
         .iterates = true});
  }
}

TEST(ConstraintMultipliers, FourUnevenLinksInMotionMatchTheTruth) {
  // Tensions by an independent computation at 60 digits: chain/links4_uneven, rod_tensions_t0
  // (masses, lengths, angles from the vertical and their rates as below).
  const double masses[] = {0.5, 1, 0.25, 2}, lengths[] = {0.3, 0.5, 0.4, 0.2},
               rates[] = {0, 1, -1, 2};
  const double angles[] = {1.57079632679489661923132169164, 1.0, 0.5, -0.25};
  const VectorXd tensions =
      vector({0.479514394938375751888112651527, 0.569852560094922844398921471009,
              0.458717843186065026537737822276, 0.476123324278267257725946445336});
  Rig rig;
  rig.bodies.push_back(ceiling());
  for (int i = 0; i < 4; ++i) {
    rig.bodies.push_back(point_mass(masses[i]));
    rig.rows.push_back(rod_between(i + 1, kNoArm, i, kNoArm,
                                   Vector3d(std::sin(angles[i]), 0, -std::cos(angles[i])),
                                   lengths[i] * rates[i] * rates[i]));
  }
  rig.wanted = VectorXd::Zero(4);
  // Terms up to g m are summed to these tensions; A's condition is about 13.
  expect_near(
      rig.multipliers(), VectorXd(-tensions), 200 * kEps * 2 * kGravity, "N",
      {.scene = "a chain of 0.5, 1, 0.25 and 2 kg on rods of 0.3, 0.5, 0.4 and 0.2 m, in motion",
       .slip = "A where rods share a body, or the velocity product",
       .handout = equation(7)});
}

TEST(ConstraintMultipliers, AHundredLinksCarryTheirWeight) {
  const Rig rig = hanging_chain(std::vector<double>(100, 0.1));
  const VectorXd found = rig.multipliers();
  VectorXd expected(100);
  for (int i = 0; i < 100; ++i) expected[i] = -(100 - i) * 0.1 * kGravity;
  // Condition (4 n / pi)^2 = 1.6e4: 1e-10 allows every order of elimination, and no iteration that
  // stops early.
  expect_near(found, expected, 1e-10 * 98.1, "N",
              {.scene = "a chain of 100 links of 0.1 kg hangs at rest",
               .slip = found.size() == 100 && found.allFinite() && std::abs(found[0]) < 98
                           ? "an iteration that stops too early: A is solved directly"
                           : "A where rods share a body",
               .handout = equation(7),
               .iterates = true});
}

TEST(ConstraintMultipliers, ARodTwiceSharesTheForce) {
  Rig rig = hanging_chain({1, 2, 4});
  rig.rows.push_back(rig.rows[0]);
  rig.rows.push_back(rig.rows[1]);
  rig.wanted = VectorXd::Zero(5);
  const VectorXd found = rig.multipliers();
  const std::string no_number =
      "singular rows: two rods that say the same make A singular, and a pivot of 0 is divided by";
  const std::string slip = !found.allFinite()
                               ? no_number
                               : "a rod that is there twice: any share is right, but the sum must "
                                 "be; a pivot of round-off is divided by";
  const Vector3d both(found.size() == 5 ? found[0] + found[3] : kUnset,
                      found.size() == 5 ? found[1] + found[4] : kUnset,
                      found.size() == 5 ? found[2] : kUnset);
  expect_near(both, Vector3d(-7, -6, -4) * kGravity, 1e-9 * 7 * kGravity, "N, both together",
              {.scene = "1, 2 and 4 kg below each other, the first two rods there twice",
               .slip = slip,
               .handout = equation(7),
               .no_number = no_number,
               .iterates = true});
}

TEST(ConstraintMultipliers, WhatMovesNothingCarriesNothing) {
  Rig rig = hanging_chain({1, 2});
  rig.bodies.push_back(ceiling());
  // from wall to wall
  rig.rows.insert(rig.rows.begin() + 1, rod_between(0, kNoArm, 3, kNoArm, kDown));
  // its ends coincide: J = 0
  rig.rows.push_back(rod_between(1, kNoArm, 2, kNoArm, Vector3d::Zero()));
  rig.wanted = vector({0, 5, 0, 5});
  const VectorXd found = rig.multipliers();
  expect_near(found, vector({-3 * kGravity, 0, -2 * kGravity, 0}), 1e-9 * 3 * kGravity, "N",
              {.scene = "two weights on rods; between them in the list a rod from wall to wall, "
                        "and after them one without direction",
               .slip = "singular rows: A_ii = 0 where a row moves nothing. Its multiplier is 0, "
                       "and the others must not suffer",
               .handout = equation(7),
               .no_number = "singular rows: A_ii = 0 where a row moves nothing, and is divided by. "
                            "Its multiplier is 0",
               .iterates = true});
}

/// Wall time of one call [s]: the shortest of up to `tries`, until one is short enough.
double seconds_of(const Rig& rig, double enough, int tries) {
  double best = INFINITY;
  for (int i = 0; i < tries && best > enough; ++i) {
    const auto start = std::chrono::steady_clock::now();
    rig.multipliers();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

TEST(ConstraintMultipliers, AreSolvedAsTheChainTheyAre) {
  // Longer and longer chains, so that a dense solution is detected where it still ends. Sparse,
  // 2,000 rods take some milliseconds; dense, their 2.7e9 multiplications take seconds. The header
  // requires 1,000 in 0.1 s. Too slow is 0.1 s and eight times more than the chains have grown: a
  // busy machine slows the short chain, too.
  constexpr double kPatience = 0.1;  // s
  constexpr int kShort = 50;
  const auto chain = [](int links) {
    return hanging_chain(std::vector<double>(static_cast<std::size_t>(links), 0.1));
  };
  const double a_link = seconds_of(chain(kShort), 0.0, 20) / kShort;
  for (const int links : {kShort, 125, 250, 350, 500, 700, 1000, 1400, 2000}) {
    const double allowed = std::max(kPatience, 8 * a_link * links),
                 seconds = seconds_of(chain(links), allowed, 2);
    expect_true(seconds <= allowed, "an answer within " + show_scale(allowed) + " s",
                show(std::round(seconds * 100) / 100) + " s",
                {.scene = "chains of 50 to 6,000 links of 0.1 kg hang at rest; this one has " +
                          std::to_string(links),
                 .slip = "A is solved as a dense matrix: its cost grows with the cube of the "
                         "links, and A of a chain has three numbers a row",
                 .handout = equation(7)});
    if (seconds > allowed) return;
  }
  // dense, A has 288 MB and takes 7e10 multiplications and more; sparse, 18,000 numbers
  constexpr int kLinks = 6000;
  const Rig rig = hanging_chain(std::vector<double>(kLinks, 0.1));
  const VectorXd found = rig.multipliers();
  VectorXd expected(kLinks);
  for (int i = 0; i < kLinks; ++i) expected[i] = -(kLinks - i) * 0.1 * kGravity;
  expect_near(found, expected, 1e-7 * kLinks * 0.1 * kGravity, "N",  // condition 5.8e7
              {.scene = "chains of 50 to 6,000 links of 0.1 kg hang at rest; this one has 6,000",
               .slip = "A is not solved as what it is, three numbers a row",
               .handout = equation(7)});
}

}  // namespace
}  // namespace tumble::a3_testing
