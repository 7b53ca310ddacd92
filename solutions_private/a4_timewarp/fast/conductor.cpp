#include "solutions_private/a4_timewarp/fast/conductor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/numbers.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/engines/timewarp/flight_boxes.h"
#include "solutions_private/a4_timewarp/fast/fast_timewarp.h"

namespace tumble::a4 {
namespace {

constexpr std::size_t kCommitAfter = 512;      // events worked at before global virtual time is looked at again
constexpr std::size_t kForgetAfter = 1;        // going on of each body, likewise: what passages keep should stay in the nearer caches
constexpr int kMostThreads = 64;
constexpr int kTerritoryIds = std::numeric_limits<std::uint8_t>::max();   // Shared::home; the border is one more
constexpr int kFewestStates = 8;               // a passage keeps two steps behind what is certain, and one that is looked at

// Bounded optimism: the window grows and shrinks so that 5 to 15 % of the integrations are undone.
constexpr double kTooMuchUndone = 0.15, kTooLittleUndone = 0.05, kWiden = 1.3, kNarrow = 0.75;
constexpr std::uint64_t kIntegrationsToJudgeBy = 2000;
constexpr double kWidest = 2.0, kNarrowest = 1.0 / 64;   // of the first window
constexpr double kWindowSteps = 2.0;           // of several threads, the first window: of the time in which a process goes its way at once
constexpr double kWindowAlone = 2.0;           // of one thread, which is unbounded until too much is undone: of that window
constexpr double kRound = 0.25;                // of the window is a round: at its end processes have gone their ways, not been cut short
constexpr double kMostInARound = 2.0;          // integrations a body
constexpr double kRoundAlone = 0.125;          // of one thread with several territories: longer rounds find more pairs, shorter ones look at each territory more often

}  // namespace

Conductor::Conductor(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record, const engines::RollbackWatch* watch)
    : all_(scene, laws, options, sink), record_(record), watch_(watch), commit_at_(kCommitAfter), wanted_(all_.home), leaders_(all_.home.size()) {
  const FlightWorld& world = all_.world();
  const double bin = bin_for(world, all_.lengths.way, all_.run.duration());
  const std::size_t domains = all_.territories > 1 ? static_cast<std::size_t>(all_.territories) + 1 : 1;
  const int all_bodies = world.size(), a_territory = 2 * all_bodies / all_.territories;
  all_.domains.reserve(domains);
  for (std::size_t k = 0; k < domains; ++k) {
    all_.domains.emplace_back(all_.boxes, static_cast<int>(k), k == kBorder ? all_bodies : a_territory, all_.lengths, k == kBorder ? bin : bin * all_.territories);
    workers_.push_back(std::make_unique<Worker>(all_, k));
  }
  if (domains > 1) all_.burdens.assign(static_cast<std::size_t>(world.size()), 0.0);
  all_.is_recorded = record_ != nullptr;
  for (const int i : world.movers()) {
    if (record_) record_->processes.push_back(world.world().bodies[i].name);
    all_.histories.push(i, world.first_flight(i));
    ++alone().kept;
  }
  for (const int i : world.obstacles()) enter_obstacle(i);
  first_window_ = first_window();
}

void Conductor::enter_obstacle(int i) {
  const FlightWorld& world = all_.world();
  all_.processes[static_cast<std::size_t>(i)].horizon = kInfinity;
  if (world.is_half_space(i)) return all_.planes.push_back(i);
  all_.domains[kBorder].pairs.set_box(i, engines::box_of_immovable(world, i, all_.run.duration()));
}

void Conductor::run() {
  std::string stopped_by;
  try {
    begin();
    if (all_.territories > 1) go_in_rounds();
    else go_alone();
    commit_before(kInfinity);
    check_nothing_leaked();
  } catch (const engines::StoppedRun& stop) {
    stopped_by = stop.what();
  }
  try {   // what came before is certain, and kept
    if (working_at_) commit_before(*working_at_);
  } catch (const engines::StoppedRun& stop) {
    stopped_by = stop.what();
  }
  end(stopped_by);
}

void Conductor::begin() {
  std::vector<int> order = all_.world().movers();
  if (all_.trial.shuffle) {
    Random random(all_.trial.seed);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  }
  alone().now = 0.0;
  all_.called.assign(all_.run.callbacks().size(), false);
  for (const EventKey& callback : all_.run.callbacks()) alone().expect_callback(callback);
  for (const int body : order)
    if (all_.first_member(body) == body) alone().begin(body);
  alone().now = kInfinity;
  // What going on for the first time has cost is what the time that it covers costs.
  if (all_.territories > 1)
    for (const int body : order) all_.burdens[static_cast<std::size_t>(body)] *= first_window_ / std::max(all_.processes[static_cast<std::size_t>(body)].horizon, 1e-3 * first_window_);
}

// ---- One thread --------------------------------------------------------------------------------------------------------------

void Conductor::go_alone() {
  engines::EventQueue<Due>& queue = all_.domains[kBorder].queue;
  const double duration = all_.run.duration();
  while (!queue.empty() && queue.front().key.time <= duration) {
    if (is_time_for_a_trial())
      try_rollback([&] {
        for (std::size_t k = 0; k < all_.world().movers().size() && !queue.empty() && queue.front().key.time <= duration; ++k) work_alone_at(queue.pop());
      });
    if (all_.trial.rollback_every > 0) alone().disturb();
    Due due = all_.trial.disorder_s > 0 ? alone().next_legal(duration) : queue.pop();
    if (all_.trial.late_callbacks && due.key.kind == EventClass::kCallback && !queue.empty() && queue.front().key.time <= duration) due = in_place_of(due);
    if (!queue.empty()) alone().fetch(queue.front());
    work_alone_at(due);
    const double gvt = queue.empty() ? kInfinity : queue.front().key.time;
    const bool keeps_much = all_.world().processes() && ++since_commit_ >= kForgetAfter * all_.world().movers().size();
    if (keeps_much || alone().executed.size() >= commit_at_ || all_.run.next_frame() < gvt) {
      commit_before(std::min(gvt, duration));
      commit_at_ = alone().executed.size() + kCommitAfter;
      since_commit_ = 0;
      adapt_window();
    }
  }
}

// A test's: what comes after a callback is worked at before it.
Due Conductor::in_place_of(const Due& callback) {
  engines::EventQueue<Due>& queue = all_.domains[kBorder].queue;
  std::vector<Due> late{callback};
  while (queue.front().key.kind == EventClass::kCallback && queue.size() > 1) late.push_back(queue.pop());
  const Due next = queue.pop();
  for (const Due& due : late) queue.push(due);
  return next;
}

// ---- Several -----------------------------------------------------------------------------------------------------------------

Domain* Conductor::next_domain() {
  Domain* next = nullptr;
  for (Domain& domain : all_.domains)
    if (!domain.queue.empty() && (!next || domain.queue.front().key < next->queue.front().key)) next = &domain;
  return next;
}

double Conductor::next_time() {
  const Domain* next = next_domain();
  return next ? next->queue.front().key.time : kInfinity;
}

// In the mean over bodies: how far one goes at once.
double Conductor::first_window() const {
  const FlightWorld& world = all_.world();
  double sum = 0.0;
  for (const int i : world.movers()) {
    const double speed = world.first_flight(i).velocity_world.norm() + std::sqrt(0.5 * world.gravity_world().norm() * all_.lengths.way);
    sum += world.is_ball(i) && speed > 0 ? std::min(all_.lengths.way / speed, all_.run.duration()) : all_.run.step();
  }
  return world.movers().empty() ? all_.run.step() : kWindowSteps * sum / static_cast<double>(world.movers().size());
}

void Conductor::go_in_rounds() {
  all_.window = first_window_;
  double end_of_round = 0.0;
  bool is_over = false;
  std::barrier meet(all_.threads);
  std::vector<std::jthread> threads;
  // Whatever ends this thread ends the others.
  struct Release {
    std::barrier<>& meet;
    bool& is_over;
    ~Release() {
      is_over = true;
      meet.arrive_and_wait();
    }
  };
  for (int thread = 1; thread < all_.threads; ++thread)
    threads.emplace_back([&, thread] {
      for (;;) {
        meet.arrive_and_wait();
        if (is_over) return;
        work_as(thread, end_of_round);
        meet.arrive_and_wait();
      }
    });
  const Release release{meet, is_over};
  while (next_time() <= all_.run.duration()) {
    if (is_time_for_a_trial()) try_rollback([&] { go_round(end_of_round, meet); });
    go_round(end_of_round, meet);
    commit_before(std::min(next_time(), all_.run.duration()));
    adapt_window();
  }
}

// Territories go from thread to thread in turn. One after the other to the end of the round: what each looks at stays in the caches meanwhile.
// @return how far all of them have come: who went farther is ahead
double Conductor::work_as(int thread, double end) {
  for (std::size_t k = 1 + static_cast<std::size_t>(thread); k < workers_.size(); k += static_cast<std::size_t>(all_.threads)) end = workers_[k]->work_before(end);
  return end;
}

void Conductor::go_round(double& end_of_round, std::barrier<>& meet) {
  all_.global_virtual_time = next_time();
  end_of_round = all_.global_virtual_time + (all_.threads > 1 ? kRound : kRoundAlone) * all_.window;
  const double began = thread_seconds();
  settle();
  const double settled = thread_seconds();
  all_.run.share(all_.threads > 1);
  meet.arrive_and_wait();
  const double reached = work_as(0, end_of_round);   // of several threads: the end of the round
  meet.arrive_and_wait();
  all_.run.share(false);
  for (const auto& worker : workers_)
    if (worker->left.out_of_time) std::rethrow_exception(worker->left.out_of_time);
  std::vector<double> of_threads(static_cast<std::size_t>(all_.threads), 0.0);
  for (std::size_t k = 1; k < workers_.size(); ++k) of_threads[(k - 1) % of_threads.size()] += std::exchange(workers_[k]->cpu_seconds, 0.0);
  const double busiest = *std::max_element(of_threads.begin(), of_threads.end());
  const double worked = thread_seconds();
  collect_what_is_left();
  work_alone_before(reached);
  ++alone().counters.rounds;
  alone().counters.together_seconds += busiest;
  alone().counters.alone_seconds += settled - began + thread_seconds() - worked;
}

void Conductor::collect_what_is_left() {
  for (std::size_t k = 1; k < workers_.size(); ++k) {
    alone().moves.insert(alone().moves.end(), workers_[k]->moves.begin(), workers_[k]->moves.end());
    workers_[k]->moves.clear();
    Worker::Left& left = workers_[k]->left;
    for (const Due& due : left.due) all_.domains[kBorder].queue.push(due);
    for (const EventKey& callback : left.recalls)
      if (all_.called[callback.generation]) alone().expect_callback(callback);
    left.due.clear();
    left.recalls.clear();
  }
  for (std::size_t k = 1; k < workers_.size(); ++k) {
    for (const auto& [body, serial] : workers_[k]->left.anti_messages) alone().take_back(body, serial);
    workers_[k]->left.anti_messages.clear();
  }
}

void Conductor::work_alone_before(double end) {
  for (Domain* next = next_domain(); next && next->queue.front().key.time < end && next->queue.front().key.time <= all_.run.duration(); next = next_domain()) work_alone_at(next->queue.pop());
}

// Who has as many states as are allowed waits until global virtual time has passed some of them. What is first of all need not wait.
void Conductor::work_alone_at(Due due) {
  if (all_.most_states > 0 && !alone().has_room(due)) {
    ++alone().counters.held_back;
    if (Domain* next = next_domain(); next && next->queue.front().key < due.key) {
      const Due first = next->queue.pop();
      all_.domains[all_.territories > 1 ? all_.home_of(due.key) : kBorder].queue.push(due);
      due = first;
    }
    commit_before(due.key);
    alone().purge(due);
  }
  const Domain* next = next_domain();
  working_at_ = next && next->queue.front().key < due.key ? next->queue.front().key : due.key;
  alone().work_at(due);
  working_at_.reset();
}

// ---- How far ahead -------------------------------------------------------------------------------------------------------------

void Conductor::adapt_window() {
  if (all_.threads == 1 && all_.territories > 1 && !all_.world().processes()) return adapt_rounds();   // nobody is cut short by it: it only measures rounds
  if (all_.trial.late_callbacks) return;   // what waits for the late one would wait for the window too
  std::uint64_t done = 0, undone = 0;
  for (const auto& worker : workers_) {
    done += worker->counters.integrations;
    undone += worker->counters.undone_integrations;
  }
  if (done - done_before_ < kIntegrationsToJudgeBy) return;
  const double share = static_cast<double>(undone - undone_before_) / static_cast<double>(done - done_before_);
  done_before_ = done;
  undone_before_ = undone;
  const double first = all_.territories > 1 ? first_window_ : kWindowAlone * first_window_;
  if (share > kTooMuchUndone) all_.window = std::max(kNarrowest * first, kNarrow * (all_.window < kInfinity ? all_.window : first));
  else if (share < kTooLittleUndone) all_.window = all_.territories > 1 ? std::min(kWidest * first, kWiden * all_.window) : all_.window > first ? kInfinity : kWiden * all_.window;
}

// Of one thread: states are kept until a round's end, so that in none there may be many more than bodies, however fast they have become.
void Conductor::adapt_rounds() {
  std::uint64_t done = 0;
  for (const auto& worker : workers_) done += worker->counters.integrations;
  const double a_body = static_cast<double>(done - std::exchange(done_before_, done)) / static_cast<double>(all_.world().movers().size());
  if (a_body > kMostInARound) all_.window *= std::max(0.1, kMostInARound / a_body);
  else if (a_body < 0.25 * kMostInARound) all_.window = std::min(kWidest * first_window_, kWiden * all_.window);
}

// ---- The end -------------------------------------------------------------------------------------------------------------------

// Every flight that began has been dropped, forgotten or is among the last: what is left of passages and changes without one would never
// have been freed.
void Conductor::check_nothing_leaked() {
  for (const int body : all_.world().movers())
    for (std::size_t k = 0; k < all_.histories[body].size(); ++k) {
      all_.world().release(all_.histories[body][k]);
      if (all_.histories[body][k].change >= 0) all_.changes.release(all_.histories[body][k].change);
    }
  require(all_.world().all_processes().passages().alive() == 0 && all_.changes.alive() == 0, "no passage or change outlives its flights");
}

void Conductor::end(const std::string& stopped_by) {
  for (const auto& worker : workers_) {
    all_.run.counters.add(worker->counters);
    all_.run.cost.pair_checks += worker->cost.pair_checks;
    all_.run.cost.narrow.gap_evaluations += worker->cost.narrow.gap_evaluations;
    all_.run.cost.narrow.root_findings += worker->cost.narrow.root_findings;
  }
  if (workers_.size() > 1) {
    const auto works_less = [](const auto& x, const auto& y) { return x->worked_at < y->worked_at; };
    all_.run.counters.least_of_a_thread = (*std::min_element(workers_.begin() + 1, workers_.end(), works_less))->worked_at;
  }
  all_.run.counters.states_kept = static_cast<std::uint64_t>(most_kept_);
  if (record_) record_->moves = std::move(alone().moves);
  all_.run.end(stopped_by);
}

void run_fast_timewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record, const engines::RollbackWatch* watch) {
  if (options.most_states != 0 && options.most_states < kFewestStates)
    throw UserError("--most-states " + std::to_string(options.most_states), fmt::format("a process in contact needs {}", kFewestStates), fmt::format("Give {} or more, or 0: as many as it takes.", kFewestStates));
  if (options.threads < 1 || options.threads > kMostThreads)
    throw UserError("--threads " + std::to_string(options.threads), fmt::format("expected a number from 1 to {}", kMostThreads), "As many as the machine has cores is most that helps.");
  require(options.trial.territories >= 0 && options.trial.territories <= kTerritoryIds, fmt::format("TimewarpTrial::territories is from 0 to {}, and not {}: homes of bodies are numbered in a byte", kTerritoryIds, options.trial.territories));
  Conductor(scene, laws, options, sink, record, watch).run();
}

}  // namespace tumble::a4
