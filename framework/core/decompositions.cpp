#include "framework/core/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace tumble {

SymmetricEigen3 symmetric_eigen(const Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen symmetric_eigen(const MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Matrix3d symmetric_root(const Matrix3d& matrix) { return Eigen::SelfAdjointEigenSolver<Matrix3d>(matrix).operatorSqrt(); }

MatrixXd pseudo_inverse(const MatrixXd& matrix) { return matrix.completeOrthogonalDecomposition().pseudoInverse(); }

MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B) { return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(A).solve(B); }

}  // namespace tumble
