#include "framework/core/decompositions.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace tumble {

SymmetricEigen3 symmetric_eigen(const Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen symmetric_eigen(const MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Matrix3d symmetric_root(const Matrix3d& matrix) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(matrix).operatorSqrt();
}

std::vector<char> spanning_rows(MatrixXd G, double threshold) {
  std::vector<char> chosen(static_cast<std::size_t>(G.rows()), 0);
  VectorXd left = G.diagonal();
  for (Eigen::Index k = 0; k < G.rows(); ++k) {
    Eigen::Index pivot = 0;
    if (!(left.maxCoeff(&pivot) > threshold)) break;
    chosen[static_cast<std::size_t>(pivot)] = 1;
    const VectorXd column = G.col(pivot) / std::sqrt(left[pivot]);
    G.noalias() -= column * column.transpose();
    for (Eigen::Index i = 0; i < G.rows(); ++i)
      left[i] = chosen[static_cast<std::size_t>(i)] != 0 ? 0.0 : G(i, i);
  }
  return chosen;
}

VectorXd tridiagonal_eigenvalues(const VectorXd& diagonal, const VectorXd& beside) {
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

}  // namespace tumble
