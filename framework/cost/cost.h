/// Error against cost: a scene run over a sequence of steps or tolerances, with the error and the
/// cost of each run.
///
/// Error: the largest deviation of a body from the reference solution, over all movable bodies and
/// samples [m]. The deviation of a body is the distance of its centre of mass plus the angle of its
/// rotation error times its radius of gyration, which measures how far its matter is out of place.
/// Reference solution: the closed form where nothing but gravity and impacts acts, else a run far
/// finer than any that is judged. A second run estimates its own error, the error floor: errors
/// near it mean nothing.
/// Cost: CPU time of the engine from its first step on (without models and shapes), the best of
/// several short runs; and the number of evaluations of bodies' derivatives, which does not depend
/// on the machine.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/methods.h"
#include "framework/engines/run.h"
#include "framework/truths/known_positions.h"

namespace tumble::cost {

/// Of the scale: a run with a larger error is no answer, and does not follow the power law yet.
inline constexpr double kAnswer = 0.1;
/// Errors that differ by less, as a ratio, are equal: the cheaper run is better.
inline constexpr double kAlikeErrors = 1.05;
/// s: runs that together have taken longer are not repeated.
inline constexpr double kShort = 0.1;
/// Expected cost of a run with half the step relative to the last one; and the least, where steps
/// are not the cost.
inline constexpr double kGrowth = 2.2, kLeastGrowth = 1.2;

/// One curve: all choices about a run except its resolution.
struct CostMethod {
  std::string name;         // "RK4"
  std::string word;         // its word in a flag
  bool is_subject = false;  // of the module that is measured, whoever wrote it
  std::string engine = "rd", propagator = "laws";
  // in place of the laws' integration; empty: theirs, or a closed form
  std::function<StepFunction(double tolerance)> step_function;
  bool steps_in_units = false;    // of step_function: see Laws
  bool has_library_step = false;  // of step_function: what lowers its order is a law
  // sets what else in the laws depends on the tolerance: a root finder, a solver
  std::function<void(double tolerance, Laws& laws)> tuned;
  std::string counted = "derivative_evaluations";  // the counter of its evaluations
  double order = kUnset;                           // order of the method; NaN: none
  // its resolution is a tolerance, not a step
  bool controlled = false;
  bool has_refinement = true;                             // false: it has no step or tolerance
  std::optional<scene::StabilisationSpec> stabilisation;  // in place of the scene's
  std::optional<scene::Coordinates> coordinates;          // the same
  Laws laws;
};

/// One run, at one resolution.
struct CostResult {
  double step_s = kUnset, tolerance = kUnset;
  // error: for judgement by numbers [-], see CostReference
  double error_m = kUnset, cpu_s = kUnset;
  std::string worst;  // for judgement by numbers: the worst one
  // models and shapes, before the first step: not part of cpu_s
  double building_s = kUnset;
  double spent_s = 0.0;  // CPU time of all runs of this measurement
  // derivatives of the state of a body or of an island of linked bodies; or what the method counts
  std::uint64_t evaluations = 0;
  // steps were shortened below the one asked for, as where a body passes a water's level
  bool has_shortened_steps = false;
  // by sample [s]; |E - E of the reference| over the energy at the start [-]
  std::vector<double> times, energy_errors;
  std::map<std::string, double> stage_seconds;
  std::string stopped_by;      // empty: ran to the end
  bool took_too_long = false;  // stopped only because of its CPU time
  // a function that it needs is a stub: stopped_by names it
  bool not_attempted = false;
};

/// The reference solution of a scene.
///
/// Where no two fine runs agree (an arch of stones, dominoes: rounding decides which of two corners
/// collides first) there is none, and runs are judged by the scene's own numbers: an "error" is
/// then the worst of these relative to its tolerance [-], right up to 1.
struct CostReference {
  std::string what;  // in words, for people
  bool by_numbers = false;
  std::string why_by_numbers;
  long intervals = 0;          // between samples
  std::vector<Frame> samples;  // intervals + 1, or none
  std::vector<double> radii;   // of gyration, by body; NaN for immovable bodies [m]
  double floor_m = kUnset;     // its own error
  // size of the motion: an error of this size is no answer at all
  double scale_m = kUnset;
  double duration_s = 0.0;  // of the comparison
  // requested duration; more than duration_s where no reference solution exists for so long
  double asked_s = 0.0;
  std::string shortened_by;  // the reason; empty: it has the requested duration
};

struct CostOptions {
  std::optional<double> duration_s;   // overrides the scene's
  double budget_s = 45.0;             // CPU time of all refinements together
  double most_of_reference_s = 12.0;  // CPU time of one reference run
  double most_of_search_s = 18.0;     // CPU time of all reference runs
  double least_share = 0.0;           // of the requested duration: a shorter reference is refused
  // samples of the reference: the frames of a run (or slightly more, so that they divide the
  // duration); empty: a few
  std::optional<double> frame_rate_hz;
  // shorten the comparison where the reference does not hold for all of it; else that is refused
  bool shorten = true;
  // CPU time of one run: longer ones are stopped, where they integrate
  double most_of_run_s = std::numeric_limits<double>::infinity();
  // repetitions of a short run: the fastest counts; 1 where only counts matter
  int runs = 5;
  engines::Engine timewarp;
  std::function<void(const std::string&)> progress;  // receives progress in words; empty: none
};

/// Whether bodies move only by gravity and impacts, so that closed forms exist.
bool goes_in_closed_form(const scene::Scene& scene);

/// @param laws  right ones: what they do not integrate is part of the reference
/// @throws UserError where there is no reference even for a short time
CostReference find_reference(const scene::Scene& scene, const Laws& laws,
                             const CostOptions& options);
/// The same, or nothing. @param why  the reason for nothing, or for a shorter duration
std::optional<CostReference> try_reference(const scene::Scene& scene, const Laws& laws,
                                           const CostOptions& options, std::string& why);
/// Compares a reference with positions from another source: their difference becomes its error
/// floor where it is larger than the estimate.
/// @param source  of the positions, for people. Positions after the end of the reference are
///   skipped
void check_reference(const scene::Scene& scene, const Laws& laws,
                     const std::vector<truths::KnownPosition>& places, const std::string& source,
                     CostReference& reference);
/// A reference that judges by the scene's numbers. @param why  the reason why no reference solution
///   exists
CostReference by_numbers(const scene::Scene& scene, const CostOptions& options,
                         const std::string& why);

/// One run of a method. @param steps  per sample, >= 1; @param tolerance  of a controlled method
CostResult run_at_resolution(const scene::Scene& scene, const CostMethod& method,
                             const CostReference& reference, long steps, double tolerance,
                             const CostOptions& options);

/// Steps per sample of the coarsest fixed-step run; or the outer step of a controlled method.
long first_steps(const scene::Scene& scene, const CostReference& reference);
long outer_steps(const scene::Scene& scene, const CostReference& reference);

/// Whether a controlled method may choose its steps freely: nothing in the scene happens once per
/// step.
bool steps_are_free(const scene::Scene& scene);

/// The engine run of a resolution: the scene in equal steps, laws and options.
struct CostRun {
  scene::Scene scene;
  Laws laws;
  engines::RunOptions options;
};
CostRun run_of(const scene::Scene& scene, const CostMethod& method, const CostReference& reference,
               long steps, double tolerance, const CostOptions& options);

/// Requested resolutions; empty: halvings of the first step, tolerances 0.1, 0.01, ... (with rods
/// or joints from 1e-4 on)
struct RefinementWords {
  std::vector<double> steps_s, tolerances;
};
/// Whether a refinement is complete: the error floor is reached, errors no longer decrease, or all
/// requested resolutions have been run.
bool refinement_is_done(const scene::Scene& scene, const CostMethod& method,
                        const CostReference& reference, const std::vector<CostResult>& results,
                        const RefinementWords& words);
/// Expected CPU time of the next run. [s]
double next_price(const std::vector<CostResult>& results);
/// Continues a refinement within the CPU time given, by at least one run where it is not complete.
/// A run that takes too long ends it, because finer runs take longer; a later call with more than
/// twice the time per run repeats that run.
void extend_refinement(const scene::Scene& scene, const CostMethod& method,
                       const CostReference& reference, double budget_s, const CostOptions& options,
                       const RefinementWords& words, std::vector<CostResult>& results,
                       const std::function<void(const CostResult&)>& progress);

/// The whole refinement, coarse to fine: until the error floor is reached, or the next run would
/// exceed the budget.
/// @param progress  called after each run
/// @param steps_s   requested steps; empty: halvings of the first @param tolerances  the same
std::vector<CostResult> run_refinement(const scene::Scene& scene, const CostMethod& method,
                                       const CostReference& reference, double budget_s,
                                       const CostOptions& options,
                                       const std::vector<double>& steps_s,
                                       const std::vector<double>& tolerances,
                                       const std::function<void(const CostResult&)>& progress);

/// Deviation of two frames as above. [m]
double distance_between(const Frame& found, const Frame& expected,
                        const std::vector<double>& radii);

}  // namespace tumble::cost
