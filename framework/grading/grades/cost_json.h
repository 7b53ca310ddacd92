/// The section on the cost of accuracy as JSON: a record keeps it, so that a page can be rewritten
/// without measuring again.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "framework/grading/grades/cost_section.h"

namespace tumble::grading {

nlohmann::ordered_json cost_json(const CostSection& cost);
/// The inverse.
/// @throws nlohmann::json::exception for anything else
CostSection cost_of(const nlohmann::ordered_json& json);

}  // namespace tumble::grading
