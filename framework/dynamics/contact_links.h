/// Links of a contact problem, eliminated where nothing touches: a chain of N bodies that meets
/// others with its last one is solved as one body with the mobility that the chain leaves it.
/// Internal to dynamics.
///
/// In the coordinates y of contact_system.h every body's inverse mass is I. Rows of links take
/// mobility from a body p. Phi_p is what it has left, y_p its velocity, w_p what else pushes it.
/// The rows G_p, G_c to a body c that hangs on p alone, their velocity base without impulses, push
/// with
///   lambda = -S^-1 (base + G_p (y_p + Phi_p w_p) + G_c y_c)                               (C.10)
///   S = G_p Phi_p G_p^T + G_c Phi_c G_c^T
/// and leave p with
///   Phi_p - Phi_p G_p^T S^-1 G_p Phi_p,   y_p - Phi_p G_p^T S^-1 (base + G_p y_p + G_c y_c)
/// One link after the other from the ends of a chain, each in constant time; c is then out of the
/// problem. Links to what cannot be pushed go likewise, without c. The contacts that are left have
/// G K in place of G, Phi = K K^T. Their impulses known, w and lambda follow in the opposite order.
/// Nothing is divided by a mobility: a chain that hangs on the wall needs no other form.
/// A contact along whose normal links to what cannot be pushed leave no mobility (the foot of a
/// robot, bolted to the floor that it stands on) has no say: what it presses with, the links push
/// back, and any pressure would do. It is left out, with no impulse, unless its bodies approach.
/// What this leaves in the problem: loops, redundant rows, bodies between two that are touched.
/// Sources: R. Featherstone, Int. J. Robotics Research 2, 1983 (articulated bodies); D. Baraff,
/// "Linear-time dynamics using Lagrange multipliers", SIGGRAPH 1996; K. Kreutz-Delgado, A. Jain, G.
/// Rodriguez, Int. J. Robotics Research 11, 1992 (inverse of the operational-space inertia).
#pragma once

#include <cstddef>
#include <vector>

#include "framework/dynamics/contact_matrix.h"
#include "framework/dynamics/contact_system.h"

namespace tumble::contacts {

/// Takes the contact out of its problem: nothing moves by it.
void leave_out(ContactBlock& contact);

class LinkElimination {
 public:
  /// @param system      stays where it is as long as this lives
  /// @param negligible  approach of what links hold: rounding [m/s]
  LinkElimination(const System& system, double negligible);

  /// Whether rows were eliminated, and what is left is as well conditioned as the whole.
  bool is_of_use() const { return is_of_use_; }
  /// The contacts, and the rows that are left, of bodies with the mobility that they are left.
  const System& rest() const { return rest_; }
  /// Contacts that are left out: links hold what they would push.
  const std::vector<std::size_t>& held_contacts() const { return held_contacts_; }
  /// These impulses of the whole system, as far as they are ones of the rest.
  Impulses of_rest(const Impulses& whole) const;
  /// An answer of the rest, and with it that of the eliminated rows.
  Impulses of_whole(const Impulses& rest) const;
  /// Takes away what rounding has left of the velocities of eliminated rows.
  void refine(Impulses& whole) const;

 private:
  static constexpr int kMostRows = 6;
  /// Rows that follow each other and tie the same two bodies; `body_b` may be none that moves.
  struct Link {
    int body_a = kFixed, body_b = kFixed;
    std::size_t first = 0, count = 0;  // of its rows
  };
  /// One elimination: of a link between `body` and `child`, or what cannot be pushed. Columns
  /// beyond the link's rows are zero.
  struct Step {
    int body = kFixed, child = kFixed;
    std::size_t first = 0, count = 0;
    Block6 of_body, of_child;  // G_p^T, G_c^T
    Block6 root;               // C of S = C C^T
    Block6 reach;              // Phi_p G_p^T C^-T
  };

  std::vector<Link> find_links() const;
  void eliminate_links(const std::vector<Link>& links);
  std::vector<std::vector<std::size_t>> contacts_of_bodies() const;
  bool is_held_along_normal(const ContactBlock& contact) const;
  bool eliminate(int body, int child, const Link& link);
  /// Forward through the steps: C^-1 of what the rows lack, by step, where `velocity` is that of
  /// each row without their impulses; `y` becomes the velocities of bodies with them.
  template <typename RowVelocity>
  std::vector<Vector6d> lacks(const RowVelocity& velocity, std::vector<Vector6d>& y) const;
  /// Backward: impulses of the eliminated rows added, where w pushes the bodies.
  void add_impulses(const std::vector<Vector6d>& lacks, std::vector<Vector6d> w,
                    std::vector<double>& rows) const;
  /// False where it is not as well conditioned as the whole.
  bool build_rest(const std::vector<Vector6d>& y);

  const System& system_;
  System rest_;
  bool is_of_use_ = false;
  std::vector<Step> steps_;
  std::vector<Block6> mobility_;  // Phi, by body
  std::vector<char> is_held_;     // by body: whether Phi is not I
  std::vector<char> is_left_;     // by row
  std::vector<std::size_t> held_contacts_;
  std::vector<std::size_t> row_of_rest_;  // by row of the rest
  std::vector<Vector6d> lacks_;           // by step
};

}  // namespace tumble::contacts
