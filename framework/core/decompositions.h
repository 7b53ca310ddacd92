/// Eigen's decompositions behind plain functions: including the templates costs every file seconds
/// of compile time.
#pragma once

#include "framework/core/math.h"

namespace tumble {

/// Eigendecomposition of a symmetric matrix: values in ascending order, unit eigenvectors as
/// columns. Only the lower triangle is read.
struct SymmetricEigen3 {
  Vector3d values;
  Matrix3d vectors;
};
SymmetricEigen3 symmetric_eigen(const Matrix3d& matrix);

struct SymmetricEigen {
  VectorXd values;
  MatrixXd vectors;
};
/// Cost: O(n^3)
SymmetricEigen symmetric_eigen(const MatrixXd& matrix);

/// The symmetric square root of a symmetric matrix without negative eigenvalues.
Matrix3d symmetric_root(const Matrix3d& matrix);

/// Moore-Penrose inverse of any matrix, rank-deficient ones too, by a complete orthogonal
/// decomposition (Golub and Van Loan, section 5.5).
MatrixXd pseudo_inverse(const MatrixXd& matrix);

/// The X of least norm that minimises |A X - B|, (columns of A) x (columns of B).
MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B);

}  // namespace tumble
