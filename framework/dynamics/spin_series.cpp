#include "framework/dynamics/spin_series.h"

#include <algorithm>
#include <cmath>

namespace tumble {

SpinSeries::SpinSeries(const Vector3d& moments, const Quaterniond& body_from_principal,
                       const Spin& start)
    : principal_from_body_(body_from_principal.conjugate()) {
  const Vector3d c((moments.y() - moments.z()) / moments.x(),
                   (moments.z() - moments.x()) / moments.y(),
                   (moments.x() - moments.y()) / moments.z());
  const Vector3d w = principal_from_body_ * start.omega_body;
  const Quaterniond q = start.world_from_body * body_from_principal;
  auto& [w1, w2, w3, qw, qx, qy, qz] = series_;
  w1[0] = w.x(), w2[0] = w.y(), w3[0] = w.z();
  qw[0] = q.w(), qx[0] = q.x(), qy[0] = q.y(), qz[0] = q.z();
  for (std::size_t k = 0; k < kOrder; ++k) {
    double s1 = 0, s2 = 0, s3 = 0, sw = 0, sx = 0, sy = 0, sz = 0;
    for (std::size_t j = 0; j <= k; ++j) {
      const double a = w1[k - j], b = w2[k - j], d = w3[k - j];
      s1 += w2[j] * d;
      s2 += w3[j] * a;
      s3 += w1[j] * b;
      sw -= qx[j] * a + qy[j] * b + qz[j] * d;
      sx += qw[j] * a + qy[j] * d - qz[j] * b;
      sy += qw[j] * b + qz[j] * a - qx[j] * d;
      sz += qw[j] * d + qx[j] * b - qy[j] * a;
    }
    const double n = 1.0 / static_cast<double>(k + 1);
    w1[k + 1] = n * c.x() * s1;
    w2[k + 1] = n * c.y() * s2;
    w3[k + 1] = n * c.z() * s3;
    qw[k + 1] = 0.5 * n * sw;
    qx[k + 1] = 0.5 * n * sx;
    qy[k + 1] = 0.5 * n * sy;
    qz[k + 1] = 0.5 * n * sz;
  }
}

double SpinSeries::reach(const Vector3d& moments, double largest_speed) {
  constexpr double kLeftOut = 5e-18, kTerms = kOrder + 1;
  double c = 1e-3;  // nothing is gained below
  for (int i = 0; i < 3; ++i)
    c = std::max(c, std::abs(moments[(i + 1) % 3] - moments[(i + 2) % 3]) / moments[i]);
  double product = 1.0;
  for (std::size_t j = 0; j <= kOrder; ++j)
    product *= (0.5 + c * static_cast<double>(j)) / static_cast<double>(j + 1);
  const double of_w = std::pow(kLeftOut, 1 / kTerms) / c,
               of_q = std::pow(kLeftOut / product, 1 / kTerms);
  return std::min(of_w, of_q) / largest_speed;
}

Spin SpinSeries::at(double t) const {
  std::array<double, 7> sum{};
  for (std::size_t k = kOrder + 1; k-- > 0;)
    for (std::size_t i = 0; i < 7; ++i) sum[i] = sum[i] * t + series_[i][k];
  return {(Quaterniond(sum[3], sum[4], sum[5], sum[6]) * principal_from_body_).normalized(),
          principal_from_body_.conjugate() * Vector3d(sum[0], sum[1], sum[2])};
}

}  // namespace tumble
