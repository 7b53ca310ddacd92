/// Output of verbs for other programs.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "framework/cli/command.h"

namespace tumble::cli {

/// The text of a page, indented. Bytes that are no UTF-8 are replaced: names and command lines may
/// hold some.
std::string json_text(const nlohmann::ordered_json& page, int indent);

/// Prints one object on stdout: the command, the version, then `parts`. Bytes that are no UTF-8 are
/// replaced.
void print_json(const Command& command, const nlohmann::ordered_json& parts);

}  // namespace tumble::cli
