/// Block Gauss-Seidel on a contact problem: contact after contact, each solved exactly with the
/// others held. Internal to dynamics.
///
/// Finds most small problems' answers and always the right modes of easy ones; the error falls by a
/// factor a sweep that is near 1 for high stacks and large mass ratios (a stack of N: 2.3 N^2 /
/// pi^2 sweeps a digit), where contact_newton.h takes over.
/// Sources: J. Moreau, "Numerical aspects of the sweeping process", 1999; F. Jourdan, P. Alart, M.
/// Jean, Comput. Methods Appl. Mech. Eng. 155, 1998.
#pragma once

#include <limits>

#include "framework/dynamics/contact_cone.h"
#include "framework/dynamics/contact_system.h"

namespace tumble::contacts {

/// Sweeps over the contacts of one system. Most points of a heap are near each other and do not
/// touch: such a point is looked at again when its bodies' velocities have changed by enough to
/// bring it together, at the earliest; until then its impulse could only stay zero. Answers are the
/// same as without that, bit for bit. A contact that pushes is left alone likewise, while its
/// bodies' velocities have changed by less than what is negligible since it was solved.
class Sweeper {
 public:
  /// @param system      stays where it is as long as this lives
  /// @param negligible  [m/s] a contact is left alone while others have changed its velocity by
  ///   less; 0: every sweep solves all contacts that push
  explicit Sweeper(const System& system, double negligible = 0.0);

  /// The impulses have been changed by others since the last sweep.
  void begin();
  struct Swept {
    double change = 0;    // largest of an impulse, as a velocity [m/s]
    double rounding = 0;  // rounding_floor of the impulses afterwards [m/s]
  };
  /// One sweep, forward or backward (alternate: together they treat no contact as the last).
  Swept sweep(bool forward, Impulses& impulses);

 private:
  // When an open contact, or one that has been solved, has to be looked at again: at the earliest
  // when the changes of its two bodies' y, summed up, reach so far.
  struct Gate {
    int body_a, body_b;        // places in ways_
    bool is_prepared = false;  // its local problem
    double alone_until = -std::numeric_limits<double>::infinity();
  };

  double way_of(const Gate& gate) const {
    return ways_[static_cast<std::size_t>(gate.body_a)] +
           ways_[static_cast<std::size_t>(gate.body_b)];
  }
  void relax_contact(std::size_t i, Impulses& impulses, Swept& swept);
  void relax_row(std::size_t i, Impulses& impulses, Swept& swept);
  LocalContact& local_of(std::size_t i);
  void note_push(int body_a, int body_b, double length);

  const System& system_;
  double negligible_;                 // [m/s]
  std::vector<LocalContact> locals_;  // each prepared when it is first solved
  std::vector<Gate> gates_;           // by contact
  // by body, after one for what cannot be pushed: bound on the sum of |changes of y| so far
  std::vector<double> ways_;
};

}  // namespace tumble::contacts
