/// The faults of a run in words.
#pragma once

#include <string>
#include <vector>

#include "framework/trajectory/trajectory.h"

namespace tumble {

/// "link_open of 'wire', 161 where 1e-06 is allowed, first at t = 0.25 s, 12 times in all".
std::string in_words(const RunFault& fault);
/// All of them, separated by semicolons; empty where there is none.
std::string in_words(const std::vector<RunFault>& faults);

}  // namespace tumble
