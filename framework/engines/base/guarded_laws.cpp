#include "framework/engines/base/guarded_laws.h"

#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/dynamics/world.h"

namespace tumble::engines {
namespace {

struct Guard {
  std::string effect, law, source;

  std::string subject() const { return fmt::format("{} ({} of {})", effect, law, source); }

  template <class Call>
  auto operator()(Call&& call) const {
    try {
      return call();
    } catch (const StoppedRun&) {
      throw;  // out of a derivative that the method asked for
    } catch (const NotImplemented&) {
      throw;
    } catch (const UserError&) {
      throw;
    } catch (const std::exception& error) {
      const std::string words = fmt::format("{} failed: {}", subject(), error.what());
      if (dynamic_cast<const Final*>(&error)) throw StoppedForGood(words);
      throw StoppedRun(words);
    }
  }
  void need(bool fine, const char* what) const {
    if (!fine) throw StoppedRun(fmt::format("{} returned {}", subject(), what));
  }
  void need_size(Eigen::Index found, Eigen::Index expected) const {
    if (found != expected)
      throw StoppedRun(
          fmt::format("{} returned {} numbers instead of {}", subject(), found, expected));
  }
};

constexpr const char* kNotANumber = "a value that is not a number";

void guard_impulses(const Laws& laws, Laws& safe) {
  const std::string& source = laws.impulse_source;
  if (laws.relative_normal_velocity) {
    const Guard guard{"collision", "relative_normal_velocity", source};
    safe.relative_normal_velocity = [guard, law = laws.relative_normal_velocity](
                                        const Contact& contact, const Body& a, const Body& b) {
      const double velocity = guard([&] { return law(contact, a, b); });
      guard.need(std::isfinite(velocity), kNotANumber);
      return velocity;
    };
  }
  if (laws.collision_impulse) {
    const Guard guard{"collision", "collision_impulse", source};
    safe.collision_impulse = [guard, law = laws.collision_impulse](const Contact& contact,
                                                                   const Body& a, const Body& b,
                                                                   double restitution) {
      const double impulse = guard([&] { return law(contact, a, b, restitution); });
      guard.need(std::isfinite(impulse), kNotANumber);
      return impulse;
    };
  }
  if (laws.apply_impulse) {
    const Guard guard{"collision", "apply_impulse", source};
    safe.apply_impulse = [guard, law = laws.apply_impulse](const Body& body,
                                                           const Vector3d& impulse_world,
                                                           const Vector3d& point_world) {
      const Velocity after = guard([&] { return law(body, impulse_world, point_world); });
      guard.need(after.linear_world.allFinite() && after.angular_world.allFinite(), kNotANumber);
      return after;
    };
  }
  if (laws.wrench_of_point_force) {
    const Guard guard{"point force", "wrench_of_point_force", source};
    safe.wrench_of_point_force = [guard, law = laws.wrench_of_point_force](const Vector3d& force,
                                                                           const Vector3d& point,
                                                                           const Vector3d& com) {
      const Wrench wrench = guard([&] { return law(force, point, com); });
      guard.need(wrench.force_world.allFinite() && wrench.torque_world.allFinite(), kNotANumber);
      return wrench;
    };
  }
}

void guard_motion(const Laws& laws, Laws& safe) {
  const std::string& source = laws.integrator_source;
  if (laws.integrate_step) {
    const Guard guard{"integration", "integrate_step", source};
    safe.integrate_step = [guard, law = laws.integrate_step](const OdeFunction& f, double t,
                                                             const VectorXd& y, double h) {
      const VectorXd end = guard([&] { return law(f, t, y, h); });
      guard.need_size(end.size(), y.size());
      guard.need(end.allFinite(), kNotANumber);
      return end;
    };
  }
  if (laws.state_derivative) {
    const Guard guard{"integration", "state_derivative", source};
    safe.state_derivative = [guard, law = laws.state_derivative](const RigidBodyState& state,
                                                                 const Inertia& inertia,
                                                                 const Wrench& wrench) {
      const VectorXd rate = guard([&] { return law(state, inertia, wrench); });
      guard.need_size(rate.size(), kStateSize);
      // Out of a state that is no number nothing better can come: that is the method's doing.
      guard.need(rate.allFinite() || !is_finite(state), kNotANumber);
      return rate;
    };
  }
  if (laws.renormalize) {
    const Guard guard{"integration", "renormalize", source};
    safe.renormalize = [guard, law = laws.renormalize](const Quaterniond& q) {
      const Quaterniond unit = guard([&] { return law(q); });
      guard.need(unit.coeffs().allFinite(), kNotANumber);
      return unit;
    };
  }
  if (laws.find_impact_time) {
    const Guard guard{"time of impact", "find_impact_time", source};
    safe.find_impact_time = [guard, law = laws.find_impact_time](
                                const ScalarFunction& gap, const ScalarFunction& rate, double low,
                                double high, double tolerance) {
      return guard([&] { return law(gap, rate, low, high, tolerance); });
    };
  }
}

void guard_constraints(const Laws& laws, Laws& safe) {
  const std::string& source = laws.constraint_source;
  if (laws.spring_force) {
    const Guard guard{"springs", "spring_force", source};
    safe.spring_force = [guard, law = laws.spring_force](const Spring& spring, const AnchorState& a,
                                                         const AnchorState& b) {
      const Vector3d force = guard([&] { return law(spring, a, b); });
      guard.need(force.allFinite(), kNotANumber);
      return force;
    };
  }
  if (laws.rod_row) {
    const Guard guard{"rods", "rod_row", source};
    safe.rod_row = [guard, law = laws.rod_row](const Body& a, const Vector3d& point_a,
                                               const Body& b, const Vector3d& point_b,
                                               double length) {
      const ConstraintRow row = guard([&] { return law(a, point_a, b, point_b, length); });
      guard.need(row.jacobian_a.allFinite() && row.jacobian_b.allFinite() &&
                     std::isfinite(row.value) && std::isfinite(row.rate) &&
                     std::isfinite(row.velocity_product),
                 kNotANumber);
      return row;
    };
  }
  if (laws.baumgarte_acceleration) {
    const Guard guard{"rods and joints", "baumgarte_acceleration", source};
    safe.baumgarte_acceleration = [guard, law = laws.baumgarte_acceleration](
                                      double value, double rate, double time_constant_s) {
      const double acceleration = guard([&] { return law(value, rate, time_constant_s); });
      guard.need(std::isfinite(acceleration), kNotANumber);
      return acceleration;
    };
  }
  const auto vector_law = [&](auto& law, const char* effect, const char* name,
                              const std::string& its_source) {
    if (!law) return;
    const Guard guard{effect, name, its_source};
    law = [guard, inner = law](const auto&... arguments) {
      const VectorXd answer = guard([&] { return inner(arguments...); });
      guard.need(answer.allFinite(), kNotANumber);
      return answer;
    };
  };
  vector_law(safe.constraint_multipliers, "rods and joints", "constraint_multipliers",
             laws.source_of_links());
  vector_law(safe.constraint_correction, "rods and joints", "constraint_correction",
             laws.source_of_links());
  vector_law(safe.contact_forces, "persistent contact", "contact_forces",
             laws.source_of_contacts());
}

}  // namespace

Laws guarded(const Laws& laws) {
  Laws safe = laws;
  guard_impulses(laws, safe);
  guard_motion(laws, safe);
  guard_constraints(laws, safe);
  return safe;
}

}  // namespace tumble::engines
