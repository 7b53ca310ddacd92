#include "framework/dynamics/contact_cone.h"

#include <limits>

#include "framework/core/numbers.h"

namespace tumble::contacts {
namespace {

// bisection alone needs 52 to the last bit; Newton's iteration about 5
constexpr int kMostNewtonSteps = 60;

/// p(s) of (C.5), tangents along the eigenvectors of S.
struct SlidingImpulse {
  double normal, t1, t2, length;
  double normal_slope, length_slope;  // d/ds
};

struct SlidingProblem {
  const LocalContact& local;
  double c1, c2;  // right-hand side along the eigenvectors
  double free_n;

  SlidingImpulse at(double s) const {
    const double r1 = 1 / (local.stiff_1 + s), r2 = 1 / (local.stiff_2 + s);
    SlidingImpulse p;
    p.t1 = -c1 * r1;
    p.t2 = -c2 * r2;
    p.length = std::sqrt(p.t1 * p.t1 + p.t2 * p.t2);
    p.normal = (-free_n - local.coupling_1 * p.t1 - local.coupling_2 * p.t2) / local.w_nn;
    p.normal_slope = (local.coupling_1 * p.t1 * r1 + local.coupling_2 * p.t2 * r2) / local.w_nn;
    p.length_slope = p.length > 0 ? -(p.t1 * p.t1 * r1 + p.t2 * p.t2 * r2) / p.length : 0.0;
    return p;
  }
};

/// Finds the s at which |p_t| = mu p_n, from a guess. 1 - mu p_n / |p_t| is nearly linear in s.
SlidingImpulse slide(const SlidingProblem& problem, double friction, double high, double& s) {
  double low = 0;
  if (!(s < high)) s = 0;
  SlidingImpulse p = problem.at(s);
  for (int i = 0; i < kMostNewtonSteps; ++i) {
    const double bound = friction * p.normal, excess = p.length - bound;
    (excess > 0 ? low : high) = s;
    if (std::abs(excess) <= 4 * kEpsilon * p.length || high - low <= 2 * kEpsilon * high) break;
    // of excess / length, times length^2
    const double slope = friction * (p.normal * p.length_slope - p.normal_slope * p.length);
    double next = slope < 0 ? s - excess * p.length / slope : -1.0;
    if (std::abs(next - s) <= 4 * kEpsilon * s) break;  // nearer to it no s is
    if (!(next > low && next < high))
      next = low > 0 ? std::sqrt(low) * std::sqrt(high) : 0.5 * high;
    s = next;
    p = problem.at(s);
  }
  return p;
}

}  // namespace

LocalContact prepare_local(const Matrix3d& w) {
  LocalContact local;
  local.w = w;
  local.w_nn = w(0, 0);
  const double s11 = w(1, 1) - w(1, 0) * w(1, 0) / local.w_nn,
               s22 = w(2, 2) - w(2, 0) * w(2, 0) / local.w_nn;
  const double s12 = w(1, 2) - w(1, 0) * w(2, 0) / local.w_nn;
  const double middle = 0.5 * (s11 + s22), half = 0.5 * (s11 - s22),
               radius = std::sqrt(half * half + s12 * s12);
  // S of a body that cannot turn about some axis may be singular: hold p_t finite
  const double least = 1e-14 * w.trace();
  local.stiff_1 = std::max(middle + radius, least);
  local.stiff_2 = std::max(middle - radius, least);
  const double angle = radius > 0 ? 0.5 * std::atan2(s12, half) : 0.0;
  local.cosine = std::cos(angle);
  local.sine = std::sin(angle);
  local.coupling_1 = local.cosine * w(1, 0) + local.sine * w(2, 0);
  local.coupling_2 = -local.sine * w(1, 0) + local.cosine * w(2, 0);
  local.coupling =
      std::sqrt(local.coupling_1 * local.coupling_1 + local.coupling_2 * local.coupling_2);
  return local;
}

Vector3d solve_local(LocalContact& local, const Vector3d& free, double friction) {
  if (free[0] >= 0) return Vector3d::Zero();  // open
  if (friction == 0) return {-free[0] / local.w_nn, 0, 0};
  const double free_1 = local.cosine * free[1] + local.sine * free[2],
               free_2 = -local.sine * free[1] + local.cosine * free[2];
  const double push = free[0] / local.w_nn;
  const SlidingProblem problem{local, free_1 - local.coupling_1 * push,
                               free_2 - local.coupling_2 * push, free[0]};
  SlidingImpulse p = problem.at(0);
  if (!(p.length > friction * p.normal)) {
    local.slide = 0;
  } else {
    const double c = std::sqrt(problem.c1 * problem.c1 + problem.c2 * problem.c2);
    // there |p_t| < mu p_n for certain
    const double high = c * (local.w_nn + friction * local.coupling) / (friction * -free[0]);
    p = slide(problem, friction, high, local.slide);
    const double scale = p.length > 0 ? friction * std::max(p.normal, 0.0) / p.length : 0.0;
    p.t1 *= scale;
    p.t2 *= scale;
  }
  return {std::max(p.normal, 0.0), local.cosine * p.t1 - local.sine * p.t2,
          local.sine * p.t1 + local.cosine * p.t2};
}

}  // namespace tumble::contacts
