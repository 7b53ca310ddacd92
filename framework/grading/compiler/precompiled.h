/// What stands precompiled before every submission: Eigen, and the classes of the expressions that
/// most files use, since half of a file's time goes into making them.
///
/// Each expression has a class of its own, and so has each step from it to numbers. Nothing here is
/// called: sizeof asks for the classes, and the precompiled header keeps them. Where a file uses
/// something else, the compiler makes it as ever. Listed is what several of the course's solutions
/// use: a quarter less CPU time for a file of a1, at 65 MB and, for a file that uses none of it,
/// 0.03 s.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tumble_precompiled {

namespace inside = Eigen::internal;

/// From an expression to a vector or a matrix.
template <class Expression>
struct Assigned {
  using To = inside::evaluator<typename Expression::PlainObject>;
  using From = inside::evaluator<Expression>;
  using Set = inside::assign_op<double, double>;
  using Kernel = inside::generic_dense_assignment_kernel<To, From, Set>;
  static constexpr std::size_t size =
      sizeof(inside::evaluator<const Expression>) + sizeof(inside::dense_assignment_loop<Kernel>) +
      sizeof(inside::Assignment<typename Expression::PlainObject, Expression, Set,
                                inside::Dense2Dense>);
};

/// From an expression to the sum of its numbers.
template <class Expression>
struct Summed {
  using Terms = inside::redux_evaluator<Expression>;
  using Sum = inside::scalar_sum_op<double, double>;
  static constexpr std::size_t size = sizeof(inside::redux_impl<Sum, Terms>);
};

#define TUMBLE_MAKES(...) static_assert(sizeof(__VA_ARGS__) > 0)
#define TUMBLE_ASSIGNS(...) static_assert(Assigned<std::decay_t<decltype(__VA_ARGS__)>>::size > 0)
#define TUMBLE_SUMS(...) static_assert(Summed<std::decay_t<decltype(__VA_ARGS__)>>::size > 0)
#define TUMBLE_DOT(a, b)    \
  TUMBLE_MAKES((a).dot(b)); \
  TUMBLE_SUMS((a).binaryExpr(b, inside::scalar_conj_product_op<double, double>()))
#define TUMBLE_NORM(a)      \
  TUMBLE_MAKES((a).norm()); \
  TUMBLE_SUMS((a).cwiseAbs2())

template <class Vector>
struct Vectors {
  static const Vector a, b, c;
  static Vector result;
  static const double s;
  TUMBLE_ASSIGNS(Vector::Constant(s));
  TUMBLE_ASSIGNS(a + b);
  TUMBLE_ASSIGNS(a - b);
  TUMBLE_ASSIGNS(-a);
  TUMBLE_ASSIGNS(s* a);
  TUMBLE_ASSIGNS(a / s);
  TUMBLE_ASSIGNS(a + s * b);
  TUMBLE_MAKES(result << s);
  TUMBLE_MAKES(result = a + b);
  TUMBLE_MAKES(Vector(a + b));
  TUMBLE_MAKES(Vector(a - b));
  TUMBLE_MAKES(Vector(s* a));
  TUMBLE_MAKES(a.normalized());
  TUMBLE_DOT(a, b);
  TUMBLE_NORM(a);
  TUMBLE_ASSIGNS(a* s);
  TUMBLE_ASSIGNS(a - s * b);
  TUMBLE_ASSIGNS((a - b) / s);
  TUMBLE_MAKES((result << s, s));
  TUMBLE_MAKES(result += s * a);
  TUMBLE_MAKES((a - b).normalized());
  TUMBLE_DOT(a, b - c);
  TUMBLE_DOT(a - b, c);
  TUMBLE_NORM(a - b);
};

struct Space {
  static const Eigen::Vector3d a, b, c, d;
  static const Eigen::Matrix3d A, B;
  static Eigen::Matrix3d result;
  static const Eigen::Quaterniond q, p;
  static const double s;
  TUMBLE_MAKES(a.cross(b));
  TUMBLE_MAKES((a - b).cross(c));
  TUMBLE_MAKES((a - b).cross(c - d));
  TUMBLE_MAKES(a.cross(b - c));
  TUMBLE_ASSIGNS(a + b.cross(c));
  TUMBLE_ASSIGNS(A* a);
  TUMBLE_ASSIGNS(A.lazyProduct(a));
  TUMBLE_SUMS(A.row(0).transpose().cwiseProduct(a.col(0)));
  TUMBLE_ASSIGNS(a + A * b);
  TUMBLE_ASSIGNS(A* B);
  TUMBLE_ASSIGNS(A.lazyProduct(B));
  TUMBLE_SUMS(A.row(0).transpose().cwiseProduct(B.col(0)));
  TUMBLE_ASSIGNS(A.transpose());
  TUMBLE_ASSIGNS(s* A);
  TUMBLE_ASSIGNS(Eigen::Matrix3d::Constant(s));
  TUMBLE_ASSIGNS(Eigen::Matrix3d::Identity());
  TUMBLE_MAKES(Eigen::Vector3d(A* a));
  TUMBLE_MAKES((result << s, s));
  TUMBLE_MAKES(q* a);
  TUMBLE_MAKES(q* p);
  TUMBLE_MAKES(q.conjugate() * a);
  TUMBLE_MAKES(q.inverse() * a);
  TUMBLE_MAKES(q.vec().cross(a));
  TUMBLE_ASSIGNS(a + s * b + c);
  TUMBLE_ASSIGNS(q.toRotationMatrix() * a);
  TUMBLE_MAKES(q.normalized());
};

template struct Vectors<Eigen::Vector2d>;
template struct Vectors<Eigen::Vector3d>;

#undef TUMBLE_MAKES
#undef TUMBLE_ASSIGNS
#undef TUMBLE_SUMS
#undef TUMBLE_DOT
#undef TUMBLE_NORM

}  // namespace tumble_precompiled

// What multiplies, factors and solves dense matrices of any size: 2 s of a file that solves a
// system. It is compiled once, from this file with `template` for TUMBLE_KERNEL, and a file that
// uses some of it is linked with the result, libkernels.a. Inline functions are compiled with the
// file as ever.
#ifndef TUMBLE_NO_KERNELS
#ifndef TUMBLE_KERNEL
#define TUMBLE_KERNEL extern template
#endif
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of a packet of two doubles
namespace Eigen {

TUMBLE_KERNEL class PartialPivLU<MatrixXd>;
TUMBLE_KERNEL class LDLT<MatrixXd>;
TUMBLE_KERNEL class LLT<MatrixXd>;

namespace internal {

using TumbleResult = blas_data_mapper<double, Index, ColMajor>;
using TumbleColumns = const_blas_data_mapper<double, Index, ColMajor>;
using TumbleRows = const_blas_data_mapper<double, Index, RowMajor>;

// A B and A B^T
TUMBLE_KERNEL struct gebp_kernel<double, double, Index, TumbleResult, 4, 4>;
TUMBLE_KERNEL struct gemm_pack_lhs<double, Index, TumbleColumns, 4, 2, Packet2d, ColMajor>;
TUMBLE_KERNEL struct gemm_pack_rhs<double, Index, TumbleColumns, 4, ColMajor>;
TUMBLE_KERNEL struct gemm_pack_rhs<double, Index, TumbleRows, 4, RowMajor>;
TUMBLE_KERNEL struct general_matrix_matrix_product<Index, double, ColMajor, false, double, ColMajor,
                                                   false, ColMajor, 1>;
TUMBLE_KERNEL struct general_matrix_matrix_product<Index, double, ColMajor, false, double, RowMajor,
                                                   false, ColMajor, 1>;
// A x and A^T x
TUMBLE_KERNEL struct general_matrix_vector_product<Index, double, TumbleColumns, ColMajor, false,
                                                   double, TumbleColumns, false>;
TUMBLE_KERNEL struct general_matrix_vector_product<Index, double, TumbleColumns, ColMajor, false,
                                                   double, TumbleRows, false>;
TUMBLE_KERNEL struct general_matrix_vector_product<Index, double, TumbleRows, RowMajor, false,
                                                   double, TumbleColumns, false>;
// L x = b and U x = b
TUMBLE_KERNEL struct triangular_solve_vector<double, double, Index, OnTheLeft, Upper, false,
                                             ColMajor>;
TUMBLE_KERNEL struct triangular_solve_vector<double, double, Index, OnTheLeft, Lower, false,
                                             ColMajor>;
TUMBLE_KERNEL struct triangular_solve_vector<double, double, Index, OnTheLeft, UnitLower, false,
                                             ColMajor>;

}  // namespace internal
}  // namespace Eigen
#pragma GCC diagnostic pop
#undef TUMBLE_KERNEL
#endif
