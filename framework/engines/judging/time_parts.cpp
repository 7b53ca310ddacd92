#include "framework/engines/judging/time_parts.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

namespace tumble::engines {

const std::vector<StackSamples::Part>& time_parts() {
  static const std::vector<StackSamples::Part> parts = {
      {"contacts",
       {"tumble::solve_contacts", "tumble::contacts::", "tumble::engines::PersistentContacts::",
        "tumble::engines::ContactModes::"}},
      {"links and forces", {"tumble::engines::LinkedBodies::", "tumble::a3::"}},
      {"motion",
       {"tumble::engines::MovingWorld::", "tumble::FreeRotation::", "tumble::SpinSeries::",
        "tumble::engines::SmoothPath::", "tumble::a2::"}},
      {"impacts",
       {"tumble::engines::SequentialImpacts::", "tumble::engines::FlightImpactResponse::",
        "tumble::a1::"}},
      {"search for impacts",
       {"tumble::collision::", "tumble::engines::find_impact",
        "tumble::engines::FlightImpactDetection::", "tumble::engines::ImpactDetection::"}},
      {"pairs that may meet",
       {"tumble::collision::overlapping_pairs", "tumble::collision::NearBoxes::",
        "tumble::engines::ActivePairs::", "tumble::engines::ImpactDetection::candidates"}},
  };
  return parts;
}

const std::vector<std::string>& set_up_functions() {
  static const std::vector<std::string> functions = {
      "tumble::build_world", "tumble::engines::FlightWorld::FlightWorld",
      "tumble::engines::FlightRun::FlightRun", "tumble::engines::ImpactDetection::ImpactDetection",
      "tumble::engines::ImpactDetection::refuse_overlap"};
  return functions;
}

TimeShares time_shares(const StackSamples& samples) {
  const StackSamples::Shares found = samples.shares(time_parts(), set_up_functions());
  TimeShares shares;
  shares.samples = found.samples;
  for (std::size_t k = 0; k < time_parts().size(); ++k)
    shares.parts.emplace_back(time_parts()[k].name, found.of_part[k]);
  shares.parts.emplace_back("scheduling", found.rest);
  shares.physics =
      std::accumulate(found.of_part.begin(), found.of_part.begin() + kPhysicsParts, 0.0);
  return shares;
}

std::string in_words(const TimeShares& shares) {
  constexpr double kLeast = 0.05;
  if (shares.samples == 0) return "";
  auto parts = shares.parts;
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& x, const auto& y) { return x.second > y.second; });
  std::string words;
  for (const auto& [name, share] : parts)
    if (share >= kLeast)
      words += fmt::format("{}{} {:.0f} %", words.empty() ? "" : ", ", name, 100.0 * share);
  return words;
}

}  // namespace tumble::engines
