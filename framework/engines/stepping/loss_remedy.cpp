#include "framework/engines/stepping/loss_remedy.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "framework/dynamics/stopped_run.h"
#include "framework/effects/registry.h"
#include "framework/engines/stepping/stability.h"

namespace tumble::engines {
namespace {

/// What acts on the bodies of a part beside what acts on all bodies.
struct PartLinks {
  bool are_springs = false;
  int holding = 0;       // rods and joints
  bool are_any = false;  // forces of effects that name a body, too
};

PartLinks links_of(const std::vector<int>& bodies, const World& world) {
  PartLinks links;
  const auto is_among = [&](int body) {
    return std::binary_search(bodies.begin(), bodies.end(), body);
  };
  for (const effects::Effect* effect : effects::all())
    for (int entry = 0; entry < effect->count_in(world); ++entry) {
      const std::vector<int> ends = effect->bodies_of(world, entry);
      if (std::none_of(ends.begin(), ends.end(), is_among)) continue;
      links.are_any = true;
      if (effect->traits().constrains) ++links.holding;
      if (effect->traits().stores_energy) links.are_springs = true;
    }
  return links;
}

/// Of the energy of a swing, what steps of the method leave of it after a time.
double kept_after(double time, double frequency, const Laws& laws, double step) {
  return std::pow(amplification(laws, frequency, 0.0, step), 2.0 * time / step);
}

/// The largest step that keeps the fastest swing of springs; nothing where the step of the run
/// does, and it is not by damping that energy is lost.
std::optional<double> step_that_keeps_swings(const World& world, const Laws& laws, double time,
                                             double step) {
  constexpr double kLeast = 1.0 - 0.5 * kEnergyLost;
  constexpr int kHalvings = 20;
  const auto springs = judge_springs(world, laws, step);
  if (!springs || springs->is_overdamped()) return std::nullopt;
  const auto keeps = [&](double h) {
    return kept_after(time, springs->angular_frequency, laws, h) >= kLeast;
  };
  if (keeps(step)) return std::nullopt;
  double too_long = step, keeping = step;
  for (int i = 0; i < kHalvings && !keeps(keeping); ++i) {
    too_long = keeping;
    keeping *= 0.5;
  }
  if (!keeps(keeping)) return std::nullopt;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (keeping + too_long);
    (keeps(middle) ? keeping : too_long) = middle;
  }
  return keeping;
}

}  // namespace

double order_of_damping(const Laws& laws) {
  constexpr double kRadian = 0.4;  // well within the range of methods, and far above rounding
  const double lost = 1.0 - amplification(laws, 1.0, 0.0, kRadian),
               lost_by_half = 1.0 - amplification(laws, 1.0, 0.0, 0.5 * kRadian);
  if (!(lost > kNegligible) || !(lost_by_half > 0.0)) return kOrderOfMethods;
  // twice as many steps in the same time
  return std::clamp(std::log2(lost / lost_by_half) - 1.0, 1.0, kOrderOfMethods);
}

RunWatch::Size told_of_loss(const LostEnergy& loss, const World& world, const Laws& laws,
                            double step) {
  const PartLinks links = links_of(loss.bodies, world);
  RunWatch::Size told{loss.lost / loss.whole, kEnergyLost, loss.time, step,
                      kOrderOfMethods,        loss.whole};
  if (loss.is_at_contacts) {
    told.order = kOrderAtContacts;
    told.meaning =
        "what rolls or rests loses no energy, and what slides or lands no more than friction and "
        "the landing take: the rest is lost by the step";
    return told;
  }
  if (loss.is_by_sleep) {
    told.step = 0.0;  // none helps
    told.meaning =
        "what falls asleep stands still from then on: these bodies were slow enough for it, and "
        "not at rest";
    told.remedy = "\"sleep\": false in the scene's \"contact\", or a smaller \"rest_speed_m_s\"";
    return told;
  }
  try {
    told.order = order_of_damping(laws);
    if (links.are_springs)
      if (const auto mending = step_that_keeps_swings(world, laws, loss.watched, step))
        told.mending_step = *mending;
  } catch (const StoppedRun&) {
    // A law that takes whole bodies only: the size of the loss has to do.
  }
  const bool is_of_low_order = told.order < kOrderOfMethods;
  if (links.holding > 0) told.order = std::min(told.order, kOrderOfLinks);
  if (loss.is_sudden) told.order = kOrderAtContacts;
  if (links.holding > 0 && world.coordinates == scene::Coordinates::kReduced)
    told.first_remedy = "--coordinates maximal, or ";
  else if (links.holding > 0 && links.holding <= static_cast<int>(loss.bodies.size()))
    told.remedy = "--coordinates reduced";
  else if (is_of_low_order)
    told.remedy = "a method of a higher order (a2's rk4_step)";
  else if (links.are_springs && links.holding == 0)
    told.remedy = "softer springs";
  else if (loss.bodies.size() == 1 && !links.are_any)
    told.remedy = "--propagator auto where nothing but gravity acts";
  return told;
}

}  // namespace tumble::engines
