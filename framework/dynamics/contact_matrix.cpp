#include "framework/dynamics/contact_matrix.h"

#include <algorithm>
#include <cmath>

namespace tumble::contacts {
namespace {

void connect(std::vector<std::vector<int>>& neighbours, int a, int b) {
  if (a == kFixed || b == kFixed || a == b) return;
  neighbours[a].push_back(b);
  neighbours[b].push_back(a);
}

void sort_unique(std::vector<int>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Of the steps still open, the one with the fewest neighbours; the first of equals.
int least_degree(const std::vector<std::vector<int>>& neighbours, const std::vector<char>& open) {
  int best = -1;
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    if (open[i] && (best < 0 || neighbours[i].size() < neighbours[best].size()))
      best = static_cast<int>(i);
  return best;
}

/// By factors L U, rows pivoted, and a solution for each column of I: of blocks with entries from 1
/// to 1e11 what is left over stays small, which it does not by Gauss and Jordan. What is singular
/// comes out as no numbers.
/// Source: G. Golub, C. Van Loan, "Matrix Computations", 3.4.
void invert(Block6& m) {
  // Unrolled, every entry has a place that is known beforehand.
  Block6 x = Block6::Identity();
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    int pivot = k;
    for (int i = k + 1; i < 6; ++i)
      if (std::abs(m(i, k)) > std::abs(m(pivot, k))) pivot = i;
    if (pivot != k) {
      m.row(pivot).swap(m.row(k));
      x.row(pivot).swap(x.row(k));
    }
    const double inverse = 1.0 / m(k, k);
    for (int i = k + 1; i < 6; ++i) m(i, k) *= inverse;
#pragma GCC unroll 6
    for (int j = k + 1; j < 6; ++j)
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) m(i, j) -= m(i, k) * m(k, j);
  }
  for (int column = 0; column < 6; ++column) {
    double* const of = x.data() + 6 * column;
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k)
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) of[i] -= m(i, k) * of[k];
#pragma GCC unroll 6
    for (int k = 6; k-- > 0;) {
      of[k] /= m(k, k);
#pragma GCC unroll 6
      for (int i = 0; i < k; ++i) of[i] -= m(i, k) * of[k];
    }
  }
  m = x;
}

}  // namespace

BodyMatrix::BodyMatrix(const System& system) {
  std::vector<std::vector<int>> neighbours(system.root_inverse_mass.size());
  step_of_body_.assign(neighbours.size(), -1);
  const auto take = [&](int a, int b) {
    if (a != kFixed) step_of_body_[a] = 0;
    if (b != kFixed) step_of_body_[b] = 0;
    connect(neighbours, a, b);
  };
  for (const ContactBlock& contact : system.contacts) take(contact.body_a, contact.body_b);
  for (const RowBlock& row : system.rows) take(row.body_a, row.body_b);
  for (std::vector<int>& list : neighbours) sort_unique(list);
  find_order(std::move(neighbours));
}

void BodyMatrix::find_order(std::vector<std::vector<int>> neighbours) {
  std::vector<char> open(neighbours.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = step_of_body_[i] == 0;
  std::vector<std::vector<int>> couples;  // by step, as bodies
  for (int body = least_degree(neighbours, open); body >= 0;
       body = least_degree(neighbours, open)) {
    open[body] = 0;
    step_of_body_[body] = static_cast<int>(body_of_step_.size());
    body_of_step_.push_back(body);
    couples.push_back(neighbours[body]);
    for (const int other : couples.back()) {  // its neighbours become each other's
      std::vector<int>& list = neighbours[other];
      list.insert(list.end(), couples.back().begin(), couples.back().end());
      sort_unique(list);
      std::erase_if(list, [&](int k) { return k == body || k == other; });
    }
  }
  columns_.resize(body_of_step_.size());
  for (std::size_t step = 0; step < columns_.size(); ++step) {
    Column& column = columns_[step];
    for (const int body : couples[step]) column.rows.push_back(step_of_body_[body]);
    std::sort(column.rows.begin(), column.rows.end());
    column.lower.resize(column.rows.size());
    column.upper.resize(column.rows.size());
  }
}

void BodyMatrix::set_identity() {
  for (Column& column : columns_) {
    column.diagonal.setIdentity();
    for (Block6& block : column.lower) block.setZero();
    for (Block6& block : column.upper) block.setZero();
  }
}

BodyMatrix::PairOfBlocks BodyMatrix::pair_of(int body_a, int body_b) {
  const int a = step_of_body_[body_a], b = step_of_body_[body_b];
  Column& column = columns_[std::min(a, b)];
  const auto place = std::lower_bound(column.rows.begin(), column.rows.end(), std::max(a, b)) -
                     column.rows.begin();
  Block6 &upper = column.upper[place], &lower = column.lower[place];
  return a < b ? PairOfBlocks{upper, lower} : PairOfBlocks{lower, upper};
}

void BodyMatrix::add(const ContactBlock& contact, const Matrix3d& d) {
  if (contact.is_frictional()) {
    add_product<3>(contact, d);
  } else {
    add_product<1>(contact, d);
  }
}

template <int kRows>
void BodyMatrix::add_product(const ContactBlock& contact, const Matrix3d& d) {
  using Tall = Eigen::Matrix<double, 6, kRows>;
  const Tall g_a = contact.g_a.topRows<kRows>().transpose(),
             g_b = contact.g_b.topRows<kRows>().transpose();
  const auto small = d.topLeftCorner<kRows, kRows>();
  if (contact.body_a != kFixed) {
    const Tall left = g_a.lazyProduct(small);
    columns_[step_of_body_[contact.body_a]].diagonal += left.lazyProduct(g_a.transpose());
    if (contact.body_b != kFixed) {
      const Tall right = g_b.lazyProduct(small);
      const PairOfBlocks pair = pair_of(contact.body_a, contact.body_b);
      pair.ab += left.lazyProduct(g_b.transpose());
      pair.ba += right.lazyProduct(g_a.transpose());
    }
  }
  if (contact.body_b == kFixed) return;
  const Tall right = g_b.lazyProduct(small);
  columns_[step_of_body_[contact.body_b]].diagonal += right.lazyProduct(g_b.transpose());
}

void BodyMatrix::add(const RowBlock& row, double d) {
  // Column by column into place: a product of 6 x 6 as an expression costs four times as much.
  const auto add_outer = [](const Vector6d& left, const Vector6d& right, Block6& to) {
    for (int column = 0; column < 6; ++column) to.col(column) += right[column] * left;
  };
  const bool moves_a = row.body_a != kFixed, moves_b = row.body_b != kFixed;
  const Vector6d of_a = d * row.g_a, of_b = d * row.g_b;
  if (moves_a) add_outer(of_a, row.g_a, columns_[step_of_body_[row.body_a]].diagonal);
  if (moves_b) add_outer(of_b, row.g_b, columns_[step_of_body_[row.body_b]].diagonal);
  if (!moves_a || !moves_b) return;
  const PairOfBlocks pair = pair_of(row.body_a, row.body_b);
  add_outer(of_a, row.g_b, pair.ab);
  add_outer(of_b, row.g_a, pair.ba);
}

void BodyMatrix::eliminate(std::size_t step) {
  Column& column = columns_[step];
  for (std::size_t i = 0; i < column.rows.size(); ++i) {
    column.lower[i] = (column.lower[i] * column.diagonal).eval();  // times the inverse
    const int row = column.rows[i];
    columns_[row].diagonal.noalias() -= column.lower[i] * column.upper[i];
  }
  // blocks (row_i, row_j), i > j, and their mirror images
  for (std::size_t j = 0; j < column.rows.size(); ++j) {
    Column& target = columns_[column.rows[j]];
    std::size_t place = 0;
    for (std::size_t i = j + 1; i < column.rows.size(); ++i) {
      while (target.rows[place] != column.rows[i]) ++place;
      target.lower[place].noalias() -= column.lower[i] * column.upper[j];
      target.upper[place].noalias() -= column.lower[j] * column.upper[i];
    }
  }
}

bool BodyMatrix::factorise() {
  for (std::size_t step = 0; step < columns_.size(); ++step) {
    Block6& diagonal = columns_[step].diagonal;
    invert(diagonal);
    if (!diagonal.allFinite()) return false;
    eliminate(step);
  }
  return true;
}

void BodyMatrix::solve(std::vector<Vector6d>& x) const {
  for (std::size_t step = 0; step < columns_.size(); ++step) {
    const Column& column = columns_[step];
    const Vector6d& here = x[body_of_step_[step]];
    for (std::size_t i = 0; i < column.rows.size(); ++i)
      x[body_of_step_[column.rows[i]]].noalias() -= column.lower[i] * here;
  }
  for (std::size_t step = columns_.size(); step-- > 0;) {
    const Column& column = columns_[step];
    Vector6d here = x[body_of_step_[step]];
    for (std::size_t i = 0; i < column.rows.size(); ++i)
      here.noalias() -= column.upper[i] * x[body_of_step_[column.rows[i]]];
    x[body_of_step_[step]].noalias() = column.diagonal * here;
  }
}

}  // namespace tumble::contacts
