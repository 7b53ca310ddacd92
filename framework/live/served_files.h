/// The files that pages load: the page itself, its parts, handouts.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "framework/live/server.h"

namespace tumble::live {

/// @param handout  a page by its name; empty: none
/// @return nothing where there is no such file
std::optional<Served> served_file(const std::string& path,
                                  const std::function<std::string(const std::string&)>& handout);

}  // namespace tumble::live
