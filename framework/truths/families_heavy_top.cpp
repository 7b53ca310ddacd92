// heavy_top: Lagrange's symmetric top on a fixed point, a body on a ball joint run by the engine
// with the chosen laws.
//
// Gravity along -z, fixed point at the world's origin, body z the axis, centre of mass at l on it;
// tilted by theta0 about world x.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/truths/families.h"
#include "framework/truths/memory_scene.h"
#include "framework/truths/refined_run.h"
#include "framework/scene/write_entries.h"

namespace tumble::truths {
namespace {

struct HeavyTop {
  double It, I3, m, l, g, tilt, phi_rate, theta_rate, psi_rate;  // It about the fixed point

  explicit HeavyTop(const Case& truth)
      : It(truth.input("It_about_fixed_point").number()),
        I3(truth.input("I3").number()),
        m(truth.input("m").number()),
        l(truth.input("l").number()),
        g(truth.input("g").number()),
        tilt(truth.input("theta0").number()),
        phi_rate(truth.input("phidot0").number()),
        theta_rate(truth.input("thetadot0").number()),
        psi_rate(truth.input("psidot0").number()) {}
  /// From z-x-z Euler angles (0, theta0, 0) and their rates.
  Vector3d omega_body() const {
    return {theta_rate, phi_rate * std::sin(tilt), phi_rate * std::cos(tilt) + psi_rate};
  }
  Quaterniond orientation() const {
    return Quaterniond(Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
  }
  double spin() const { return omega_body().z(); }
  scene::Scene scene(const std::string& name) const;
};

scene::Scene HeavyTop::scene(const std::string& name) const {
  scene::Scene scene = empty_scene(name, 1.0, 1e-9);
  scene::EntryWriter{scene}("gravity_m_s2", Vector3d(0, 0, -g));
  scene.stabilisation = scene::StabilisationSpec{};
  const Quaterniond q = orientation();
  const Vector3d omega = q * omega_body(), com = q * Vector3d(0, 0, l);
  scene::BodySpec top = point_mass("top", m, com, omega.cross(com));
  top.world_from_body = q;
  top.omega_world_rad_s = omega;
  const double transverse = It - m * l * l;  // about the centre of mass (Steiner)
  top.inertia_body_kg_m2 = Vector3d(transverse, transverse, I3).asDiagonal();
  scene.bodies.push_back(top);
  scene::EntryWriter{scene}("joints", {{"name", "point"},
                                       {"kind", "ball"},
                                       {"body_a", "top"},
                                       {"point_m", Vector3d(Vector3d::Zero())}});
  return scene;
}

// ---- Closed forms ------------------------------------------------------------------------------

/// Roots of c[0] + c[1] d + c[2] d^2 + c[3] d^3, all real, ascending. Each is refined in d itself,
/// so that small roots have full relative precision.
Vector3d roots_of_cubic(const double (&c)[4]) {
  // Depressed: d = y - c2 / (3 c3), y^3 + p y + q = 0, y = 2 sqrt(-p / 3) cos(...).
  const double shift = c[2] / (3.0 * c[3]), p = c[1] / c[3] - 3.0 * shift * shift,
               q = 2.0 * std::pow(shift, 3) - shift * c[1] / c[3] + c[0] / c[3];
  const double radius = 2.0 * std::sqrt(std::max(0.0, -p / 3.0));
  const double angle =
      radius > 0.0 ? std::acos(std::clamp(3.0 * q / (p * radius), -1.0, 1.0)) / 3.0 : 0.0;
  Vector3d roots;
  for (int k = 0; k < 3; ++k)
    roots[k] = radius * std::cos(angle - 2.0 * std::numbers::pi * k / 3.0) - shift;
  for (double& d : roots) {
    for (int round = 0; round < 60; ++round) {
      const double value = c[0] + d * (c[1] + d * (c[2] + d * c[3])),
                   slope = c[1] + d * (2.0 * c[2] + d * 3.0 * c[3]);
      if (slope == 0.0 || value == 0.0) break;
      d -= value / slope;
    }
  }
  std::sort(roots.begin(), roots.end());
  return roots;
}

/// Nutation: u = cos(theta) moves between two roots of f(u) = (1 - u^2)(alpha - beta u) - (b - a
/// u)^2. In d = u0 - u, which is small for small nutation, there is no cancellation:
///   f = (s^2 + 2 u0 d - d^2)(w1^2 + w2^2 + beta d) - (w2 s + a d)^2,   s = sin(theta0).
Vector3d drops_of_nutation(const HeavyTop& top) {
  const double u0 = std::cos(top.tilt), s = std::sin(top.tilt),
               beta = 2.0 * top.m * top.g * top.l / top.It, a = top.I3 * top.spin() / top.It;
  const Vector3d w = top.omega_body();
  const double W = w.head<2>().squaredNorm();
  const double c[4] = {s * s * w.x() * w.x(), s * s * beta + 2.0 * u0 * W - 2.0 * a * s * w.y(),
                       2.0 * u0 * beta - W - a * a, -beta};
  return roots_of_cubic(c);
}

/// theta at u = u0 - d, by sin^2(theta / 2) = (1 - u) / 2, which is accurate for small angles.
double angle_after_drop(const HeavyTop& top, double d) {
  const double half = std::sin(0.5 * top.tilt), sine2 = half * half + 0.5 * d;
  return 2.0 * std::atan2(std::sqrt(std::max(0.0, sine2)), std::sqrt(std::max(0.0, 1.0 - sine2)));
}

void compare_closed_forms(const Case& truth, const HeavyTop& top, Comparison& comparison) {
  const Vector3d drops = drops_of_nutation(top);  // ascending d: the unphysical root u > 1 first
  const double u0 = std::cos(top.tilt), moment = top.m * top.g * top.l, L3 = top.I3 * top.spin();
  comparison.closed_form(truth, "cubic_roots_u",
                         VectorXd(Vector3d(u0 - drops[2], u0 - drops[1], u0 - drops[0])));
  comparison.closed_form(truth, "nutation_theta_min", angle_after_drop(top, drops[1]));
  comparison.closed_form(truth, "nutation_theta_max", angle_after_drop(top, drops[2]));
  comparison.closed_form(truth, "sleeping_stability_w3_critical",
                         2.0 * std::sqrt(moment * top.It) / top.I3);
  // It cos(theta) W^2 - I3 w3 W + m g l = 0, without cancellation: the larger root by the formula,
  // the other by their product.
  const double A = top.It * u0, discriminant = L3 * L3 - 4.0 * A * moment;
  if (truth.has_output("steady_precession_rates_at_theta0") && discriminant >= 0.0 &&
      !truth.output("steady_precession_rates_at_theta0").is_null()) {
    const double larger = 0.5 * (L3 + std::copysign(std::sqrt(discriminant), L3)),
                 fast = larger / A, slow = moment / larger;
    comparison.closed_form(truth, "steady_precession_rates_at_theta0",
                           VectorXd(Eigen::Vector2d(slow, fast)));
  }
}

// ---- Runs --------------------------------------------------------------------------------------

Matrix3d rotation_of(const Frame& frame) {
  return frame.poses[0].world_from_body.toRotationMatrix();
}
double tilt_of(const Frame& frame) {
  const Vector3d axis = rotation_of(frame).col(2);
  return std::atan2(axis.head<2>().norm(), axis.z());
}
VectorXd omega_body_of(const Frame& frame) {
  return frame.poses[0].world_from_body.conjugate() * frame.poses[0].omega_world;
}
VectorXd nine(const Matrix3d& R) { return Eigen::Map<const VectorXd>(R.data(), 9); }

std::vector<Quantity> quantities_of_top(const Case& truth, const std::string& t) {
  Quantity q = quantity(truth, "q_" + t, vector_of_last_frame([](const Frame& frame) {
                          return components(frame.poses[0].world_from_body);
                        }));
  q.difference = difference_of_orientations;
  return {
      quantity(truth, "omega_body_" + t, vector_of_last_frame(omega_body_of)),
      q,
      {"R_" + t, vector_of_last_frame([](const Frame& frame) { return nine(rotation_of(frame)); }),
       nine(truth.output("R_" + t).matrix3()), truth.floor("R_" + t)},
      derived(truth, "theta_" + t, of_last_frame(tilt_of)),
      quantity(truth, "com_world_" + t, vector_of_last_frame([](const Frame& frame) {
                 return VectorXd(frame.poses[0].com_world);
               }))};
}

void compare_start(const Case& truth, const Frame& start, Comparison& comparison) {
  comparison.closed_form(truth, "omega0_body", omega_body_of(start));
  comparison.closed_form(
      "q0", quaternion_difference(start.poses[0].world_from_body, truth.output("q0").vector()),
      truth.floor("q0"));
  comparison.closed_form(truth, "energy", start.kinetic_energy + start.potential_energy);
  comparison.closed_form(truth, "p_phi", start.angular_momentum_world.z());
  comparison.closed_form(truth, "p_psi",
                         start.angular_momentum_world.dot(rotation_of(start).col(2)));
}

}  // namespace

void compare_heavy_top(const Case& truth, const Laws& laws, Comparison& comparison) {
  const HeavyTop top(truth);
  const scene::Scene scene = top.scene(truth.id);
  compare_closed_forms(truth, top, comparison);
  comparison.attempt("start", [&] { compare_start(truth, start_of(scene, laws), comparison); });
  for (const Value& time : truth.input("times").list()) {
    const std::string t = "t" + time.text();
    const double rate =
        std::max(top.omega_body().norm(), std::sqrt(top.m * top.g * top.l / top.It));
    comparison.attempt("run to " + t, [&] {
      compare_refined({scene, time.number(), t, rate}, laws, quantities_of_top(truth, t),
                      comparison);
    });
  }
}

}  // namespace tumble::truths
