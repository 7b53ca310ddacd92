/// What of a made assignment is still as it was made: places marked "(to be written: ...)", and
/// expected values that nobody has worked out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::extend {

struct Unwritten {
  std::string place;  // "tests/a5_plausible/plausible_test.cpp:12"
  std::string what;   // the line, without blanks around it
};

/// @param folder  "a5_plausible"
/// @return in the order in which they are best written: header, reference, tests, the rest
std::vector<Unwritten> unwritten_of(const std::filesystem::path& root, const std::string& folder);

}  // namespace tumble::extend
