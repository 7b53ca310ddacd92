#include "framework/dynamics/contact_links.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/dynamics/contact_cone.h"

namespace tumble::contacts {
namespace {

/// Of what a row or a contact moves by itself: where links leave less than this, what they hold is
/// told from what they leave by too few digits.
constexpr double kHeld = 1e-6;

std::size_t at(int body) { return static_cast<std::size_t>(body); }

/// to += sign L R^T, of the first `count` columns. Column by column into place: as an expression it
/// costs three times as much.
void add_product(const Block6& left, const Block6& right, std::size_t count, double sign,
                 Block6& to) {
  for (int j = 0; j < 6; ++j) {
    Vector6d sum = to.col(j);
    for (int k = 0; k < static_cast<int>(count); ++k) sum += (sign * right(j, k)) * left.col(k);
    to.col(j) = sum;
  }
}

/// C, lower triangular, of m = C C^T. A column whose pivot is not above `least` of `whole` is zero,
/// and the answer false.
bool factorise_symmetric(const Block6& m, const Vector6d& whole, double least, Block6& root) {
  root.setZero();
  bool is_regular = true;
  for (int j = 0; j < 6; ++j) {
    Vector6d column = m.col(j);
    for (int k = 0; k < j; ++k) column -= root(j, k) * root.col(k);
    if (column[j] > least * whole[j])
      root.col(j).tail(6 - j) = column.tail(6 - j) / std::sqrt(column[j]);
    else
      is_regular = false;
  }
  return is_regular;
}

/// x := C^-1 x.
void solve_lower(const Block6& root, Vector6d& x) {
  for (int j = 0; j < 6; ++j) {
    x[j] /= root(j, j);
    for (int i = j + 1; i < 6; ++i) x[i] -= root(i, j) * x[j];
  }
}

/// x := C^-T x.
void solve_upper(const Block6& root, Vector6d& x) {
  for (int j = 6; j-- > 0;) {
    for (int i = j + 1; i < 6; ++i) x[j] -= root(i, j) * x[i];
    x[j] /= root(j, j);
  }
}

constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);

/// Least of what an impulse at the contact moves it by, over directions. [1/kg]
double least_mobility(const ContactBlock& c) {
  if (!c.is_frictional()) return c.inverse_effective_mass;
  Matrix3d w = Matrix3d::Zero();
  if (c.body_a != kFixed) w.noalias() += c.g_a * c.g_a.transpose();
  if (c.body_b != kFixed) w.noalias() += c.g_b * c.g_b.transpose();
  const LocalContact local = prepare_local(w);
  return std::min(local.w_nn, local.stiff_2);
}

}  // namespace

void leave_out(ContactBlock& contact) {
  contact.body_a = contact.body_b = kFixed;
  contact.inverse_effective_mass = 0;
}

LinkElimination::LinkElimination(const System& system, double negligible)
    : system_(system),
      mobility_(system.root_inverse_mass.size()),
      is_held_(mobility_.size(), 0),
      is_left_(system.rows.size(), 1) {
  eliminate_links(find_links());
  std::vector<Vector6d> y(mobility_.size(), Vector6d::Zero());
  lacks_ = lacks([&](std::size_t row) { return system_.rows[row].base; }, y);
  for (const std::size_t i : held_contacts_)
    if (!(contact_velocity(system_.contacts[i], y)[0] >= -negligible)) {
      held_contacts_.clear();
      return;
    }
  is_of_use_ = !steps_.empty() && build_rest(y);
}

std::vector<LinkElimination::Link> LinkElimination::find_links() const {
  std::vector<Link> links;
  for (std::size_t i = 0; i < system_.rows.size(); ++i) {
    const RowBlock& row = system_.rows[i];
    const int a = row.body_a != kFixed ? row.body_a : row.body_b,
              b = row.body_a != kFixed ? row.body_b : kFixed;
    if (links.empty() || links.back().body_a != a || links.back().body_b != b)
      links.push_back({a, b, i, 0});
    ++links.back().count;
  }
  return links;
}

void LinkElimination::eliminate_links(const std::vector<Link>& links) {
  // of the links of each body that are left: how many, and the exclusive or of their indices,
  // which is the last one's index
  std::vector<std::size_t> degree(mobility_.size(), 0), last(mobility_.size(), 0);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& link = links[i];
    if (link.body_a == kFixed) continue;
    if (link.body_b == kFixed && eliminate(link.body_a, kFixed, link)) continue;
    for (const int body : {link.body_a, link.body_b})
      if (body != kFixed) {
        ++degree[at(body)];
        last[at(body)] ^= i;
      }
  }
  // what is touched is no end of a chain
  constexpr std::size_t kTouched = 2;
  for (const ContactBlock& c : system_.contacts)
    for (const int body : {c.body_a, c.body_b})
      if (body != kFixed) degree[at(body)] += kTouched;
  std::vector<std::vector<std::size_t>> contacts_of;
  if (!steps_.empty()) contacts_of = contacts_of_bodies();
  std::vector<char> is_out(system_.contacts.size(), 0);
  // those of a body that has lost mobility
  const auto leave_out_held = [&](std::size_t body) {
    if (contacts_of.empty()) return;
    for (const std::size_t i : contacts_of[body]) {
      const ContactBlock& c = system_.contacts[i];
      if (is_out[i] || !is_held_along_normal(c)) continue;
      is_out[i] = 1;
      held_contacts_.push_back(i);
      for (const int side : {c.body_a, c.body_b})
        if (side != kFixed) degree[at(side)] -= kTouched;
    }
  };
  for (std::size_t body = 0; body < degree.size(); ++body)
    if (is_held_[body]) leave_out_held(body);
  for (std::size_t held = 0, before = kUnknown; held != before;) {
    before = held_contacts_.size();
    for (std::size_t start = 0; start < degree.size(); ++start)
      for (std::size_t child = start; degree[child] == 1;) {
        const std::size_t index = last[child];
        const Link& link = links[index];
        const int other = at(link.body_a) == child ? link.body_b : link.body_a;
        if (other == kFixed || !eliminate(other, static_cast<int>(child), link)) break;
        degree[child] = 0;
        --degree[at(other)];
        last[at(other)] ^= index;
        child = at(other);
        leave_out_held(child);
      }
    held = held_contacts_.size();  // others may be ends of chains now
  }
}

std::vector<std::vector<std::size_t>> LinkElimination::contacts_of_bodies() const {
  std::vector<std::vector<std::size_t>> result(mobility_.size());
  for (std::size_t i = 0; i < system_.contacts.size(); ++i)
    for (const int body : {system_.contacts[i].body_a, system_.contacts[i].body_b})
      if (body != kFixed) result[at(body)].push_back(i);
  return result;
}

/// Whether links leave the bodies nothing of what an impulse along the normal would move them by.
bool LinkElimination::is_held_along_normal(const ContactBlock& contact) const {
  double alone = 0, left = 0;
  for (const auto& [body, g] :
       {std::pair{contact.body_a, &contact.g_a}, {contact.body_b, &contact.g_b}}) {
    if (body == kFixed) continue;
    const Vector6d normal = g->row(0).transpose();
    alone += normal.squaredNorm();
    left += is_held_[at(body)] ? normal.dot(mobility_[at(body)] * normal) : normal.squaredNorm();
  }
  return alone > 0 && left <= kHeld * alone;
}

bool LinkElimination::eliminate(int body, int child, const Link& link) {
  if (link.count > kMostRows) return false;
  if (steps_.empty()) steps_.reserve(mobility_.size());
  Step& step = steps_.emplace_back();
  step.body = body;
  step.child = child;
  step.first = link.first;
  step.count = link.count;
  step.of_body.setZero();
  step.of_child.setZero();
  Vector6d whole = Vector6d::Ones();
  for (std::size_t i = 0; i < link.count; ++i) {
    const RowBlock& row = system_.rows[link.first + i];
    const auto column = static_cast<Eigen::Index>(i);
    step.of_body.col(column) = row.body_a == body ? row.g_a : row.g_b;
    if (child != kFixed) step.of_child.col(column) = row.body_a == child ? row.g_a : row.g_b;
    whole[column] = row.inverse_effective_mass;
  }
  // S from below: columns of G Phi, and then those of (G Phi) G^T
  Block6 s = Block6::Zero();
  const auto add_side = [&](int side, const Block6& of_side) {
    const Block6 rows = of_side.transpose();
    Block6 moved = rows;
    if (is_held_[at(side)]) {
      moved.setZero();
      add_product(rows, mobility_[at(side)], kMostRows, 1, moved);  // Phi is symmetric
    }
    add_product(moved, rows, kMostRows, 1, s);
    return moved;
  };
  step.reach = add_side(body, step.of_body).transpose();
  if (child != kFixed) add_side(child, step.of_child);
  for (Eigen::Index i = static_cast<Eigen::Index>(link.count); i < kMostRows; ++i) s(i, i) = 1;
  if (!factorise_symmetric(s, whole, kHeld, step.root)) {
    steps_.pop_back();
    return false;
  }
  for (int j = 0; j < kMostRows; ++j) {
    step.reach.col(j) /= step.root(j, j);
    for (int i = j + 1; i < kMostRows; ++i)
      step.reach.col(i) -= step.root(i, j) * step.reach.col(j);
  }
  if (!std::exchange(is_held_[at(body)], 1)) mobility_[at(body)].setIdentity();
  add_product(step.reach, step.reach, link.count, -1, mobility_[at(body)]);
  std::fill_n(is_left_.begin() + static_cast<std::ptrdiff_t>(link.first), link.count, 0);
  return true;
}

template <typename RowVelocity>
std::vector<Vector6d> LinkElimination::lacks(const RowVelocity& velocity,
                                             std::vector<Vector6d>& y) const {
  std::vector<Vector6d> result;
  result.reserve(steps_.size());
  for (const Step& step : steps_) {
    Vector6d lack = step.of_body.transpose() * y[at(step.body)];
    if (step.child != kFixed) lack += step.of_child.transpose() * y[at(step.child)];
    for (std::size_t i = 0; i < step.count; ++i)
      lack[static_cast<Eigen::Index>(i)] += velocity(step.first + i);
    solve_lower(step.root, lack);
    y[at(step.body)] -= step.reach * lack;
    result.push_back(lack);
  }
  return result;
}

void LinkElimination::add_impulses(const std::vector<Vector6d>& lacks, std::vector<Vector6d> w,
                                   std::vector<double>& rows) const {
  for (std::size_t k = steps_.size(); k-- > 0;) {
    const Step& step = steps_[k];
    Vector6d impulse = -lacks[k] - step.reach.transpose() * w[at(step.body)];
    solve_upper(step.root, impulse);
    w[at(step.body)] += step.of_body * impulse;
    if (step.child != kFixed) w[at(step.child)] += step.of_child * impulse;
    for (std::size_t i = 0; i < step.count; ++i)
      rows[step.first + i] += impulse[static_cast<Eigen::Index>(i)];
  }
}

bool LinkElimination::build_rest(const std::vector<Vector6d>& y) {
  // K of Phi, of bodies that are left; directions in which nothing moves have a zero column
  constexpr double kRounding = 1e-15;
  std::vector<Block6> roots(mobility_.size());
  std::vector<char> has_root(mobility_.size(), 0);
  const auto root_of = [&](int body) -> const Block6& {
    Block6& root = roots[at(body)];
    if (!std::exchange(has_root[at(body)], 1))
      factorise_symmetric(mobility_[at(body)], Vector6d::Ones(), kRounding, root);
    return root;
  };
  const auto is_held = [&](int body) { return body != kFixed && is_held_[at(body)]; };

  rest_.speed = system_.speed;
  rest_.root_inverse_mass = system_.root_inverse_mass;
  rest_.root_inverse_inertia = system_.root_inverse_inertia;
  rest_.contacts = system_.contacts;
  for (const std::size_t i : held_contacts_) leave_out(rest_.contacts[i]);
  for (ContactBlock& c : rest_.contacts) {
    if (!is_held(c.body_a) && !is_held(c.body_b)) continue;
    for (const auto& [body, g] : {std::pair{c.body_a, &c.g_a}, {c.body_b, &c.g_b}}) {
      if (!is_held(body)) continue;
      const Eigen::Index n = c.is_frictional() ? 3 : 1;
      c.base.head(n) += g->topRows(n) * y[at(body)];
      g->topRows(n) = (g->topRows(n) * root_of(body)).eval();
    }
    const double alone = std::exchange(c.inverse_effective_mass, diagonal_mean(c));
    if (!(least_mobility(c) >= kHeld * alone)) return false;
  }
  for (std::size_t i = 0; i < system_.rows.size(); ++i) {
    if (!is_left_[i]) continue;
    RowBlock row = system_.rows[i];
    const double alone = std::exchange(row.inverse_effective_mass, 0.0);
    for (const auto& [body, g] : {std::pair{row.body_a, &row.g_a}, {row.body_b, &row.g_b}}) {
      if (body == kFixed) continue;
      if (is_held(body)) {
        row.base += g->dot(y[at(body)]);
        *g = (root_of(body).transpose() * *g).eval();
      }
      row.inverse_effective_mass += g->squaredNorm();
    }
    if (!(row.inverse_effective_mass >= kHeld * alone)) return false;
    rest_.rows.push_back(row);
    row_of_rest_.push_back(i);
  }
  return true;
}

Impulses LinkElimination::of_rest(const Impulses& whole) const {
  Impulses rest;
  rest.contacts = whole.contacts;
  for (const std::size_t row : row_of_rest_) rest.rows.push_back(whole.rows[row]);
  sum_impulses(rest_, rest);
  return rest;
}

Impulses LinkElimination::of_whole(const Impulses& rest) const {
  Impulses whole;
  whole.contacts = rest.contacts;
  whole.rows.assign(system_.rows.size(), 0.0);
  for (std::size_t i = 0; i < row_of_rest_.size(); ++i) whole.rows[row_of_rest_[i]] = rest.rows[i];
  sum_impulses(system_, whole);
  add_impulses(lacks_, whole.y, whole.rows);
  sum_impulses(system_, whole);
  return whole;
}

void LinkElimination::refine(Impulses& whole) const {
  std::vector<Vector6d> y(mobility_.size(), Vector6d::Zero());
  const std::vector<Vector6d> left =
      lacks([&](std::size_t row) { return row_velocity(system_.rows[row], whole.y); }, y);
  add_impulses(left, std::vector<Vector6d>(mobility_.size(), Vector6d::Zero()), whole.rows);
  sum_impulses(system_, whole);
}

}  // namespace tumble::contacts
