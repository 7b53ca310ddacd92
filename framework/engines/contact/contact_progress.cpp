#include "framework/engines/contact/contact_progress.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/contact/contact_constants.h"

namespace tumble::engines {
namespace {

constexpr const char* kLeaveRoom = "what drives them together (\"motion\") must leave them room";

}  // namespace

// Driven bodies that touch the island: what they do does not depend on what resists them.
std::vector<int> ContactProgress::driven_against(const ContactIsland& island) const {
  std::vector<int> driven;
  for (const auto& pair : island.pairs)
    for (const int body : {pair.first, pair.second})
      if (moving_.is_driven(body) && std::find(driven.begin(), driven.end(), body) == driven.end())
        driven.push_back(body);
  return driven;
}

void ContactProgress::require_room(const ContactIsland& island, double residual) {
  if (!(residual > kContact.jammed)) return;
  const std::vector<int> driven = driven_against(island);
  if (driven.empty()) return;
  if (std::exchange(memory_.jammed_at, moving_.time()) != moving_.time()) memory_.jams = 0;
  if (++memory_.jams <= kContact.most_jams) return;
  throw StoppedRun(fmt::format(
      "{} cannot give way to {}: what their contacts ask for together stays unsolved, also in "
      "shorter parts of a step of {:.3g} s; {}",
      names_of(moving_.world(), island.bodies), names_of(moving_.world(), driven),
      memory_.longest_step, kLeaveRoom));
}

void ContactProgress::require(const std::vector<ContactIsland>& islands) {
  const double t = moving_.time();
  if (!(memory_.cut_since <= t && t < memory_.cut_since + memory_.longest_step)) {
    memory_.cut_since = t;
    memory_.cuts = 0;
    memory_.sweeps = 0;
  }
  ++memory_.cuts;
  const auto asked = std::find_if(islands.begin(), islands.end(), [&](const ContactIsland& island) {
    return std::binary_search(island.bodies.begin(), island.bodies.end(), memory_.asked_last);
  });
  const auto names = [&] {
    return asked == islands.end() ? std::string("bodies")
                                  : names_of(moving_.world(), asked->bodies);
  };
  const char* const remedy =
      asked != islands.end() && !driven_against(*asked).empty()
          ? kLeaveRoom
          : "masses or sizes that differ less, or a shorter \"step_s\", may help";
  if (memory_.sweeps > kContact.most_sweeps_a_step)
    throw StoppedRun(fmt::format(
        "{}: what their contacts, rods and joints ask for together stays unsolved, also in the "
        "shortest parts of a step of {:.3g} s. They may contradict each other; {}",
        names(), memory_.longest_step, remedy));
  if (memory_.cuts > kMostIdleSteps * static_cast<long>(moving_.size()))
    throw StoppedRun(
        fmt::format("{}: their contacts ask for more than {} steps within one of {:.3g} s; {}",
                    names(), memory_.cuts - 1, memory_.longest_step, remedy));
}

}  // namespace tumble::engines
