/// The page on the cost of accuracy in a scene: error against CPU time and against force
/// evaluations, order, energy, stages.
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "framework/report/plot.h"

namespace tumble::report {

struct CostPoint {
  std::string fineness;              // "1/120 s", "tolerance 1e-06"
  double step;                       // [s]; NaN where there is none
  double error, cpu_s, evaluations;  // error [m]; NaN where the run did not finish
  std::string stopped_by;
};

/// One method, engine or setting over its refinement sequence.
struct CostCurve {
  std::string name;
  std::string reading;  // the sentence that interprets its curve
  // CostPoint::evaluations of its points, in words; empty: the page's
  std::string counted;
  bool is_subject = false;  // the subject of the page: its sentence is at the head
  double order = std::numeric_limits<double>::quiet_NaN();  // measured; NaN: none
  std::vector<CostPoint> points;                            // coarse to fine
  std::size_t example = 0;                      // the point whose energy and stages are shown
  std::vector<double> times, energy_errors;     // of the example
  std::map<std::string, double> stage_seconds;  // of the example
};

struct CostPage {
  std::string title, about;
  std::vector<std::string> readings;  // sentences at the head
  std::string truth;                  // the reference solution, against which errors are measured
  std::string error_name = "error of places", error_unit = "m";
  std::vector<double> marks = {1e-3, 1e-6, 1e-9};  // tolerances whose cost is listed
  std::string what_error_is;                       // a sentence
  std::string what_price_is;                       // a sentence; empty: that of engines
  // the quantity that is refined: CostPoint::step
  Axis finer = {"step", "s", Scale::kLog};
  std::string counted = "derivatives asked for";  // CostPoint::evaluations
  double floor;                                   // error of the reference solution [m]
  double scale;  // larger errors are not drawn: such a run is useless [m]
  std::vector<CostCurve> curves;
  // methods without a curve, and why: "ca: bodies fall asleep here"
  std::vector<std::string> not_run;
  std::string record;
};

/// The Pareto front: indices of the points that no other point beats in both cost and error, sorted
/// by cost.
std::vector<std::size_t> not_beaten(const std::vector<double>& price,
                                    const std::vector<double>& error);

/// The cheapest point with at most this error; nullptr where there is none.
const CostPoint* cheapest(const CostCurve& curve, double error);

/// A tolerance in words: "1e-6 m", or "right" where errors are relative to what the scene allows.
std::string mark_in_words(const CostPage& page, double mark);

/// A time with two digits and a suitable unit: "3.2 ms".
std::string price_of(double seconds);

/// Error against CPU time, with the measured order in each name and the error floor.
Plot plot_of_price(const CostPage& page);

/// Error against evaluations: one plot for each counted quantity, because derivatives and gaps
/// cannot share an axis.
std::vector<Plot> plots_of_evaluations(const CostPage& page);

/// @throws UserError when the file cannot be written
void write_cost_page(const CostPage& page, const std::filesystem::path& file);

}  // namespace tumble::report
