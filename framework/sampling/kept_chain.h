/// A chain as text and back, bit for bit: for a process that makes it and another that reads it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/sampling/chains.h"

namespace tumble::sampling {

std::string text_of(const Chain& chain);
/// @throws UserError where the text is not that of a chain
Chain chain_of(std::string_view text);

/// A table of all samples, one a row: chain (from 1), step (from 1), the numbers by name, ln of the
/// target, violation. Without times: the same chains give the same bytes.
std::string csv_of(const std::vector<std::string>& names, const std::vector<Chain>& chains);

}  // namespace tumble::sampling
