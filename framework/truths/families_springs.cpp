// spring_mass, elastic_pendulum, two_body_spring: bodies on springs, run by the engine with the
// chosen laws.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "framework/truths/families.h"
#include "framework/truths/memory_scene.h"
#include "framework/truths/refined_run.h"
#include "framework/scene/write_entries.h"

namespace tumble::truths {
namespace {

void add_spring(scene::Scene& scene, const scene::AnchorSpec& a, const scene::AnchorSpec& b,
                const Spring& spring) {
  scene::EntryWriter{scene}("springs", {{"name", "spring"},
                                        {"a", a},
                                        {"b", b},
                                        {"stiffness_n_m", spring.stiffness},
                                        {"damping_n_s_m", spring.damping},
                                        {"rest_length_m", spring.rest_length}});
}

const Vector3d kAxis = Vector3d::UnitX();  // axis of the spring-mass motion

// ---- spring_mass ------------------------------------------------------------------------------

struct SpringMass {
  double m, k, c, x0, v0;

  explicit SpringMass(const Case& truth)
      : m(truth.input("m").number()),
        k(truth.input("k").number()),
        c(truth.input("c").number()),
        x0(truth.input("x0").number()),
        v0(truth.input("v0").number()) {}
  double omega() const { return std::sqrt(k / m); }
  /// Bound of |x|, from the energy at the start, which never grows.
  double largest_stretch() const { return std::hypot(x0, v0 / omega()); }
  /// Largest root of m r^2 + c r + k = 0 by size: a step must resolve it.
  double fastest_rate() const {
    const double damping = c / (2.0 * m);
    return damping > omega() ? damping + std::sqrt(damping * damping - omega() * omega()) : omega();
  }
  scene::Scene scene(const std::string& name) const;
};

// A spring of rest length 0, attached at its point of rest, exerts -k x - c x' along the line: the
// equation itself, in which x keeps its relative precision however small it is. It has no direction
// at x = 0; a start there has a long spring that keeps its direction.
scene::Scene SpringMass::scene(const std::string& name) const {
  scene::Scene scene = empty_scene(name, 1.0, 1e-9);
  scene.bodies.push_back(point_mass("mass", m, x0 * kAxis, v0 * kAxis));
  const double rest_length = x0 == 0.0 && c > 0.0 ? 2.0 * largest_stretch() : 0.0;
  add_spring(scene, {"", -rest_length * kAxis}, {"mass", Vector3d::Zero()}, {k, c, rest_length});
  return scene;
}

/// |y(h)| / |y(0)| of the laws' method on y' = i w y with w h = z: above 1 the method is unstable
/// there.
double amplification(const Laws& laws, double z) {
  const OdeFunction turn = [](double, const VectorXd& y) -> VectorXd {
    return Eigen::Vector2d(-y[1], y[0]);
  };
  return laws.integrate_step(turn, 0.0, Eigen::Vector2d(1.0, 0.0), z).norm();
}

/// The z beyond which the amplification stays above 1, between a damped and a growing point.
double stability_limit(const Laws& laws) {
  // RK4 is damped on (0, 2.83), most at 2.4, well away from rounding.
  double stable = 2.4, unstable = 4.0;
  if (!(amplification(laws, stable) < 1.0) || !(amplification(laws, unstable) > 1.0)) return kUnset;
  for (double middle = 3.2; middle > stable && middle < unstable;
       middle = 0.5 * (stable + unstable))
    (amplification(laws, middle) <= 1.0 ? stable : unstable) = middle;
  return stable;
}

/// The same for the semi-implicit method v += h a(x), x += h v: its matrix has determinant 1 and
/// trace 2 - z^2, stable while |trace| <= 2.
double symplectic_euler_limit(double omega) { return 2.0 / omega; }

void compare_constants_of_spring(const Case& truth, const SpringMass& spring, const Laws& laws,
                                 Comparison& comparison) {
  const double w = spring.omega();
  comparison.closed_form(truth, "omega_natural", w);
  comparison.closed_form(truth, "damping_ratio", spring.c / (2.0 * std::sqrt(spring.k * spring.m)));
  comparison.closed_form(truth, "undamped_period", 2.0 * std::numbers::pi / w);
  comparison.closed_form(truth, "dt_limit_symplectic_euler", symplectic_euler_limit(w));
  comparison.attempt("dt_limit_rk4_undamped", [&] {
    comparison.closed_form(truth, "dt_limit_rk4_undamped", stability_limit(laws) / w);
  });
}

}  // namespace

void compare_spring_mass(const Case& truth, const Laws& laws, Comparison& comparison) {
  const SpringMass spring(truth);
  compare_constants_of_spring(truth, spring, laws, comparison);
  const scene::Scene scene = spring.scene(truth.id);
  for (const Value& time : truth.input("times").list()) {
    const std::string t = "t" + time.text();
    comparison.attempt("run to " + t, [&] {
      std::vector<Quantity> quantities{
          quantity(truth, "x_" + t, of_last_frame([](const Frame& frame) {
                     return frame.poses[0].com_world.dot(kAxis);
                   })),
          quantity(truth, "v_" + t, of_last_frame([](const Frame& frame) {
                     return frame.poses[0].velocity_world.dot(kAxis);
                   })),
          derived(truth, "energy_" + t, of_last_frame(energy_of))};
      compare_refined({scene, time.number(), t, spring.fastest_rate()}, laws, quantities,
                      comparison);
    });
  }
}

// ---- elastic_pendulum --------------------------------------------------------------------------

void compare_elastic_pendulum(const Case& truth, const Laws& laws, Comparison& comparison) {
  const double m = truth.input("m").number(), k = truth.input("k").number();
  scene::Scene scene = empty_scene(truth.id, 1.0, 1e-9);
  scene::EntryWriter{scene}("gravity_m_s2", Vector3d(0, 0, -truth.input("g").number()));
  scene.bodies.push_back(
      point_mass("bob", m, truth.input("x0").vector3(), truth.input("v0").vector3()));
  add_spring(scene, {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()},
             {k, 0.0, truth.input("L0").number()});

  const Frame start = start_of(scene, laws);
  comparison.closed_form(truth, "energy", energy_of(start));
  comparison.closed_form(truth, "Lz",
                         (start.poses[0].com_world.cross(m * start.poses[0].velocity_world)).z());
  // The bob swings, and passes the lowest point at the speed that its energy gives.
  const double rate =
      std::sqrt(k / m) + std::sqrt(truth.input("g").number() / truth.input("L0").number());
  for (const Value& time : truth.input("times").list()) {
    const std::string t = "t" + time.text();
    comparison.attempt("run to " + t, [&] {
      compare_refined({scene, time.number(), t, rate}, laws,
                      {quantity(truth, "x_" + t, vector_of_last_frame([](const Frame& frame) {
                                  return VectorXd(frame.poses[0].com_world);
                                })),
                       quantity(truth, "v_" + t, vector_of_last_frame([](const Frame& frame) {
                                  return VectorXd(frame.poses[0].velocity_world);
                                }))},
                      comparison);
    });
  }
}

// ---- two_body_spring ---------------------------------------------------------------------------

namespace {

/// Body 'A' or 'B' of a case.
scene::BodySpec joined_body(const Case& truth, const std::string& name) {
  scene::BodySpec body =
      point_mass(name, truth.input("m" + name).number(), truth.input("x" + name).vector3(),
                 truth.input("v" + name).vector3());
  const VectorXd q = truth.input("q" + name).vector();
  body.world_from_body = Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  body.inertia_body_kg_m2 = truth.input("I" + name).vector3().asDiagonal();
  body.omega_world_rad_s = body.world_from_body * truth.input("w" + name).vector3();
  return body;
}

/// All quantities of body 'A' (0) or 'B' (1) at an instant.
void add_body(const Case& truth, std::size_t index, const std::string& t,
              std::vector<Quantity>& quantities) {
  const std::string end = (index == 0 ? "A_" : "B_") + t;
  const auto pose = [index](const Frame& frame) { return frame.poses[index]; };
  quantities.push_back(quantity(truth, "x" + end, vector_of_last_frame([=](const Frame& f) {
                                  return VectorXd(pose(f).com_world);
                                })));
  quantities.push_back(quantity(truth, "v" + end, vector_of_last_frame([=](const Frame& f) {
                                  return VectorXd(pose(f).velocity_world);
                                })));
  quantities.push_back(quantity(truth, "q" + end, vector_of_last_frame([=](const Frame& f) {
                                  return components(pose(f).world_from_body);
                                })));
  quantities.back().difference = difference_of_orientations;
  quantities.push_back(quantity(truth, "w" + end, vector_of_last_frame([=](const Frame& f) {
                                  return VectorXd(pose(f).world_from_body.conjugate() *
                                                  pose(f).omega_world);
                                })));
}

}  // namespace

void compare_two_body_spring(const Case& truth, const Laws& laws, Comparison& comparison) {
  scene::Scene scene = empty_scene(truth.id, 1.0, 1e-9);
  scene.bodies = {joined_body(truth, "A"), joined_body(truth, "B")};
  const Vector3d a = truth.input("aA").vector3(), b = truth.input("aB").vector3();
  const double k = truth.input("k").number();
  add_spring(scene, {"A", a}, {"B", b}, {k, truth.input("c").number(), truth.input("L0").number()});
  const auto length = [a, b](const Frame& frame) {
    const auto end = [&](std::size_t i, const Vector3d& point) {
      return Vector3d(frame.poses[i].com_world + frame.poses[i].world_from_body * point);
    };
    return (end(1, b) - end(0, a)).norm();
  };

  const Frame start = start_of(scene, laws);
  comparison.closed_form(truth, "energy_t0", energy_of(start));
  comparison.closed_form(truth, "momentum_world", VectorXd(start.momentum_world));
  comparison.closed_form(truth, "angular_momentum_world_about_origin",
                         VectorXd(start.angular_momentum_world));
  comparison.closed_form(truth, "spring_length_t0", length(start));

  // Compliance of both ends: by their masses, and by rotation at most |a|^2 / I.
  double give = 0.0, spin = 0.0;
  for (const scene::BodySpec& body : scene.bodies) {
    const Vector3d& arm = body.name == "A" ? a : b;
    give +=
        1.0 / *body.mass_kg + arm.squaredNorm() / body.inertia_body_kg_m2->diagonal().minCoeff();
    spin = std::max(spin, body.omega_world_rad_s.norm());
  }
  for (const Value& time : truth.input("times").list()) {
    const std::string t = "t" + time.text();
    comparison.attempt("run to " + t, [&] {
      std::vector<Quantity> quantities;
      add_body(truth, 0, t, quantities);
      add_body(truth, 1, t, quantities);
      quantities.push_back(derived(truth, "energy_" + t, of_last_frame(energy_of)));
      quantities.push_back(derived(truth, "spring_length_" + t, of_last_frame(length)));
      compare_refined({scene, time.number(), t, std::sqrt(k * give) + spin}, laws, quantities,
                      comparison);
    });
  }
}

}  // namespace tumble::truths
