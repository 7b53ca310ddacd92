// free_top_*: a body that nothing turns, by the framework's exact rotation and by the laws' integrator.
//
// The files name outputs by time: q_t10 is the orientation at t = 10 s. Frames: omega in the body frame, q and R body to world.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/free_rotation.h"
#include "framework/engines/truths/families.h"

namespace tumble::truths {
namespace {

struct Top {
  Vector3d moments;
  Spin start;
  std::vector<std::pair<std::string, double>> times;  // as in the outputs' names, and as a number [s]

  explicit Top(const Case& truth) : moments(truth.input("I_principal").vector3()) {
    const VectorXd q = truth.input("q0").vector();
    start = {Quaterniond(q[0], q[1], q[2], q[3]), truth.input("omega0_body").vector3()};
    for (const Value& time : truth.input("times").list()) times.emplace_back("t" + time.text(), time.number());
  }
  Vector3d angular_momentum_world() const { return start.world_from_body * moments.cwiseProduct(start.omega_body); }
};

// ---- Exact -----------------------------------------------------------------------------------------------------------

void compare_constants(const Case& truth, const Top& top, const FreeRotation& rotation, Comparison& comparison) {
  const Vector3d L = top.angular_momentum_world();
  const Vector3d& w = top.start.omega_body;
  comparison.closed_form(truth, "energy", 0.5 * w.dot(top.moments.cwiseProduct(w)));
  comparison.closed_form(truth, "L_world", VectorXd(L));
  comparison.closed_form(truth, "L_norm", L.norm());
  if (truth.has_output("jacobi_modulus_m")) comparison.closed_form(truth, "jacobi_modulus_m", rotation.tumbling(w).modulus_m);
  if (truth.has_output("polhode_period")) comparison.closed_form(truth, "polhode_period", rotation.tumbling(w).period);
  // Symmetric tops of the files have their axis along body z.
  const double transverse = top.moments.x(), axial = top.moments.z();
  if (truth.has_output("precession_rate")) comparison.closed_form(truth, "precession_rate", L.norm() / transverse);
  if (truth.has_output("body_cone_rate")) comparison.closed_form(truth, "body_cone_rate", w.z() * (axial - transverse) / transverse);
  if (truth.has_output("angle_axis_to_L")) {
    const Vector3d L_body = top.moments.cwiseProduct(w);
    comparison.closed_form(truth, "angle_axis_to_L", std::atan2(L_body.head<2>().norm(), L_body.z()));
  }
}

void compare_exact(const Case& truth, const Top& top, Comparison& comparison) {
  const FreeRotation rotation(top.moments.asDiagonal());
  compare_constants(truth, top, rotation, comparison);
  for (const auto& [name, t] : top.times) {
    const Spin spin = rotation.after(top.start, t);
    comparison.closed_form(truth, "omega_body_" + name, VectorXd(spin.omega_body));
    comparison.closed_form("q_" + name, quaternion_difference(spin.world_from_body, truth.output("q_" + name).vector()), truth.floor("q_" + name));
    const Matrix3d R = spin.world_from_body.toRotationMatrix();
    comparison.closed_form("R_" + name, (R - truth.output("R_" + name).matrix3()).cwiseAbs().maxCoeff(), truth.floor("R_" + name));
  }
}

// ---- The laws' integrator --------------------------------------------------------------------------------------------

constexpr double kMostSteps = 2e6;        // of the three runs of one time together: a few seconds
constexpr double kLargestAngle = 0.05;    // rad: w h beyond which RK4 is not in its asymptotic range
constexpr double kAsymptoticError = 1e-3; // rad: predicted error of the coarsest run, small enough for its order to show

/// Orientation after `steps` equal steps of the laws, renormalised after each as engines do.
Quaterniond march(const Laws& laws, const Top& top, double t, long steps) {
  const Inertia inertia = finite_inertia(1.0, top.moments.asDiagonal());
  const Wrench none{Vector3d::Zero(), Vector3d::Zero()};
  const OdeFunction f = [&](double, const VectorXd& y) { return laws.state_derivative(unpack(y), inertia, none); };
  RigidBodyState state{Vector3d::Zero(), top.start.world_from_body, Vector3d::Zero(), top.angular_momentum_world()};
  const double h = t / static_cast<double>(steps);
  for (long i = 0; i < steps; ++i) {
    state = unpack(laws.integrate_step(f, static_cast<double>(i) * h, pack(state), h));
    state.world_from_body = laws.renormalize(state.world_from_body);
  }
  return state.world_from_body;
}

/// Steps from which on the error of RK4 is small enough to show its order. Each step errs by (w h)^5 / 120 rad; an error of the
/// axis against L is an error of |L| / I_min of the spin (a needle's drawback in the world frame), which turns on for the rest.
long first_steps(const Top& top, double t) {
  const FreeRotation rotation(top.moments.asDiagonal());
  double w = 0.0;
  for (int i = 0; i <= 16; ++i) w = std::max(w, rotation.after(top.start, t * i / 16).omega_body.norm());
  const double amplification = 1.0 + top.angular_momentum_world().norm() / top.moments.minCoeff() * t;
  const double angle = std::min(kLargestAngle, std::pow(120.0 * kAsymptoticError / (w * t * amplification), 0.25));
  return static_cast<long>(std::ceil(w * t / angle));
}

VectorXd components(const Quaterniond& q) { return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()); }

void compare_integrated_at(const Case& truth, const Laws& laws, const Top& top, const std::string& name, double t, Comparison& comparison) {
  constexpr double kOrder = 4.0, kOrderTolerance = 0.1;  // issue 2: 4.0 +- 0.1 in the asymptotic range
  const long steps = first_steps(top, t);
  if (7.0 * static_cast<double>(steps) > kMostSteps) {
    comparison.not_compared("rk4.q_" + name, "small enough steps would be " + std::to_string(7 * steps) + " in all, more than is spent here");
    return;
  }
  const Quaterniond coarse = march(laws, top, t, steps), middle = march(laws, top, t, 2 * steps), fine = march(laws, top, t, 4 * steps);
  const double d1 = quaternion_difference(coarse, components(middle)), d2 = quaternion_difference(middle, components(fine));
  const double floor = truth.floor("q_" + name), error = quaternion_difference(fine, truth.output("q_" + name).vector());

  // What halving the step still changes is 15 times the error that remains; 2: its next term.
  const double truncation = 2.0 * d2 / 15.0;
  const std::string sizes = std::to_string(steps) + ", " + std::to_string(2 * steps) + ", " + std::to_string(4 * steps) + " steps";
  if (d2 > 100.0 * kClosedFormFactor * floor) {  // so that rounding does not blur the order by more than a few hundredths
    const double order = std::log2(d1 / d2);
    comparison.check("rk4.order_" + name, std::abs(order - kOrder), kUnset, kOrderTolerance, "order " + std::to_string(order).substr(0, 5) + " over " + sizes);
  } else {
    comparison.not_compared("rk4.order_" + name, "round-off hides the order at " + sizes);
  }
  const double mark = std::max(kClosedFormFactor * floor, truncation);
  comparison.check("rk4.q_" + name, error, floor, mark,
                   mark > kClosedFormFactor * floor ? "mark: predicted truncation error of " + std::to_string(4 * steps) + " steps" : "");
}

}  // namespace

void compare_free_top(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Top top(truth);
  compare_exact(truth, top, comparison);
  for (const auto& [name, t] : top.times) {
    comparison.attempt("rk4.q_" + name, [&, name = name, t = t] { compare_integrated_at(truth, laws, top, name, t, comparison); });
  }
}

}  // namespace tumble::truths
