/// Newton's methods on all contacts at once, for what Gauss-Seidel does slowly. Internal to
/// dynamics.
///
/// Four, which take turns, and before them `stick`:
/// - `finish`: semismooth Newton on Coulomb's law itself, p = P(p - v / r) for all contacts, r =
///   inverse effective mass. Near the answer its error squares at each step; far from it, it may
///   wander, so a step that does not lessen the violation ends it. With the modes found (open,
///   stick, slide) the equations of redundant contacts are singular; a compliance delta r keeps
///   them regular and fades as the steps repeat (a proximal method), so that nothing of it stays in
///   the answer.
/// - `sharpen`: the same law with rounded edges (C.9), made sharp step by step. A few dozen
///   factorisations find modes that sweeps and `finish` do not; it may end in a fold of its path.
/// - `soften`: with De Saxce's shift g_i = mu |v_t,i| held, the law is convex: p in the friction
///   cone K, v + g n in its dual. With a compliance eps its velocities minimise
///     1/2 |y|^2 + sum eps_i / 2 |Pi_K(p_i - (v_i(y) + g_i n) / eps_i)|^2                     (C.6)
///   a smooth convex function: Newton's method with an exact line search gets there from anywhere.
///   Then p := Pi_K(..), g := mu |v_t|, and again with less compliance (an augmented Lagrangian
///   with Cadoux's fixed point on g).
/// - `follow`: contacts with compliance eps obey  y = sum G_i^T P(-v_i(y) / (eps_i))  (C.7),  which
///   has an answer for any eps, an easy one where eps is large; from there to small eps along the
///   path of answers. Where sliding contacts jam each other the fixed point on g does not settle;
///   this has none.
/// Why these: all need one matrix of 6 rows a body, however many contacts a body has; the first
/// gives the last digits, the second is quick, the third cannot get lost, the fourth gets through
/// jams; no strictly feasible point is needed (a wedge has none), unlike by an interior point
/// method.
/// Sources: P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991; F. Cadoux, PhD thesis,
/// Grenoble 2009; A. Castro, F. Permenter, X. Han, IEEE Trans. Robotics 39, 2023 (C.6 and its line
/// search); G. De Saxce, Z.-Q. Feng, Math. Comput. Modelling 28, 1998.
#pragma once

#include "framework/dynamics/contact_matrix.h"
#include "framework/dynamics/contact_system.h"

namespace tumble::contacts {

/// What an iteration works on and what it has reached.
struct Progress {
  Impulses impulses;
  Violation violation;  // of the impulses
  bool accepted = false;
  int sweeps = 0, factorisations = 0;
};

/// When it is good enough.
struct Goal {
  const System& system;
  double violation = 0;  // [m/s]
  bool accepts(const Impulses& impulses, double now) const {
    return now <= violation || now <= rounding_floor(system, impulses);
  }
  /// Measures what `progress` has reached.
  void measure(Progress& progress) const {
    progress.violation = measure_violation(system, progress.impulses);
    progress.accepted = accepts(progress.impulses, progress.violation.largest);
  }
};

/// Steps of semismooth Newton while they help; the sum of squared violations never grows.
void finish(const Goal& goal, int most_steps, BodyMatrix& matrix, Progress& progress);

/// Full steps of semismooth Newton, whatever they leave, until one is accepted: for contacts whose
/// surfaces yield (ContactBlock::compliance), where a contact that opens leaves for a step what is
/// larger by far than what the surfaces tell apart. False: none was.
bool finish_yielding(const Goal& goal, int most_steps, BodyMatrix& matrix, Progress& progress);

/// Impulses of rows that go with those of contacts, from a warm start that knows none of rows:
/// without them modes would be told from velocities that no row has.
/// @return false, and nothing is changed: that lessens no violation
bool hold_rows(const Goal& goal, BodyMatrix& matrix, Progress& progress);

/// Contacts held in all directions, those that would have to pull open: a structure that stands.
/// True, and `progress` is that, if none leaves its cone; otherwise it is as it was.
bool stick(const Goal& goal, BodyMatrix& matrix, Progress& progress);

/// How fast `sharpen` goes.
struct Sharpening {
  double first = 0;    // the first tau, over the problem's speed
  double down = 0;     // tau over the one before
  int most_steps = 0;  // of Newton's method
};

/// Steps of Newton's method on the rounded law from the impulses; the best that was met, by the
/// sharp law, is kept.
void sharpen(const Goal& goal, const Sharpening& pace, BodyMatrix& matrix, Progress& progress);

/// One problem (C.6) solved, impulses and shift renewed from it. False, and nothing changed:
/// Newton's method did not reach its minimum.
bool soften(const Goal& goal, double compliance_over_give, BodyMatrix& matrix, Progress& progress);

/// One point of the path (C.7), or as near as Newton's method gets to it from the impulses'
/// velocities.
void follow(const Goal& goal, double compliance_over_give, BodyMatrix& matrix, Progress& progress);

}  // namespace tumble::contacts
