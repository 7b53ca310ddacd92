/// Tar archives, written (POSIX.1-1988, "ustar").
#pragma once

#include <string>
#include <vector>

#include "framework/core/zip.h"

namespace tumble {

/// The same members give the same bytes: no times, owner 0.
/// @pre  names of at most 100 bytes
std::string tar_of(const std::vector<ZipMember>& members);

}  // namespace tumble
