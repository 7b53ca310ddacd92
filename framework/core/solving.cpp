#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "framework/core/decompositions.h"

namespace tumble {

MatrixXd pseudo_inverse(const MatrixXd& matrix) {
  return matrix.completeOrthogonalDecomposition().pseudoInverse();
}

MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B, std::optional<double> threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  if (threshold) decomposition.setThreshold(*threshold);
  decomposition.compute(A);
  return decomposition.solve(B);
}

VectorXd solve_symmetric(const MatrixXd& A, const VectorXd& b) { return A.ldlt().solve(b); }

}  // namespace tumble
