#include "framework/dynamics/rotation_bounds.h"

#include <algorithm>
#include <cmath>

#include "framework/core/decompositions.h"
#include "framework/dynamics/world.h"

namespace tumble {
namespace {

struct Band {
  double low, high;
  bool holds(double value, double slack) const {
    return value >= low * (1.0 - slack) && value <= high * (1.0 + slack);
  }
};

// Two moments closer than kSameMoment (relative) are one: a corner between them would lose all
// digits. Corners count when they miss the bands by no more than that, and solving for one leaves
// at most 2^-52 / kSameMoment, about 2e-7, of a component.
constexpr double kSameMoment = 1e-9;
constexpr double kCornerSlack = 10 * kSameMoment;
constexpr double kSolveSlack = 1.0 + 1e-6;

struct Largest {
  Vector3d squares;  // of each x_i
  double sum;        // of x_1 + x_2 + x_3
};

// Over { x >= 0 : sum I_i x_i in `energy`, sum I_i^2 x_i in `momentum` }, a polytope: what is
// linear is largest at a corner.
Largest largest_squares(const Vector3d& I, const Band& energy, const Band& momentum,
                        const Vector3d& now) {
  Largest largest{now, now.sum()};
  const auto consider = [&](const Vector3d& corner) {
    const Vector3d x = corner.cwiseMax(0.0);
    if (!energy.holds(I.dot(x), kCornerSlack) ||
        !momentum.holds(I.cwiseAbs2().dot(x), kCornerSlack))
      return;
    largest.squares = largest.squares.cwiseMax(kSolveSlack * x);
    largest.sum = std::max(largest.sum, (1.0 + kCornerSlack) * x.sum());
  };
  for (int i = 0; i < 3; ++i) {
    for (const double e : {energy.low, energy.high}) consider(Vector3d::Unit(i) * (e / I[i]));
    for (const double m : {momentum.low, momentum.high})
      consider(Vector3d::Unit(i) * (m / (I[i] * I[i])));
    const int j = (i + 1) % 3;
    const double difference = I[j] - I[i];
    if (std::abs(difference) <= kSameMoment * std::max(I[i], I[j])) continue;
    for (const double e : {energy.low, energy.high})
      for (const double m : {momentum.low, momentum.high})
        consider(Vector3d::Unit(i) * ((e * I[j] - m) / (I[i] * difference)) +
                 Vector3d::Unit(j) * ((m - e * I[i]) / (I[j] * difference)));
  }
  return largest;
}

double squared(double x) { return x * x; }

}  // namespace

PrincipalMoments principal_moments(const Inertia& inertia) {
  const SymmetricEigen3 eigen = symmetric_eigen(inertia.inertia_body);
  return {eigen.values, eigen.vectors};
}

RotationBounds bound_rotation(const RigidBodyState& state, const Inertia& inertia,
                              const Disturbance& disturbance) {
  if (omega_of(state, inertia).isZero(0.0) && disturbance.torque == 0.0) return {0.0, 0.0};
  return bound_rotation(state, inertia, principal_moments(inertia), disturbance);
}

RotationBounds bound_rotation(const RigidBodyState& state, const Inertia& inertia,
                              const PrincipalMoments& principal, const Disturbance& disturbance) {
  const Vector3d omega_world = omega_of(state, inertia);
  if (omega_world.isZero(0.0) && disturbance.torque == 0.0) return {0.0, 0.0};
  const Vector3d& moments = principal.moments;
  const Vector3d omega_principal =
      principal.axes_body.transpose() * (state.world_from_body.conjugate() * omega_world);
  const Vector3d now = omega_principal.cwiseAbs2();
  const double error = disturbance.angular_velocity_error, h = disturbance.duration;

  // (D.1), the torque's part
  const double root = std::sqrt(moments.dot(now)),
               root_kick = disturbance.torque * h / std::sqrt(moments[0]);
  const double length = moments.cwiseProduct(omega_principal).norm(), kick = disturbance.torque * h;
  const Band free_energy{squared(std::max(root - root_kick, 0.0)), squared(root + root_kick)};
  const Band momentum{squared(std::max(length - kick, 0.0)), squared(length + kick)};
  const double top_momentum = length + kick,
               top_speed = (1.0 + kCornerSlack) * top_momentum / moments[0];
  Largest largest = largest_squares(moments, free_energy, momentum, now);
  double speed = std::min(std::sqrt(largest.sum), top_speed);

  // (D.1), the error's part: it holds as long as |omega| stays below `assumed`, and |omega| does so
  // when the bound comes out below.
  for (double assumed = 2.0 * speed; error > 0.0; assumed *= 2.0) {
    assumed = std::min(assumed, top_speed);
    const double drift = 2.0 * error * assumed * top_momentum * h;
    largest = largest_squares(
        moments, {std::max(free_energy.low - drift, 0.0), free_energy.high + drift}, momentum, now);
    speed = std::min(std::sqrt(largest.sum), top_speed);
    if (speed <= assumed || assumed >= top_speed) break;
  }

  double acceleration_squared = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    acceleration_squared +=
        squared((moments[j] - moments[k]) / moments[i]) * largest.squares[j] * largest.squares[k];
  }
  return {speed, std::sqrt(acceleration_squared) + disturbance.torque / moments[0] +
                     error * (speed + top_speed)};
}

}  // namespace tumble
