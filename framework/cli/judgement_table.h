/// The judgement of a run as a table: quantity, value, tolerance, reason.
#pragma once

#include <string>
#include <vector>

#include "framework/engines/judging/judge.h"

namespace tumble::cli {

/// @return lines for people, each at most 110 columns wide; "" without checks
std::string judgement_table(const std::vector<engines::CheckResult>& checks);

}  // namespace tumble::cli
