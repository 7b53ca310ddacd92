/// The process that simulates: a run at the pace of a clock, on which a hand acts, streamed frame
/// by frame. It holds the user's own code; a crash or an endless loop ends this process and not the
/// one that serves the page.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "framework/engines/base/run_options.h"

namespace tumble::live {

/// What a ray has hit.
struct Hit {
  int body = -1;
  int face = -1;
  Vector3d point_world = unset_vector();  // [m]
};

struct Simulation {
  scene::Scene scene;
  Laws laws;
  engines::RunOptions options;  // engine set
  std::filesystem::path root;   // for models
  // moves of a timewarp while they are made; null: none
  std::shared_ptr<const VirtualTimes> times;
  std::string modules;  // in words, for people and for the command that runs it again
  double from_s = 0.0;  // frames before are neither sent nor waited for
  double speed = 1.0;   // seconds of the run in a second; infinite: as fast as it goes
  bool is_paused = false;
  // The first face that a ray hits, by the laws' ray function.
  // posed: the scene with bodies where they are now
  std::function<std::optional<Hit>(const scene::Scene& posed, const Ray& ray)> pick;
  // What the run has asked of each module so far, JSON: [{"id": "a1", "source": "student",
  // "functions": [["collision_impulse", 12], ...], "laws": ["collision_impulse", ...]}], where laws
  // are the functions that a run can ask at all; empty: not counted
  std::function<std::string()> asked;
};

/// Runs to the end, or until nobody reads or writes any more.
/// @param commands  a descriptor that gives one JSON object a line:
///   {"do": "pace", "speed": 1, "paused": false}, {"do": "step"},
///   {"do": "aim", "ray": [ox, oy, oz, dx, dy, dz]}: answered by a record kAimed,
///   {"do": "aim", "body": 0, "point_body_m": [x, y, z]}: the same without a ray,
///   {"do": "push", "force_n": [x, y, z], "duration_s": 0.2}: at the point that was aimed at,
///   {"do": "pull", "to_m": [x, y, z]}: a spring from that point, until {"do": "release"}
/// @param records   receives records.h
void simulate(Simulation& simulation, int commands, int records);

}  // namespace tumble::live
