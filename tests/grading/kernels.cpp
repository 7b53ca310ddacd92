// What a submission's dense and sparse algebra gives, number by number: compiled twice, with the
// parts of Eigen that are compiled once for all submissions (grading/compiler/precompiled.h), and
// with Eigen's own. Prints what differs by nothing, so that the outputs are compared as bytes.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <cstdio>
#include <vector>

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

using Sparse = Eigen::SparseMatrix<double>;

double next_number() {  // in [-1, 1), the same on every machine
  static unsigned long long state = 1;
  state = state * 6364136223846793005ULL + 1442695040888963407ULL;
  return static_cast<double>(state >> 11) * 0x1p-52 - 1;
}

MatrixXd some(Index rows, Index columns) {
  MatrixXd m(rows, columns);
  for (double& x : m.reshaped()) x = next_number();
  return m;
}

void print(const char* what, const MatrixXd& m) {
  std::printf("%s %d %d:", what, static_cast<int>(m.rows()), static_cast<int>(m.cols()));
  for (const double x : m.reshaped()) std::printf(" %a", x);
  std::printf("\n");
}

/// Solved into a vector, and as a part of expressions, which read the numbers where Eigen put them.
template <class Factors>
void print_solved(const char* what, const Factors& factors, const VectorXd& b) {
  VectorXd x = factors.solve(b);
  print(what, x);
  x += factors.solve(b);
  print(what, x);
  x -= 0.5 * factors.solve(b);
  print(what, x);
  print(what, VectorXd(b - factors.solve(2 * b)));
  std::printf("%s %a\n", what, b.dot(factors.solve(b)));
  const MatrixXd A = some(3, b.size()), square = some(b.size(), b.size());
  print(what, VectorXd(A * factors.solve(b)));
  print(what, VectorXd(-square.transpose() * factors.solve(b - x)));
  print(what, MatrixXd(square * factors.solve(square.leftCols(1))));
  x = square * factors.solve(x);
  print(what, x);
  x.noalias() -= 0.5 * square * factors.solve(b);
  print(what, x);
}

/// A chain's: each row meets the next one, some meet a far one.
Sparse sparse_of(Index n, double diagonal) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto put = [&](Index i, Index k, double x) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(k), x);
    if (i != k) entries.emplace_back(static_cast<int>(k), static_cast<int>(i), x);
  };
  for (Index i = 0; i < n; ++i) {
    put(i, i, diagonal);
    put(i, i, 0.5);  // is added
    if (i + 1 < n) put(i, i + 1, next_number());
    if (i % 5 == 0 && i + 7 < n) put(i, i + 7, 0.1 * next_number());
  }
  Sparse m(n, n);
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

template <class Factors>
void print_sparse(const char* what, const Sparse& m, const VectorXd& b) {
  const Factors factors(m);
  std::printf("%s info %d\n", what, static_cast<int>(factors.info()));
  if (factors.info() != Eigen::Success) return;
  print_solved(what, factors, b);
  const VectorXd x = factors.solve(b);
  print(what, VectorXd(factors.solve(b - m * x)));
  Factors again;
  again.analyzePattern(m);
  again.factorize(m);
  print(what, VectorXd(again.solve(2 * b)));
}

}  // namespace

int main() {
  for (const Index n : {0, 1, 2, 3, 6, 13, 40}) {
    const MatrixXd A = some(n, n), B = some(n, n + 2), C = some(n + 1, n);
    const VectorXd b = some(n, 1);
    print("A B", A * B);
    print("A^T B", A.transpose() * B);
    print("A C^T", A * C.transpose());
    print("A D A^T", A * b.asDiagonal() * A.transpose());
    print("A b", A * b);
    print("A^T b", A.transpose() * b);
    print("b - A b", b - A * b);
    if (n == 0) continue;
    const MatrixXd S = A * A.transpose() + MatrixXd::Identity(n, n);
    print_solved("LU", A.partialPivLu(), b);
    print_solved("full LU", A.fullPivLu(), b);
    print("inverse", A.inverse());
    print_solved("LLT", S.llt(), b);
    print("LDLT", S.ldlt().solve(b - A * b));
    print_solved("LDLT", S.ldlt(), b);
    print_solved("QR", A.colPivHouseholderQr(), b);
    print_solved("plain QR", A.householderQr(), b);
    print_solved("SVD", A.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV), b);
    print_solved("orthogonal", A.completeOrthogonalDecomposition(), b);
    print_sparse<Eigen::SimplicialLDLT<Sparse>>("sparse LDLT", sparse_of(n, 4), b);
    print_sparse<Eigen::SimplicialLLT<Sparse>>("sparse LLT", sparse_of(n, 4), b);
    print_sparse<Eigen::SimplicialLDLT<Sparse>>("indefinite LDLT", sparse_of(n, -0.7), b);
    print_sparse<Eigen::SimplicialLLT<Sparse>>("indefinite LLT", sparse_of(n, -0.7), b);
    print_sparse<Eigen::SimplicialLDLT<Sparse>>("singular LDLT", sparse_of(n, -0.5), b);
  }
}
