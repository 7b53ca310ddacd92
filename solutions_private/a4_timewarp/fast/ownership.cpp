// Sites: the territories of both passes, and in which of them each body lies. Part of Coordinator.
#include <algorithm>
#include <numeric>

#include "solutions_private/a4_timewarp/fast/coordinator.h"
#include "solutions_private/a4_timewarp/fast/partition.h"

namespace tumble::a4 {
namespace {

constexpr std::uint64_t kEpochsPerPartition = 256;  // at most, because bodies move
constexpr std::uint64_t kEpochsToJudgeBy = 2;
// the busiest thread against the mean, from which regions are cut anew
constexpr double kUneven = 1.15;
constexpr double kFading = 0.5;  // weight of costs before the last partition

int leader_of(std::vector<int>& leaders, int body) {
  while (leaders[static_cast<std::size_t>(body)] != body)
    body = leaders[static_cast<std::size_t>(body)] =
        leaders[static_cast<std::size_t>(leaders[static_cast<std::size_t>(body)])];
  return body;
}

}  // namespace

// Between two epochs: assigns every body its site, and every event to the queue of its site.
void Coordinator::settle() {
  const bool is_uneven = unevenness() > kUneven && epochs_ - last_partition_ >= kEpochsToJudgeBy;
  if (epochs_ == 0 || is_uneven || epochs_ - last_partition_ >= kEpochsPerPartition) {
    repartition();
    last_partition_ = epochs_;
    for (const auto& worker : workers_) worker->work_load = 0.0;
  }
  ++epochs_;
  find_sites();
  if (all_.world().processes()) keep_processes_together();
  for (Domain& domain : all_.domains) domain.hull = {};
  all_.domains.front().hull = obstacles_;
  for (const int body : all_.world().movers()) {
    const Site& wanted = wanted_site_[static_cast<std::size_t>(body)];
    if (wanted != all_.site_of(body))
      change_site(body, wanted);
    else
      all_.domains[all_.domain_of(wanted)].hull.take_in(all_.domains.front().pairs.box(body));
  }
  hand_out();
}

// The work of the busiest thread against the mean, since the last partition.
double Coordinator::unevenness() const {
  double sum = 0.0, most_of_all = 0.0;
  for (int pass = 0; pass < passes(); ++pass) {
    double most = 0.0;
    for (int thread = 0; thread < all_.threads; ++thread) {
      double its = 0.0;
      for_each_worker(pass, thread, [&](const Worker& worker) { its += worker.work_load; });
      sum += its;
      most = std::max(most, its);
    }
    most_of_all += most;
  }
  return sum > 0 ? most_of_all * all_.threads / sum : 1.0;
}

void Coordinator::repartition() {
  std::vector<WorkLoad> work_loads;
  for (const int body : all_.world().movers()) {
    const Box& box = all_.domains.front().pairs.box(body);
    double& work_load = all_.work_loads[static_cast<std::size_t>(body)];
    if (box.low.allFinite() && box.high.allFinite()) work_loads.push_back({box, 1.0 + work_load});
    work_load *= kFading;
  }
  const auto cut = [this](std::size_t pass, const std::vector<Box>& boxes) {
    std::copy(boxes.begin(), boxes.end(), all_.territories[pass].begin() + 1);
  };
  cut(0, partition_space(work_loads, all_.regions));
  if (all_.slabs > 0) {
    std::vector<WorkLoad> crossing;
    for (const WorkLoad& work_load : work_loads)
      if (territory_that_holds(0, work_load.box_world) == kBoundary) crossing.push_back(work_load);
    cut(1, slabs_of_space(std::move(crossing), all_.slabs));
  }
  for (Domain& domain : all_.domains) {
    domain.region = all_space();
    for (std::size_t pass = 0; pass < kPasses; ++pass) {
      const Box& territory = all_.territories[pass][domain.site.territory[pass]];
      domain.region.low = domain.region.low.cwiseMax(territory.low);
      domain.region.high = domain.region.high.cwiseMin(territory.high);
    }
    if (&domain != &all_.domains.front())
      domain.queue.drain([this](const Due& due) { all_.domains.front().queue.push(due); });
  }
  // Sites are found anew below: until then every body belongs to the boundary, where boxes may lie
  // anywhere.
  for (const int body : all_.world().movers())
    if (all_.site_of(body) != Site{}) change_site(body, Site{});
}

std::uint8_t Coordinator::territory_that_holds(std::size_t pass, const Box& box) const {
  for (std::size_t k = 1; k < all_.territories[pass].size(); ++k)
    if (holds(all_.territories[pass][k], box)) return static_cast<std::uint8_t>(k);
  return kBoundary;
}

void Coordinator::find_sites() {
  for (const int body : all_.world().movers()) {
    const Box& box = all_.domains.front().pairs.box(body);
    Site& wanted = wanted_site_[static_cast<std::size_t>(body)];
    wanted = all_.site_of(body);
    for (std::size_t pass = 0; pass < kPasses; ++pass) {
      std::uint8_t& territory = wanted.territory[pass];
      if (territory == kBoundary || !holds(all_.territories[pass][territory], box))
        territory = territory_that_holds(pass, box);
    }
  }
}

// Bodies that share a segment, now or as far back as a rollback may go, share a site: one thread at
// a time computes a segment.
void Coordinator::keep_processes_together() {
  std::iota(leaders_.begin(), leaders_.end(), 0);
  for (const int body : all_.world().movers()) {
    const FlightHistory& flights = all_.histories[body];
    for (std::size_t k = 0; k < flights.size(); ++k) {
      if (flights[k].segment < 0) continue;
      for (const int member : all_.world().all_processes().segments().members(flights[k].segment)) {
        const int a = leader_of(leaders_, body), b = leader_of(leaders_, member);
        leaders_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
  }
  const auto wanted_of_leader = [&](int body) -> Site& {
    return wanted_site_[static_cast<std::size_t>(leader_of(leaders_, body))];
  };
  for (const int body : all_.world().movers())
    wanted_of_leader(body) =
        common(wanted_of_leader(body), wanted_site_[static_cast<std::size_t>(body)]);
  for (const int body : all_.world().movers())
    wanted_site_[static_cast<std::size_t>(body)] = wanted_of_leader(body);
}

void Coordinator::change_site(int body, const Site& site) {
  all_.enter(body, site, all_.domains.front().pairs.box(body));
  if (site.territory[0] != kBoundary)
    all_.last_region[static_cast<std::size_t>(body)] = site.territory[0];
}

// The queues of the first pass's boundary hold events that may now belong to a territory of that
// pass; what lies wrong in other queues is deferred when its turn comes. A body that waits in the
// boundary for an impact also advances there: advanced by another worker it would pass the impact.
void Coordinator::hand_out() {
  std::vector<Due> of_boundary;
  for (Domain& domain : all_.domains)
    if (domain.site.territory[0] == kBoundary)
      domain.queue.drain([&](const Due& due) { of_boundary.push_back(due); });
  for (const Due& due : of_boundary) {
    Domain& domain = all_.domain_of(due.key);
    domain.queue.push(due);
    if (domain.site.territory[0] != kBoundary || due.key.kind != StampKind::kCollision) continue;
    for (const int body : {due.key.body_a, due.key.body_b}) {
      if (!all_.can_move(body) || all_.site_of(body) == domain.site) continue;
      const int first = all_.first_member(body);
      LogicalProcess& waiting = all_.processes[static_cast<std::size_t>(first)];
      if (waiting.horizon <= due.key.time)
        domain.queue.push(
            {{waiting.horizon, kAfterAll, StampKind::kAdvance, first, -1}, ++waiting.version, 0});
    }
  }
}

}  // namespace tumble::a4
