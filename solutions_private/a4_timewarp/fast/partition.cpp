#include "solutions_private/a4_timewarp/fast/territories.h"

#include <algorithm>
#include <limits>
#include <span>

namespace tumble::a4 {
namespace {

using engines::Box;

constexpr int kBodiesATerritory = 6000;   // measured on a gas of 10^5 balls: 3,000 and 12,000 are slower by a tenth, one territory by a third
constexpr int kMostTerritories = 64;

void cut(std::span<Burden> burdens, const Box& room, int count, std::vector<Box>& territories) {
  if (count == 1) return territories.push_back(room);
  Box around;
  double all = 0.0;
  for (const Burden& burden : burdens) {
    around.take_in({burden.middle_world, burden.middle_world});
    all += burden.work;
  }
  int axis = 0;
  double place = 0.0;
  std::size_t below = 0;
  const int left = count / 2;
  if (!burdens.empty()) {
    (around.high - around.low).maxCoeff(&axis);
    std::sort(burdens.begin(), burdens.end(), [axis](const Burden& a, const Burden& b) { return a.middle_world[axis] < b.middle_world[axis]; });
    double sum = 0.0;
    while (below + 1 < burdens.size() && sum + 0.5 * burdens[below].work < all * left / count) sum += burdens[below++].work;
    place = below > 0 ? 0.5 * (burdens[below - 1].middle_world[axis] + burdens[below].middle_world[axis]) : burdens[0].middle_world[axis];
  }
  place = std::clamp(place, room.low[axis], room.high[axis]);
  Box lower = room, upper = room;
  lower.high[axis] = upper.low[axis] = place;
  cut(burdens.subspan(0, below), lower, left, territories);
  cut(burdens.subspan(below), upper, count - left, territories);
}

}  // namespace

int territories_for(const engines::FlightWorld& world, const engines::RunOptions& options) {
  const engines::TimewarpTrial& trial = options.trial;
  if (trial.territories > 0) return std::max(trial.territories, options.threads);
  const bool is_of_one_queue = trial.disorder_s > 0 || trial.rollback_every > 0 || trial.late_callbacks;
  if (is_of_one_queue || world.processes()) return options.threads;
  const int wanted = std::min(kMostTerritories, static_cast<int>(world.movers().size()) / kBodiesATerritory);
  return std::max(1, wanted / options.threads) * options.threads;
}

std::vector<Box> cut_into_territories(std::vector<Burden> burdens, int count) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  std::vector<Box> territories;
  cut(burdens, {Vector3d::Constant(-kEnd), Vector3d::Constant(kEnd)}, count, territories);
  return territories;
}

}  // namespace tumble::a4
