// free_top_*: a torque-free body, by the framework's exact rotation and by the laws' integrator.
//
// The files name outputs by time: q_t10 is the orientation at t = 10 s. Frames: omega in the body
// frame, q and R body to world.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/free_rotation.h"
#include "framework/truths/families.h"

namespace tumble::truths {
namespace {

struct Top {
  Vector3d moments;
  Spin start;
  // time as in the outputs' names, and as a number [s]
  std::vector<std::pair<std::string, double>> times;

  explicit Top(const Case& truth) : moments(truth.input("I_principal").vector3()) {
    const VectorXd q = truth.input("q0").vector();
    start = {Quaterniond(q[0], q[1], q[2], q[3]), truth.input("omega0_body").vector3()};
    for (const Value& time : truth.input("times").list())
      times.emplace_back("t" + time.text(), time.number());
  }
  Vector3d angular_momentum_world() const {
    return start.world_from_body * moments.cwiseProduct(start.omega_body);
  }
};

// ---- Exact -------------------------------------------------------------------------------------

void compare_constants(const Case& truth, const Top& top, const FreeRotation& rotation,
                       Comparison& comparison) {
  const Vector3d L = top.angular_momentum_world();
  const Vector3d& w = top.start.omega_body;
  comparison.closed_form(truth, "energy", 0.5 * w.dot(top.moments.cwiseProduct(w)));
  comparison.closed_form(truth, "L_world", VectorXd(L));
  comparison.closed_form(truth, "L_norm", L.norm());
  if (truth.has_output("jacobi_modulus_m"))
    comparison.closed_form(truth, "jacobi_modulus_m", rotation.tumbling(w).modulus_m);
  if (truth.has_output("polhode_period"))
    comparison.closed_form(truth, "polhode_period", rotation.tumbling(w).period);
  // The axis of symmetric tops in the files is body z.
  const double transverse = top.moments.x(), axial = top.moments.z();
  if (truth.has_output("precession_rate"))
    comparison.closed_form(truth, "precession_rate", L.norm() / transverse);
  if (truth.has_output("body_cone_rate"))
    comparison.closed_form(truth, "body_cone_rate", w.z() * (axial - transverse) / transverse);
  if (truth.has_output("angle_axis_to_L")) {
    const Vector3d L_body = top.moments.cwiseProduct(w);
    comparison.closed_form(truth, "angle_axis_to_L",
                           std::atan2(L_body.head<2>().norm(), L_body.z()));
  }
}

void compare_exact(const Case& truth, const Top& top, Comparison& comparison) {
  const FreeRotation rotation(top.moments.asDiagonal());
  compare_constants(truth, top, rotation, comparison);
  for (const auto& [name, t] : top.times) {
    const Spin spin = rotation.after(top.start, t);
    comparison.closed_form(truth, "omega_body_" + name, VectorXd(spin.omega_body));
    comparison.closed_form(
        "q_" + name,
        quaternion_difference(spin.world_from_body, truth.output("q_" + name).vector()),
        truth.floor("q_" + name));
    const Matrix3d R = spin.world_from_body.toRotationMatrix();
    comparison.closed_form("R_" + name,
                           (R - truth.output("R_" + name).matrix3()).cwiseAbs().maxCoeff(),
                           truth.floor("R_" + name));
  }
}

// ---- The laws' integrator ----------------------------------------------------------------------

constexpr double kMostSteps = 4e6;      // of all runs to one time together: about a second
constexpr double kLargestAngle = 0.05;  // rad: for larger w h RK4 is not in its asymptotic range
// rad: predicted error of the coarsest run, small enough for its order to show
constexpr double kAsymptoticError = 1e-3;
// a change of this many roundings is known to 1 %, its log2 to 0.02
constexpr double kAboveRoundOff = 100.0;

/// Orientation after `steps` equal steps of the laws, renormalised after each as engines do.
Quaterniond march(const Laws& laws, const Top& top, double t, long steps) {
  const Inertia inertia = finite_inertia(1.0, top.moments.asDiagonal());
  const Wrench none{Vector3d::Zero(), Vector3d::Zero()};
  const OdeFunction f = [&](double, const VectorXd& y) {
    return laws.state_derivative(unpack(y), inertia, none);
  };
  RigidBodyState state{Vector3d::Zero(), top.start.world_from_body, Vector3d::Zero(),
                       top.angular_momentum_world()};
  const double h = t / static_cast<double>(steps);
  for (long i = 0; i < steps; ++i) {
    state = unpack(laws.integrate_step(f, static_cast<double>(i) * h, pack(state), h));
    state.world_from_body = laws.renormalize(state.world_from_body);
  }
  return state.world_from_body;
}

/// Growth of an error of the orientation over t: it causes an error |L| / I_min of the angular
/// velocity (large for a needle in the world frame, where a state holds L), which adds rotation
/// until the end.
double amplification(const Top& top, double t) {
  return 1.0 + top.angular_momentum_world().norm() / top.moments.minCoeff() * t;
}

/// Number of steps from which on the error of RK4 is small enough to show its order. Each step has
/// the error (w h)^5 / 120 rad.
long first_steps(const Top& top, double t) {
  const FreeRotation rotation(top.moments.asDiagonal());
  double w = 0.0;
  for (int i = 0; i <= 16; ++i)
    w = std::max(w, rotation.after(top.start, t * i / 16).omega_body.norm());
  const double angle = std::min(
      kLargestAngle, std::pow(120.0 * kAsymptoticError / (w * t * amplification(top, t)), 0.25));
  return std::max(1L, static_cast<long>(std::ceil(w * t / angle)));
}

VectorXd components(const Quaterniond& q) { return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()); }

/// Rounding error of a state (q, L) in doubles over a run: one rounding per step, as a random walk,
/// each growing like any error.
double round_off(const Top& top, double t, long steps) {
  return 0x1p-53 * amplification(top, t) * std::sqrt(static_cast<double>(steps));
}

/// Runs with successively halved steps.
struct Refinement {
  long steps = 0;  // of the finest run
  Quaterniond finest;
  double change = kUnset;  // by the last halving
  double order = kUnset;   // log2 of the ratio of successive changes
  bool hidden = false;     // round-off was reached before the order had settled
};

/// Halves the step until the order has settled, round-off shows, or the limit of steps is reached.
Refinement refine(const Laws& laws, const Top& top, double t, long steps) {
  Refinement runs{steps, march(laws, top, t, steps)};
  double last_order = kUnset;
  for (double spent = static_cast<double>(steps);
       spent + 2.0 * static_cast<double>(runs.steps) <= kMostSteps;
       spent += static_cast<double>(runs.steps)) {
    const Quaterniond finer = march(laws, top, t, 2 * runs.steps);
    const double change = quaternion_difference(runs.finest, components(finer));
    const double order = std::log2(runs.change / change);
    runs = {2 * runs.steps, finer, change, order, false};
    // false for NaN, which smaller steps may cure
    runs.hidden = change <= kAboveRoundOff * round_off(top, t, runs.steps);
    if (runs.hidden || std::abs(order - last_order) <= kSettled) break;
    last_order = order;
  }
  return runs;
}

void compare_integrated_at(const Case& truth, const Laws& laws, const Top& top,
                           const std::string& name, double t, Comparison& comparison) {
  const long steps = first_steps(top, t);
  if (32.0 * static_cast<double>(steps) > kMostSteps) {
    comparison.not_compared(
        "rk4.q_" + name, "the order shows only with millions of steps, more than the limit here");
    return;
  }
  const double floor = truth.floor("q_" + name);
  const Refinement runs = refine(laws, top, t, steps);
  const std::string finest = std::to_string(runs.steps) + " steps";
  if (runs.hidden) {
    comparison.not_compared("rk4.order_" + name, "round-off hides the order at " + finest);
  } else {
    comparison.check(
        "rk4.order_" + name, std::abs(runs.order - kOrder), kUnset, kOrderTolerance,
        "order " + std::to_string(runs.order).substr(0, 5) + " on halving the step to " + finest);
  }

  // The remaining error of a method of order 4 is 1/15 of the last change; 2: its next term. 10:
  // roundings per step.
  const double truncation = 2.0 * runs.change / 15.0,
               rounding = std::max(kClosedFormFactor * floor, 10.0 * round_off(top, t, runs.steps));
  comparison.check("rk4.q_" + name,
                   quaternion_difference(runs.finest, truth.output("q_" + name).vector()), floor,
                   std::max(rounding, truncation),
                   truncation > rounding ? "tolerance: predicted truncation error of " + finest
                                         : "tolerance: rounding of (q, L) over " + finest);
}

}  // namespace

void compare_free_top(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Top top(truth);
  compare_exact(truth, top, comparison);
  for (const auto& [name, t] : top.times) {
    comparison.attempt("rk4.q_" + name, [&, name = name, t = t] {
      compare_integrated_at(truth, laws, top, name, t, comparison);
    });
  }
}

}  // namespace tumble::truths
