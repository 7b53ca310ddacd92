/// What stands precompiled before every submission: Eigen, and the classes of the expressions that
/// most files use, since half of a file's time goes into making them.
///
/// Each expression has a class of its own, and so has each step from it to numbers. Nothing here is
/// called: sizeof asks for the classes, and the precompiled header keeps them. Where a file uses
/// something else, the compiler makes it as ever. Listed is what several of the course's solutions
/// use: a quarter less CPU time for a file of a1 or a3, at 95 MB and, for a file that uses none of
/// it, 0.05 s.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tumble_precompiled {

namespace inside = Eigen::internal;

/// From an expression to a vector or a matrix, or to a block of one.
template <class Expression, class Result = typename Expression::PlainObject>
struct Assigned {
  using To = inside::evaluator<Result>;
  using From = inside::evaluator<Expression>;
  using Set = inside::assign_op<double, double>;
  using Kernel = inside::generic_dense_assignment_kernel<To, From, Set>;
  static constexpr std::size_t size =
      sizeof(inside::evaluator<const Expression>) + sizeof(inside::dense_assignment_loop<Kernel>) +
      sizeof(inside::Assignment<Result, Expression, Set, inside::Dense2Dense>);
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
#define TUMBLE_SETS(result, ...)          \
  TUMBLE_MAKES((result) = (__VA_ARGS__)); \
  static_assert(                          \
      Assigned<std::decay_t<decltype(__VA_ARGS__)>, std::decay_t<decltype(result)>>::size > 0)
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

// What systems of constraints are made of: rows of six numbers within matrices of any size.
struct Systems {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  static const Eigen::Vector3d a, b;
  static const Eigen::Matrix3d A;
  static const Vector6d six, other;
  static const Eigen::MatrixXd M, N;
  static const Eigen::VectorXd x, y;
  static Vector6d row;
  static Eigen::MatrixXd matrix;
  static Eigen::VectorXd vector;
  static const double s;
  static const Eigen::Index i, n;
  TUMBLE_ASSIGNS(Eigen::MatrixXd::Zero(n, n));
  TUMBLE_ASSIGNS(Eigen::VectorXd::Zero(n));
  TUMBLE_MAKES((row << a, b));
  TUMBLE_MAKES((row << a, a.cross(b)));
  TUMBLE_MAKES((row << -a, -a.cross(b)));
  TUMBLE_SETS(row.block(i, i, i, i), a);
  TUMBLE_SETS(row.block(i, i, i, i), -a);
  TUMBLE_SETS((row.block<3, 1>(i, i)), a);
  TUMBLE_SETS((row.block<3, 1>(i, i)), -a);
  TUMBLE_SETS((matrix.block<1, 6>(i, i)), six.transpose());
  TUMBLE_SETS((matrix.block<3, 3>(i, i)), s* Eigen::Matrix3d::Identity());
  TUMBLE_SETS((matrix.block<3, 3>(i, i)), A);
  TUMBLE_SETS((vector.block<6, 1>(i, i)), six);
  TUMBLE_SETS((vector.block<3, 1>(i, i)), a);
  TUMBLE_MAKES(vector.segment<6>(i) = six);
  TUMBLE_MAKES(vector.segment<3>(i) = a);
  TUMBLE_MAKES(Eigen::Vector3d(six.head<3>()));
  TUMBLE_MAKES(Eigen::Vector3d(six.tail<3>()));
  TUMBLE_DOT(six, other);
  TUMBLE_DOT(x, y);
  TUMBLE_MAKES(M.row(i).dot(x));
  TUMBLE_SUMS(M.row(i).transpose().binaryExpr(x, inside::scalar_conj_product_op<double, double>()));
  TUMBLE_ASSIGNS(x - y);
  TUMBLE_ASSIGNS(x + y);
  TUMBLE_ASSIGNS(-x);
  TUMBLE_ASSIGNS(M* N.transpose());
  TUMBLE_ASSIGNS(M* x);
  TUMBLE_ASSIGNS(-M.transpose() * x);
  TUMBLE_ASSIGNS(x - M * y);
  TUMBLE_MAKES(M.lu().solve(x));
  TUMBLE_MAKES(M.ldlt().solve(x));
  TUMBLE_MAKES(M.llt().solve(x));
  TUMBLE_MAKES(M.lu().solve(x - M * y));
  TUMBLE_MAKES(Eigen::VectorXd(M.lu().solve(x)));
  TUMBLE_MAKES(Eigen::VectorXd(M.lu().solve(x - M * y)));
};

template struct Vectors<Eigen::Vector2d>;
template struct Vectors<Eigen::Vector3d>;

#undef TUMBLE_MAKES
#undef TUMBLE_ASSIGNS
#undef TUMBLE_SUMS
#undef TUMBLE_SETS
#undef TUMBLE_DOT
#undef TUMBLE_NORM

}  // namespace tumble_precompiled

// What multiplies, factors and solves dense matrices of any size: 1 to 6 s of a file that solves a
// system. It is compiled once, from this file with `template` for one of the words below, and a
// file that uses some of it is linked with the results, libkernels.a. Inline functions are compiled
// with the file as ever, unless they are specialised here. Left out is BDCSVD: 20 s.
#if !defined(TUMBLE_NO_KERNELS) && EIGEN_VERSION_AT_LEAST(3, 4, 0) && \
    !EIGEN_VERSION_AT_LEAST(3, 4, 90)
#ifdef TUMBLE_PRODUCTS
#define TUMBLE_COMPILED_ONCE(...) __VA_ARGS__
#else
#define TUMBLE_COMPILED_ONCE(...) ;
#define TUMBLE_PRODUCTS extern template
#endif
#ifndef TUMBLE_FACTORS
#define TUMBLE_FACTORS extern template
#endif
#ifndef TUMBLE_ORTHOGONAL
#define TUMBLE_ORTHOGONAL extern template
#endif
#ifndef TUMBLE_SPECTRA
#define TUMBLE_SPECTRA extern template
#endif
#ifdef TUMBLE_SPARSE
#define TUMBLE_SPARSE_COMPILED_ONCE(...) __VA_ARGS__
#else
#define TUMBLE_SPARSE_COMPILED_ONCE(...) ;
#define TUMBLE_SPARSE extern template
#endif
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of a packet of two doubles
namespace Eigen {
namespace internal {

using TumbleResult = blas_data_mapper<double, Index, ColMajor>;
using TumbleColumns = const_blas_data_mapper<double, Index, ColMajor>;
using TumbleRows = const_blas_data_mapper<double, Index, RowMajor>;

// A B and A B^T
TUMBLE_PRODUCTS struct gebp_kernel<double, double, Index, TumbleResult, 4, 4>;
TUMBLE_PRODUCTS struct gemm_pack_lhs<double, Index, TumbleColumns, 4, 2, Packet2d, ColMajor>;
TUMBLE_PRODUCTS struct gemm_pack_rhs<double, Index, TumbleColumns, 4, ColMajor>;
TUMBLE_PRODUCTS struct gemm_pack_rhs<double, Index, TumbleRows, 4, RowMajor>;
TUMBLE_PRODUCTS struct general_matrix_matrix_product<Index, double, ColMajor, false, double,
                                                     ColMajor, false, ColMajor, 1>;
TUMBLE_PRODUCTS struct general_matrix_matrix_product<Index, double, ColMajor, false, double,
                                                     RowMajor, false, ColMajor, 1>;
// A x and A^T x
TUMBLE_PRODUCTS struct general_matrix_vector_product<Index, double, TumbleColumns, ColMajor, false,
                                                     double, TumbleColumns, false>;
TUMBLE_PRODUCTS struct general_matrix_vector_product<Index, double, TumbleColumns, ColMajor, false,
                                                     double, TumbleRows, false>;
TUMBLE_PRODUCTS struct general_matrix_vector_product<Index, double, TumbleRows, RowMajor, false,
                                                     double, TumbleColumns, false>;
// L x = b and U x = b
TUMBLE_PRODUCTS struct triangular_solve_vector<double, double, Index, OnTheLeft, Upper, false,
                                               ColMajor>;
TUMBLE_PRODUCTS struct triangular_solve_vector<double, double, Index, OnTheLeft, Lower, false,
                                               ColMajor>;
TUMBLE_PRODUCTS struct triangular_solve_vector<double, double, Index, OnTheLeft, UnitLower, false,
                                               ColMajor>;

// The products themselves, in the steps of Eigen 3.4.
using TumbleProduct = Product<MatrixXd, MatrixXd>;
using TumbleScaled = Product<MatrixXd, DiagonalWrapper<const VectorXd>, LazyProduct>;
using TumbleTransposed = Transpose<MatrixXd>;
using TumbleConstTransposed = Transpose<const MatrixXd>;
using TumbleMinus = CwiseUnaryOp<scalar_opposite_op<double>, const MatrixXd>;
using TumbleMinusTransposed = CwiseUnaryOp<scalar_opposite_op<double>, const TumbleTransposed>;
using TumbleMinusConstTransposed =
    CwiseUnaryOp<scalar_opposite_op<double>, const TumbleConstTransposed>;

#define TUMBLE_MULTIPLIES(First, Second)                                                       \
  template <>                                                                                  \
  template <>                                                                                  \
  void generic_product_impl<First, Second, DenseShape, DenseShape, GemmProduct>::evalTo(       \
      MatrixXd& to, const First& A, const Second& B) TUMBLE_COMPILED_ONCE({                    \
    if (B.rows() + to.rows() + to.cols() < EIGEN_GEMM_TO_COEFFBASED_THRESHOLD && B.rows() > 0) \
      return lazyproduct::eval_dynamic(to, A, B, assign_op<double, double>());                 \
    to.setZero();                                                                              \
    scaleAndAddTo(to, A, B, 1.0);                                                              \
  })
TUMBLE_MULTIPLIES(MatrixXd, MatrixXd)
TUMBLE_MULTIPLIES(MatrixXd, TumbleTransposed)
TUMBLE_MULTIPLIES(MatrixXd, TumbleConstTransposed)
TUMBLE_MULTIPLIES(TumbleTransposed, MatrixXd)
TUMBLE_MULTIPLIES(TumbleConstTransposed, MatrixXd)
TUMBLE_MULTIPLIES(TumbleProduct, TumbleTransposed)
TUMBLE_MULTIPLIES(TumbleProduct, TumbleConstTransposed)
TUMBLE_MULTIPLIES(TumbleScaled, TumbleTransposed)
TUMBLE_MULTIPLIES(TumbleScaled, TumbleConstTransposed)
#undef TUMBLE_MULTIPLIES

#define TUMBLE_MULTIPLIES(First)                                                                  \
  template <>                                                                                     \
  template <>                                                                                     \
  void generic_product_impl<First, VectorXd, DenseShape, DenseShape, GemvProduct>::scaleAndAddTo( \
      VectorXd& to, const First& A, const VectorXd& x, const double& s) TUMBLE_COMPILED_ONCE({    \
    if (A.rows() == 1) {                                                                          \
      to(0) += s * A.row(0).dot(x);                                                               \
      return;                                                                                     \
    }                                                                                             \
    LhsNested factor(A);                                                                          \
    constexpr int order = int(MatrixType::Flags) & RowMajorBit ? RowMajor : ColMajor;             \
    gemv_dense_selector<OnTheRight, order,                                                        \
                        bool(blas_traits<MatrixType>::HasUsableDirectAccess)>::run(factor, x, to, \
                                                                                   s);            \
  })
TUMBLE_MULTIPLIES(MatrixXd)
TUMBLE_MULTIPLIES(TumbleTransposed)
TUMBLE_MULTIPLIES(TumbleConstTransposed)
TUMBLE_MULTIPLIES(TumbleMinus)
TUMBLE_MULTIPLIES(TumbleMinusTransposed)
TUMBLE_MULTIPLIES(TumbleMinusConstTransposed)
#undef TUMBLE_MULTIPLIES

}  // namespace internal

// What is solved for an expression is solved for its vector.
namespace internal {
template <class Solver, class Expression>
requires(Expression::ColsAtCompileTime == 1 &&
         !std::is_same_v<Expression,
                         VectorXd>) struct Assignment<VectorXd, Solve<Solver, Expression>,
                                                      assign_op<double, double>, Dense2Dense> {
  static void run(VectorXd& to, const Solve<Solver, Expression>& solved,
                  const assign_op<double, double>&) {
    const VectorXd b = solved.rhs();
    to.resize(solved.rows());
    solved.dec()._solve_impl(b, to);
  }
};

// So is what such a solution is multiplied by: A factors.solve(b).
template <class Left, class Solver, class Expression>
requires(Expression::ColsAtCompileTime ==
         1) struct generic_product_impl<Left, Solve<Solver, Expression>, DenseShape, DenseShape,
                                        GemvProduct>
    : generic_product_impl_base<Left, Solve<Solver, Expression>,
                                generic_product_impl<Left, Solve<Solver, Expression>, DenseShape,
                                                     DenseShape, GemvProduct>> {
  template <class Result>
  static void scaleAndAddTo(Result& to, const Left& A, const Solve<Solver, Expression>& solved,
                            const typename Expression::Scalar& s) {
    const typename Solve<Solver, Expression>::PlainObject x(solved);
    generic_product_impl<Left, typename Solve<Solver, Expression>::PlainObject, DenseShape,
                         DenseShape, GemvProduct>::scaleAndAddTo(to, A, x, s);
  }
};
}  // namespace internal

// Factorisations. What is a template inside of a class is named for matrices and vectors.
TUMBLE_FACTORS class PartialPivLU<MatrixXd>;
TUMBLE_FACTORS class FullPivLU<MatrixXd>;
TUMBLE_FACTORS class LDLT<MatrixXd>;
TUMBLE_FACTORS class LLT<MatrixXd>;
TUMBLE_FACTORS PartialPivLU<MatrixXd>::PartialPivLU(const EigenBase<MatrixXd>&);
TUMBLE_FACTORS FullPivLU<MatrixXd>::FullPivLU(const EigenBase<MatrixXd>&);
TUMBLE_FACTORS LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
TUMBLE_FACTORS LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
TUMBLE_FACTORS void FullPivLU<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
TUMBLE_FACTORS void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
TUMBLE_FACTORS void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

template <>
template <>
void PartialPivLU<MatrixXd>::_solve_impl(const VectorXd& b,
                                         VectorXd& x) const TUMBLE_COMPILED_ONCE({
  x = permutationP() * b;
  m_lu.triangularView<UnitLower>().solveInPlace(x);
  m_lu.triangularView<Upper>().solveInPlace(x);
})

    template <>
    void internal::compute_inverse<MatrixXd, MatrixXd>::run(const MatrixXd& A, MatrixXd& inverse)
        TUMBLE_COMPILED_ONCE({ inverse = A.partialPivLu().inverse(); })

            TUMBLE_ORTHOGONAL class HouseholderQR<MatrixXd>;
TUMBLE_ORTHOGONAL class ColPivHouseholderQR<MatrixXd>;
TUMBLE_ORTHOGONAL class CompleteOrthogonalDecomposition<MatrixXd>;
TUMBLE_ORTHOGONAL ColPivHouseholderQR<MatrixXd>& ColPivHouseholderQR<MatrixXd>::compute(
    const EigenBase<MatrixXd>&);
TUMBLE_ORTHOGONAL void HouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
TUMBLE_ORTHOGONAL void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
TUMBLE_ORTHOGONAL void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&,
                                                                              VectorXd&) const;

TUMBLE_SPECTRA class JacobiSVD<MatrixXd>;
TUMBLE_SPECTRA class SelfAdjointEigenSolver<MatrixXd>;
TUMBLE_SPECTRA SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
TUMBLE_SPECTRA void SVDBase<JacobiSVD<MatrixXd>>::_solve_impl(const VectorXd&, VectorXd&) const;

// Sparse factors, with the ordering that each has where nothing is said. A solution is written
// where its vector lies: an expression that it is a part of (x += factors.solve(b)) points there.
using TumbleSparse = SparseMatrix<double>;
using TumbleEntries = std::vector<Triplet<double>>::iterator;
TUMBLE_SPARSE class SparseMatrix<double>;
TUMBLE_SPARSE class SparseMatrix<double, RowMajor>;
TUMBLE_SPARSE void TumbleSparse::setFromTriplets(const TumbleEntries&, const TumbleEntries&);
#define TUMBLE_FACTORISES(Factors, is_ldlt)                                                 \
  TUMBLE_SPARSE void SimplicialCholeskyBase<Factors>::ordering(                             \
      const TumbleSparse&, const TumbleSparse*&, TumbleSparse&);                            \
  TUMBLE_SPARSE void SimplicialCholeskyBase<Factors>::analyzePattern_preordered(            \
      const TumbleSparse&, bool);                                                           \
  TUMBLE_SPARSE void SimplicialCholeskyBase<Factors>::factorize_preordered<is_ldlt>(        \
      const TumbleSparse&);                                                                 \
  template <>                                                                               \
  template <>                                                                               \
  void SimplicialCholeskyBase<Factors>::factorize<is_ldlt>(const TumbleSparse& matrix)      \
      TUMBLE_SPARSE_COMPILED_ONCE({                                                         \
        TumbleSparse permuted(matrix.cols(), matrix.cols());                                \
        permuted.selfadjointView<Upper>() = matrix.selfadjointView<Lower>().twistedBy(m_P); \
        factorize_preordered<is_ldlt>(permuted);                                            \
      }) template <>                                                                        \
      template <>                                                                           \
      void SimplicialCholeskyBase<Factors>::_solve_impl(const MatrixBase<VectorXd>& b,      \
                                                        MatrixBase<VectorXd>& x)            \
          const TUMBLE_SPARSE_COMPILED_ONCE({                                               \
            if (m_info != Success) return;                                                  \
            VectorXd& solved = x.derived();                                                 \
            if (m_P.size() > 0)                                                             \
              solved = m_P * b.derived();                                                   \
            else                                                                            \
              solved = b.derived();                                                         \
            if (m_matrix.nonZeros() > 0) derived().matrixL().solveInPlace(solved);          \
            if (m_diag.size() > 0) solved = m_diag.asDiagonal().inverse() * solved;         \
            if (m_matrix.nonZeros() > 0) derived().matrixU().solveInPlace(solved);          \
            if (m_P.size() > 0) solved = m_Pinv * solved;                                   \
          })
TUMBLE_FACTORISES(SimplicialLDLT<TumbleSparse>, true)
TUMBLE_FACTORISES(SimplicialLLT<TumbleSparse>, false)
#undef TUMBLE_FACTORISES

}  // namespace Eigen
#pragma GCC diagnostic pop
#undef TUMBLE_PRODUCTS
#undef TUMBLE_FACTORS
#undef TUMBLE_ORTHOGONAL
#undef TUMBLE_SPECTRA
#undef TUMBLE_SPARSE
#undef TUMBLE_COMPILED_ONCE
#undef TUMBLE_SPARSE_COMPILED_ONCE
#endif
