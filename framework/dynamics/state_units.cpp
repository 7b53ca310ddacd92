#include "framework/dynamics/state_units.h"

#include <cmath>
#include <numbers>

namespace tumble {

double nearest_power_of_two(double value) {
  int exponent = 0;
  const double part = std::frexp(value, &exponent);  // in [1/2, 1)
  return std::ldexp(1.0, part < 0.5 * std::numbers::sqrt2 ? exponent - 1 : exponent);
}

double radius_of_gyration(const Inertia& inertia) {
  return std::sqrt(inertia.inertia_body.trace() / (3.0 * inertia.mass));
}

VectorXd units_of_state(const Inertia& inertia, double length) {
  const double radius = radius_of_gyration(inertia), l = length > 0.0 ? length : 1.0,
               turning = radius > 0.0 ? radius : l;
  const double in_length = nearest_power_of_two(l), in_mass = nearest_power_of_two(inertia.mass),
               in_moment = nearest_power_of_two(inertia.mass * turning * turning);
  VectorXd units(kStateSize);
  units.segment<3>(0).setConstant(in_length);
  units.segment<4>(3).setOnes();
  units.segment<3>(7).setConstant(in_mass * in_length);
  units.segment<3>(10).setConstant(in_moment);
  return units;
}

VectorXd integrate_by(const Laws& laws, const OdeFunction& f, double t, const VectorXd& y, double h,
                      const VectorXd& units) {
  if (!laws.steps_in_units) return laws.integrate_step(f, t, y, h);
  const VectorXd per_unit = units.cwiseInverse();
  const OdeFunction in_units = [&](double time, const VectorXd& z) -> VectorXd {
    if (z.size() != units.size()) return f(time, z);  // says so
    VectorXd slope = f(time, z.cwiseProduct(units));
    slope.array() *= per_unit.array();
    return slope;
  };
  return laws.integrate_step(in_units, t, y.cwiseProduct(per_unit), h).cwiseProduct(units);
}

}  // namespace tumble
