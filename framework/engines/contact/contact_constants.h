/// Tolerances of contacts alone: of what each is a part, its reason, and what happens when it is
/// larger or smaller. Those that other parts share stand in base/tolerances.h.
///
/// `ninja -C build bench_contact_constants && build/bin/bench_contact_constants` multiplies and
/// divides each by ten, and says which scenes notice. "Of the restitution threshold": of the
/// scene's rest_speed_m_s. "Of the smaller body": of the radius about the smaller of two.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tumble::engines {

struct ContactConstants {
  // ---- Margins: how far bodies in contact are kept apart
  /// of the smaller body: far above rounding, far below what is seen or measured. Larger: bodies
  /// rest visibly apart. Smaller: gaps drown in rounding.
  double margin = 1e-10;
  /// of the smaller body: takes up what sweeps leave in large islands. Larger: they rest visibly
  /// apart. Smaller: more corrections a step.
  double large_island_margin = 1e-4;
  /// margins: nearer than this two touch at the start of a step; farther, a point becomes active
  /// in it. Larger: gaps close late. Smaller: contacts at rest are activated again and again.
  double touching_band = 8.0;
  /// of the smaller body: where links left open what carries in the step before, points nearer than
  /// this share a load with those that touch, and no impact closes their gaps. Larger: bodies land
  /// late. Smaller: errors of long steps decide what carries.
  double sharing_band = 1e-4;
  /// margins: farther than this, and than the restitution threshold goes in a step, a contact has
  /// ended. Larger: contacts outlast their end. Smaller: contacts flicker.
  double open_band = 32.0;

  // ---- Manifolds: which points of two bodies are looked at
  /// of the smaller body: points farther away are not looked at in a step. Larger: slower.
  /// Smaller: corners are missed that come near within the step.
  double reach = 0.25;
  /// of what neighbours' impacts bend a body's path by: how far that may bring it nearer to
  /// others, whose points are at the ends of levers. Larger: slower. Smaller: impacts of a heap are
  /// met at their instants.
  double levers = 2.0;
  /// of the smaller body: no step leads deeper, save in large islands, so a deeper point gets a
  /// second look. Larger: points of the far side pass. Smaller: many second looks.
  double deep = 0.01;
  /// of the penetration: how far the deepest point of a manifold may be from it. A point that is
  /// deeper is not part of the overlap; where none is as deep, the deepest was missed, and is
  /// added. Larger: points of the far side pass. Smaller: rounding adds points.
  double depth_error = 0.1;
  /// of the smaller body: how far points of one contact lie from each other at two instants of a
  /// step, at most. Larger: one corner is taken for another. Smaller: contacts lose their middle.
  double midway = 0.3;
  /// of what the two have turned against each other between them: how far the normal of one contact
  /// turns, at most; that of edges turns by 1 / sin(angle between them) of it. Larger: one face is
  /// taken for the next. Smaller: edges that cross at less than 20 degrees lose their middle.
  double midway_turn = 3.0;
  /// of the smaller body, and of what the two have turned against each other: a point that has gone
  /// no farther on either is what they turn about, and may change its normal. Larger: edges that
  /// slide slowly are taken to a next face. Smaller: hinges of edge on edge lose their middle.
  double pivot = 0.03;

  // ---- The step
  /// of the longest step: what changes sooner than this after a step's start, or before its end,
  /// is taken with it. Larger: sliding ends late. Smaller: longer searches.
  double shortest_step = 1e-6;
  /// restitution thresholds: a slower island is near an equilibrium, and is solved to the last
  /// digit. Larger: moving islands cost as much. Smaller: equilibria drift.
  double moving = 10.0;
  /// rad: an island that turns twice as far in a step gets a shorter one; the error left is of
  /// second order. Larger: that error grows. Smaller: more steps.
  double most_turn = 0.05;
  /// of the longest step: one in which what presses goes over a corner to the next face is not cut
  /// below this; it presses for all of that part or for none. Larger: that error, of first order,
  /// grows. Smaller: more steps.
  double shortest_step_at_corners = 1.0 / 16;
  /// rad: where nothing turns more in a step, forces of its start do for the whole. Larger: energy
  /// errors. Smaller: a second solve for most steps.
  double even_turn = 1e-5;
  /// solves for where curved surfaces touch at the step's end: the second one leaves a thirtieth
  /// of the error. Larger: slower. Smaller: energy errors of what rolls.
  int curved_rounds = 2;
  /// solves where statics does not tell which contact carries a load, at most, until targets
  /// change by less than this part of what is indistinct. More, or smaller: slower. Fewer, or
  /// larger: errors of the step tell what carries.
  int most_sharing_rounds = 5;
  double same_targets = 1e-2;
  /// of a force: as near what presses a body and what springs, drag and water felt of it are to be
  /// where a contact begins, and how often that is looked for. A round leaves a tenth of the error
  /// or so; after as many that are not enough, as many more look where the rounds lead to. Larger,
  /// or fewer: the first step of a contact is of first order.
  double same_pressing = 1e-4;
  int most_pressing_rounds = 6;
  /// of the longest step: what presses a body in a shorter one is not told from it. Larger: forces
  /// of earlier steps are felt. Smaller: what solvers leave of velocities (`solved`), over such a
  /// time, is taken for a force.
  double shortest_step_for_pressing = 1e-3;
  /// sweeps of the solver in one step: some 200 problems that all stayed unsolved. Larger: a run
  /// without an answer takes hours. Smaller: hard steps are given up.
  std::uint64_t most_sweeps_a_step = 300000;
  /// of the island's speed: what stays unsolved where a driven body leaves no room (half of the
  /// driven body's speed, where nothing else moves). Larger: such a run ends late. Smaller: jams
  /// that a solver's patience would open end it.
  double jammed = 1e-2;
  /// jams from one instant on, in ever shorter steps. Larger: such a run ends late. Smaller: as
  /// above.
  int most_jams = 4;

  // ---- Contact problems
  /// of the island's speed: approach and slip left where it moves. Larger: energy errors. Smaller:
  /// sweeps that change nothing that is measured.
  double solved = 1e-8;
  /// of the smaller body: how far a point may be from where an impulse acted to take it as its warm
  /// start. Larger: neighbours take it. Smaller: points that slide start from zero.
  double warm_start_within = 1e-2;
  /// the same in large islands, where points come and go, and the sum of a pair's impulses is worth
  /// more than where each acted
  double warm_start_within_in_large_island = 0.5;
  /// contacts of an island: so many are solved to the last digit, and their ends of sliding are
  /// located in time. Larger: slower. Smaller: stacks of a few bodies lose their order.
  std::size_t few_contacts = 12;
  /// contacts of an island: more are too many for the dense matrix of the laws' contact_forces, and
  /// are solved by a few sweeps in_step. Larger: the time goes with the third power. Smaller: less
  /// of a run is by the laws.
  std::size_t many_contacts = 64;

  // ---- Large islands: without restitution, solved in steps and not at instants
  /// impacts of one island in a step: more make it a large one. Larger: a collapsing stack takes
  /// long. Smaller: small stacks lose the order of their impacts.
  int most_located_impacts = 8;
  /// bodies of an island: it is never a large one. Larger: slower. Smaller: stacks of a few bodies
  /// lose their order.
  std::size_t few_bodies = 12;
  /// of the island's speed: approach and slip left. Larger: more corrections. Smaller: slower.
  double solved_in_large_island = 1e-5;
  /// of the island's speed: what sweeps leave at the worst of hundreds of contacts (0.28 in the
  /// bowl of 200 models, whose energy and gaps are right) its margin and the next step take up;
  /// where as much is left as there was, no answer was found. Smaller: right runs are reported.
  double unsolved_in_large_island = 1.0;
  /// sweeps in_step, of islands of many contacts. Larger: slower. Smaller: contacts approach.
  int sweeps_in_step = 120;
  /// sweeps from the warm start; of position corrections too. Larger: slower. Smaller: as above.
  int sweeps_in_large_island = 40;
  /// of the margin, in a step: what errors have taken from it comes back without a correction.
  /// Larger: it comes back as speed. Smaller: more corrections.
  double restored = 0.2;

  /// of the smaller body: corners of a pair in contact that are this near take part in an impact
  /// that passes through it. Larger: corners that have opened are struck. Smaller: the path within
  /// a step, which stands off by 1e-7 or so, decides through which corner an impact passes first.
  double impact_band = 1e-6;

  // ---- Activation: contacts that become active within a step
  /// of the time until the gap closes: the step ends before, and a second, short one takes it all
  /// the way. Larger: the prediction's error leads too deep. Smaller: longer second steps.
  double before_activation = 0.99;
  /// of the restitution threshold: no better answer is asked of a large island, and a point nearer
  /// than this goes in the longest step touches. Larger: impacts come early. Smaller: solves that
  /// change nothing, and points that never arrive.
  double still = 1e-3;
  /// of the longest step: a gap that closes this soon is predicted to the third power of that time,
  /// below a margin. Larger: that error grows. Smaller: more steps to one impact.
  double soon = 1e-3;

  // ---- Ends of sliding
  /// searches within a step: bodies that chatter stop sliding with the step. Larger: chatter takes
  /// long. Smaller: ends of sliding are late.
  int most_searches = 16;

  // ---- Position correction: what rotation and errors leave of overlaps is removed
  /// rounds, within a step and for a frame; in the first half of them active contacts are drawn to
  /// their margins too. Larger:
  /// nothing, once converged. Smaller: overlaps are left.
  int most_corrections = 10;
  /// of the smaller body: what rotation leaves between active contacts, at most. Larger: points
  /// that have opened are drawn together. Smaller: energy errors.
  double active_reach = 1e-3;
  /// corrections: how far apart points may be to matter. Larger: slower. Smaller: a correction
  /// closes other gaps.
  double correction_reach = 4.0;
  /// of what is missing a round may leave. Larger: more rounds. Smaller: more sweeps.
  double correction_missed = 1e-6;
  /// of what was missing before it: a round that leaves more finds no room, and the pairs give up
  /// their margin. Larger: slow. Smaller: contacts that could have their margin lose it.
  double correction_in_vain = 0.4;
  /// of what was missing before it: a round that leaves more has gained nothing. Larger: two walls
  /// that leave no room are noticed late. Smaller: as above.
  double correction_stands = 0.99;
  /// rounds in a row that gain nothing: so many between two walls find no room either. Larger:
  /// slow. Smaller: what has room between them loses its margins.
  int most_rounds_in_vain = 3;
  /// cosine: walls whose normals part by more push against each other. Larger: what stands in a
  /// right-angled corner counts, though it has room. Smaller: three walls round a ball do not.
  double against = -0.1;
  /// longest steps: how long. Larger: their margin comes back late where there is room again.
  /// Smaller: the correction in vain is tried too often.
  double steps_without_margin = 64;
  /// margins: a point farther away at the start has become active in the step, and is not drawn to
  /// its margin. Larger: its impact is undone. Smaller: active contacts open.
  double far_at_start = 1e3;
  /// a correction is no motion, so the lightest bodies count as heavier ones beyond this ratio of
  /// masses. Larger: the solver loses digits. Smaller: heavy bodies move for light ones.
  double most_mass_ratio = 1e4;
  /// rounds in large islands. Larger: slower. Smaller: steps are cut.
  int most_corrections_in_large_island = 24;
  /// large-island margins: nearer than this is corrected. Larger: more corrections. Smaller: gaps
  /// close.
  double too_near = 0.1;
  /// of the farthest: the next round takes the rest. Larger: more rounds. Smaller: more sweeps.
  double correction_left_in_large_island = 1e-2;
  /// corrections: points this far apart may come together by them. Larger: slower. Smaller: as
  /// above.
  double correction_reach_in_large_island = 1.5;
  /// likewise, in what two bodies have moved by the last correction: levers make it long
  double correction_moved_in_large_island = 2.0;
  /// large-island margins: of larger gaps, and than the restitution threshold goes in a step, a
  /// bound will do. Larger: slower. Smaller: contacts end early.
  double measured = 10.0;
  /// of the large-island margin: a pair that has moved less since keeps its manifold. Larger: old
  /// normals. Smaller: slower.
  double same_place = 0.05;

  // ---- Energy: contacts bring none in
  /// of the longest step: one that gains energy is not cut below this. Larger: energy rises.
  /// Smaller: more steps.
  double shortest_step_for_energy = 1.0 / 64;
};

#ifdef TUMBLE_TUNE_CONTACTS
/// Of the program that measures how much each matters (tests/bench/contact_constants.cpp).
extern ContactConstants kContact;
#else
inline constexpr ContactConstants kContact;
#endif

}  // namespace tumble::engines
