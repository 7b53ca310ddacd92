#include "tests/bench/engine_profiles.h"

#include <algorithm>

#include <fmt/format.h>

namespace tumble::testing {

report::StackedBars bars_of(const std::string& title,
                            const std::vector<std::pair<std::string, const Measured*>>& runs,
                            const std::string& caption) {
  report::StackedBars bars;
  bars.title = title;
  bars.axis = {"share of the time", "%"};
  bars.caption = caption;
  for (const auto& [name, run] : runs) {
    if (run->shares.samples == 0) continue;
    if (bars.parts.empty())
      for (const auto& [part, share] : run->shares.parts) bars.parts.push_back(part);
    report::StackedBars::Row row{fmt::format("{}, {:.3g} s", name, run->seconds), {}};
    for (const auto& [part, share] : run->shares.parts) row.values.push_back(100.0 * share);
    bars.rows.push_back(std::move(row));
  }
  return bars;
}

std::string why(const Measured& tw, const Measured& best) {
  if (tw.shares.samples == 0) return "TW too short for a profile";
  return fmt::format(
      "TW: {}; {:.0f} % is physics, so with a scheduler that cost nothing it would be {:.3g}",
      engines::in_words(tw.shares), 100 * tw.shares.physics,
      best.seconds / (tw.seconds * tw.shares.physics));
}

std::string a_collision_of(const Measured& tw) {
  const double collisions = std::max<double>(1.0, static_cast<double>(tw.tally.collisions)),
               us = 1e6 * tw.seconds / collisions;
  std::string words =
      fmt::format("a collision takes {:.2f} integrations, {:.1f} pair checks, {:.1f} us",
                  tw.count("integrations") / collisions, tw.count("pair_checks") / collisions, us);
  for (const auto& [part, share] : tw.shares.parts)
    if (share >= 0.05) words += fmt::format(", {} {:.1f}", part, share * us);
  return words;
}

std::string threads_of(const Measured& two) {
  const auto spent = [&](const char* stage) {
    return two.tally.stages.at(stage) - two.building.stages.at(stage);
  };
  const double together = spent("threads_together"), alone = spent("thread_alone");
  return fmt::format(
      "{:.0f} rounds; of {:.3g} s by the clock the busiest thread of each works {:.0f} %, one "
      "alone {:.0f} %, {:.0f} % are waiting (threads that meet, other programs)",
      two.count("rounds_of_threads"), two.seconds, 100 * together / two.seconds,
      100 * alone / two.seconds, 100 * std::max(0.0, 1.0 - (together + alone) / two.seconds));
}

}  // namespace tumble::testing
