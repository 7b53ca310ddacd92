/// Numerical tolerances that several parts of the engines share: one name for one meaning.
///
/// Tolerances of contacts alone stand in contact/contact_constants.h, those of the watch over a run
/// in run_watch.h, limits of what may happen in a step in step_limits.h.
#pragma once

#include <algorithm>
#include <initializer_list>

#include "framework/core/numbers.h"

namespace tumble::engines {

// ---- Rounding
/// Relative: what a chain of some dozens of operations leaves. Larger: gaps and turns that are real
/// count as none. Smaller: bodies that touch count as apart, and impacts are found in vain.
inline constexpr double kRoundOff = 64 * kEpsilon;
/// Spacings of a coordinate: what a gap is off by, formed from places that are rounded once or
/// twice. Larger: overlaps pass. Smaller: contacts that are right are refused.
inline constexpr double kFewRoundings = 4.0;
/// Relative, of coordinates: a few dozen roundings of places, as margin of a box or of what counts
/// as closed. Larger: more pairs are searched. Smaller: pairs that just touch are missed, and
/// projections take rounds that change nothing.
inline constexpr double kCoordinateRounding = 1e-14;
/// Relative: what elimination and iteration leave of an answer in double precision. Larger: slow
/// approaches are left. Smaller: rounding is taken for an error, and is corrected without end.
inline constexpr double kSolverRounding = 1e-13;
/// Relative: what a solver leaves of a difference that is zero in exact arithmetic (of the inverse
/// effective mass where links hold a body, of the slope of a level support [rad], of the work of
/// impulses). Larger: a slope of 1e-10 rad would hold a ball without friction. Smaller: bodies that
/// links hold completely get impulses of rounding divided by rounding.
inline constexpr double kSolverResidue = 1e-11;
/// Deviations of a sum of independent roundings that cover every run. Larger: drifts of energy pass
/// as rounding. Smaller: one run in some thousands fails by chance.
inline constexpr double kDeviations = 8.0;

// ---- What is too little to matter
/// Of a length, a step, a bound, a speed or an energy: far above rounding, far below what is seen
/// or measured. Larger: times, gaps and rises that a check could see are dropped. Smaller: it
/// meets what rounding leaves, and steps and searches of no length begin.
inline constexpr double kNegligible = 1e-9;
/// s: instants that stand for each other where states are looked up by time: what six decimals of a
/// number of seconds leave. Smaller: a check at 0.333333 s has no frame. Larger: it is judged by a
/// frame in which bodies are elsewhere.
inline constexpr double kSameInstant = 1e-6;
/// m/s: as a restitution threshold, nothing rests; below it, impacts are of rounding alone
/// (bodies that lie still move by some 1e-15 m/s) and their energy obeys no law.
inline constexpr double kNegligibleSpeed = 1e-9;
/// Relative: what six digits of a file or the single precision of a model leave of numbers that
/// were meant to fit. Larger: what fits by design and what does not look alike. Smaller: scenes
/// typed with care are reported.
inline constexpr double kSixDigits = 1e-6;
/// Times: growth by less is not worth a word. Larger: reports come late. Smaller: they come for
/// what the next term of an estimate makes.
inline constexpr double kSeen = 1.1;

// ---- Rest, of the restitution threshold
/// Slower than this a body may be about to rest. Larger: slow swings are taken for rest. Smaller:
/// large islands never sleep, and slow separations are suppressed.
inline constexpr double kSlow = 0.1;
/// Slower than this nothing slides or collides: 1e-7 m/s where the threshold is 1 mm/s, the creep
/// that a sticking contact is allowed. Larger: slow sliding counts as sticking. Smaller: contacts
/// that stick are reported as sliding.
inline constexpr double kCreep = 1e-4;

// ---- Time
/// rad in one search for impacts, which looks at each of them: beyond, a run would take hours and
/// look like a hang. Larger: it does. Smaller: fast tops are refused.
inline constexpr double kMostTurning = 1e5;
/// Whether t is the end of what lasts until `end`, but for rounding: a step from there is none of
/// it. [s]
inline bool is_at_end(double t, double end, double step) { return t >= end - kNegligible * step; }
/// The first of instants at which a step may end: of those that are one but for rounding (0.7 s of
/// a grid, and of a motor that looks every 0.01 s), the last. No step of a rounding's length
/// follows, in which impulses over time say nothing of forces. [s]
inline double first_of(std::initializer_list<double> instants, double step) {
  const double first = std::min(instants);
  double last = first;
  for (const double t : instants)
    if (t <= first + kNegligible * step) last = std::max(last, t);
  return last;
}

}  // namespace tumble::engines
