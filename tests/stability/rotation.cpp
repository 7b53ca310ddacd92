// Rows 25 and 26: orientations over a million steps, and angles where they lock.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "assignments/a2_integration/a2_integration.h"
#include "framework/core/random.h"
#include "tests/stability/cases.h"
#include "tests/stability/methods.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

// ---- Row 25 -------------------------------------------------------------------------------------

struct Drift {
  double orthonormal = 0.0, determinant = 0.0;
  report::Curve curve;
};

/// A ball that turns at 1 rad/s by steps of 0.01 s, by the laws themselves: 10^6 steps of the
/// engine would measure the same.
Drift turn(const std::string& name, const Laws& laws, long steps) {
  constexpr double h = 0.01;
  const Inertia inertia = finite_inertia(1.0, Matrix3d::Identity());
  const OdeFunction f = [&](double, const VectorXd& y) {
    return laws.state_derivative(unpack(y), inertia, {Vector3d::Zero(), Vector3d::Zero()});
  };
  RigidBodyState state{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                       Vector3d(0.48, 0.6, 0.64)};
  Drift drift;
  drift.curve.name = name;
  for (long i = 1; i <= steps; ++i) {
    state = unpack(laws.integrate_step(f, static_cast<double>(i - 1) * h, pack(state), h));
    state.world_from_body = laws.renormalize(state.world_from_body);
    if (i % (steps / 500) != 0) continue;
    const Matrix3d R = state.world_from_body.toRotationMatrix();
    drift.orthonormal = std::max(drift.orthonormal,
                                 (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff());
    drift.determinant = std::max(drift.determinant, std::abs(R.determinant() - 1));
    drift.curve.x.push_back(static_cast<double>(i));
    drift.curve.y.push_back(std::max(std::abs(state.world_from_body.squaredNorm() - 1), 1e-17));
  }
  return drift;
}

void rotation_drift(const Given& given, Findings& findings) {
  const long steps = given.is_long ? 1000000 : 50000;
  const Laws normalised = with_method(given.laws, "RK4", rk4);
  Laws drifting = normalised;
  drifting.renormalize = [](const Quaterniond& q) { return q; };
  const Drift kept = turn("normalised at every step", normalised, steps),
              drifted = turn("not normalised", drifting, steps);
  const std::string name = fmt::format("{} steps of w h = 0.01", steps);
  findings.at_most(name + ": |R^T R - 1|", kept.orthonormal, 1e-12, "",
                   "a few roundings, whatever the number of steps");
  findings.at_most(name + ": |det R - 1|", kept.determinant, 1e-14, "", "a few roundings");
  findings.must_fail("quaternion not normalised: |R^T R - 1|", drifted.orthonormal, 1e-12, "",
                     "RK4 changes |q|^2 by (w h / 2)^6 / 72 = 2e-16 at every step");
  const double predicted = static_cast<double>(steps) * std::pow(0.005, 6) / 72;
  findings.at_most("quaternion not normalised: ||q|^2 - 1| against (w h / 2)^6 / 72 a step",
                   std::abs(drifted.curve.y.back() / predicted - 1), 0.1, "",
                   "measured = predicted within 10 %");
  findings.plot({"Length of a quaternion",
                 {"step"},
                 {"||q|^2 - 1|", "", report::Scale::kLog},
                 {kept.curve, drifted.curve},
                 {{1e-12, "threshold"}},
                 "Without normalising, what each step does to the length adds up."});
}

// ---- Row 26 -------------------------------------------------------------------------------------

/// yaw', pitch', roll' of a body that turns at omega_body.
VectorXd angle_rates(double, const VectorXd& y, const Vector3d& omega_body) {
  VectorXd rates(3);
  const double s = std::sin(y[2]), c = std::cos(y[2]);
  rates << (omega_body.y() * s + omega_body.z() * c) / std::cos(y[1]),
      omega_body.y() * c - omega_body.z() * s,
      omega_body.x() + (omega_body.y() * s + omega_body.z() * c) * std::tan(y[1]);
  return rates;
}

void through_the_pole(const Given& given, const a2::Module* a2, Findings& findings) {
  // Turns at constant omega: closed form. The axis misses the pole of the angles by 1e-4.
  const Vector3d omega(1e-4, 1.0, 0.0);
  constexpr double h = 1e-3;
  const auto steps = static_cast<long>(std::numbers::pi / h);
  scene::Scene scene = truths::empty_scene("nose over", 1.0, 1e-9);
  scene::BodySpec body = truths::point_mass("body", 1.0, Vector3d::Zero(), Vector3d::Zero());
  body.inertia_body_kg_m2 = Matrix3d::Identity();
  body.omega_world_rad_s = omega;
  scene.bodies = {body};
  const Trajectory run = truths::run_in_steps(scene, with_method(given.laws, "RK4", rk4),
                                              static_cast<double>(steps) * h, steps, steps);
  report::Curve quaternion{"quaternion", {}, {}}, angles{"three angles", {}, {}};
  VectorXd y = VectorXd::Zero(3);
  double worst = 0.0, worst_angles = 0.0;
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    const double t = run.frames[i].time;
    const Quaterniond exact(Eigen::AngleAxisd(omega.norm() * t, omega.normalized()));
    y = rk4([&](double time, const VectorXd& state) { return angle_rates(time, state, omega); }, t,
            y, h);
    const double error = angle_between(exact, run.frames[i].poses[0].world_from_body);
    const double by_angles =
        a2 == nullptr
            ? kUnset
            : angle_between(exact, Quaterniond(a2->rotation_from_euler_angles(y[0], y[1], y[2])));
    worst = std::max(worst, error);
    worst_angles = std::max(worst_angles, by_angles);
    quaternion.x.push_back(t), quaternion.y.push_back(std::max(error, 1e-17));
    angles.x.push_back(t),
        angles.y.push_back(std::isnan(by_angles) ? by_angles : std::max(by_angles, 1e-17));
  }
  findings.at_most("pitch through 90 degrees, quaternion, RK4 at w h = 1e-3: orientation", worst,
                   1e-12, "rad", "(w h)^5 / 1920 a step is 1e-15 in all: roundings");
  if (a2 != nullptr)
    findings.must_fail("the same with three angles as the state: orientation", worst_angles, 1e-12,
                       "rad", "yaw and roll turn at 1 / cos(pitch)");
  findings.plot({"A body that pitches through 90 degrees",
                 {"time", "s"},
                 {"error of the orientation", "rad", report::Scale::kLog},
                 {quaternion, angles},
                 {{1e-12, "threshold"}},
                 "At 1.57 s the nose points straight down: angles as a state break there, a "
                 "quaternion does not notice."});
}

void round_trips(const a2::Module& a2, Findings& findings) {
  // Roll 0 within 1e-8 of the pole: a turn by the roll about an axis c = cos(pitch) off the one
  // meant, 2 c |sin(roll / 2)| in all.
  double worst = 0.0, lock = 0.0, loss = 0.0, near = 0.0;
  const auto trip = [&](const Matrix3d& R) {
    const a2::EulerAngles angles = a2.euler_angles_from_rotation(R);
    return a2.rotation_from_euler_angles(angles.yaw, angles.pitch, angles.roll);
  };
  const auto raise = [](double& largest, double value) {
    largest = std::isnan(value) ? INFINITY : std::max(largest, value);
  };
  Random random(26);
  for (int i = 0; i < 5000; ++i) {
    const double yaw = random.between(-std::numbers::pi, std::numbers::pi),
                 roll = random.between(-std::numbers::pi, std::numbers::pi),
                 pole = i % 2 == 0 ? 0.5 * std::numbers::pi : -0.5 * std::numbers::pi,
                 inward = pole > 0 ? -1 : 1;
    const Matrix3d far =
        a2.rotation_from_euler_angles(yaw, pole + inward * random.between(1e-3, 1.5), roll);
    raise(worst, (trip(far) - far).cwiseAbs().maxCoeff());

    const double locked = pole + inward * std::pow(10.0, random.between(-16.0, -8.0));
    const Matrix3d at = a2.rotation_from_euler_angles(yaw, locked, roll);
    const double angle = angle_between(Quaterniond(at), Quaterniond(trip(at)));
    raise(lock, angle);
    raise(loss, std::abs(angle - 2 * std::cos(locked) * std::abs(std::sin(0.5 * roll))));

    // As an engine has it: from a quaternion, so that the four small entries carry the rounding of
    // 1.
    const double off = std::pow(10.0, random.between(-8.0, -3.0));
    const Quaterniond q = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                          Eigen::AngleAxisd(pole + inward * off, Vector3d::UnitY()) *
                          Eigen::AngleAxisd(roll, Vector3d::UnitX());
    const Matrix3d R = q.normalized().toRotationMatrix();
    raise(near, (trip(R) - R).cwiseAbs().maxCoeff() * off);
  }
  findings.at_most("round trip of 5,000 random angles, more than 1e-3 off the pole", worst, 1e-12,
                   "", "a few roundings over cos(pitch)");
  findings.at_most(
      "round trip of 5,000 rotations 1e-8 to 1e-3 off the pole: error times cos(pitch)", near,
      20 * kRounding, "",
      "yaw and roll come from entries of the size of cos(pitch), each known to 4 roundings of 1 "
      "from a quaternion, and their errors add up: 2 sqrt(2) 4 u / cos(pitch), and what the other "
      "entries have");
  findings.at_most("round trip of 5,000 angles within 1e-8 of the pole", lock, 2e-8 * (1 + 1e-6),
                   "rad",
                   "1e-8 with roll 0 is 2 cos(pitch) |sin(roll / 2)|: 1e-8 up to a roll of 60 "
                   "degrees, twice that at 180");
  findings.at_most("the same against 2 cos(pitch) |sin(roll / 2)|", loss, 50 * kRounding, "rad",
                   "closed form of what leaving the roll out costs; some ten roundings each of two "
                   "matrices and two quaternions, twice in an angle");
}

void gimbal_lock(const Given& given, Findings& findings) {
  const auto found = given.modules.find("a2");
  const a2::Module* a2 =
      found == given.modules.end() ? nullptr : static_cast<const a2::Module*>(found->second.get());
  findings.part("through the pole", [&] { through_the_pole(given, a2, findings); });
  if (a2 == nullptr)
    return findings.not_run("round trip of angles, angles as a state",
                            "needs the functions of a2, which nobody provides here");
  findings.part("round trip of angles", [&] { round_trips(*a2, findings); });
}

}  // namespace

void add_rotation(std::vector<Case>& cases) {
  cases.push_back({25, "rotation drift",
                   "A million steps of turning. Each step leaves the quaternion a rounding, or an "
                   "error of the method, off unit length, and a rotation matrix off orthonormal: "
                   "bodies would shear and grow. Normalising costs a square root a step.",
                   "", rotation_drift});
  cases.push_back({26, "gimbal lock",
                   "Three angles cannot name every orientation smoothly: where the nose points "
                   "straight down, yaw and roll are one. A state of angles breaks there; "
                   "a quaternion does not, and angles are for people to read and write.",
                   "", gimbal_lock});
}

}  // namespace tumble::battery
