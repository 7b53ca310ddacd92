/// Every tolerance of contacts, in one place: its unit or what it is a part of, its reason, and what happens when it is larger or smaller.
///
/// `ninja -C build bench_contact_constants && build/bin/bench_contact_constants` multiplies and divides each by ten, and says which scenes notice.
/// "Of the restitution threshold": of the scene's rest_speed_m_s. "Of the smaller body": of the radius about the smaller of two.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tumble::engines {

struct ContactConstants {
  // ---- Margins: how far bodies in contact are kept apart
  /// of the smaller body: far above rounding, far below what is seen or measured. Larger:
  /// bodies rest visibly apart. Smaller: gaps drown in rounding
  double margin = 1e-10;
  /// of the smaller body: takes up what sweeps leave in large islands. Larger: a large island rests visibly
  /// apart. Smaller: more corrections a step
  double large_island_margin = 1e-4;
  /// margins: nearer than this two touch at the start of a step; farther, a point lands in it
  double touching_band = 8.0;
  /// margins: farther than this, and than the restitution threshold goes in a step, a contact
  /// has ended. Smaller: contacts flicker
  double open_band = 32.0;

  // ---- Manifolds: which points of two bodies are looked at
  /// of the smaller body: points farther away are not looked at in a step. Larger: slower
  double reach = 0.25;
  /// of the smaller body: no step leads deeper, save in large islands; a point that is deeper gets a
  /// second look
  double deep = 0.01;
  /// of the penetration: how far the deepest point of a manifold may be from it. A point that is deeper is not part of the overlap;
  /// where none is as deep the deepest was missed, and is added
  double depth_error = 0.1;
  /// of the smaller body: how far points of one contact lie from each other at two instants
  /// of a step, at most
  double midway = 0.3;

  // ---- The step
  /// of the longest step: ends of sliding that come sooner are taken with it. Larger: sliding
  /// ends late. Smaller: longer searches
  double shortest_step = 1e-6;
  /// restitution thresholds: what holds a slower island is an equilibrium, however it
  /// trembles, and is solved to the last digit
  double moving = 10.0;
  /// rad: an island that turns twice as far in a step gets a shorter one; what is left is of
  /// second order
  double most_turn = 0.05;
  /// rad: where nothing turns more in a step, forces of its start do for the whole. Larger:
  /// energy errors. Smaller: a second solve for most steps
  double even_turn = 1e-5;
  /// looks at where curved surfaces touch at the step's end; a second one leaves a thirtieth
  /// of the error
  int curved_rounds = 2;
  /// of the solver: some 200 problems that all stayed unsolved
  std::uint64_t most_sweeps_a_step = 300000;
  /// position corrections of a frame within a step
  int frame_rounds = 6;

  // ---- Contact problems
  /// of the island's speed: approach and slip left; problems at rest come out to rounding
  double solved = 1e-8;
  /// of the smaller body: how far a point may be from where an impulse acted to take it as
  /// its warm start
  double warm_start_within = 1e-2;
  /// the same in large islands, where points come and go, and the sum of a pair's impulses is worth
  /// more than their places
  double warm_start_within_in_large_island = 0.5;
  /// bodies, or contacts, of an island: so many are solved to the last digit, and their ends of sliding are located in time. Larger:
  /// slower. Smaller: large islands of a few bodies lose their order
  std::size_t few = 12;
  /// contacts of an island: more are too many for the dense matrix of the laws' contact_forces, and are solved by a few sweeps in_step
  std::size_t many_contacts = 64;

  // ---- Large islands: large islands without restitution, solved in steps and not at instants
  /// of one island in a step: more make it a large island
  int most_located_impacts = 8;
  /// of the large island's speed
  double solved_in_large_island = 1e-5;
  /// of the large island's speed: what sweeps leave at the worst of hundreds of contacts (0.28 in the
  /// bowl of 200 models, whose energy and gaps are right) its margin and the next step take
  /// up; where as much is left as there was, no answer was found
  double unsolved_in_large_island = 1.0;
  /// in_step, of islands of many contacts
  int sweeps_in_step = 120;
  /// from the warm start; of position corrections too
  int sweeps_in_large_island = 40;
  /// of the margin, in a step: what errors have taken from it comes back without a correction
  double restored = 0.2;

  // ---- Landings: points that come down within a step
  /// of the way down: the step ends before the point lands, a second, short one takes it all
  /// the way
  double before_activation = 0.99;
  /// of the restitution threshold: no better answer is asked of a large island, and what is nearer than this goes in the longest step is down
  double still = 1e-3;
  /// of the longest step: what lands this soon is predicted to its third power, below a
  /// margin
  double soon = 1e-3;

  // ---- Ends of sliding
  /// for ends of sliding within a step: bodies that chatter stop with the step
  int most_searches = 16;

  // ---- Position correction: what turning and errors leave of overlaps is removed
  /// rounds
  int most_corrections = 10;
  /// of the smaller body: what turning leaves between active contacts, at most
  double active_reach = 1e-3;
  /// corrections: how far apart points may be to matter
  double correction_reach = 4.0;
  /// of what is missing a round may leave
  double correction_missed = 1e-6;
  /// margins: a point farther away at the start has come down in the step
  double activated = 1e3;
  /// a correction is no motion: the lightest count as heavier ones beyond this
  double most_mass_ratio = 1e4;
  /// rounds
  int most_corrections_in_large_island = 24;
  /// large-island margins: nearer than this is taken back
  double too_near = 0.1;
  /// of the farthest: the next round takes the rest
  double correction_left_in_large_island = 1e-2;
  /// corrections: points this far apart may come together by them
  double correction_reach_in_large_island = 1.5;
  /// likewise, in what two bodies have moved by the last correction: levers make it long
  double correction_moved_in_large_island = 2.0;
  /// large-island margins: of larger gaps, and than the restitution threshold goes in a step, a bound
  /// will do
  double measured = 10.0;
  /// of the large-island margin: a pair that has moved less since keeps its manifold
  double same_place = 0.05;

  // ---- Energy: contacts bring none in
  /// of the longest step: one that gains energy is not cut below this
  double shortest_step_for_energy = 1.0 / 64;
};

#ifdef TUMBLE_TUNE_CONTACTS
/// Of the program that measures how much each matters (tests/bench/contact_constants.cpp).
extern ContactConstants kContact;
#else
inline constexpr ContactConstants kContact;
#endif

}  // namespace tumble::engines
