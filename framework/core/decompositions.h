/// Eigen's decompositions behind plain functions: including the templates costs every file seconds
/// of compile time.
#pragma once

#include <optional>

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
/// @param threshold  what is smaller, relative to the largest pivot, counts as zero; nothing:
///                   round-off of A's size
MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B, std::optional<double> threshold = {});

/// The x with A x = b of a symmetric matrix, by L D L^T. Only the lower triangle is read.
VectorXd solve_symmetric(const MatrixXd& A, const VectorXd& b);

/// The eigenvalues, ascending, of the symmetric matrix (n,n) with this diagonal (n) and these
/// numbers (n-1) beside it. Cost: O(n^2)
VectorXd tridiagonal_eigenvalues(const VectorXd& diagonal, const VectorXd& beside);

}  // namespace tumble
