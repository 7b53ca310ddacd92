#include "framework/dynamics/rotation_bounds.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "framework/dynamics/world.h"

namespace tumble {
namespace {

constexpr double kSlack = 1.0 + 1e-9;  // the solves below lose a few digits where two moments are almost equal

// The end of the segment at which component k is zero; false where it lies outside x >= 0 or the two moments left are equal.
bool segment_end(const Vector3d& I, double twice_energy, double momentum_squared, int k, Vector3d& x) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double difference = I[j] - I[i];
  if (std::abs(difference) <= 1e-6 * std::max(I[i], I[j])) return false;
  x[k] = 0.0;
  x[i] = (twice_energy * I[j] - momentum_squared) / (I[i] * difference);
  x[j] = (momentum_squared - twice_energy * I[i]) / (I[j] * difference);
  const double slack = 1e-9 * (std::abs(x[i]) + std::abs(x[j]));
  if (x[i] < -slack || x[j] < -slack) return false;
  x = x.cwiseMax(0.0);
  return true;
}

}  // namespace

RotationBounds bound_rotation(const RigidBodyState& state, const Inertia& inertia, double torque_bound, double duration) {
  const Vector3d omega_world = omega_of(state, inertia);
  if (omega_world.isZero(0.0) && torque_bound == 0.0) return {0.0, 0.0};
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia.inertia_body);
  const Vector3d moments = solver.eigenvalues();
  const Vector3d omega_principal = solver.eigenvectors().transpose() * (state.world_from_body.conjugate() * omega_world);
  const double twice_energy = moments.dot(omega_principal.cwiseAbs2());
  const double momentum_squared = moments.cwiseProduct(omega_principal).squaredNorm();

  Vector3d largest = omega_principal.cwiseAbs2();   // of each x_i
  double speed_squared = largest.sum();
  int ends = 0;
  for (int k = 0; k < 3; ++k) {
    Vector3d x;
    if (!segment_end(moments, twice_energy, momentum_squared, k, x)) continue;
    ++ends;
    largest = largest.cwiseMax(x);
    speed_squared = std::max(speed_squared, x.sum());
  }
  if (ends < 2) {  // (nearly) symmetric moments: each component is bounded by its share of the energy
    for (int i = 0; i < 3; ++i) largest[i] = std::max(largest[i], std::min(twice_energy / moments[i], momentum_squared / (moments[i] * moments[i])));
    const bool all_equal = moments[2] - moments[0] <= 1e-6 * moments[2];
    speed_squared = all_equal ? speed_squared * (1 + 1e-5) : std::max(speed_squared, std::min(largest.sum(), twice_energy / moments[0]));
  }
  const double kick = torque_bound / moments[0];
  const double speed = std::sqrt(speed_squared) * kSlack + kick * duration;
  double acceleration_squared = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double ratio = (moments[j] - moments[k]) / moments[i];
    const double wj = std::sqrt(largest[j]) + kick * duration, wk = std::sqrt(largest[k]) + kick * duration;
    acceleration_squared += ratio * ratio * wj * wj * wk * wk;
  }
  return {speed, std::sqrt(acceleration_squared) * kSlack + kick};
}

}  // namespace tumble
