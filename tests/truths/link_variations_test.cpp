// Springs, pendulums, tops, blocks and rollers other than those of the files, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/truths/memory_scene.h"
#include "tests/truths/made_case.h"
#include "tests/truths/truths.h"

namespace tumble::testing {
namespace {

using truths::Verdict;

constexpr double kUlp = 0x1p-53;
constexpr double kGravity = 9.81;

void expect_right(const MadeCase& made, const std::string& what) {
  static const Reference reference;
  const auto lines = reference.compare(made.truth());
  EXPECT_EQ(truths::verdict_of(lines), Verdict::kRight) << what << failures(lines);
}

// ---- Springs -----------------------------------------------------------------------------------

struct Oscillation {
  double x, v;
};

/// x'' + 2 b x' + w^2 x = 0.
Oscillation oscillation(double w, double b, double x0, double v0, double t) {
  const double square = w * w - b * b, q = std::sqrt(std::abs(square)), s = v0 + b * x0,
               decay = std::exp(-b * t);
  if (square > 0)
    return {decay * (x0 * std::cos(q * t) + s / q * std::sin(q * t)),
            decay * (v0 * std::cos(q * t) - (b * s + q * q * x0) / q * std::sin(q * t))};
  return {decay * (x0 * std::cosh(q * t) + s / q * std::sinh(q * t)),
          decay * (v0 * std::cosh(q * t) + (q * q * x0 - b * s) / q * std::sinh(q * t))};
}

TEST(LinkVariations, SpringsOfOtherMassesStiffnessesAndDampings) {
  struct {
    double m, k, c, x0, v0, t;
  } cases[] = {{3.0, 7.0, 0.0, -0.4, 1.5, 4.0},
               {0.02, 500.0, 0.3, 0.01, 0.0, 0.3},
               {5.0, 20.0, 80.0, 0.5, -2.0, 1.5},
               {1.0, 9.0, 1.0, 0.0, 2.0, 2.0},
               {200.0, 1e5, 0.0, 0.0, 0.1, 1.0}};
  for (const auto& s : cases) {
    const double w = std::sqrt(s.k / s.m), b = s.c / (2 * s.m), size = std::hypot(s.x0, s.v0 / w);
    const Oscillation end = oscillation(w, b, s.x0, s.v0, s.t);
    // Phases are rounded at their own size; a damped start at x = 0 has a spring of finite length,
    // whose rounding does not decay.
    const double floor = kUlp * 4.0 * size * (1.0 + w * s.t);
    const double energy = 0.5 * s.m * end.v * end.v + 0.5 * s.k * end.x * end.x;
    MadeCase made("spring_mass");
    made.input("m", s.m)
        .input("k", s.k)
        .input("c", s.c)
        .input("x0", s.x0)
        .input("v0", s.v0)
        .input("times", list_of({s.t}));
    const std::string t = "t" + exact_text(s.t);
    made.output("omega_natural", w, kUlp * w)
        .output("damping_ratio", b / w, kUlp)
        .output("undamped_period", 2 * M_PI / w, 2 * kUlp / w);
    made.output("dt_limit_symplectic_euler", 2 / w, kUlp * 2 / w)
        .output("dt_limit_rk4_undamped", 2 * std::sqrt(2.0) / w, kUlp * 3 / w);
    made.output("x_" + t, end.x, floor)
        .output("v_" + t, end.v, floor * w)
        .output("energy_" + t, energy, s.k * size * floor);
    expect_right(made, "k = " + std::to_string(s.k) + ", c = " + std::to_string(s.c));
  }
}

// A bob on a horizontal circle of radius r below the anchor: k (L - L0) cos(a) = m g, k (L - L0)
// sin(a) = m w^2 r.
TEST(LinkVariations, ElasticConicalPendulum) {
  const double m = 0.7, k = 90.0, L0 = 0.6, L = 0.8, force = k * (L - L0),
               cosine = m * kGravity / force, r = L * std::sqrt(1 - cosine * cosine);
  const double w = std::sqrt(force / L / m), h = L * cosine, t = 2.5, turn = w * t;
  MadeCase made("elastic_pendulum");
  made.input("m", m)
      .input("k", k)
      .input("L0", L0)
      .input("g", kGravity)
      .input("x0", vector_of({r, 0, -h}))
      .input("v0", vector_of({0, w * r, 0}))
      .input("times", list_of({t}));
  const double stretch = L - L0;
  made.output("energy", 0.5 * m * w * w * r * r - m * kGravity * h + 0.5 * k * stretch * stretch,
              1e-15)
      .output("Lz", m * w * r * r, 1e-16);
  made.output("x_t2.5", vector_of({r * std::cos(turn), r * std::sin(turn), -h}), 2e-15)
      .output("v_t2.5", vector_of({-w * r * std::sin(turn), w * r * std::cos(turn), 0}), 1e-14);
  expect_right(made, "conical");
}

// ---- Pendulums ---------------------------------------------------------------------------------

// A hanging chain at rest: rod i carries all the weight below it.
TEST(LinkVariations, ChainAtRestCarriesWhatHangsOnIt) {
  const std::vector<double> masses{2.0, 0.001, 30.0}, lengths{0.5, 1.0, 0.2}, zeros(3, 0.0),
      tensions{32.001 * kGravity, 30.001 * kGravity, 30.0 * kGravity};
  MadeCase made("chain");
  made.input("masses", list_of(masses))
      .input("lengths", list_of(lengths))
      .input("g", kGravity)
      .input("theta0", list_of(zeros))
      .input("omega0", list_of(zeros))
      .input("times", list_of({0.5}));
  const truths::Value::List places{
      {"row", list_of({0, -0.5})}, {"row", list_of({0, -1.5})}, {"row", list_of({0, -1.7})}},
      still(3, {"row", list_of({0, 0})});
  made.output("energy", -kGravity * (2.0 * 0.5 + 0.001 * 1.5 + 30.0 * 1.7), 1e-13)
      .output("rod_tensions_t0", list_of(tensions), 1e-13);
  made.output("positions_t0.5", places, 1e-16)
      .output("velocities_t0.5", still, 1e-16)
      .output("theta_t0.5", list_of(zeros), 1e-16)
      .output("omega_t0.5", list_of(zeros), 1e-16);
  made.output("rod_tensions_t0.5", list_of(tensions), 1e-13);
  expect_right(made, "hanging chain");
}

// A straight chain released from rest at an angle: rod i carries the component along itself of the
// weight below it, and with a light bob in the chain the matrix of the rods has a condition of four
// times the ratio of masses.
TEST(LinkVariations, TensionsOfARowThatIsLetGo) {
  for (const double ratio : {1.0, 1e2, 1e4, 1e6}) {
    const double angle = 0.5, pull = kGravity * std::cos(angle);
    const std::vector<double> masses{1.0 / ratio, 1.0}, lengths{1.0, 0.7}, angles{angle, angle},
        tensions{(1.0 + 1.0 / ratio) * pull, pull};
    for (const double part : {0.0, 1e-6}) {  // of the tension: a wrong one must fail
      MadeCase made("double_pendulum");
      made.input("masses", list_of(masses))
          .input("lengths", list_of(lengths))
          .input("g", kGravity)
          .input("theta0", list_of(angles))
          .input("omega0", list_of({0.0, 0.0}))
          .input("times", truths::Value::List{});
      made.output("energy", -kGravity * std::cos(angle) * (masses[0] * 1.0 + 1.7), 1e-14)
          .output("rod_tensions_t0", list_of({tensions[0], tensions[1] * (1.0 + part)}),
                  2 * kUlp * tensions[0]);
      static const Reference reference;
      EXPECT_EQ(truths::verdict_of(reference.compare(made.truth())),
                part == 0.0 ? Verdict::kRight : Verdict::kWrong)
          << ratio << ' ' << part;
    }
  }
}

// All mass in one point: a rod in place of a hinge. T = 4 K(sin(theta0 / 2)) / w0.
TEST(LinkVariations, PointPendulumOfAnyAngle) {
  for (const double angle : {-2.0, 0.3, 1.2}) {
    const double d = 0.4, m = 3.0, w0 = std::sqrt(kGravity / d),
                 T = 4.0 * std::comp_ellint_1(std::abs(std::sin(0.5 * angle))) / w0;
    const double bottom = 2.0 * w0 * std::abs(std::sin(0.5 * angle));
    MadeCase made("compound_pendulum");
    made.input("m", m)
        .input("d_pivot_to_com", d)
        .input("I_about_pivot", m * d * d)
        .input("g", kGravity)
        .input("theta0", angle);
    made.output("period", T, 4e-16)
        .output("energy", -m * kGravity * d * std::cos(angle), 2e-15)
        .output("thetadot_bottom", bottom, 2e-15);
    const double pull = m * kGravity * std::cos(angle);  // along the rod, at rest
    made.output("pivot_force_t0", list_of({-pull * std::sin(angle), pull * std::cos(angle)}),
                4e-15);
    made.output("theta_at_0.5T", -angle, 1e-15)
        .output("thetadot_at_0.5T", 0.0, 4e-15)
        .output("pivot_force_at_0.5T", list_of({pull * std::sin(angle), pull * std::cos(angle)}),
                2e-14);
    expect_right(made, "theta0 = " + std::to_string(angle));
  }
}

// ---- Blocks and rollers ------------------------------------------------------------------------

void expect_block(double v0, double degrees, double mu, double m) {
  const double angle = degrees * M_PI / 180,
               a = kGravity * (mu * std::cos(angle) - std::sin(angle)),
               normal = m * kGravity * std::cos(angle);
  MadeCase made("friction_incline");
  made.input("v0", v0)
      .input("alpha_deg", degrees)
      .input("mu", mu)
      .input("g", kGravity)
      .input("m", m);
  made.output("deceleration", a, 2e-15)
      .output("normal_force", normal, kUlp * 4 * normal)
      .output("friction_force_sliding", mu * normal, kUlp * 4 * mu * normal);
  made.output("critical_mu", std::tan(angle), 1e-16);
  if (a > 0) {
    const double part = 2e-15 / a;
    made.output("stop_time", v0 / a, v0 / a * part)
        .output("stop_distance", v0 * v0 / (2 * a), v0 * v0 / a * part);
    made.output("friction_force_rest", m * kGravity * std::abs(std::sin(angle)),
                kUlp * 4 * m * kGravity)
        .output("energy_dissipated", mu * normal * v0 * v0 / (2 * a),
                mu * normal * v0 * v0 / a * part);
  } else {
    made.output("stop_time", std::monostate{}, 0.0);
  }
  expect_right(made, std::to_string(degrees) + " deg, mu = " + std::to_string(mu));
}

// The end of sliding uphill, where friction reverses, is located to 1e-5 m only: to be enabled when
// it is exact.
TEST(LinkVariations, BlocksUphill) { expect_block(4.0, -15.0, 0.4, 2.0); }

TEST(LinkVariations, BlocksSteepSmoothAndHeavy) {
  expect_block(0.5, 60.0, 2.5, 0.1);
  expect_block(1.0, 10.0, 0.1, 1.0);  // accelerates
  expect_block(1.0, 0.0, 0.0, 1.0);   // slides at constant speed
  expect_block(2.0, 5.0, 0.3, 1e4);
}

void expect_roller(double beta, double R, double degrees, double mu, double T, double m) {
  const double angle = degrees * M_PI / 180, critical = std::tan(angle) * beta / (1 + beta),
               g = kGravity;
  const bool rolls = mu >= critical;
  const double a =
      rolls ? g * std::sin(angle) / (1 + beta) : g * (std::sin(angle) - mu * std::cos(angle));
  const double friction = rolls ? m * g * std::sin(angle) * beta / (1 + beta)
                                : m * mu * g * std::cos(angle),
               spin = friction / (beta * m * R);
  MadeCase made("roll_incline");
  made.input("beta", beta)
      .input("R", R)
      .input("alpha_deg", degrees)
      .input("mu", mu)
      .input("g", g)
      .input("T", T)
      .input("m", m);
  made.output("rolls_without_slip", truths::Value::Content(rolls), 0.0)
      .output("critical_mu", critical, 1e-16)
      .output("acceleration", a, 2e-15);
  made.output("angular_acceleration", spin, 2e-15 / R)
      .output("friction_force", friction, 1e-15 * m)
      .output("x_T", 0.5 * a * T * T, 2e-15 * T * T);
  made.output("v_T", a * T, 2e-15 * T).output("omega_T", spin * T, 4e-15 * T / R);
  expect_right(made, "beta = " + std::to_string(beta) + ", " + std::to_string(degrees) +
                         " deg, mu = " + std::to_string(mu));
}

TEST(LinkVariations, HoopsCylindersAndSmoothRollers) {
  expect_roller(1.0, 0.3, 25.0, 0.5, 1.0, 2.0);
  expect_roller(1.0, 0.3, 25.0, 0.2, 1.0, 2.0);
  expect_roller(0.5, 1.5, 5.0, 0.05, 3.0, 100.0);
  expect_roller(0.4, 0.1, 35.0, 0.0, 0.7, 0.5);
}

void expect_slip(double beta, double R, double v0, double w0, double mu, double m) {
  const double slip = v0 - R * w0, sign = slip < 0 ? -1.0 : 1.0,
               t = std::abs(slip) / (mu * kGravity * (1 + 1 / beta)),
               v = (v0 + beta * R * w0) / (1 + beta);
  const double lost = m * slip * slip * beta / (2 * (1 + beta)),
               size = std::abs(v0) + std::abs(R * w0);
  MadeCase made("slip_to_roll");
  made.input("beta", beta)
      .input("R", R)
      .input("v0", v0)
      .input("omega0_forward", w0)
      .input("mu", mu)
      .input("g", kGravity)
      .input("m", m);
  made.output("roll_time", t, kUlp * 4 * t)
      .output("roll_velocity", v, kUlp * 4 * size)
      .output("roll_omega", v / R, kUlp * 4 * size / R);
  made.output("roll_distance", v0 * t - sign * 0.5 * mu * kGravity * t * t, kUlp * 4 * size * t)
      .output("energy_lost", lost, kUlp * 8 * m * size * size);
  expect_right(made, "v0 = " + std::to_string(v0) + ", w0 = " + std::to_string(w0));
}

TEST(LinkVariations, HoopsBackwardsAndRollersThatNeverSlip) {
  expect_slip(1.0, 0.5, 3.0, 0.0, 0.25, 2.0);
  expect_slip(0.5, 0.1, -2.0, 0.0, 0.6, 0.3);
  expect_slip(0.4, 0.2, 0.0, 50.0, 0.1, 10.0);
  expect_slip(0.4, 0.25, 1.0, 4.0, 0.3, 1.0);  // rolls from the start
}

}  // namespace
}  // namespace tumble::testing
