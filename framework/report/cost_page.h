/// The page that shows what accuracy costs in a scene: error against CPU time and against force evaluations, order, energy, stages.
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

/// One method, engine or setting over its ladder.
struct CostCurve {
  std::string name;
  std::string reading;               // the sentence that reads its curve
  std::string counted;               // CostPoint::evaluations of its points, in words; empty: the page's
  bool is_subject = false;           // what the page is about: its sentence stands at the head
  double order = std::numeric_limits<double>::quiet_NaN();   // measured; NaN: none to be seen
  std::vector<CostPoint> points;     // coarse to fine
  std::size_t example = 0;           // the point whose energy and stages are shown
  std::vector<double> times, energy_errors;                  // of the example
  std::map<std::string, double> stage_seconds;               // of the example
};

struct CostPage {
  std::string title, about;
  std::vector<std::string> readings; // sentences at the head
  std::string truth;                 // what errors are measured against
  std::string error_name = "error of places", error_unit = "m";
  std::vector<double> marks = {1e-3, 1e-6, 1e-9};   // errors whose price is asked
  std::string what_error_is;         // in a sentence
  std::string what_price_is;         // the same; empty: the engine's
  Axis finer = {"step", "s", Scale::kLog};           // what makes runs finer: CostPoint::step
  std::string counted = "derivatives asked for";     // CostPoint::evaluations
  double floor;                      // of the truth [m]
  double scale;                      // errors above it are no answer, and not drawn [m]
  std::vector<CostCurve> curves;
  std::vector<std::string> not_run;  // what has no curve, and why: "ca: bodies fall asleep here"
  std::string record;
};

/// What none of the points beats in both price and error, by price: their indices.
std::vector<std::size_t> not_beaten(const std::vector<double>& price, const std::vector<double>& error);

/// The cheapest point whose error is at most this; nullptr where none gets there.
const CostPoint* cheapest(const CostCurve& curve, double error);

/// An error that is asked for, in words: "1e-6 m", or "right" where errors are shares of what is allowed.
std::string mark_in_words(const CostPage& page, double mark);

/// A time with two digits and the unit that suits it: "3.2 ms".
std::string price_of(double seconds);

/// Error against CPU time, with the measured order in each name; drawn with the floor.
Plot plot_of_price(const CostPage& page);

/// Error against evaluations: a plot for each thing that curves count, for derivatives and gaps do not share an axis.
std::vector<Plot> plots_of_evaluations(const CostPage& page);

/// @throws UserError when the file cannot be written
void write_cost_page(const CostPage& page, const std::filesystem::path& file);

}  // namespace tumble::report
