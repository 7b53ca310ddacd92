/// Eigen's decompositions behind plain functions: their templates take seconds of every file that includes them.
#pragma once

#include "framework/core/math.h"

namespace tumble {

/// Of a symmetric matrix: values in ascending order, vectors of length 1 as columns. Only the lower triangle is read.
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

/// The symmetric root of a symmetric matrix with no negative eigenvalue.
Matrix3d symmetric_root(const Matrix3d& matrix);

/// Of any matrix, by a complete orthogonal decomposition (Golub and Van Loan, section 5.5): rows may depend on each other.
MatrixXd pseudo_inverse(const MatrixXd& matrix);

/// The X of least norm that minimises |A X - B|, (columns of A) x (columns of B).
MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B);

}  // namespace tumble
