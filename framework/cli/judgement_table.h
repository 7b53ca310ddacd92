/// The judgement of a run as a table: quantity, found, allowed, why.
#pragma once

#include <string>
#include <vector>

#include "framework/engines/judging/judge.h"

namespace tumble::cli {

/// @return lines for people, each at most 110 columns wide; "" where nothing was judged
std::string judgement_table(const std::vector<engines::CheckResult>& checks);

}  // namespace tumble::cli
