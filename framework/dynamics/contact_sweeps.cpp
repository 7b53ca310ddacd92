#include "framework/dynamics/contact_sweeps.h"

#include <cmath>

namespace tumble::contacts {
namespace {

double normal_velocity(const ContactBlock& c, const std::vector<Vector6d>& y) {
  double v = c.base[0];
  if (c.body_a != kFixed) v += c.g_a.row(0).dot(y[c.body_a]);
  if (c.body_b != kFixed) v += c.g_b.row(0).dot(y[c.body_b]);
  return v;
}

double relax_contact(const ContactBlock& block, LocalContact& local, Vector3d& impulse,
                     std::vector<Vector6d>& y) {
  if (!(block.inverse_effective_mass > 0)) return 0;
  if (!block.is_frictional()) {
    const double before = impulse[0];
    impulse[0] = std::max(0.0, before - normal_velocity(block, y) / local.w_nn);
    const double change = impulse[0] - before;
    if (change != 0) push(block, Vector3d(change, 0, 0), y);
    return block.inverse_effective_mass * std::abs(change);
  }
  if (impulse[0] == 0 && normal_velocity(block, y) >= 0) return 0;  // open, and stays so
  const Vector3d velocity = contact_velocity(block, y), before = impulse;
  impulse = solve_local(local, velocity - local.w * before, block.friction);
  const Vector3d change = impulse - before;
  push(block, change, y);
  return block.inverse_effective_mass * change.norm();
}

double relax_row(const RowBlock& row, double& impulse, std::vector<Vector6d>& y) {
  if (!(row.inverse_effective_mass > 0)) return 0;
  const double velocity = row_velocity(row, y), change = -velocity / row.inverse_effective_mass;
  impulse += change;
  push(row, change, y);
  return std::abs(velocity);
}

}  // namespace

std::vector<LocalContact> prepare_locals(const System& system) {
  std::vector<LocalContact> locals(system.contacts.size());
  for (std::size_t i = 0; i < locals.size(); ++i) {
    const ContactBlock& block = system.contacts[i];
    if (!block.is_frictional()) {
      locals[i].w_nn = block.inverse_effective_mass;
      continue;
    }
    Matrix3d w = Matrix3d::Zero();
    if (block.body_a != kFixed) w.noalias() += block.g_a * block.g_a.transpose();
    if (block.body_b != kFixed) w.noalias() += block.g_b * block.g_b.transpose();
    if (block.inverse_effective_mass > 0) locals[i] = prepare_local(w);
  }
  return locals;
}

double sweep(const System& system, std::vector<LocalContact>& locals, bool forward,
             Impulses& impulses) {
  const std::size_t contacts = system.contacts.size(), rows = system.rows.size();
  double largest = 0;
  const auto relax = [&](std::size_t i) {
    largest =
        std::max(largest, i < rows ? relax_row(system.rows[i], impulses.rows[i], impulses.y)
                                   : relax_contact(system.contacts[i - rows], locals[i - rows],
                                                   impulses.contacts[i - rows], impulses.y));
  };
  for (std::size_t i = 0; i < rows + contacts; ++i) relax(forward ? i : rows + contacts - 1 - i);
  return largest;
}

}  // namespace tumble::contacts
