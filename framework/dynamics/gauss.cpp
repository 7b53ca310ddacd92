// Source of the transformation: J. C. Butcher, "On the implementation of implicit Runge-Kutta
// methods", BIT 1976: with A = T diag(l) T^-1 the equations of three stages, 3 n of them, become
//   (1 - h l_i J) z_i = r_i                                                                  (G.2)
// of which one is real and two are each other's conjugates.
#include "framework/dynamics/gauss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

namespace tumble {
namespace {

using Complex = std::complex<double>;
using Stages = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // k_1, k_2, k_3

constexpr int kMostNewtonIterations = 12;
// Newton's last change leaves an error of its rate of convergence, some 1e-3, times its own size.
constexpr double kRounding = 1e-14;
// A change that no longer falls is rounding of f, which a fast oscillation multiplies by w h.
constexpr double kStagnates = 1e-9, kSlow = 0.3;
// Changes that do not fall fast enough lead to another root than the one that is continuous in h.
constexpr double kDiverges = 0.5;
constexpr int kMostHalvings = 10;

/// a_ij, b and c of (G.1), and the eigenvectors of A: the real one first, then a pair.
struct Tableau {
  Matrix3d A;
  Vector3d b, c;
  double real;
  Complex pair;
  Eigen::Matrix3cd T, T_inverse;
};

Tableau make_tableau() {
  const double root = std::sqrt(15.0);
  Tableau gauss;
  gauss.A << 5.0 / 36, 2.0 / 9 - root / 15, 5.0 / 36 - root / 30,  //
      5.0 / 36 + root / 24, 2.0 / 9, 5.0 / 36 - root / 24,         //
      5.0 / 36 + root / 30, 2.0 / 9 + root / 15, 5.0 / 36;
  gauss.b << 5.0 / 18, 4.0 / 9, 5.0 / 18;
  gauss.c << 0.5 - root / 10, 0.5, 0.5 + root / 10;
  // The eigenvalues l of A are the roots of l^3 - l^2 / 2 + l / 10 - 1 / 120, one of them real:
  // Newton's method from above every root comes down to it, where the polynomial is convex.
  double l = 0.5;
  for (int i = 0; i < 12; ++i)
    l -= (((l - 0.5) * l + 0.1) * l - 1.0 / 120) / ((3 * l - 1.0) * l + 0.1);
  const double half_sum = 0.5 * (0.5 - l), product = 1.0 / (120 * l);
  gauss.real = l;
  gauss.pair = {half_sum, std::sqrt(product - half_sum * half_sum)};
  // By the theorem of Cayley and Hamilton the factors of the other two leave an eigenvector.
  const std::array<Complex, 3> values = {gauss.real, gauss.pair, std::conj(gauss.pair)};
  const auto minus = [&](std::size_t i) -> Eigen::Matrix3cd {
    return gauss.A.cast<Complex>() - values[i] * Eigen::Matrix3cd::Identity();
  };
  for (std::size_t i = 0; i < 3; ++i)
    gauss.T.col(static_cast<Eigen::Index>(i)) =
        (minus((i + 1) % 3) * minus((i + 2) % 3)).col(0).normalized();
  gauss.T_inverse = gauss.T.inverse();
  return gauss;
}

MatrixXd jacobian(const OdeFunction& f, double t, const VectorXd& y, const VectorXd& slope) {
  const double part = std::sqrt(std::numeric_limits<double>::epsilon());
  MatrixXd J(y.size(), y.size());
  for (Eigen::Index column = 0; column < y.size(); ++column) {
    VectorXd beside = y;
    beside[column] += part * std::max(1.0, std::abs(y[column]));
    J.col(column) = (f(t, beside) - slope) / (beside[column] - y[column]);
  }
  return J;
}

/// The factors of (G.2).
class NewtonMatrix {
 public:
  NewtonMatrix(const Tableau& gauss, double h, const MatrixXd& J)
      : gauss_(gauss),
        real_(MatrixXd::Identity(J.rows(), J.cols()) - h * gauss.real * J),
        pair_(Eigen::MatrixXcd::Identity(J.rows(), J.cols()) - h * gauss.pair * J.cast<Complex>()) {
  }
  /// The change of the stages that takes this residual away.
  Stages solve(const Stages& residual) const {
    const Eigen::Matrix<Complex, Eigen::Dynamic, 3> r = residual * gauss_.T_inverse.transpose();
    Eigen::Matrix<Complex, Eigen::Dynamic, 3> z(r.rows(), 3);
    // the real eigenvector may come with any complex factor
    z.col(0).real() = real_.solve(r.col(0).real());
    z.col(0).imag() = real_.solve(r.col(0).imag());
    z.col(1) = pair_.solve(r.col(1));
    z.col(2) = z.col(1).conjugate();
    return (z * gauss_.T.transpose()).real();
  }

 private:
  const Tableau& gauss_;
  Eigen::PartialPivLU<MatrixXd> real_;
  Eigen::PartialPivLU<Eigen::MatrixXcd> pair_;
};

/// Solves (G.1). @return whether Newton's method has ended
bool find_stages(const Tableau& gauss, const OdeFunction& f, double t, const VectorXd& y, double h,
                 Stages& k) {
  const VectorXd slope = f(t, y);
  if (!slope.allFinite()) return false;
  const MatrixXd J = jacobian(f, t, y, slope);
  if (!J.allFinite()) return false;
  const NewtonMatrix newton(gauss, h, J);
  k = slope.replicate<1, 3>();
  double before = kUnset;
  for (int iteration = 0; iteration < kMostNewtonIterations; ++iteration) {
    Stages residual(y.size(), 3);
    for (int i = 0; i < 3; ++i)
      residual.col(i) = f(t + gauss.c[i] * h, y + h * (k * gauss.A.row(i).transpose())) - k.col(i);
    const Stages change = newton.solve(residual);
    k += change;
    // in parts of y, or of 1 where that is small
    const double size =
        std::abs(h) * (change.rowwise().norm().array() / (1.0 + y.array().abs())).matrix().norm();
    if (!std::isfinite(size)) return false;
    if (size < kRounding) return true;
    if (iteration > 0) {
      const double rate = size / before;
      if (rate * size < kRounding || (size < kStagnates && rate > kSlow)) return true;
      if (rate > kDiverges) return false;
    }
    before = size;
  }
  return false;
}

VectorXd step_in_parts(const Tableau& gauss, const OdeFunction& f, double t, const VectorXd& y,
                       double h, int halvings) {
  Stages k;
  if (find_stages(gauss, f, t, y, h, k)) return y + h * (k * gauss.b);
  if (halvings == kMostHalvings)
    throw std::runtime_error("no step is short enough at t = " + std::to_string(t) +
                             " s: the equations of its stages have no solution that Newton's "
                             "method finds");
  const VectorXd middle = step_in_parts(gauss, f, t, y, 0.5 * h, halvings + 1);
  return step_in_parts(gauss, f, t + 0.5 * h, middle, 0.5 * h, halvings + 1);
}

}  // namespace

VectorXd gauss_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  static const Tableau gauss = make_tableau();
  if (h == 0.0) return y;
  return step_in_parts(gauss, f, t, y, h, 0);
}

}  // namespace tumble
