/// This course's cost model: the number of integrations of the three kinds of engine, from the rate
/// of discontinuities per body.
///
///   RD: n lambda (1 + p) / p      CA: n (1/h + 3 lambda)      TW: n (1/h + 3 w)
///       in integrations per simulated second
///   lambda = n w / 2 (discontinuities per second, of all bodies),  p = 1 - exp(-lambda h)
/// n bodies, h the largest step [s], w discontinuities per body and second [1/s]; a discontinuity
/// involves two bodies.
/// Source: derived in handouts/a4_timewarp.md#cost, not in the slides or the paper, for the three
/// engines of B. Mirtich, Timewarp Rigid Body Simulation, SIGGRAPH 2000. The model has no closed
/// forms: an engine that advances a free body to its next discontinuity in one integration stays
/// below it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/report/engines_page.h"

namespace tumble::report {

/// @param engine  "rd", "ca" or "tw"
/// @param n, w, h  as above, all positive
/// @return integrations per simulated second, all bodies together; nothing for other engines
std::optional<double> modelled_integrations(const std::string& engine, double n, double w,
                                            double h);

/// Discontinuities per body and second, from a run that counts each once (of an engine that goes
/// from event to event), else from the first run. 0: no engine ran.
double discontinuities_a_body(const std::vector<EngineRow>& rows);

/// Integrations per simulated second against n: measured, with marks, and by the model at the w of
/// each size.
Plot plot_of_model(const std::vector<std::vector<EngineRow>>& ladder);
/// " Counted over model here: RD 1.11 to 1.39, above it; TW 0.41 to 0.43, below it.": a sentence
/// with what the plot shows; empty where nothing is in it.
std::string place_beside_model(const std::vector<std::vector<EngineRow>>& ladder);
/// The same as a table: one row per size and engine; the last column is measured / model.
Table table_of_model(const std::vector<std::vector<EngineRow>>& ladder);

}  // namespace tumble::report
