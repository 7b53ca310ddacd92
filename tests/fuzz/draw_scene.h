/// Scenes drawn from one number, as JSON that `tumble run FILE` takes: every shape and every effect of the schema, sizes from 1 mm to
/// 100 m, masses from 1e-3 to 1e4 kg, speeds up to 1000 m/s, bodies that start apart, in a heap, or touching.
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

namespace tumble::fuzz {

using Json = nlohmann::ordered_json;

struct DrawOptions {
  bool quick = false;      // at most four bodies and 60 steps: for the sample that runs with every change
  bool all_engines = false; // nothing that an engine refuses by name: no sleep
};

/// The same number gives the same scene on every machine.
Json draw_scene(std::uint64_t number, const DrawOptions& options = {});

}  // namespace tumble::fuzz
