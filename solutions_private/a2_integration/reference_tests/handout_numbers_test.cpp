// Every table of numbers in handouts/a2_integration.md, computed anew with the reference solution:
// what the handout prints between `<!-- numbers: NAME -->` and the next empty line must be what
// comes out here, character by character.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "assignments/a2_integration/a2_integration.h"

namespace tumble::a2 {
namespace {

constexpr double kDegree = M_PI / 180;

// ---- Tables -------------------------------------------------------------------------------------

template <class... Numbers>
std::string text(const char* format, Numbers... numbers) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, numbers...);
  return buffer;
}

/// A size that is all rounding differs between processors: only its bound is printed.
std::string size_of(double x) { return std::abs(x) < 1e-14 ? "below 1e-14" : text("%.2g", x); }

std::string row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  return line + "\n";
}

/// Rows of the table in the handout, without its head.
std::string printed(const std::string& name) {
  std::ifstream in(test::source_dir() + "/handouts/a2_integration.md");
  std::string line, rows;
  while (std::getline(in, line) && line != "<!-- numbers: " + name + " -->") {
  }
  bool in_body = false;
  while (std::getline(in, line) && line.starts_with("|")) {
    if (in_body) rows += line + "\n";
    in_body = in_body || line.starts_with("|-");
  }
  return rows;
}

void expect_printed(const std::string& name, const std::string& rows) {
  EXPECT_TRUE(printed(name) == rows)
      << "handouts/a2_integration.md should print under `<!-- numbers: " << name << " -->`:\n"
      << rows;
}

VectorXd scalar(double x) { return VectorXd::Constant(1, x); }

// ---- The lecture's example ----------------------------------------------------------------------

VectorXd logistic(double, const VectorXd& y) { return scalar(6 * y[0] - 0.007 * y[0] * y[0]); }
double exact_logistic(double t) {
  return 6 / 0.007 / (1 + (6 / 0.007 / 10 - 1) * std::exp(-6 * t));
}

template <class Step>
double march(const Step& step, int steps) {
  VectorXd y = scalar(10);
  for (int i = 0; i < steps; ++i) y = step(logistic, i * 0.5 / steps, y, 0.5 / steps);
  return y[0];
}

TEST(HandoutOfA2, LectureStep) {
  std::string rows;
  int stage = 0;
  const char* at[] = {"$y$", "$y + \\frac h2 k_1$", "$y + \\frac h2 k_2$", "$y + h\\,k_3$"};
  const OdeFunction watched = [&](double t, const VectorXd& y) {
    const VectorXd slope = logistic(t, y);
    rows += row({text("$k_%d$", stage + 1), text("%.2f", t), at[stage], text("%.4f", y[0]),
                 text("%.4f", slope[0])});
    ++stage;
    return slope;
  };
  rk4_step(watched, 0, scalar(10), 0.5);
  expect_printed("lecture-step", rows);
}

TEST(HandoutOfA2, LectureSideBySide) {
  std::string rows;
  double euler_before = kUnset, rk4_before = kUnset;
  for (int steps = 1; steps <= 256; steps *= 2) {
    const double euler = march(euler_step, steps), rk4 = march(rk4_step, steps);
    const double euler_error = euler - exact_logistic(0.5), rk4_error = rk4 - exact_logistic(0.5);
    const auto order = [&](double before, double now) {
      return steps == 1 ? std::string("") : text("%.2f", std::log2(before / now));
    };
    rows += row({text("%d", steps), text("%.6g", 0.5 / steps), text("%.4f", euler),
                 text("%.3g", euler_error), order(euler_before, euler_error), text("%.4f", rk4),
                 text("%.3g", rk4_error), order(rk4_before, rk4_error)});
    euler_before = euler_error, rk4_before = rk4_error;
  }
  expect_printed("lecture-side-by-side", rows);
  EXPECT_EQ(text("%.4f", exact_logistic(0.5)), "164.2768");
}

// What the slide goes on with, if its k3 is believed, and if it is not.
TEST(HandoutOfA2, MisprintOfTheSlide) {
  const auto last_stage = [](double k3) { return 10 + 0.5 * k3; };
  expect_printed("slide", row({"263.0, as printed", text("%.2f", last_stage(263.0))}) +
                              row({"262.04, as computed", text("%.2f", last_stage(262.04))}));
}

// ---- Energy -------------------------------------------------------------------------------------

TEST(HandoutOfA2, EnergyOfASpring) {
  const OdeFunction spring = [](double, const VectorXd& y) -> VectorXd {
    return Eigen::Vector2d(y[1], -y[0]);
  };
  const auto energy_after = [&](const auto& step, int steps_a_period) {
    VectorXd y = Eigen::Vector2d(1, 0);
    for (int i = 0; i < 10 * steps_a_period; ++i)
      y = step(spring, 0.0, y, 2 * M_PI / steps_a_period);
    return y.squaredNorm();
  };
  std::string rows;
  for (const int steps : {20, 40, 80, 160})
    rows += row({text("%d", steps), text("%.3g", energy_after(euler_step, steps)),
                 text("1 - %.2g", 1 - energy_after(rk4_step, steps))});
  expect_printed("energy", rows);
}

// ---- Orientations -------------------------------------------------------------------------------

// R' = [w]x R with w = (1, 1, 1) rad/s by Euler's method, steps of 1/60 s.
TEST(HandoutOfA2, DriftingRotation) {
  const Vector3d w(1, 1, 1);
  Matrix3d w_cross;
  w_cross << 0, -1, 1, 1, 0, -1, -1, 1, 0;
  const auto off = [](const Matrix3d& R) {
    return (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  };
  Matrix3d drifting = Matrix3d::Identity(), repaired = Matrix3d::Identity();
  std::string rows;
  for (int step = 0; step <= 600; ++step) {
    const double t = step / 60.0;
    if (step == 0 || step == 60 || step == 300 || step == 600) {
      const Matrix3d exact = Eigen::AngleAxisd(w.norm() * t, w.normalized()).toRotationMatrix();
      const double angle = Eigen::AngleAxisd(Matrix3d(exact.transpose() * repaired)).angle();
      rows += row({text("%g", t), size_of(off(drifting)), text("%.4g", drifting.determinant()),
                   size_of(off(repaired)), text("%.3f", repaired.determinant()),
                   text("%.2f", angle / kDegree)});
    }
    drifting += 1 / 60.0 * w_cross * drifting;
    repaired = orthonormalize(repaired + 1 / 60.0 * w_cross * repaired);
  }
  expect_printed("drift", rows);
}

// A plane with yaw 30 and roll 0 degrees, then a turn of 0.1 degree about world x.
TEST(HandoutOfA2, NearGimbalLock) {
  std::string rows;
  for (const double pitch : {0.0, 60.0, 89.0, 89.9, 89.99}) {
    const Matrix3d before = rotation_from_euler_angles(30 * kDegree, pitch * kDegree, 0);
    const EulerAngles after = euler_angles_from_rotation(
        Eigen::AngleAxisd(0.1 * kDegree, Vector3d::UnitX()).toRotationMatrix() * before);
    rows += row({text("%g", pitch), text("%.2f", after.yaw / kDegree),
                 text("%.2f", after.pitch / kDegree), text("%.2f", after.roll / kDegree)});
  }
  expect_printed("gimbal", rows);
}

TEST(HandoutOfA2, InGimbalLock) {
  std::string rows;
  for (const double roll : {0.0, 10.0, 25.0}) {
    const Matrix3d R = rotation_from_euler_angles((20 + roll) * kDegree, M_PI / 2, roll * kDegree);
    const double difference =
        (R - rotation_from_euler_angles(20 * kDegree, M_PI / 2, 0)).cwiseAbs().maxCoeff();
    const EulerAngles back = euler_angles_from_rotation(R);
    rows += row(
        {text("%g, 90, %g", 20 + roll, roll), size_of(difference),
         text("%.0f, %.0f, %.0f", back.yaw / kDegree, back.pitch / kDegree, back.roll / kDegree)});
  }
  expect_printed("locked", rows);
}

// ---- Time of impact -----------------------------------------------------------------------------

double thrown_gap(double t) { return 4.5 + 2 * t - 4.905 * t * t; }
double thrown_rate(double t) { return 2 - 9.81 * t; }
const double kThrownImpact = (2 + std::sqrt(4 + 4 * 4.905 * 4.5)) / 9.81;

TEST(HandoutOfA2, NewtonAlone) {
  std::string rows;
  double t = 3;
  for (int i = 0; i <= 5; ++i, t -= thrown_gap(t) / thrown_rate(t))
    rows += row({text("%d", i), text("%.9f", t), text("%.1e", t - kThrownImpact)});
  expect_printed("newton", rows);
}

TEST(HandoutOfA2, LooksAtTheGap) {
  std::string rows;
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12})
    rows +=
        row({text("%.0e", tolerance),
             text("%d", impact_time_bisection(thrown_gap, 0, 3, tolerance).evaluations),
             text("%d", impact_time_newton(thrown_gap, thrown_rate, 0, 3, tolerance).evaluations)});
  expect_printed("looks", rows);
}

// Where the tangent alone leads, in the cases that the tests are about.
TEST(HandoutOfA2, NewtonGoesWrong) {
  const auto next = [](double t, double gap, double rate) { return text("%.4g", t - gap / rate); };
  const double steep = 1 - std::exp(-10.0) + 1e-2, steep_rate = -10 * std::exp(-10.0) - 1e-2;
  expect_printed("wrong",
                 row({"$5 - 4.905\\,t^2$", "0", next(0, 5, -0.0),
                      "slope 0 where a fall starts: a division by zero"}) +
                     row({"$1 - e^{10(t-1)} + 0.01\\,(1 - t)$", "0", next(0, steep, steep_rate),
                          "out of the interval [0, 2.3] s"}) +
                     row({"$4.5 + 2t - 4.905\\,t^2$", "0", next(0, thrown_gap(0), thrown_rate(0)),
                          "into the past: the ball still rises"}));
}

// A bullet of 5 mm radius at 1000 m/s, its surface 10.5 m before a wall of 1 mm, steps of 10 ms.
TEST(HandoutOfA2, Tunnelling) {
  std::string rows;
  // signed
  const auto to_face = [](double t) { return 10.5 - 1000 * t; };
  // to the nearer side
  const auto to_wall = [](double t) {
    return std::max(10.5 - 1000 * t, 1000 * t - 10.5 - 0.001 - 0.01);
  };
  for (const double t : {0.0, 0.01, 0.02, 0.03})
    rows += row({text("%g", 1000 * t), text("%.3f", to_wall(t)), text("%.1f", to_face(t))});
  expect_printed("tunnelling", rows);
  const RootResult found = impact_time_newton(
      to_face, [](double) { return -1000.0; }, 0.01, 0.02, 1e-12);
  EXPECT_EQ(text("%.4f", 1000 * found.time), "10.5000");
  EXPECT_EQ(impact_time_newton(
                to_wall, [](double) { return -1000.0; }, 0.01, 0.02, 1e-12)
                .status,
            RootStatus::kNoSignChange);
}

}  // namespace
}  // namespace tumble::a2
