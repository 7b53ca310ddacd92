// Ownership: regions, and the owner of each body. Part of Coordinator.
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

// Between two epochs: assigns every body its owner, and every event to the queue of its owner.
void Coordinator::settle() {
  double sum = 0.0, most = 0.0;
  for (int thread = 0; thread < all_.threads; ++thread) {
    double its = 0.0;
    for (std::size_t k = 1 + static_cast<std::size_t>(thread); k < workers_.size();
         k += static_cast<std::size_t>(all_.threads))
      its += workers_[k]->work_load;
    sum += its;
    most = std::max(most, its);
  }
  const bool is_uneven =
      most * all_.threads > kUneven * sum && epochs_ - last_partition_ >= kEpochsToJudgeBy;
  if (epochs_ == 0 || is_uneven || epochs_ - last_partition_ >= kEpochsPerPartition) {
    repartition();
    last_partition_ = epochs_;
    for (const auto& worker : workers_) worker->work_load = 0.0;
  }
  ++epochs_;
  find_owners();
  if (all_.world().processes()) keep_processes_together();
  for (const int body : all_.world().movers()) {
    const std::size_t k = static_cast<std::size_t>(body);
    if (wanted_owner_[k] != all_.owner[k]) change_owner(body, wanted_owner_[k]);
  }
  hand_out();
}

void Coordinator::repartition() {
  std::vector<WorkLoad> work_loads;
  for (const int body : all_.world().movers()) {
    const Box& box = all_.domains[all_.owner[static_cast<std::size_t>(body)]].pairs.box(body);
    double& work_load = all_.work_loads[static_cast<std::size_t>(body)];
    if (box.low.allFinite() && box.high.allFinite())
      work_loads.push_back({0.5 * (box.low + box.high), 1.0 + work_load});
    work_load *= kFading;
  }
  const std::vector<Box> regions = partition_space(std::move(work_loads), all_.regions);
  for (std::size_t k = 1; k < all_.domains.size(); ++k) {
    all_.domains[k].region = regions[k - 1];
    all_.domains[k].queue.drain(
        [this](const Due& due) { all_.domains[kBoundary].queue.push(due); });
  }
  // Owners are found anew below: until then every body belongs to the boundary, where boxes may lie
  // anywhere.
  for (const int body : all_.world().movers()) change_owner(body, kBoundary);
}

void Coordinator::find_owners() {
  for (const int body : all_.world().movers()) {
    const std::size_t now = all_.owner[static_cast<std::size_t>(body)];
    const Box& box = all_.domains[now].pairs.box(body);
    std::uint8_t wanted = kBoundary;
    if (now != kBoundary && holds(all_.domains[now].region, box))
      wanted = static_cast<std::uint8_t>(now);
    for (std::size_t k = 1; k < all_.domains.size() && wanted == kBoundary; ++k)
      if (holds(all_.domains[k].region, box)) wanted = static_cast<std::uint8_t>(k);
    wanted_owner_[static_cast<std::size_t>(body)] = wanted;
  }
}

// Bodies that share a segment, now or as far back as a rollback may go, share an owner: one thread
// at a time computes a segment.
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
  const auto wanted_of_leader = [&](int body) -> std::uint8_t& {
    return wanted_owner_[static_cast<std::size_t>(leader_of(leaders_, body))];
  };
  for (const int body : all_.world().movers())
    if (wanted_owner_[static_cast<std::size_t>(body)] != wanted_of_leader(body))
      wanted_of_leader(body) = kBoundary;
  for (const int body : all_.world().movers())
    wanted_owner_[static_cast<std::size_t>(body)] = wanted_of_leader(body);
}

void Coordinator::change_owner(int body, std::uint8_t owner) {
  std::uint8_t& now = all_.owner[static_cast<std::size_t>(body)];
  if (now == owner) return;
  const Box box = all_.domains[now].pairs.box(body);
  all_.domains[now].pairs.remove(body);
  all_.domains[owner].pairs.set_box(body, box);
  now = owner;
  if (owner != kBoundary) all_.last_region[static_cast<std::size_t>(body)] = owner;
}

// The boundary's queue holds the events that the boundary owned in the last epoch. A body that
// waits there for an impact also advances there: advanced by another worker it would pass the
// impact.
void Coordinator::hand_out() {
  std::vector<Due> boundary;
  all_.domains[kBoundary].queue.drain([&](const Due& due) { boundary.push_back(due); });
  for (const Due& due : boundary) {
    const std::size_t owner = all_.owner_of(due.key);
    all_.domains[owner].queue.push(due);
    if (owner != kBoundary || due.key.kind != StampKind::kCollision) continue;
    for (const int body : {due.key.body_a, due.key.body_b}) {
      if (!all_.world().can_move(body) || all_.owner[static_cast<std::size_t>(body)] == kBoundary)
        continue;
      const int first = all_.first_member(body);
      LogicalProcess& waiting = all_.processes[static_cast<std::size_t>(first)];
      if (waiting.horizon <= due.key.time)
        all_.domains[kBoundary].queue.push(
            {{waiting.horizon, kAfterAll, StampKind::kAdvance, first, -1}, ++waiting.version, 0});
    }
  }
}

}  // namespace tumble::a4
