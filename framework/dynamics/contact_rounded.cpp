// Coulomb's law with rounded edges, made sharp step by step (contact_newton.h).
//
// In coordinates x = (mu p_n, p_t), w = (v_n / mu + |v_t|, v_t), the second with De Saxce's shift,
// the law says that x and w lie in the cone |x_t| <= x_n and x . w = 0, or
//   x = P(x - w / r),   P the projection on the cone                                       (C.8)
// P acts on the two eigenvalues l = z_n +- |z_t| of its argument as max(0, l). Rounded, it is
//   g(l) = (l + sqrt(l^2 + 4 s^2)) / 2,   s = tau / r,   and |v_t| is sqrt(v_t^2 + tau^2)  (C.9)
// smooth, and strictly between open, stick and slide everywhere: Newton's method is told by all
// contacts at once how they would answer, also by those whose mode is about to change. tau falls as
// fast as it can follow.
// Sources: M. Fukushima, Z.-Q. Luo, P. Tseng, SIAM J. Optim. 12, 2002 (smoothing of second-order
// cones); V. Acary, M. Bremond, O. Huber, in "Advanced Topics in Nonsmooth Dynamics", 2018.
#include <algorithm>
#include <cmath>

#include "framework/core/numbers.h"
#include "framework/dynamics/contact_cone.h"
#include "framework/dynamics/contact_equations.h"
#include "framework/dynamics/contact_newton.h"

namespace tumble::contacts {
namespace {

/// g of (C.9), without cancellation, and its derivative.
struct Rounded {
  double value, slope;
};

Rounded rounded(double l, double s) {
  const double root = std::sqrt(l * l + 4 * s * s),
               value = l >= 0 ? 0.5 * (l + root) : 2 * s * s / (root - l);
  return {value, value / root};
}

/// What (C.8) lacks at one contact, x - P, and what P is made of there.
struct RoundedLaw {
  Vector3d lack = Vector3d::Zero();
  Rounded high{}, low{};               // of both eigenvalues; without friction only the first
  double length = 0, normal = 0;       // |z_t|, z_n
  Vector2d along = Vector2d::UnitX();  // z_t / |z_t|
  double slip = 0;                     // the rounded |v_t| [m/s]
};

RoundedLaw rounded_law(const ContactBlock& c, const Vector3d& p, const Vector3d& v, double tau) {
  const double r = c.inverse_effective_mass, s = tau / r;
  RoundedLaw law;
  if (!c.is_frictional()) {
    law.high = rounded(p[0] - v[0] / r, s);
    law.lack[0] = p[0] - law.high.value;
    return law;
  }
  law.slip = std::sqrt(v.tail<2>().squaredNorm() + tau * tau);
  const Vector3d x(c.friction * p[0], p[1], p[2]), w(v[0] / c.friction + law.slip, v[1], v[2]),
      z = x - w / r;
  law.normal = z[0];
  law.length = z.tail<2>().norm();
  if (law.length > 0) law.along = z.tail<2>() / law.length;
  law.high = rounded(z[0] + law.length, s);
  law.low = rounded(z[0] - law.length, s);
  law.lack = x;
  law.lack[0] -= 0.5 * (law.high.value + law.low.value);
  law.lack.tail<2>() -= 0.5 * (law.high.value - law.low.value) * law.along;
  return law;
}

/// P' of a contact with friction.
Matrix3d slope_of(const RoundedLaw& law) {
  const double even = 0.5 * (law.high.slope + law.low.slope),
               odd = 0.5 * (law.high.slope - law.low.slope),
               across = law.length > kEpsilon * std::abs(law.normal)
                            ? (law.high.value - law.low.value) / (2 * law.length)
                            : even;
  const Vector2d& t = law.along;
  Matrix3d slope;
  slope(0, 0) = even;
  slope.block<1, 2>(0, 1) = odd * t.transpose();
  slope.block<2, 1>(1, 0) = odd * t;
  slope.block<2, 2>(1, 1) =
      even * t * t.transpose() + across * (Eigen::Matrix2d::Identity() - t * t.transpose());
  return slope;
}

/// Linearised (C.8):  (I - (1 - fade) P') dx = -(x - P) - P' dw / r.
Response rounded_response(const ContactBlock& c, const Vector3d& p, const Vector3d& v, double tau,
                          double fade) {
  const double r = c.inverse_effective_mass;
  const RoundedLaw law = rounded_law(c, p, v, tau);
  Response response{Vector3d::Zero(), Matrix3d::Zero()};
  if (!c.is_frictional()) {
    const double inverse = 1 / (1 - (1 - fade) * law.high.slope);
    response.f[0] = -inverse * law.lack[0];
    response.d(0, 0) = inverse * law.high.slope / r;
    return response;
  }
  Matrix3d w_of_v = Matrix3d::Identity();
  w_of_v(0, 0) = 1 / c.friction;
  w_of_v.block<1, 2>(0, 1) = v.tail<2>().transpose() / law.slip;
  const Matrix3d slope = slope_of(law),
                 inverse = (Matrix3d::Identity() - (1 - fade) * slope).inverse();
  response.f = -inverse * law.lack;
  response.d = inverse * slope * w_of_v / r;
  response.f[0] /= c.friction;
  response.d.row(0) /= c.friction;
  return response;
}

/// Mean square of what (C.8) lacks, as a velocity. [m^2/s^2]
double mean_square(const System& system, const Impulses& at, double tau) {
  double sum = 0;
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const ContactBlock& c = system.contacts[i];
    if (!(c.inverse_effective_mass > 0)) continue;
    const Vector3d lack = rounded_law(c, at.contacts[i], contact_velocity(c, at.y), tau).lack;
    sum += c.inverse_effective_mass * c.inverse_effective_mass * lack.squaredNorm();
  }
  for (const RowBlock& row : system.rows)
    if (row.inverse_effective_mass > 0) {
      const double v = row_velocity(row, at.y);
      sum += v * v;
    }
  return sum / static_cast<double>(system.contacts.size() + system.rows.size());
}

std::vector<Response> rounded_responses(const System& system, const Impulses& now, double tau,
                                        double fade) {
  std::vector<Response> responses(system.contacts.size(),
                                  Response{Vector3d::Zero(), Matrix3d::Zero()});
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const ContactBlock& c = system.contacts[i];
    if (c.inverse_effective_mass > 0)
      responses[i] = rounded_response(c, now.contacts[i], contact_velocity(c, now.y), tau, fade);
  }
  return responses;
}

Impulses ahead(const System& system, const Impulses& now, double share, const Impulses& change) {
  Impulses next = now;
  for (std::size_t i = 0; i < next.contacts.size(); ++i)
    next.contacts[i] += share * change.contacts[i];
  for (std::size_t i = 0; i < next.rows.size(); ++i) next.rows[i] += share * change.rows[i];
  sum_impulses(system, next);
  return next;
}

/// What is reached, measured by the sharp law; `progress` keeps the best.
void keep_best(const Goal& goal, const Impulses& now, Progress& progress) {
  Progress here = progress;
  here.impulses = now;
  for (std::size_t i = 0; i < now.contacts.size(); ++i)
    here.impulses.contacts[i] =
        coulomb_projection(now.contacts[i], goal.system.contacts[i].friction);
  sum_impulses(goal.system, here.impulses);
  goal.measure(here);
  if (here.accepted || here.violation.squares < progress.violation.squares)
    progress = std::move(here);
}

}  // namespace

void sharpen(const Goal& goal, const Sharpening& pace, BodyMatrix& matrix, Progress& progress) {
  // delta, as in `finish`: the more a step had to be shortened, the more it is held to where it is,
  // because contacts that share a load in many ways would be sent far for what is next to nothing
  constexpr double kFirstFade = 1e-6, kLeastFade = 1e-11, kMostFade = 1e-3;
  constexpr double kShort = 0.3, kShortest = 1e-3;  // shares of a step
  // of the mean square: a full step that leaves more may owe it to the fade
  constexpr double kSlow = 1e-2;
  constexpr int kMostFailures = 6;
  constexpr double kSharp = 1e-9;  // of the problem's speed: nothing is left to round
  const System& system = goal.system;
  const double speed = system.speed > 0 ? system.speed : 1.0;
  double tau = pace.first * speed, fade = kFirstFade;
  Impulses now = progress.impulses, change;
  StepEquations equations;
  for (int i = 0, failures = 0; i < pace.most_steps && tau > kSharp * speed; ++i) {
    const double before = mean_square(system, now, tau);
    if (!equations.prepare(system, fade, matrix, now, rounded_responses(system, now, tau, fade)))
      return;
    ++progress.factorisations;
    const bool solved = equations.solve(matrix, std::sqrt(before), change);
    // as far along the step as it helps
    double share = 1;
    Impulses next = ahead(system, now, share, change);
    double after = mean_square(system, next, tau);
    while (share > kShortest && !(after < (1 - 0.1 * share) * before)) {
      share *= 0.5;
      next = ahead(system, now, share, change);
      after = mean_square(system, next, tau);
    }
    if (share < kShort || !solved) {
      fade = std::min(kMostFade, 10 * fade);
    } else if (share == 1 && after > kSlow * before) {
      fade = std::max(kLeastFade, 0.1 * fade);
    }
    if (!(share > kShortest)) {  // a fold of the path: rounder again
      if (++failures > kMostFailures) return;
      if (solved) tau *= 3;
      continue;
    }
    now = std::move(next);
    keep_best(goal, now, progress);
    if (progress.accepted) return;
    if (after <= tau * tau) tau *= pace.down;
  }
}

}  // namespace tumble::contacts
