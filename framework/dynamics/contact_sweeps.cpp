#include "framework/dynamics/contact_sweeps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tumble::contacts {
namespace {

constexpr double kAtOnce = -std::numeric_limits<double>::infinity();
// of the problem's speed: a contact that opens more slowly is always looked at
constexpr double kSlowlyOpen = 1e-6;
// of the speed with which a contact opens: so much of it may go before it is looked at again; the
// rest is far above rounding
constexpr double kSurelyOpen = 0.9;

double normal_velocity(const ContactBlock& c, const std::vector<Vector6d>& y) {
  double v = c.base[0];
  if (c.body_a != kFixed) v += c.g_a.row(0).dot(y[c.body_a]);
  if (c.body_b != kFixed) v += c.g_b.row(0).dot(y[c.body_b]);
  return v;
}

// Bound on |G_a| and |G_b|: their squares sum up to the trace of W_ii.
double largest_gain(const ContactBlock& block) {
  return std::sqrt((block.is_frictional() ? 3 : 1) * block.inverse_effective_mass);
}

}  // namespace

Sweeper::Sweeper(const System& system, double negligible)
    : system_(system),
      negligible_(negligible),
      locals_(system.contacts.size()),
      ways_(system.root_inverse_mass.size() + 1, 0.0) {
  gates_.reserve(system.contacts.size());
  for (const ContactBlock& block : system.contacts)
    gates_.push_back({block.body_a + 1, block.body_b + 1});
}

void Sweeper::begin() {
  for (Gate& gate : gates_) gate.alone_until = kAtOnce;
}

LocalContact& Sweeper::local_of(std::size_t i) {
  const ContactBlock& block = system_.contacts[i];
  LocalContact& local = locals_[i];
  if (std::exchange(gates_[i].is_prepared, true)) return local;
  if (!block.is_frictional()) {
    local.w_nn = block.inverse_effective_mass + block.compliance;
    return local;
  }
  Matrix3d w = Matrix3d::Zero();
  if (block.body_a != kFixed) w.noalias() += block.g_a * block.g_a.transpose();
  if (block.body_b != kFixed) w.noalias() += block.g_b * block.g_b.transpose();
  w(0, 0) += block.compliance;
  return local = prepare_local(w);
}

// An impulse p changes y by G^T p.
void Sweeper::note_push(int body_a, int body_b, double length) {
  if (body_a != kFixed) ways_[static_cast<std::size_t>(body_a + 1)] += length;
  if (body_b != kFixed) ways_[static_cast<std::size_t>(body_b + 1)] += length;
}

void Sweeper::relax_contact(std::size_t i, Impulses& impulses, Swept& swept) {
  Gate& gate = gates_[i];
  const double way = way_of(gate);
  const ContactBlock& block = system_.contacts[i];
  if (!(block.inverse_effective_mass > 0)) return;
  Vector3d& impulse = impulses.contacts[i];
  std::vector<Vector6d>& y = impulses.y;
  gate.alone_until = kAtOnce;
  if (impulse[0] == 0) {
    if (const double v = normal_velocity(block, y); v >= 0) {  // open, and stays so
      if (v > kSlowlyOpen * system_.speed)
        gate.alone_until = way + kSurelyOpen * v / largest_gain(block);
      return;
    }
  }
  LocalContact& local = local_of(i);
  double change = 0;
  if (!block.is_frictional()) {
    const double before = impulse[0];
    const double v = normal_velocity(block, y) + block.compliance * before;
    impulse[0] = std::max(0.0, before - v / local.w_nn);
    change = impulse[0] - before;
    if (change != 0) push(block, Vector3d(change, 0, 0), y);
    change = std::abs(change);
  } else {
    const Vector3d velocity = yielding_velocity(block, impulse, y), before = impulse;
    impulse = solve_local(local, velocity - local.w * before, block.friction);
    const Vector3d by = impulse - before;
    push(block, by, y);
    change = by.norm();
  }
  const double gain = largest_gain(block);
  note_push(block.body_a, block.body_b, gain * change);
  if (negligible_ > 0) gate.alone_until = way_of(gate) + negligible_ / gain;
  swept.change = std::max(swept.change, block.inverse_effective_mass * change);
  swept.rounding =
      std::max(swept.rounding, block.inverse_effective_mass * impulse.cwiseAbs().maxCoeff());
}

void Sweeper::relax_row(std::size_t i, Impulses& impulses, Swept& swept) {
  const RowBlock& row = system_.rows[i];
  double& impulse = impulses.rows[i];
  if (row.inverse_effective_mass > 0) {
    const double velocity = row_velocity(row, impulses.y),
                 change = -velocity / row.inverse_effective_mass;
    impulse += change;
    push(row, change, impulses.y);
    note_push(row.body_a, row.body_b, std::sqrt(row.inverse_effective_mass) * std::abs(change));
    swept.change = std::max(swept.change, std::abs(velocity));
  }
  swept.rounding = std::max(swept.rounding, row.inverse_effective_mass * std::abs(impulse));
}

Sweeper::Swept Sweeper::sweep(bool forward, Impulses& impulses) {
  const std::size_t contacts = system_.contacts.size(), rows = system_.rows.size();
  Swept swept;
  const auto relax = [&](std::size_t i) {
    if (i < rows)
      relax_row(i, impulses, swept);
    else if (!(way_of(gates_[i - rows]) < gates_[i - rows].alone_until))
      relax_contact(i - rows, impulses, swept);
  };
  for (std::size_t i = 0; i < rows + contacts; ++i) relax(forward ? i : rows + contacts - 1 - i);
  swept.rounding = rounding_of(swept.rounding);
  return swept;
}

}  // namespace tumble::contacts
