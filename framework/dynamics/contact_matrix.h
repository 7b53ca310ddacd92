/// The matrix of Newton's method on a contact problem, by bodies: H = I + sum G_i^T D_i G_i, in 6 x
/// 6 blocks. Internal to dynamics.
///
/// Eliminated block by block without pivoting between blocks, in an order of least degree found
/// once: a stack or a chain costs O(bodies). H need not be symmetric (sliding contacts), but its
/// pattern is. The part of I makes it regular where contacts are redundant.
/// Source: A. George, J. Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981.
#pragma once

#include <vector>

#include "framework/dynamics/contact_system.h"

namespace tumble::contacts {

using Block6 = Eigen::Matrix<double, 6, 6>;

class BodyMatrix {
 public:
  /// Finds the order of elimination and where it fills in. Cost: O(bodies^2) at most, of small
  /// constant.
  explicit BodyMatrix(const System& system);

  void set_identity();
  /// H += G^T D G for one contact (without friction only D(0, 0) counts).
  void add(const ContactBlock& contact, const Matrix3d& d);
  /// H += d g^T g for one row.
  void add(const RowBlock& row, double d);
  /// Eliminates in place. False: a block was singular, H is of no use.
  bool factorise();
  /// x := H^-1 x, by body; parts of bodies that cannot be pushed are left alone.
  void solve(std::vector<Vector6d>& x) const;

 private:
  void find_order(std::vector<std::vector<int>> neighbours);
  template <int kRows>
  void add_product(const ContactBlock& contact, const Matrix3d& d);
  struct PairOfBlocks {
    Block6 &ab, &ba;
  };
  PairOfBlocks pair_of(int body_a, int body_b);
  void eliminate(std::size_t step);

  struct Column {                      // of one step of the elimination
    Block6 diagonal;                   // after factorise(): its inverse
    std::vector<int> rows;             // later steps that it couples to, ascending
    std::vector<Block6> lower, upper;  // blocks (rows[i], step) and (step, rows[i])
  };
  std::vector<int> step_of_body_;  // -1: not in the matrix
  std::vector<int> body_of_step_;
  std::vector<Column> columns_;
};

}  // namespace tumble::contacts
