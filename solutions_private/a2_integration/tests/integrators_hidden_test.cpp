// Hidden: Euler and Runge-Kutta where their answers are known in closed form.
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

const std::string kOrder = "handouts/a2_integration.md#order";

// y = (cos t, -sin t): a unit mass on a unit spring.
VectorXd oscillator(double, const VectorXd& y) { return vector({y[1], -y[0]}); }

TEST(EulerStep, BlowsUpAnOscillationAsPredicted) {
  // Each step multiplies the amplitude by sqrt(1 + h^2), exactly.
  const double h = 0.1;
  const VectorXd y = integrate(a2_module().euler_step, oscillator, 0, vector({1, 0}), 100 * h, 100);
  const double expected = std::pow(1 + h * h, 50);
  expect_near(y.norm(), expected, 500 * kEps * expected, "m (amplitude)",
              {.scene = "a unit mass on a unit spring, y = (1, 0)",
               .steps = "100 steps of 0.1 s",
               .slip = y.norm() < 1.001 ? "this method keeps the amplitude: it is not Euler's (the "
                                          "new velocity must not be used for the position)"
                                        : "y + h f(t, y)",
               .handout = equation(1)});
}

TEST(EulerStep, StepsBackwardsAndNotAtAll) {
  Diary diary;
  const OdeFunction f = scripted(diary, {vector({3, -4})});
  expect_near(a2_module().euler_step(f, 5.0, vector({1, 2}), -0.25), vector({0.25, 3.0}), 0.0, "",
              {.scene = "y = (1, 2), slope (3, -4), h = -0.25 s",
               .slip = "the sign of h",
               .handout = equation(1)});
  expect_near(a2_module().euler_step(f, 5.0, vector({1, 2}), 0.0), vector({1, 2}), 0.0, "",
              {.scene = "y = (1, 2), slope (3, -4), h = 0",
               .slip = "the slope is not multiplied by h",
               .handout = equation(1)});
}

TEST(Rk4Step, DecaysByTaylorsPolynomial) {
  // y' = -y: one step multiplies by 1 + z + z^2/2 + z^3/6 + z^4/24 with z = -h, whatever the size
  // of h.
  for (const double z : {-0.125, -1.0, -3.0, 2.0}) {
    const OdeFunction f = [](double, const VectorXd& y) { return VectorXd(-y); };
    const double expected = 1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)));
    expect_near(a2_module().rk4_step(f, 0, vector({1}), -z)[0], expected,
                50 * kEps * (1 + std::abs(expected)), "",
                {.scene = "y' = -y, y = 1, one step of h = " + show(-z) + " s",
                 .slip = "a stage or a weight: the factor must be Taylor's, up to z^4 / 24",
                 .handout = equation(2)});
  }
}

TEST(Rk4Step, LosesEnergyAsPredicted) {
  // |R(ih)|^2 = 1 - h^6/72 + h^8/576, per step and exactly.
  const double h = 0.5;
  const VectorXd y = integrate(a2_module().rk4_step, oscillator, 0, vector({1, 0}), 100 * h, 100);
  const double expected = std::pow(1 - std::pow(h, 6) / 72 + std::pow(h, 8) / 576, 100);
  expect_near(y.squaredNorm(), expected, 2000 * kEps, "J (twice the energy)",
              {.scene = "a unit mass on a unit spring, y = (1, 0)",
               .steps = "100 steps of 0.5 s",
               .slip = "a stage or a weight: energy falls by h^6 / 72 a step",
               .handout = kOrder});
}

TEST(Rk4Step, TreatsEveryNumberOfTheStateAlike) {
  Random random(2);
  VectorXd y(40), rates(40);
  for (int i = 0; i < 40; ++i) y[i] = random.between(-2, 2), rates[i] = random.between(-2, 2);
  const VectorXd found = a2_module().rk4_step(
      [&](double, const VectorXd& at) { return VectorXd(rates.cwiseProduct(at)); }, 0, y, 0.5);
  const VectorXd z = 0.5 * rates;
  const VectorXd factor =
      (1 + z.array() * (1 + z.array() / 2 * (1 + z.array() / 3 * (1 + z.array() / 4)))).matrix();
  expect_near(found, factor.cwiseProduct(y), 50 * kEps * 8, "",
              {.scene = "40 numbers, each growing at a rate of its own",
               .slip = "states of any size must work",
               .handout = equation(2)});
}

TEST(Rk4Step, BringsAPlanetHomeWithOrderFour) {
  // An orbit of eccentricity 0.3 with GM = 1 and semi-axis 1 closes after 2 pi. Orders of a correct
  // step here: 4.09 and 4.05, from above.
  const OdeFunction gravity = [](double, const VectorXd& y) {
    const double r = y.head<2>().norm();
    return vector({y[2], y[3], -y[0] / (r * r * r), -y[1] / (r * r * r)});
  };
  const VectorXd start = vector({0.7, 0, 0, std::sqrt(1.3 / 0.7)});
  const auto found =
      observed_orders(a2_module().rk4_step, gravity, 0, start, 2 * M_PI, start, 400, 2);
  expect_orders(found, 4.0, 0.15,
                {.scene = "one orbit of eccentricity 0.3",
                 .steps = "400, 800, 1600 steps",
                 .slip = "a stage is built on the wrong slope",
                 .handout = kOrder});
}

TEST(Rk4Step, SymmetricTopPrecessesAtItsOwnRate) {
  // Disc, moments 1, 1, 2, w = (0.4, 0.3, 5) rad/s: w turns about the axis at 5 rad/s of phase;
  // the value at 1 s is exact.
  const OdeFunction disc = [](double, const VectorXd& w) {
    const Vector3d moments(1, 1, 2), omega = w;
    return VectorXd(moments.cwiseProduct(omega).cross(omega).cwiseQuotient(moments));
  };
  const VectorXd exact =
      vector({0.401142156584232046454601990452, -0.298471054226287508217270011008, 5.0});
  const auto found =
      observed_orders(a2_module().rk4_step, disc, 0, vector({0.4, 0.3, 5}), 1.0, exact, 25, 3);
  expect_orders(found, 4.0, 0.1,
                {.scene = "a free disc, moments 1, 1, 2 kg m^2, for 1 s",
                 .steps = "25, 50, 100, 200 steps",
                 .slip = "a stage is built on the wrong slope",
                 .handout = kOrder});
}

}  // namespace
}  // namespace tumble::a2_testing
