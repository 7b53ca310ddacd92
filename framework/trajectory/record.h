/// The provenance of a run in one line, for pages, pictures and files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/trajectory/trajectory.h"

namespace tumble {

/// The parts that are not empty, separated by dots.
std::string joined_record(const std::vector<std::string>& parts);

/// "Tumble 0.1.0 (25ccc19a01)"; nothing where the version is not known.
std::string version_in_words(const std::string& version);
/// "scene gas 7f3a..., seed 11", with the first 16 digits of the digest.
std::string scene_in_words(const std::string& name, const std::string& digest,
                           const std::vector<std::uint64_t>& seeds);

/// "tumble run gas --n 40 · Tumble 0.1.0 (25ccc19a01) · scene gas gas n=40, seed 11"
std::string record_of(const TrajectoryInfo& info);

}  // namespace tumble
