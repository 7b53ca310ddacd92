/// The free turning of one body over a while, worked out once as a power series and asked for many
/// times.
///
/// FreeRotation gives any time to 1e-15 for microseconds a question; a caller that asks a hundred
/// times about one short while, as a search for an impact does, pays for the coefficients once
/// here.
///   (k+1) w1[k+1] = (I2 - I3) / I1  sum_j w2[j] w3[k-j]   and cyclic,
///       (k+1) q[k+1] = 1/2 sum_j q[j] (0, w[k-j])     (F.4, F.5)
/// Source: A. Jorba, M. Zou, Experimental Mathematics 14, 2005 (free_rotation.cpp has the same in
/// long double).
#pragma once

#include <array>

#include "framework/dynamics/free_rotation.h"

namespace tumble {

class SpinSeries {
 public:
  SpinSeries() = default;
  /// @param moments               principal, > 0 [kg m^2]
  /// @param body_from_principal   unit
  SpinSeries(const Vector3d& moments, const Quaterniond& body_from_principal, const Spin& start);

  /// A time t after the start. @return right to some 1e-16 for 0 <= t <= reach(largest speed)
  Spin at(double t) const;

  /// How far the series reaches where a body never turns faster than this [s]: the first
  /// coefficients that are left out are then below 5e-18 of the first ones. With c the largest |I_i
  /// - I_j| / I_k (at most 1) and W the speed, majorants of (F.1) are
  ///   w' = c w^2:      w_k <= W (c W)^k,               q' = w q / 2:
  ///       q_k <= W^k prod_{j<k} (1/2 + c j) / (j + 1)
  /// @param moments  principal, > 0 [kg m^2];  @param largest_speed  > 0 [rad/s]
  static double reach(const Vector3d& moments, double largest_speed);

 private:
  static constexpr std::size_t kOrder = 20;
  using Coefficients = std::array<double, kOrder + 1>;

  std::array<Coefficients, 7> series_{};  // w1 w2 w3, q as w x y z; principal frame
  Quaterniond principal_from_body_ = Quaterniond::Identity();
};

}  // namespace tumble
