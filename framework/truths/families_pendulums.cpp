// chain, double_pendulum, compound_pendulum: rods and hinges, run by the engine with the chosen
// laws.
//
// Planar cases: gravity along -y, angles from the downward vertical, positive towards +x. Their
// plane is the world's x-y plane.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/engines/base/tolerances.h"
#include "framework/truths/families.h"
#include "framework/truths/memory_scene.h"
#include "framework/truths/refined_run.h"
#include "framework/scene/write_entries.h"

namespace tumble::truths {
namespace {

/// The unit vector at an angle, and its derivative by the angle.
Vector3d along(double angle) { return {std::sin(angle), -std::cos(angle), 0.0}; }
Vector3d across(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

// ---- chain and double_pendulum: point masses on rods -------------------------------------------

struct Chain {
  VectorXd masses, lengths, angles, rates;
  double g;

  explicit Chain(const Case& truth)
      : masses(truth.input("masses").vector()),
        lengths(truth.input("lengths").vector()),
        angles(truth.input("theta0").vector()),
        rates(truth.input("omega0").vector()),
        g(truth.input("g").number()) {}
  Eigen::Index size() const { return masses.size(); }
  scene::Scene scene(const std::string& name) const;
  double fastest_rate() const;
};

scene::Scene Chain::scene(const std::string& name) const {
  scene::Scene scene = empty_scene(name, 1.0, 1e-9);
  scene::EntryWriter{scene}("gravity_m_s2", Vector3d(0, -g, 0));
  scene.stabilisation = scene::StabilisationSpec{};
  Vector3d place = Vector3d::Zero(), velocity = Vector3d::Zero();
  std::string above;  // the first rod is attached to the world
  for (Eigen::Index i = 0; i < size(); ++i) {
    place += lengths[i] * along(angles[i]);
    velocity += lengths[i] * rates[i] * across(angles[i]);
    const std::string bob = "bob" + std::to_string(i);
    scene.bodies.push_back(point_mass(bob, masses[i], place, velocity));
    scene::EntryWriter{scene}("rods", {{"name", "rod" + std::to_string(i)},
                                       {"a", scene::AnchorSpec{above}},
                                       {"b", scene::AnchorSpec{bob}},
                                       {"length_m", lengths[i]}});
    above = bob;
  }
  return scene;
}

// The fastest of: small swings of the shortest rod with all the weight below it, free fall, and the
// rates at the start.
double Chain::fastest_rate() const {
  const double whole = lengths.sum(), shortest = lengths.minCoeff();
  return std::max({std::sqrt(g * masses.sum() / (shortest * masses.minCoeff())),
                   std::sqrt(g * whole) / shortest, rates.cwiseAbs().maxCoeff()});
}

/// From bob i - 1 (the pivot for 0) to bob i, of positions or velocities.
Vector3d step_of(const Frame& frame, std::size_t i, Vector3d BodyPose::*what) {
  return i == 0 ? Vector3d(frame.poses[0].*what)
                : Vector3d(frame.poses[i].*what - frame.poses[i - 1].*what);
}

/// Angles at the end of a run with whole turns, followed from frame to frame.
VectorXd angles_at_end(const Chain& chain, const Trajectory& run) {
  VectorXd angles = chain.angles;
  for (const Frame& frame : run.frames) {
    for (Eigen::Index i = 0; i < chain.size(); ++i) {
      const Vector3d rod = step_of(frame, static_cast<std::size_t>(i), &BodyPose::com_world);
      angles[i] +=
          std::remainder(std::atan2(rod.x(), -rod.y()) - angles[i], 2.0 * std::numbers::pi);
    }
  }
  return angles;
}

VectorXd rates_of(const Chain& chain, const Frame& frame) {
  VectorXd rates(chain.size());
  for (Eigen::Index i = 0; i < chain.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vector3d rod = step_of(frame, at, &BodyPose::com_world),
                   velocity = step_of(frame, at, &BodyPose::velocity_world);
    rates[i] = rod.cross(velocity).z() / rod.squaredNorm();
  }
  return rates;
}

/// x and y of all bobs in sequence, of positions or velocities.
VectorXd in_plane(const Frame& frame, Vector3d BodyPose::*what) {
  VectorXd all(2 * static_cast<Eigen::Index>(frame.poses.size()));
  for (std::size_t i = 0; i < frame.poses.size(); ++i)
    all.segment<2>(2 * static_cast<Eigen::Index>(i)) = (frame.poses[i].*what).head<2>();
  return all;
}

VectorXd flat_rows(const Value& rows) {
  std::vector<double> all;
  for (const Value& row : rows.list())
    for (const Value& number : row.list()) all.push_back(number.number());
  return Eigen::Map<const VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

VectorXd tensions_of(const Frame& frame) {
  return Eigen::Map<const VectorXd>(frame.rod_tensions.data(),
                                    static_cast<Eigen::Index>(frame.rod_tensions.size()));
}

// Tensions solve a system with the matrix J M^-1 J^T: with a light bob in the chain its condition
// is four times the ratio of masses, and rounding of its entries changes them by that factor; 25
// for a few dozen roundings.
void compare_tensions_at_start(const Case& truth, const Chain& chain, const VectorXd& found,
                               Comparison& comparison) {
  constexpr double kFewDozen = 25.0, kRounding = 0x1p-53;
  const VectorXd expected = truth.output("rod_tensions_t0").vector();
  const double floor = truth.floor("rod_tensions_t0"),
               condition = 4.0 * chain.masses.maxCoeff() / chain.masses.minCoeff();
  const double solved = kFewDozen * kRounding * condition * expected.cwiseAbs().maxCoeff(),
               rounding = kClosedFormFactor * floor;
  comparison.check(
      "rod_tensions_t0", largest_difference(found, expected), floor, std::max(rounding, solved),
      solved > rounding ? "tolerance: rounding times the condition of the rods' matrix" : "");
}

std::vector<Quantity> quantities_of_chain(const Case& truth, const Chain& chain,
                                          const std::string& t) {
  const auto of_bobs = [&](const std::string& output, Vector3d BodyPose::*what) {
    return Quantity{
        output, vector_of_last_frame([what](const Frame& frame) { return in_plane(frame, what); }),
        flat_rows(truth.output(output)), truth.floor(output)};
  };
  return {of_bobs("positions_" + t, &BodyPose::com_world),
          of_bobs("velocities_" + t, &BodyPose::velocity_world),
          derived(truth, "theta_" + t,
                  [chain](const Trajectory& run) { return angles_at_end(chain, run); }),
          derived(truth, "omega_" + t, vector_of_last_frame([chain](const Frame& frame) {
                    return rates_of(chain, frame);
                  })),
          derived(truth, "rod_tensions_" + t, vector_of_last_frame(tensions_of))};
}

}  // namespace

void compare_chain(const Case& truth, const Laws& laws, Comparison& comparison) {
  const Chain chain(truth);
  const scene::Scene scene = chain.scene(truth.id);
  comparison.attempt("start", [&] {
    const Frame start = start_of(scene, laws);
    comparison.closed_form(truth, "energy", energy_of(start));
    compare_tensions_at_start(truth, chain, tensions_of(start), comparison);
  });
  for (const Value& time : truth.input("times").list()) {
    const std::string t = "t" + time.text();
    comparison.attempt("run to " + t, [&] {
      compare_refined({scene, time.number(), t, chain.fastest_rate(), true}, laws,
                      quantities_of_chain(truth, chain, t), comparison);
    });
  }
}

// ---- compound_pendulum: a body on a hinge ------------------------------------------------------

namespace {

struct CompoundPendulum {
  double m, d, I_pivot, g, angle;

  explicit CompoundPendulum(const Case& truth)
      : m(truth.input("m").number()),
        d(truth.input("d_pivot_to_com").number()),
        I_pivot(truth.input("I_about_pivot").number()),
        g(truth.input("g").number()),
        angle(truth.input("theta0").number()) {}
  double rate() const { return std::sqrt(m * g * d / I_pivot); }
  scene::Scene scene(const std::string& name) const;
};

scene::Scene CompoundPendulum::scene(const std::string& name) const {
  scene::Scene scene = empty_scene(name, 1.0, 1e-9);
  scene::EntryWriter{scene}("gravity_m_s2", Vector3d(0, -g, 0));
  scene.stabilisation = scene::StabilisationSpec{};
  scene::BodySpec body = point_mass("body", m, d * along(angle), Vector3d::Zero());
  // body -y points from the pivot to the centre of mass
  body.world_from_body = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
  const double I_com = I_pivot - m * d * d;
  // of I_pivot: a smaller difference is rounding, and all the mass is in one point
  const bool is_point = !(I_com > engines::kSolverRounding * I_pivot);
  if (!is_point) body.inertia_body_kg_m2 = I_com * Matrix3d::Identity();
  scene.bodies.push_back(body);
  if (!is_point) {
    scene::EntryWriter{scene}("joints", {{"name", "hinge"},
                                         {"kind", "hinge"},
                                         {"body_a", "body"},
                                         {"point_m", Vector3d(Vector3d::Zero())},
                                         {"axis", Vector3d(Vector3d::UnitZ())}});
  } else {
    scene::EntryWriter{scene}("rods", {{"name", "rod"},
                                       {"a", scene::AnchorSpec{}},
                                       {"b", scene::AnchorSpec{"body"}},
                                       {"length_m", d}});
  }
  return scene;
}

double pivot_force(const Frame& frame) {
  return frame.joint_forces.empty() ? std::abs(frame.rod_tensions[0]) : frame.joint_forces[0];
}

/// At the end of a run, with whole turns.
double angle_at_end(const CompoundPendulum& pendulum, const Trajectory& run) {
  double angle = pendulum.angle;
  for (const Frame& frame : run.frames) {
    const Vector3d& x = frame.poses[0].com_world;
    angle += std::remainder(std::atan2(x.x(), -x.y()) - angle, 2.0 * std::numbers::pi);
  }
  return angle;
}

double rate_of(const Frame& frame) {
  const Vector3d &x = frame.poses[0].com_world, &v = frame.poses[0].velocity_world;
  return x.cross(v).z() / x.squaredNorm();
}

/// Change of the angle, its rate and the pivot's force at an instant by a relative rounding of
/// angle and rate during the run: root mean squares over the run (Quantity::growth). Angles are
/// roundings of positions of size d, so of 1 rad.
struct Growth {
  double angle = 0.0, rate = 0.0, force = 0.0;
};

/// The swing with its variations, theta'' = -w0^2 sin theta and Phi' = (0 1; -w0^2 cos theta 0)
/// Phi: a rounding at s becomes Phi(t) Phi(s)^-1 times itself at t. Near the top it grows as e^(w0
/// (t - s)); a rounding of the energy at the bottom is amplified by 1/sin(theta0) at the turning
/// point.
Growth growth_to(const CompoundPendulum& pendulum, double t) {
  constexpr int kSteps = 4000;  // growth to a few per cent, which suffices for a tolerance
  const double h = t / kSteps, w2 = pendulum.rate() * pendulum.rate();
  using State = Eigen::Matrix<double, 2, 3>;  // (theta, rate) and Phi
  const auto slope = [&](const State& y) -> State {
    State f;
    f.row(0) = y.row(1);
    f.row(1) = -w2 * std::cos(y(0, 0)) * y.row(0);
    f(1, 0) = -w2 * std::sin(y(0, 0));
    return f;
  };
  State y;
  y << pendulum.angle, 1.0, 0.0, 0.0, 0.0, 1.0;
  std::vector<State> way{y};
  for (int k = 0; k < kSteps; ++k) {
    const State k1 = slope(y), k2 = slope(y + 0.5 * h * k1), k3 = slope(y + 0.5 * h * k2),
                k4 = slope(y + h * k3);
    y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    way.push_back(y);
  }
  // |F| of (theta, rate): along the rod m (g cos + d rate^2), across it m g sin (1 - m d^2 / I).
  const auto force = [&](double angle, double rate) {
    return std::hypot(pendulum.m * (pendulum.g * std::cos(angle) + pendulum.d * rate * rate),
                      pendulum.m * pendulum.g * std::sin(angle) *
                          (1.0 - pendulum.m * pendulum.d * pendulum.d / pendulum.I_pivot));
  };
  // of a central difference, whose errors h^2 and eps / h are smallest together there
  const double aside = std::cbrt(kEpsilon);
  const double angle = y(0, 0), rate = y(1, 0);
  const Eigen::RowVector2d of_force(
      (force(angle + aside, rate) - force(angle - aside, rate)) / (2 * aside),
      (force(angle, rate + aside) - force(angle, rate - aside)) / (2 * aside));
  Growth squares;
  for (const State& at : way) {
    const Eigen::Matrix2d later = y.rightCols<2>() * at.rightCols<2>().inverse();
    const Eigen::Vector2d rounded(1.0, std::abs(at(1, 0)));
    squares.angle += later.row(0).cwiseAbs2().dot(rounded.cwiseAbs2());
    squares.rate += later.row(1).cwiseAbs2().dot(rounded.cwiseAbs2());
    squares.force += (of_force * later).cwiseAbs2().dot(rounded.cwiseAbs2().transpose());
  }
  const auto mean = [&](double sum) { return std::sqrt(sum / static_cast<double>(way.size())); };
  return {mean(squares.angle), mean(squares.rate), mean(squares.force)};
}

/// @param instant  as in the outputs' names: "t1", "at_0.25T"
void compare_pendulum_at(const Case& truth, const CompoundPendulum& pendulum,
                         const std::string& instant, double t, const Laws& laws,
                         Comparison& comparison) {
  comparison.attempt("run to " + instant, [&] {
    const std::string force = "pivot_force_" + instant;
    // The hinge reports the size of the force.
    Quantity size{"|" + force + "|", of_last_frame(pivot_force),
                  VectorXd::Constant(1, truth.output(force).vector().norm()), truth.floor(force),
                  false};
    Quantity rate = quantity(truth, "thetadot_" + instant, of_last_frame(rate_of));
    Quantity angle = quantity(truth, "theta_" + instant, [pendulum](const Trajectory& run) {
      return VectorXd::Constant(1, angle_at_end(pendulum, run));
    });
    const Growth growth = growth_to(pendulum, t);
    angle.growth = growth.angle;
    rate.growth = growth.rate;
    size.growth = growth.force;
    // Half the scene's gravity as well: a swing of large amplitude is faster than small ones only
    // by its own speed.
    compare_refined({pendulum.scene(truth.id), t, instant, 2.0 * pendulum.rate(), true}, laws,
                    {angle, rate, size}, comparison);
  });
}

}  // namespace

void compare_compound_pendulum(const Case& truth, const Laws& laws, Comparison& comparison) {
  const CompoundPendulum pendulum(truth);
  const double T = truth.output("period").number();
  comparison.attempt("start", [&] {
    const Frame start = start_of(pendulum.scene(truth.id), laws);
    comparison.closed_form(truth, "energy", energy_of(start));
    comparison.closed_form(
        "|pivot_force_t0|",
        std::abs(pivot_force(start) - truth.output("pivot_force_t0").vector().norm()),
        truth.floor("pivot_force_t0"));
  });
  for (const auto& [name, value] : truth.outputs.members()) {
    const std::string prefix = "theta_";
    if (name.rfind(prefix, 0) != 0) continue;
    const std::string instant = name.substr(prefix.size());
    const double t = instant.rfind("at_", 0) == 0 ? std::stod(instant.substr(3)) * T
                                                  : std::stod(instant.substr(1));
    compare_pendulum_at(truth, pendulum, instant, t, laws, comparison);
  }
  // It passes the lowest point at T / 4 and 3 T / 4: the times follow from position and velocity
  // near them.
  comparison.attempt("period", [&] {
    const auto passage = [&](const Trajectory& run) {
      return run.frames.back().time -
             std::remainder(angle_at_end(pendulum, run), 2.0 * std::numbers::pi) /
                 rate_of(run.frames.back());
    };
    Quantity period = quantity(truth, "period", [=](const Trajectory& run) {
      return VectorXd::Constant(1, 4.0 * passage(run));
    });
    const Quantity fastest =
        quantity(truth, "thetadot_bottom",
                 of_last_frame([](const Frame& frame) { return std::abs(rate_of(frame)); }));
    compare_refined(
        {pendulum.scene(truth.id), 0.25 * T, "quarter_period", 2.0 * pendulum.rate(), true}, laws,
        {period, fastest}, comparison);
  });
}

}  // namespace tumble::truths
