// Rows 7, 20, 21 and 27: needles, high spin, the intermediate axis, tops in gravity.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/dynamics/free_rotation.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "tests/stability/cases.h"
#include "tests/stability/methods.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

/// A body that nothing touches or pushes.
scene::Scene free_top(const Vector3d& moments, const Vector3d& omega_body,
                      const Quaterniond& q = Quaterniond::Identity()) {
  scene::Scene scene = truths::empty_scene("free top", 1.0, 1e-9);
  scene::BodySpec body = truths::point_mass("top", 1.0, Vector3d::Zero(), Vector3d::Zero());
  body.inertia_body_kg_m2 = moments.asDiagonal();
  body.world_from_body = q;
  body.omega_world_rad_s = q * omega_body;
  scene.bodies = {body};
  return scene;
}

// ---- Row 7 --------------------------------------------------------------------------------------

/// Spin of a needle about its axis, conserved, by the laws and RK4: how far it comes off. [rad/s]
/// Their state holds L in the world frame.
double spin_lost_by_rk4(const Given& given, const Vector3d& moments, const Quaterniond& q,
                        const Vector3d& omega, double h, long steps) {
  const Laws laws = with_method(given.laws, "RK4", rk4);
  const Inertia inertia = finite_inertia(1.0, moments.asDiagonal());
  const OdeFunction f = [&](double, const VectorXd& y) {
    return laws.state_derivative(unpack(y), inertia, {Vector3d::Zero(), Vector3d::Zero()});
  };
  RigidBodyState state{Vector3d::Zero(), q, Vector3d::Zero(), q * moments.cwiseProduct(omega)};
  double lost = 0.0;
  for (long i = 0; i < steps; ++i) {
    state = unpack(laws.integrate_step(f, static_cast<double>(i) * h, pack(state), h));
    state.world_from_body = laws.renormalize(state.world_from_body);
    lost = std::max(
        lost, std::abs((state.world_from_body.conjugate() * state.angular_momentum_world).x() /
                           moments.x() -
                       omega.x()));
  }
  return lost;
}

/// RK4's stages stand off the needle's direction by (w h)^2, and I_min turns each of them into a
/// spin |L| (w h)^2 / I_min too large: of which the fourth order has to take off all but rounding.
void needles_by_the_laws(const Given& given, Findings& findings) {
  const Quaterniond q = Quaterniond(0.3, 0.5, -0.4, 0.7).normalized();
  const Vector3d omega(1.0, 0.3, 0.2);
  struct Needle {
    double axial, across, h;
  };
  for (const auto& [axial, across, h] : {Needle{1e-6, 1.0, 5e-5}, Needle{1e-9, 2.0, 1e-5}}) {
    const Vector3d moments(axial, across, across);
    const double floor = kRounding * moments.cwiseProduct(omega).norm() / axial;
    const std::string name = fmt::format("I = ({:g}, {:g}, {:g}) by the laws and RK4, h = {:g} s, ",
                                         axial, across, across, h);
    const long steps = std::lround((given.is_long ? 10.0 : 1.0) / h);
    findings.at_most(name + "100 steps: spin about the axis",
                     spin_lost_by_rk4(given, moments, q, omega, h, 100), 100 * floor, "rad/s",
                     "a state with L in the world frame knows it to u |L| / I_min; above 100 times "
                     "that something else is wrong");
    findings.at_most(name + fmt::format("{} steps: spin about the axis", steps),
                     spin_lost_by_rk4(given, moments, q, omega, h, steps),
                     static_cast<double>(steps) * floor, "rad/s",
                     "each step rounds the orientation once: u |L| / I_min a step");
  }
}

/// The same in a run, where the derivative gets orientations of unit length at every stage. What
/// stays is the error of the method.
void needle_in_a_run(const Given& given, Findings& findings) {
  const Quaterniond q = Quaterniond(0.3, 0.5, -0.4, 0.7).normalized();
  const Vector3d moments(1e-9, 2.0, 2.0), omega(1.0, 0.3, 0.2);
  constexpr double h = 2e-4;
  const Trajectory run = run_by_steps(free_top(moments, omega, q),
                                      with_method(given.laws, "RK4", rk4), 100 * h, h, 100);
  double lost = 0.0;
  for (const Frame& frame : run.frames)
    lost = std::max(
        lost,
        std::abs((frame.poses[0].world_from_body.conjugate() * frame.poses[0].omega_world).x() -
                 omega.x()));
  findings.at_most("I = (1e-9, 2, 2) in a run, RK4, h = 2e-4 s, 100 steps: spin about the axis",
                   lost, 1e-3, "rad/s", "0.3 where stages keep the length that they come out with");
}

void needle(const Given& given, Findings& findings) {
  report::Plot plot{"Spin of a needle about its axis: error of what is recovered",
                    {"moment about the axis over moment across it", "", report::Scale::kLog},
                    {"error", "rad/s", report::Scale::kLog},
                    {},
                    {},
                    "In the body frame nothing is lost; recovered from an angular momentum in the "
                    "world frame the spin loses u |L| / I_min."};
  report::Curve body_frame{"body frame", {}, {}, true},
      world_frame{"R I^-1 R^T L, world frame", {}, {}, true}, floor{"u |L| / I_min", {}, {}};
  const Quaterniond q = Quaterniond(0.3, 0.5, -0.4, 0.7).normalized();
  const Vector3d omega(5.0, 0.3, 0.2);
  for (const double slender : {1e-3, 1e-6, 1e-9}) {
    const Vector3d moments(slender, 2.0, 2.0);
    const FreeRotation rotation(moments.asDiagonal());
    double kept = 0.0;
    for (int i = 1; i <= 50; ++i)
      kept =
          std::max(kept, std::abs(rotation.after({q, omega}, 0.37 * i).omega_body.x() - omega.x()));
    // What an engine with a tensor in the world frame does: the largest error over some
    // orientations.
    double lost = 0.0;
    const double L = moments.cwiseProduct(omega).norm();
    for (int i = 1; i <= 50; ++i) {
      const Spin spin = rotation.after({q, omega}, 0.37 * i);
      const Matrix3d R = spin.world_from_body.toRotationMatrix(),
                     inverse = R * moments.cwiseInverse().asDiagonal() * R.transpose();
      const Vector3d back = R.transpose() * (inverse * (R * moments.cwiseProduct(spin.omega_body)));
      lost = std::max(lost, std::abs(back.x() - spin.omega_body.x()));
    }
    const double limit = kRounding * L / slender;
    body_frame.x.push_back(slender), body_frame.y.push_back(std::max(kept, 1e-17));
    world_frame.x.push_back(slender), world_frame.y.push_back(lost);
    floor.x.push_back(slender), floor.y.push_back(limit);
    if (slender > 1e-4) continue;
    const std::string name = fmt::format("I = ({:g}, 2, 2)", slender);
    findings.at_most(name + ", body frame, 18 s: spin about the axis", kept,
                     10 * kRounding * omega.norm(), "rad/s", "conserved: 10 roundings");
    findings.at_most(
        name + ", world frame: spin recovered from L", lost, 100 * limit, "rad/s",
        "u |L| / I_min is unavoidable there; above 100 times that something else is wrong");
    findings.must_fail(name + ", world frame: as good as the body frame", lost,
                       10 * kRounding * omega.norm(), "rad/s",
                       "the rounding of L counts 1 / I_min times");
  }
  plot.curves = {body_frame, world_frame, floor};
  findings.plot(std::move(plot));
  needles_by_the_laws(given, findings);
  findings.part("needle in a run", [&] { needle_in_a_run(given, findings); });
  for (const char* id : {"free_top_needle/needle_1e-6", "free_top_needle/needle_1e-6_spun",
                         "free_top_asymmetric/needle_asymmetric"})
    compare_with_truth(given, findings, id, !given.is_long);
  compare_with_truth(given, findings, "mass_properties/plate_1e-6");
}

// ---- Row 20 -------------------------------------------------------------------------------------

/// One second by steps of the exponential map, against the truth of 60 digits.
void high_spin_by_exponentials(const Given& given, Findings& findings) {
  const truths::Case truth = given.truth("free_top_symmetric/high_spin_1e4");
  const Vector3d moments = truth.input("I_principal").vector3();
  const VectorXd q0 = truth.input("q0").vector(), q1 = truth.output("q_t1").vector();
  Quaterniond q(q0[0], q0[1], q0[2], q0[3]);
  const Vector3d omega = truth.input("omega0_body").vector3(), L = q * moments.cwiseProduct(omega);
  const long steps = std::lround(omega.norm() / 0.05);
  for (long i = 0; i < steps; ++i)
    q = exponential_step(q, L, moments, 1.0 / static_cast<double>(steps));
  findings.at_most(
      "steps of the exponential map, w h = 0.05, 1 s: orientation",
      angle_between(q, Quaterniond(q1[0], q1[1], q1[2], q1[3])), 1e3 * truth.floor("q_t1"), "rad",
      "exact but for rounding, 1e-16 at each of 2e5 steps: a thousand floors of u w t");
}

void high_spin(const Given& given, Findings& findings) {
  compare_with_truth(given, findings, "free_top_symmetric/high_spin_1e4", true);
  findings.part("exponential map", [&] { high_spin_by_exponentials(given, findings); });
  const Vector3d moments(1.0, 1.0, 2.0), omega(3.0, 0.0, 1e4);
  const FreeRotation rotation(moments.asDiagonal());
  const double speed = omega.norm(), t = given.is_long ? 1.0 : 0.1;
  report::Plot plot{
      "Orientation of a top at 10^4 rad/s",
      {"w h", "rad a step", report::Scale::kLog},
      {"error", "rad", report::Scale::kLog},
      {},
      {},
      "Order 4, down to rounding; from half a turn a step on nothing is right, and a run says so."};
  // of q: 2 (w h / 2)^5 / 120
  report::Curve found{fmt::format("RK4, {:g} s", t), {}, {}, true},
      predicted{"(w h)^5 / 1920 a step", {}, {}};
  for (const double angle : {0.025, 0.05, 0.1, 0.2, 0.4, 4.0}) {
    const double h = angle / speed;
    const long steps = std::lround(t / h);
    const Trajectory run =
        truths::run_in_steps(free_top(moments, omega), with_method(given.laws, "RK4", rk4),
                             static_cast<double>(steps) * h, steps, 1);
    const Frame& end = run.frames.back();
    const double error =
        angle_between(end.poses[0].world_from_body,
                      rotation.after({Quaterniond::Identity(), omega}, end.time).world_from_body);
    const double mark = static_cast<double>(steps) * std::pow(angle, 5) / 1920;
    if (angle < 1)
      found.x.push_back(angle), found.y.push_back(error), predicted.x.push_back(angle),
          predicted.y.push_back(mark);
    if (angle == 0.05) {
      findings.at_most(fmt::format("RK4, w h = 0.05, {:g} s: orientation", t), error, 2 * mark,
                       "rad", "the method's leading error, (w h)^5 / 1920 a step, twice");
      findings.at_most("RK4: | |q| - 1 |", std::abs(end.poses[0].world_from_body.norm() - 1),
                       4 * kRounding, "", "renormalised at every step");
    }
    if (angle < 3) continue;
    findings.must_fail("RK4, w h = 4: orientation", error, 1e-3, "rad",
                       "more than half a turn a step is taken for a turn the other way");
    const std::vector<RunFault>& faults = run.counters.faults;
    const bool told = std::any_of(faults.begin(), faults.end(), [](const RunFault& fault) {
      return fault.kind == "turn_unresolved";
    });
    findings.is_true("w h = 4: the run tells of it", told, "aliasing must not pass in silence");
  }
  plot.curves = {found, predicted};
  findings.plot(std::move(plot));
}

// ---- Row 21 -------------------------------------------------------------------------------------

Vector3d omega_body(const Frame& frame) {
  return frame.poses[0].world_from_body.conjugate() * frame.poses[0].omega_world;
}

void intermediate_axis(const Given& given, Findings& findings) {
  const truths::Case truth = given.truth("free_top_asymmetric/dzhanibekov_123");
  compare_with_truth(given, findings, "free_top_asymmetric/dzhanibekov_123", true);
  const Vector3d moments = truth.input("I_principal").vector3(),
                 omega = truth.input("omega0_body").vector3();
  const VectorXd q0 = truth.input("q0").vector();
  const scene::Scene scene = free_top(moments, omega, Quaterniond(q0[0], q0[1], q0[2], q0[3]));
  const double duration = given.is_long ? 600.0 : 100.0,
               period = truth.output("polhode_period").number();

  const Trajectory fine =
      run_by_steps(scene, with_method(given.laws, "Dormand-Prince", dormand_prince(1e-12)),
                   duration, 0.05, 1000000);
  findings.at_most(fmt::format("Dormand-Prince at 1e-12, {:g} s: energy", duration),
                   energy_drift(fine, fine.frames.front().kinetic_energy), 1e-10, "",
                   "tolerance times the number of steps");
  const Vector3d L0 = fine.frames.front().angular_momentum_world;
  double momentum = 0.0;
  for (const Frame& frame : fine.frames)
    momentum = std::max(momentum, (frame.angular_momentum_world - L0).norm() / L0.norm());
  findings.at_most("angular momentum", momentum, 1e-13, "",
                   "it is part of the state, and nothing turns it");
  std::vector<double> flips;  // omega_y goes through 0 every half period of the tumbling
  for (std::size_t i = 1; i < fine.frames.size(); ++i) {
    const double before = omega_body(fine.frames[i - 1]).y(),
                 after = omega_body(fine.frames[i]).y();
    if (before * after < 0)
      flips.push_back(fine.frames[i - 1].time +
                      (fine.frames[i].time - fine.frames[i - 1].time) * before / (before - after));
  }
  const double spacing =
      flips.size() > 1 ? (flips.back() - flips.front()) / static_cast<double>(flips.size() - 1)
                       : kUnset;
  findings.at_most(
      fmt::format("time between {} flips against half a Jacobi period, 19.5528 s", flips.size()),
      std::abs(spacing - 0.5 * period), 1e-4, "s",
      "frames of 0.05 s, crossings interpolated linearly: (0.05 s)^3 of curvature");

  report::Plot plot{"Energy of a book thrown turning about its middle axis",
                    {"time", "s"},
                    {"|E / E0 - 1|", "", report::Scale::kLog},
                    {},
                    {{1e-10, "threshold"}},
                    "Between two flips the top turns evenly, and errors grow only while it flips."};
  const auto error_of = [](const Trajectory& run) {
    return [e0 = energy_of(run.frames.front())](const Frame& frame) {
      return std::max(std::abs(energy_of(frame) / e0 - 1), 1e-17);
    };
  };
  const Trajectory middle = run_by_steps(scene, with_method(given.laws, "RK4", rk4), duration,
                                         1.0 / 60, 2000),
                   euler = run_by_steps(scene,
                                        with_method(given.laws, "explicit Euler", explicit_euler),
                                        duration, 1.0 / 60, 2000);
  plot.curves = {curve_of("Dormand-Prince, 1e-12", fine, error_of(fine)),
                 curve_of("RK4, 1/60 s", middle, error_of(middle)),
                 curve_of("explicit Euler, 1/60 s", euler, error_of(euler))};
  findings.plot(std::move(plot));
  findings.must_fail("explicit Euler, 1/60 s: energy",
                     energy_drift(euler, euler.frames.front().kinetic_energy), 1e-10, "",
                     "of order 1: the tip of the spin moves along tangents, outwards");
}

// ---- Row 27 -------------------------------------------------------------------------------------

/// Tilt of the top's axis. [rad]
double tilt_from_upright(const Frame& frame) {
  const Vector3d axis = frame.poses[0].world_from_body * Vector3d::UnitZ();
  return std::atan2(axis.head<2>().norm(), axis.z());
}

/// A top on its tip, which is at the origin, turned by q. @param axial, across  moments about its
/// axis, and across it about the tip [kg m^2]
scene::Scene top_on_its_tip(double m, double l, double across, double axial, const Quaterniond& q,
                            double spin) {
  scene::Scene scene = truths::empty_scene("top", 1.0, 1e-9);
  effects::set_gravity(scene, kDown);
  scene.stabilisation = scene::StabilisationSpec{};
  scene::BodySpec top = truths::point_mass("top", m, q * Vector3d(0, 0, l), Vector3d::Zero());
  const double about_com = across - m * l * l;  // Steiner
  top.inertia_body_kg_m2 = Vector3d(about_com, about_com, axial).asDiagonal();
  top.world_from_body = q;
  top.omega_world_rad_s = q * Vector3d(0, 0, spin);
  scene.bodies = {top};
  scene.effects.of<effects::JointSpec>() = {
      {"tip", effects::JointKind::kBall, "top", "", Vector3d::Zero(), Vector3d::UnitZ()}};
  return scene;
}

/// Let go at rest but for its spin a top nods between its first tilt and one that a cubic gives.
void nutation(const Given& given, Findings& findings) {
  const truths::Case truth = given.truth("heavy_top/nutating_released_from_rest");
  const auto input = [&](const char* name) { return truth.input(name).number(); };
  const double m = input("m"), l = input("l"), across = input("It_about_fixed_point"),
               axial = input("I3"), spin = input("psidot0"), h = 1e-4;
  const double lowest = truth.output("nutation_theta_min").number(),
               highest = truth.output("nutation_theta_max").number();
  const long steps = given.is_long ? 100000 : 10000;
  const scene::Scene scene =
      top_on_its_tip(m, l, across, axial,
                     Quaterniond(Eigen::AngleAxisd(input("theta0"), Vector3d::UnitX())), spin);
  const Trajectory run =
      truths::run_in_steps(scene, given.laws, static_cast<double>(steps) * h, steps, steps);
  double outside = 0.0, largest = 0.0, again = INFINITY;
  for (const Frame& frame : run.frames) {
    const double tilt = tilt_from_upright(frame);
    outside = std::max({outside, lowest - tilt, tilt - highest});
    largest = std::max(largest, tilt);
    if (frame.time > 0.1) again = std::min(again, tilt);
  }
  const std::string name =
      fmt::format("nutating top, {:g} s, every step: ", run.frames.back().time);
  findings.at_most(name + "tilt outside of the cubic's bounds", outside, 1e-9, "rad",
                   "the bounds are those of energy and two momenta, which RK4 at spin h = 0.012 "
                   "keeps to (spin h)^5 / 1920 = 1e-13 a step");
  // It nods by sin^2(a t / 2) of the band, a = I3 w3 / It: a step's end is at most half a step from
  // the turning point.
  const double a = axial * spin / across,
               missed = 0.5 * (highest - lowest) * 0.5 * std::pow(0.5 * a * h, 2);
  findings.at_most(name + "how far the upper bound is from what it reaches", highest - largest,
                   2 * missed + 1e-9, "rad",
                   "half a step from the turning point, (band / 2)(a h / 2)^2 / 2, twice for a "
                   "band that is not small");
  findings.at_most(name + "how far the lower bound is from where it comes back to", again - lowest,
                   2 * missed + 1e-9, "rad", "the same: it nods, between both bounds");
}

void heavy_top(const Given& given, Findings& findings) {
  compare_with_truth(given, findings, "heavy_top/nutating_released_from_rest");
  findings.part("nutation", [&] { nutation(given, findings); });
  if (given.is_long)  // seconds each
    for (const char* id : {"heavy_top/sleeping_tilt_1e-3", "heavy_top/sleeping_unstable_tilt_1e-3",
                           "heavy_top/looping"})
      compare_with_truth(given, findings, id);
  // A top on its tip, upright but for a thousandth, one spin above and one below what keeps it
  // asleep.
  const double m = 1.0, l = 0.1, across = 0.02, axial = 0.01,
               critical = 2 * std::sqrt(across * m * kG * l) / axial;
  report::Plot plot{"Tilt of a sleeping top",
                    {"time", "s"},
                    {"tilt", "rad", report::Scale::kLog},
                    {},
                    {},
                    "Above the critical spin a tilt stays small; below it the top falls."};
  for (const double part : {1.1, 0.9}) {
    const scene::Scene scene =
        top_on_its_tip(m, l, across, axial, Quaterniond(Eigen::AngleAxisd(1e-3, Vector3d::UnitY())),
                       part * critical);
    const Trajectory run = run_by_steps(scene, given.laws, given.is_long ? 20.0 : 3.0, 1e-3, 2000);
    double largest = 0.0;
    for (const Frame& frame : run.frames) largest = std::max(largest, tilt_from_upright(frame));
    // Linearised: z'' - i a z' - b z = 0 with a = I3 w / It, b = m g l / It; let go at rest it
    // reaches a / sqrt(a^2 - 4 b) times its tilt.
    const double a = axial * part * critical / across, b = m * kG * l / across;
    if (part > 1)
      findings.at_most("spin 1.1 of the critical one: largest tilt", largest,
                       1e-3 * a / std::sqrt(a * a - 4 * b) * (1 + 1e-4), "rad",
                       "of the linearised equation a / sqrt(a^2 - 4 b) times the first tilt, and "
                       "(1e-3)^2 for what is not linear");
    else {
      findings.at_least("spin 0.9 of the critical one: largest tilt", largest, 0.3, "rad",
                        "below the critical spin a top does not sleep");
      findings.must_fail("spin 0.9 of the critical one: sleeps", largest, 1e-2, "rad",
                         "a battery in which it slept would hold any top upright");
    }
    plot.curves.push_back(
        curve_of(fmt::format("{:g} of the critical spin", part), run, tilt_from_upright));
  }
  findings.plot(std::move(plot));
}

}  // namespace

void add_tops(std::vector<Case>& cases) {
  cases.push_back(
      {7, "needle",
       "A needle resists turning end over end a million times more than spinning about its axis. "
       "Whoever keeps the inverse tensor in the world frame mixes the two and "
       "loses the spin's digits; in the body frame nothing is lost.",
       "", needle});
  cases.push_back({20, "spin of 10^4 rad/s",
                   "A top that turns 1600 times a second. Engines clamp the turn of a step or add "
                   "an explicit gyroscopic term, and blow up. The closed form holds to rounding, "
                   "an integrator to its order; over half a turn a step nothing can be right, and "
                   "it must say so.",
                   "", high_spin});
  cases.push_back(
      {21, "intermediate axis",
       "A body thrown turning about its middle axis flips over and over, with a period that "
       "Jacobi's functions give. Explicit gyroscopic terms add energy, clamped momenta "
       "lose it, and some engines leave the term out: then nothing flips.",
       "", intermediate_axis});
  cases.push_back(
      {27, "heavy top",
       "A top on its tip sleeps upright if it spins faster than 2 sqrt(It m g l) / I3, and nutates "
       "between two bounds that a cubic gives. Half a percent of drift wakes it.",
       "a3", heavy_top});
}

}  // namespace tumble::battery
