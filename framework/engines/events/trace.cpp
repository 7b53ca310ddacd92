#include "framework/engines/events/trace.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace tumble::engines {
namespace {

const char* word_of(EventKind kind) {
  switch (kind) {
    case EventKind::kCollision: return "collision";
    case EventKind::kRest: return "rest";
    case EventKind::kForceOn: return "force on";
    case EventKind::kForceOff: return "force off";
    case EventKind::kContact: return "contact";
    case EventKind::kBreak: return "end of contact";
    case EventKind::kStick: return "sticking";
    case EventKind::kSlide: return "sliding";
    case EventKind::kSleep: return "sleep";
    case EventKind::kWake: return "waking";
    case EventKind::kControl: return "control";
  }
  return "event";
}

bool same(const Event& x, const Event& y) {
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v); };
  return bits(x.time) == bits(y.time) && x.kind == y.kind && x.body_a == y.body_a &&
         x.body_b == y.body_b && bits(x.impulse) == bits(y.impulse);
}

std::string in_words(const Trajectory& run, std::size_t index) {
  if (index >= run.events.size())
    return run.stopped_by.empty() ? "nothing more"
                                  : "nothing more (it stopped: " + run.stopped_by + ")";
  const Event& event = run.events[index];
  const auto name = [&](int body) {
    return body < 0 ? std::string("-")
                    : "'" + run.bodies[static_cast<std::size_t>(body)].name + "'";
  };
  return fmt::format("{} of {} and {} at t = {:.17g} s, impulse {:.17g} N s", word_of(event.kind),
                     name(event.body_a), name(event.body_b), event.time, event.impulse);
}

// The likely kind of error, where the two events show it.
std::string likely(const Trajectory& reference, const Trajectory& run, std::size_t index) {
  if (index >= run.events.size()) return "an event was lost";
  if (index > 0 && run.events[index].time < run.events[index - 1].time)
    return "it was committed after a later one: global virtual time ran ahead";
  if (index >= reference.events.size())
    return "an event that should have been rolled back was committed";
  const Event &expected = reference.events[index], &found = run.events[index];
  const auto is_found_in = [](const Trajectory& there, std::size_t from, const Event& event) {
    const std::size_t until = std::min(there.events.size(), from + 50);
    for (std::size_t k = from; k < until; ++k)
      if (same(there.events[k], event)) return true;
    return false;
  };
  if (expected.body_a == found.body_a && expected.body_b == found.body_b &&
      expected.time == found.time)
    return "the same impact from other velocities: a body had a state that had been rolled back";
  if (is_found_in(run, index, expected))
    return "an event is too early or should not exist: an event was not rolled back";
  return "an event was lost, or was executed with a state that had been rolled back";
}

}  // namespace

std::uint64_t trace_hash(const Trajectory& run) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&](std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte)
      hash = (hash ^ ((word >> (8 * byte)) & 0xff)) * 0x100000001b3ULL;
  };
  for (const Event& event : run.events) {
    add(std::bit_cast<std::uint64_t>(event.time));
    add(static_cast<std::uint64_t>(event.kind));
    add((static_cast<std::uint64_t>(static_cast<std::uint32_t>(event.body_a)) << 32) |
        static_cast<std::uint32_t>(event.body_b));
    add(std::bit_cast<std::uint64_t>(event.impulse));
  }
  return hash;
}

std::optional<TraceDifference> compare_traces(const Trajectory& reference, const Trajectory& run) {
  const std::size_t both = std::min(reference.events.size(), run.events.size());
  std::size_t index = 0;
  while (index < both && same(reference.events[index], run.events[index])) ++index;
  if (index == reference.events.size() && index == run.events.size()) return std::nullopt;
  double time =
      index < reference.events.size() ? reference.events[index].time : run.events[index].time;
  if (index < both) time = std::min(time, run.events[index].time);
  return TraceDifference{
      index, time,
      fmt::format("event {} of the committed trace: expected {}; found {} ({})", index + 1,
                  in_words(reference, index), in_words(run, index), likely(reference, run, index))};
}

}  // namespace tumble::engines
