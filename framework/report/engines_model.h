/// What integrations the three kinds of engine should need, from how often something happens to a body: this course's model of cost.
///
///   RD: n lambda (1 + p) / p      CA: n (1/h + 3 lambda)      TW: n (1/h + 3 w)      in integrations a simulated second
///   lambda = n w / 2 (discontinuities a second, of all bodies),  p = 1 - exp(-lambda h)
/// n bodies, h the largest step [s], w discontinuities a body and second [1/s]; a discontinuity is of two bodies.
/// Source: ours, neither the slides' nor the paper's; derived in handouts/a4_timewarp.md#cost from the three engines as B. Mirtich, Timewarp
/// Rigid Body Simulation, SIGGRAPH 2000, describes them. The model knows no closed forms: an engine that takes a free body to its next
/// discontinuity in one integration stays below it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/report/engines_page.h"

namespace tumble::report {

/// @param engine  "rd", "ca" or "tw"
/// @param n, w, h as above, all positive
/// @return integrations a simulated second, all bodies together; nothing for other engines
std::optional<double> modelled_integrations(const std::string& engine, double n, double w, double h);

/// Discontinuities a body and second, of one who takes each once (an engine that goes from event to event), else of the first. 0: nobody ran.
double discontinuities_a_body(const std::vector<EngineRow>& rows);

/// Integrations a simulated second against n: measured, with marks, and by the model at each size's own w.
Plot plot_of_model(const std::vector<std::vector<EngineRow>>& ladder);
/// The same as numbers: a row a size and engine, the last column measured over model.
Table table_of_model(const std::vector<std::vector<EngineRow>>& ladder);

}  // namespace tumble::report
