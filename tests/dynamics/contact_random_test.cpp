// Thousands of random problems: frictionless ones against trying out every set of active contacts,
// others against the law itself.
#include <gtest/gtest.h>

#include "framework/core/decompositions.h"
#include "framework/dynamics/contact_sweeps.h"
#include "tests/dynamics/contact_scenes.h"

namespace tumble::testing {
namespace {

PushedBody random_body(Random& random, double mass_decades) {
  const double mass = std::pow(10.0, random.between(0, mass_decades)),
               size = random.between(0.3, 2);
  const Matrix3d turn = random_rotation(random).toRotationMatrix();
  const Vector3d moments = mass * size * size * 0.1 * random_moments(random).normalized();
  PushedBody body =
      body_at(mass, turn * moments.asDiagonal() * turn.transpose(), random_vector(random, 1));
  body.velocity_world = random_vector(random, 1);
  body.omega_world = random_vector(random, 1);
  return body;
}

struct Recipe {
  int most_bodies = 6, most_contacts = 40;
  double mass_decades = 4, most_friction = 2, least_target = 0;
  bool duplicates = true;
  // normals lead from body to body and up from the floor; else anywhere, as in a shell
  bool pile = true;
};

ContactProblem random_problem(Random& random, const Recipe& recipe) {
  ContactProblem problem;
  const int bodies = 1 + static_cast<int>(random.below(recipe.most_bodies)),
            contacts = 1 + static_cast<int>(random.below(recipe.most_contacts));
  problem.bodies.push_back(fixed_body());
  for (int i = 0; i < bodies; ++i)
    problem.bodies.push_back(random_body(random, recipe.mass_decades));
  for (int i = 0; i < contacts; ++i) {
    const int a = 1 + static_cast<int>(random.below(bodies));
    // another, or the floor
    const int b = (a + 1 + static_cast<int>(random.below(bodies))) % (bodies + 1);
    Vector3d normal = random_rotation(random) * Vector3d::UnitZ();
    const Vector3d outwards =
        b == 0 ? Vector3d(0, 0, 1)
               : Vector3d(problem.bodies[a].com_world - problem.bodies[b].com_world);
    if (recipe.pile && normal.dot(outwards) < 0) normal = -normal;
    const Vector3d point = problem.bodies[a].com_world - random.between(0.1, 0.6) * normal +
                           random_vector(random, 0.4);
    problem.contacts.push_back(contact_at(
        a, b, point, normal, random.unit() < 0.2 ? 0.0 : random.between(0, recipe.most_friction)));
    problem.contacts.back().target = -random.between(0, recipe.least_target);
    if (recipe.duplicates && random.unit() < 0.2)
      problem.contacts.push_back(problem.contacts[random.below(problem.contacts.size())]);
  }
  return problem;
}

/// v = base + W p of a frictionless problem, dense.
struct Lcp {
  MatrixXd w, jacobian, inverse_mass;
  VectorXd base, free;
};

Lcp dense_lcp(const ContactProblem& problem) {
  const auto n = static_cast<Eigen::Index>(problem.contacts.size()),
             m = 6 * static_cast<Eigen::Index>(problem.bodies.size());
  Lcp lcp{MatrixXd::Zero(n, n), MatrixXd::Zero(n, m), MatrixXd::Zero(m, m), VectorXd::Zero(n),
          VectorXd::Zero(m)};
  for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
    const PushedBody& body = problem.bodies[b];
    lcp.inverse_mass.block<3, 3>(6 * b, 6 * b).diagonal().setConstant(body.inverse_mass);
    lcp.inverse_mass.block<3, 3>(6 * b + 3, 6 * b + 3) = body.inverse_inertia_world;
    lcp.free.segment<3>(6 * b) = body.velocity_world;
    lcp.free.segment<3>(6 * b + 3) = body.omega_world;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const PushingContact& c = problem.contacts[i];
    for (const int body : {c.body_a, c.body_b}) {
      const Vector3d d = (body == c.body_a ? 1 : -1) * c.normal_b_to_a_world;
      lcp.jacobian.block<1, 3>(i, 6 * body) += d.transpose();
      lcp.jacobian.block<1, 3>(i, 6 * body + 3) +=
          (c.point_world - problem.bodies[body].com_world).cross(d).transpose();
    }
    lcp.base[i] = -c.target;
  }
  lcp.base += lcp.jacobian * lcp.free;
  lcp.w = lcp.jacobian * lcp.inverse_mass * lcp.jacobian.transpose();
  return lcp;
}

/// The velocities (unique) after trying every set of closed contacts: the one with the least
/// violation.
VectorXd velocities_by_enumeration(const Lcp& lcp) {
  const Eigen::Index n = lcp.base.size();
  VectorXd best = VectorXd::Zero(n);
  double least = std::numeric_limits<double>::infinity();
  for (int set = 0; set < (1 << n); ++set) {
    std::vector<Eigen::Index> closed;
    for (Eigen::Index i = 0; i < n; ++i)
      if (set >> i & 1) closed.push_back(i);
    VectorXd p = VectorXd::Zero(n);
    if (!closed.empty()) {
      const MatrixXd w = lcp.w(closed, closed);
      const VectorXd right = -lcp.base(closed), pushes = least_squares(w, right);
      p(closed) = pushes;
    }
    const VectorXd v = lcp.base + lcp.w * p;
    const double violation = std::max({-v.minCoeff(), -p.minCoeff(), std::abs(p.dot(v))});
    if (violation < least) {
      least = violation;
      best = p;
    }
  }
  return lcp.free + lcp.inverse_mass * lcp.jacobian.transpose() * best;
}

TEST(RandomContacts, FrictionlessOnesAgreeWithTryingEverySet) {
  constexpr int kProblems = 3000;
  Random random(1);
  for (int k = 0; k < kProblems; ++k) {
    const ContactProblem problem = random_problem(random, {.most_bodies = 3,
                                                           .most_contacts = 7,
                                                           .mass_decades = 1,
                                                           .most_friction = 0,
                                                           .least_target = 0.1,
                                                           .duplicates = false});
    const ContactSolution solution = solve_contacts(problem);
    ASSERT_TRUE(solution.converged) << k;
    const VectorXd exact = velocities_by_enumeration(dense_lcp(problem));
    for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
      ASSERT_LE((exact.segment<3>(6 * b) - solution.velocities[b].linear_world).norm(), 1e-8) << k;
      ASSERT_LE((exact.segment<3>(6 * b + 3) - solution.velocities[b].angular_world).norm(), 1e-8)
          << k;
    }
  }
}

/// Problems whose solution says that it is none; the others are held to the law.
int failures_among(int problems, int seed, const Recipe& recipe) {
  Random random(seed);
  int failures = 0;
  for (int k = 0; k < problems; ++k) {
    const ContactProblem problem = random_problem(random, recipe);
    const ContactSolution solution = solve_contacts(problem);
    if (!solution.converged) {
      ++failures;
      continue;
    }
    const Verdict verdict = judge(problem, solution);
    EXPECT_LE(verdict.worst(), 1e-9) << k << " " << solution.residual << ": " << verdict;
  }
  return failures;
}

// A few contacts a body, as convex bodies have: thousands without one failure.
TEST(RandomContacts, OfAFewContactsObeyTheLaw) {
  EXPECT_LE(
      failures_among(2000, 2,
                     {.most_bodies = 4, .most_contacts = 6, .mass_decades = 4, .most_friction = 1}),
      2);
  EXPECT_LE(
      failures_among(
          1000, 3, {.most_bodies = 20, .most_contacts = 20, .mass_decades = 2, .most_friction = 1}),
      1);
}

// Up to forty contacts pressed on a handful of bodies from all sides, friction up to 2, masses 1 :
// 10^4: jams, in which no method known is sure to arrive. About one in thirty is not solved to
// 1e-12, and says so.
TEST(RandomContacts, InJamsObeyTheLawOrSayThatTheyDoNot) {
  EXPECT_LE(failures_among(300, 4, {.most_bodies = 10}), 25);
}

// Points that are apart and open are left out of sweeps until their bodies have changed enough: with
// them the sweeps give the same bits, and as much rounding.
TEST(Sweeps, OpenContactsLeftOutChangeNoBit) {
  constexpr int kSweeps = 30;
  Random random(31);
  int open = 0, closed = 0;
  for (int k = 0; k < 200; ++k) {
    ContactProblem problem = random_problem(random, {.most_bodies = 20, .most_contacts = 120});
    for (PushingContact& contact : problem.contacts)  // most are apart
      if (random.unit() < 0.7) contact.target -= random.between(0, 4);
    const contacts::System system = contacts::build_system(problem);
    contacts::Impulses lazy = contacts::warm_start_of(system, problem), plain = lazy;
    contacts::Sweeper lazily(system), plainly(system);
    for (int i = 0; i < kSweeps; ++i) {
      plainly.begin();  // looks at all
      const auto swept = lazily.sweep(i % 2 == 0, lazy),
                 expected = plainly.sweep(i % 2 == 0, plain);
      ASSERT_EQ(swept.change, expected.change);
      ASSERT_EQ(swept.rounding, expected.rounding);
      ASSERT_EQ(swept.rounding, contacts::rounding_floor(system, lazy));
      ASSERT_EQ(lazy.contacts, plain.contacts);
      ASSERT_EQ(lazy.y, plain.y);
    }
    for (const Vector3d& impulse : lazy.contacts) ++(impulse[0] == 0 ? open : closed);
  }
  EXPECT_GT(open, 1000);
  EXPECT_GT(closed, 1000);
}

}  // namespace
}  // namespace tumble::testing
