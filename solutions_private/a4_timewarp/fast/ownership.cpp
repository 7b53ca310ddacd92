// Who looks after whom: territories, and the home of each body. Part of Conductor.
#include <algorithm>
#include <numeric>

#include "solutions_private/a4_timewarp/fast/conductor.h"
#include "solutions_private/a4_timewarp/fast/territories.h"

namespace tumble::a4 {
namespace {

constexpr std::uint64_t kRoundsACut = 256;  // at most: bodies wander
constexpr std::uint64_t kRoundsToJudgeBy = 2;
constexpr double kUneven = 1.15;            // the busiest thread against the mean: territories are cut anew
constexpr double kFading = 0.5;             // what burdens of before the last cut still count

int leader_of(std::vector<int>& leaders, int body) {
  while (leaders[static_cast<std::size_t>(body)] != body) body = leaders[static_cast<std::size_t>(body)] = leaders[static_cast<std::size_t>(leaders[static_cast<std::size_t>(body)])];
  return body;
}

}  // namespace

// Between two rounds: every body gets its home, every event the queue of whoever it is for.
void Conductor::settle() {
  double sum = 0.0, most = 0.0;
  for (int thread = 0; thread < all_.threads; ++thread) {
    double its = 0.0;
    for (std::size_t k = 1 + static_cast<std::size_t>(thread); k < workers_.size(); k += static_cast<std::size_t>(all_.threads)) its += workers_[k]->burden;
    sum += its;
    most = std::max(most, its);
  }
  const bool is_uneven = most * all_.threads > kUneven * sum && rounds_ - last_cut_ >= kRoundsToJudgeBy;
  if (rounds_ == 0 || is_uneven || rounds_ - last_cut_ >= kRoundsACut) {
    cut_territories();
    last_cut_ = rounds_;
    for (const auto& worker : workers_) worker->burden = 0.0;
  }
  ++rounds_;
  find_homes();
  if (all_.world().processes()) keep_processes_together();
  for (const int body : all_.world().movers()) {
    const std::size_t k = static_cast<std::size_t>(body);
    if (wanted_[k] != all_.home[k]) move_home(body, wanted_[k]);
  }
  hand_out();
}

void Conductor::cut_territories() {
  std::vector<Burden> burdens;
  for (const int body : all_.world().movers()) {
    const Box& box = all_.domains[all_.home[static_cast<std::size_t>(body)]].pairs.box(body);
    double& burden = all_.burdens[static_cast<std::size_t>(body)];
    if (box.low.allFinite() && box.high.allFinite()) burdens.push_back({0.5 * (box.low + box.high), 1.0 + burden});
    burden *= kFading;
  }
  const std::vector<Box> territories = cut_into_territories(std::move(burdens), all_.territories);
  for (std::size_t k = 1; k < all_.domains.size(); ++k) {
    all_.domains[k].territory = territories[k - 1];
    all_.domains[k].queue.drain([this](const Due& due) { all_.domains[kBorder].queue.push(due); });
  }
  // Homes are found anew below: until then everybody is at the border, where boxes may lie anywhere.
  for (const int body : all_.world().movers()) move_home(body, kBorder);
}

void Conductor::find_homes() {
  for (const int body : all_.world().movers()) {
    const std::size_t now = all_.home[static_cast<std::size_t>(body)];
    const Box& box = all_.domains[now].pairs.box(body);
    std::uint8_t wanted = kBorder;
    if (now != kBorder && holds(all_.domains[now].territory, box)) wanted = static_cast<std::uint8_t>(now);
    for (std::size_t k = 1; k < all_.domains.size() && wanted == kBorder; ++k)
      if (holds(all_.domains[k].territory, box)) wanted = static_cast<std::uint8_t>(k);
    wanted_[static_cast<std::size_t>(body)] = wanted;
  }
}

// Who shares a passage, now or as far back as anybody may go, shares a home: passages are worked out by one thread at a time.
void Conductor::keep_processes_together() {
  std::iota(leaders_.begin(), leaders_.end(), 0);
  for (const int body : all_.world().movers()) {
    const FlightHistory& flights = all_.histories[body];
    for (std::size_t k = 0; k < flights.size(); ++k) {
      if (flights[k].passage < 0) continue;
      for (const int member : all_.world().all_processes().passages().members(flights[k].passage)) {
        const int a = leader_of(leaders_, body), b = leader_of(leaders_, member);
        leaders_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
  }
  const auto wanted_of_leader = [&](int body) -> std::uint8_t& { return wanted_[static_cast<std::size_t>(leader_of(leaders_, body))]; };
  for (const int body : all_.world().movers())
    if (wanted_[static_cast<std::size_t>(body)] != wanted_of_leader(body)) wanted_of_leader(body) = kBorder;
  for (const int body : all_.world().movers()) wanted_[static_cast<std::size_t>(body)] = wanted_of_leader(body);
}

void Conductor::move_home(int body, std::uint8_t home) {
  std::uint8_t& now = all_.home[static_cast<std::size_t>(body)];
  if (now == home) return;
  const Box box = all_.domains[now].pairs.box(body);
  all_.domains[now].pairs.remove(body);
  all_.domains[home].pairs.set_box(body, box);
  now = home;
  if (home != kBorder) all_.last_territory[static_cast<std::size_t>(body)] = home;
}

// The border's queue holds what was the border's in the round before. A body that waits there for an impact goes on there too: on its own
// it would run past it.
void Conductor::hand_out() {
  std::vector<Due> border;
  all_.domains[kBorder].queue.drain([&](const Due& due) { border.push_back(due); });
  for (const Due& due : border) {
    const std::size_t home = all_.home_of(due.key);
    all_.domains[home].queue.push(due);
    if (home != kBorder || due.key.kind != EventClass::kCollision) continue;
    for (const int body : {due.key.body_a, due.key.body_b}) {
      if (!all_.world().can_move(body) || all_.home[static_cast<std::size_t>(body)] == kBorder) continue;
      const int first = all_.first_member(body);
      Process& waiting = all_.processes[static_cast<std::size_t>(first)];
      if (waiting.horizon <= due.key.time) all_.domains[kBorder].queue.push({{waiting.horizon, kAfterAll, EventClass::kAdvance, first, -1}, ++waiting.ticket, 0});
    }
  }
}

}  // namespace tumble::a4
