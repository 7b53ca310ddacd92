/// Random scenes from one number, as JSON for `tumble run FILE`: every shape and every effect of
/// the schema, sizes from 1 mm to 100 m, masses from 1e-3 to 1e4 kg, velocities up to 1000 m/s,
/// bodies that start apart, in a pile, or in contact.
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

namespace tumble::fuzz {

using Json = nlohmann::ordered_json;

struct DrawOptions {
  bool quick = false;  // at most four bodies and 60 steps: for the sample of the regular tests
  bool all_engines = false;  // without entries that an engine refuses: no sleep
};

/// The same number gives the same scene on every machine.
Json draw_scene(std::uint64_t number, const DrawOptions& options = {});

}  // namespace tumble::fuzz
