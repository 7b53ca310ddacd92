/// How much may happen while time stands still, or nearly so, before a run is stopped with words:
/// what goes on for ever looks like a hang.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "framework/dynamics/world.h"

namespace tumble::engines {

/// In a row without progress of time.
inline constexpr int kMostIdleSteps = 1000;

/// Of the step: a pair that meets again sooner than this, and more slowly than the restitution
/// threshold, is separated (micro-collisions, Mirtich 1996).
inline constexpr double kMicroInterval = 0.01;

/// Impacts in a step of a world of so many bodies: more are a Zeno sequence. A ball between walls a
/// nanometre apart meets them 1,000 times in 2 us.
inline constexpr long most_impacts(int bodies) { return 500L * bodies; }

/// Events at one instant, each caused by the last: an impact passes through a chain of touching
/// bodies in as many as it has. A timewarp looks at all that a body flew at its instant, so the
/// price of finding out goes with the square.
inline constexpr std::uint32_t most_microsteps(int bodies) {
  return 1000 + 10 * static_cast<std::uint32_t>(bodies);
}

/// The end of a message that time stands still, in a world with driven bodies.
inline const char* room_beside_driven(const World& world) {
  const bool is_any_driven =
      std::any_of(world.bodies.begin(), world.bodies.end(),
                  [](const WorldBody& b) { return b.immovable() && is_driven(b.motion); });
  return is_any_driven ? "; what drives bodies together (\"motion\") must leave them room" : "";
}

/// What a scene needs where bodies meet again and again in no time.
inline const char* room_for_contact(const World& world) {
  return world.contact ? "a larger \"rest_speed_m_s\" is needed"
                       : "bodies that lie or slide on each other need \"contact\": {} in the "
                         "scene; or a larger \"rest_speed_m_s\" is needed";
}

/// @param bodies  names, as "bodies 'a' and 'b'"
inline std::string endless_impacts_message(double time, const std::string& bodies,
                                           const World& world) {
  return fmt::format(
      "at t = {:.6f} s, {}: time stands still, they meet again and again; {}; or, where so many "
      "impacts in a step are right, a shorter \"step_s\"{}",
      time, bodies, room_for_contact(world), room_beside_driven(world));
}

}  // namespace tumble::engines
