/// What accuracy costs: a scene run over ladders of steps or tolerances, each run's error and price.
///
/// Error: the farthest that a body is from where it should be, over all movable bodies and samples [m]. Of a body it is the distance of its
/// centre of mass plus the angle it is turned by wrongly times its radius of gyration: how far matter in it is out of place.
/// Should be: the closed form where nothing but gravity and impacts acts, else a run far finer than any that is judged; that one's own
/// error is estimated by a second one, and no error near that floor means anything.
/// Price: CPU time of the engine without what comes before its first step (models, shapes), the best of several short runs; and the
/// number of derivatives of bodies that were asked for, which does not depend on the machine.
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
#include "framework/engines/truths/known_places.h"

namespace tumble::engines {

/// Of the scale: a run with a larger error is on the way to others, and shows neither where a method leads nor by which power.
inline constexpr double kAnswer = 0.1;
/// s: runs that together have taken so long are not repeated.
inline constexpr double kShort = 0.1;
/// Price of a run with half the step over the one before, as expected; and the least, where steps are not what costs.
inline constexpr double kGrowth = 2.2, kLeastGrowth = 1.2;

/// One curve: all that is chosen about a run, but how finely.
struct CostWay {
  std::string name;                                      // "RK4"
  std::string word;                                      // what a flag called it
  std::string engine = "rd", propagator = "laws";
  std::function<StepFunction(double tolerance)> method;  // in place of the laws' integration; empty: theirs, or a closed form
  std::function<void(double tolerance, Laws& laws)> tuned;   // puts what else depends on the tolerance into the laws: a root finder, a solver
  std::string counted = "derivative_evaluations";        // which counter its evaluations are
  double order = kUnset;                                 // that the method promises; NaN: none
  bool controlled = false;                               // its ladder is of tolerances, not of steps
  bool has_ladder = true;                                // false: there is nothing to refine
  std::optional<scene::StabilisationSpec> stabilisation; // in place of the scene's
  Laws laws;
};

/// One run.
struct CostRung {
  double step_s = kUnset, tolerance = kUnset;
  double error_m = kUnset, cpu_s = kUnset;               // error: by numbers [-], see CostTruth
  std::string worst;                                     // by numbers: which is the worst
  double building_s = kUnset;                            // models and shapes, before the first step: not in cpu_s
  double spent_s = 0.0;                                  // CPU time of all runs that it took to measure it
  std::uint64_t evaluations = 0;                         // derivatives of a body's, or of a group of linked bodies', state; or what the way counts
  std::vector<double> times, energy_errors;              // by sample [s]; |E - E of the truth| over all the energy there was [-]
  std::map<std::string, double> stage_seconds;
  std::string stopped_by;                                // empty: ran to the end
  bool took_too_long = false;                            // it was stopped for its time alone
  bool not_attempted = false;                            // a function that it needs is a stub: stopped_by says which
};

/// What runs are compared with.
///
/// Where no two fine runs agree (an arch of stones, dominoes: which of two corners strikes first hangs on the last digit) there is no such
/// thing, and runs are judged by the scene's own numbers: then an "error" is the worst of these over what is allowed [-], and up to 1 is right.
struct CostTruth {
  std::string what;                  // in words
  bool by_numbers = false;
  std::string why_by_numbers;
  long intervals = 0;                // between the samples that runs are looked at
  std::vector<Frame> samples;        // intervals + 1, or none
  std::vector<double> radii;         // of gyration, by body; NaN for immovable ones [m]
  double floor_m = kUnset;           // its own error
  double scale_m = kUnset;           // how far bodies move: an error of this size is no answer at all
  double duration_s = 0.0;           // looked at
  double asked_s = 0.0;              // that was asked for; more than the former where no truth can be had for so long
  std::string shortened_by;          // why; empty: it is as long as asked
};

struct CostOptions {
  std::optional<double> duration_s;  // overrides the scene's
  double budget_s = 45.0;            // CPU of all ladders together
  double most_of_truth_s = 12.0;     // CPU of one run of the truth
  double most_of_search_s = 18.0;    // CPU of all its runs
  double least_share = 0.0;          // of the time that is asked for: a truth that holds for less is none
  std::optional<double> frame_rate_hz;   // samples of the truth: the frames of a run (or a little denser, so that they divide the duration); empty: a few
  bool shorten = true;               // look at less time where the truth does not hold for all of it; else that is refused
  double most_of_rung_s = std::numeric_limits<double>::infinity();   // CPU of one run: longer ones are stopped, where they integrate
  int runs = 5;                      // of a short rung: the least disturbed counts; 1 where only counts matter
  Engine timewarp;
  std::function<void(const std::string&)> told;   // progress, in words; empty: nobody listens
};

/// What nothing but gravity and impacts moves goes in closed form too.
bool goes_in_closed_form(const scene::Scene& scene);

/// @param laws  right ones: what they do not integrate is part of the truth
/// @throws UserError where no truth can be had even for a short while
CostTruth find_truth(const scene::Scene& scene, const Laws& laws, const CostOptions& options);
/// The same, or nothing. @param why  why not, or why only for less time
std::optional<CostTruth> try_truth(const scene::Scene& scene, const Laws& laws, const CostOptions& options, std::string& why);
/// Holds a truth against places that are known from outside: what it is off by is its own error, where that is more than was estimated.
/// @param source  of the places, for people. Those later than the truth's end are not looked at
void check_truth(const scene::Scene& scene, const Laws& laws, const std::vector<truths::KnownPlace>& places, const std::string& source, CostTruth& truth);
/// To judge by the scene's numbers. @param why  no truth is there
CostTruth by_numbers(const scene::Scene& scene, const CostOptions& options, const std::string& why);

/// One run of a way. @param steps  per sample, >= 1; @param tolerance  of a controlled way
CostRung run_rung(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, long steps, double tolerance, const CostOptions& options);

/// Steps per sample of a fixed-step ladder, coarse to fine; or the outer step of a controlled method.
long first_steps(const scene::Scene& scene, const CostTruth& truth);
long outer_steps(const scene::Scene& scene, const CostTruth& truth);

/// Whether a controlled method may take its steps as it likes: nothing in the scene happens once a step.
bool steps_are_free(const scene::Scene& scene);

/// The run of a rung as the engines are asked for it: the scene in equal steps, laws and options.
struct CostRun {
  scene::Scene scene;
  Laws laws;
  RunOptions options;
};
CostRun run_of(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, long steps, double tolerance, const CostOptions& options);

/// What a ladder was asked for; empty: halvings of the first step, tolerances 0.1, 0.01, ... (with rods or joints from 1e-4 on)
struct LadderWords {
  std::vector<double> steps_s, tolerances;
};
/// Whether nothing more can come of a ladder: the truth's floor is reached, errors do not fall any more, or all that was asked for has been run.
bool ladder_is_done(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, const std::vector<CostRung>& rungs, const LadderWords& words);
/// CPU time that the next rung is expected to take. [s]
double next_price(const std::vector<CostRung>& rungs);
/// Goes on with a ladder, by one rung at least where it is not done, for so long. What takes too long ends it, for finer runs take longer still;
/// called again with more than twice the time for a rung, it tries that one again.
void extend_ladder(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, double budget_s, const CostOptions& options, const LadderWords& words, std::vector<CostRung>& rungs,
                   const std::function<void(const CostRung&)>& told);

/// The whole ladder, coarse to fine: until the truth's floor is reached, or the next rung would take more than the budget.
/// @param told     called after each rung
/// @param steps_s  steps that were asked for; empty: halvings of the first @param tolerances  the same
std::vector<CostRung> run_ladder(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, double budget_s, const CostOptions& options, const std::vector<double>& steps_s,
                                 const std::vector<double>& tolerances, const std::function<void(const CostRung&)>& told);

/// Distance of two frames as above. [m]
double distance_between(const Frame& found, const Frame& expected, const std::vector<double>& radii);

}  // namespace tumble::engines
