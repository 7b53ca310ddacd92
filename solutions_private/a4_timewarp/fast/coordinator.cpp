#include "solutions_private/a4_timewarp/fast/coordinator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/numbers.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/engines/timewarp/flight_boxes.h"
#include "solutions_private/a4_timewarp/fast/fast_timewarp.h"

namespace tumble::a4 {
namespace {

// executed events between computations of global virtual time
constexpr std::size_t kCommitAfter = 512;
// advances per body, likewise: the data of segments should stay in the nearer caches
constexpr std::size_t kForgetAfter = 1;
constexpr int kMostThreads = 64;
// a territory's number has one byte; the boundary is one more
constexpr int kRegionIds = std::numeric_limits<std::uint8_t>::max();
// a segment keeps two committed steps, and the current one
constexpr int kFewestStates = 8;

// Bounded optimism: the window is adapted so that 5 to 15 % of the integrations are rolled back.
constexpr double kTooMuchUndone = 0.15, kTooLittleUndone = 0.05, kWiden = 1.3, kNarrow = 0.75;
constexpr double kHardlyUndone = 0.01;
constexpr std::uint64_t kIntegrationsToJudgeBy = 2000;
constexpr double kWidest = 2.0, kNarrowest = 1.0 / 64;  // of the first window
// with several threads, the first window: of the time in which a process advances once
constexpr double kOptimismWindowSteps = 2.0;
// with one thread, which is unbounded until too much is rolled back: of that window
constexpr double kOptimismWindowAlone = 2.0;
constexpr double kMostInARound = 2.0;  // integrations per body

}  // namespace

Coordinator::Coordinator(const scene::Scene& scene, const Laws& laws,
                         const engines::RunOptions& options, TrajectorySink& sink,
                         VirtualTimes* record, const engines::RollbackCheck* watch)
    : all_(scene, laws, options, sink),
      record_(record),
      watch_(watch),
      commit_at_(kCommitAfter),
      wanted_site_(static_cast<std::size_t>(all_.world().size())),
      leaders_(wanted_site_.size()) {
  const FlightWorld& world = all_.world();
  add_domains();
  workers_.push_back(std::make_unique<Worker>(all_));
  for (int pass = 0; pass < kPasses; ++pass)
    for (std::size_t k = 1; k < all_.territories[static_cast<std::size_t>(pass)].size(); ++k)
      workers_.push_back(std::make_unique<Worker>(all_, pass, static_cast<std::uint8_t>(k)));
  if (all_.domains.size() > 1) all_.work_loads.assign(static_cast<std::size_t>(world.size()), 0.0);
  all_.is_recorded = record_ != nullptr;
  for (const int i : world.movers()) {
    if (record_) record_->processes.push_back(world.world().bodies[i].name);
    all_.histories.push(i, world.first_flight(i));
    ++alone().kept;
  }
  for (const int i : world.obstacles()) enter_obstacle(i);
  first_optimism_window_ = first_optimism_window();
}

// Space is not cut yet: all bodies belong to the boundary.
void Coordinator::add_domains() {
  const double bin = bin_for(all_.world(), all_.lengths.advance, all_.run.duration());
  const int all_bodies = all_.world().size();
  const std::size_t regions = all_.regions == 1 ? 0 : static_cast<std::size_t>(all_.regions),
                    slabs = static_cast<std::size_t>(all_.slabs);
  all_.territories = {std::vector<Box>(1 + regions, all_space()),
                      std::vector<Box>(1 + slabs, all_space())};
  all_.domains.reserve((1 + regions) * (1 + slabs));
  for (std::size_t k = 0; k <= regions; ++k)
    for (std::size_t m = 0; m <= slabs; ++m) {
      const Site site{{static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(m)}};
      // a snapshot of cells shows the number of buckets: there it is the same for all
      const int held = watch_ || site == Site{} ? all_bodies : 2 * all_bodies / all_.regions;
      all_.domains.emplace_back(all_.boxes, static_cast<int>(all_.domains.size()), site, held,
                                all_.lengths.cell, site == Site{} ? bin : bin * all_.regions);
    }
  for (Domain& domain : all_.domains) domain.region = all_space();
  if (all_.domains.size() == 1) all_.domains.front().hull = all_space();
}

void Coordinator::enter_obstacle(int i) {
  const FlightWorld& world = all_.world();
  all_.processes[static_cast<std::size_t>(i)].horizon = kInfinity;
  if (world.is_half_space(i)) return all_.planes.push_back(i);
  const Box box = engines::box_of_immovable(world, i, all_.run.duration());
  obstacles_.take_in(box);
  all_.enter(i, Site{}, box);
}

void Coordinator::run() {
  std::string stopped_by;
  try {
    begin();
    if (all_.regions > 1)
      run_in_epochs();
    else
      run_alone();
    commit_before(kInfinity);
    stand(all_.run.duration());
    check_nothing_leaked();
  } catch (const engines::StoppedRun& stop) {
    stopped_by = stop.what();
  }
  try {  // everything before is certain, and kept
    if (working_at_) commit_before(*working_at_);
  } catch (const engines::StoppedRun& stop) {
    stopped_by = stop.what();
  }
  if (!stopped_by.empty())
    stand(all_.run.stands_until(stopped_by, working_at_ ? working_at_->time : all_.committed));
  end(stopped_by);
}

void Coordinator::begin() {
  std::vector<int> order = all_.world().movers();
  if (all_.faults.shuffle) {
    Random random(all_.faults.seed);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  }
  alone().now = 0.0;
  all_.called.assign(all_.run.callbacks().size(), false);
  for (const EventStamp& callback : all_.run.callbacks()) alone().expect_callback(callback);
  for (const int body : order)
    if (all_.first_member(body) == body) alone().begin(body);
  alone().now = kInfinity;
  // The cost of the first advances is the cost of the time that they cover.
  if (all_.regions > 1)
    for (const int body : order)
      all_.work_loads[static_cast<std::size_t>(body)] *=
          first_optimism_window_ / std::max(all_.processes[static_cast<std::size_t>(body)].horizon,
                                            1e-3 * first_optimism_window_);
}

// ---- One thread ------------------------------------------------------------------------------

void Coordinator::run_alone() {
  engines::EventQueue<Due>& queue = all_.domains.front().queue;
  const double duration = all_.run.duration();
  while (!queue.empty() && queue.front().key.time <= duration) {
    if (is_injection_due())
      inject_rollback([&] {
        for (std::size_t k = 0; k < all_.world().movers().size() && !queue.empty() &&
                                queue.front().key.time <= duration;
             ++k)
          work_alone_at(queue.pop());
      });
    if (all_.faults.rollback_every > 0) alone().disturb();
    Due due = all_.faults.disorder_s > 0 ? alone().next_legal(queue, duration) : queue.pop();
    if (all_.faults.late_callbacks && due.key.kind == StampKind::kCallback && !queue.empty() &&
        queue.front().key.time <= duration)
      due = in_place_of(due);
    if (!queue.empty()) alone().fetch(queue.front());
    work_alone_at(due);
    const double gvt = queue.empty() ? kInfinity : queue.front().key.time;
    const bool keeps_much =
        all_.world().processes() && ++since_commit_ >= kForgetAfter * all_.world().movers().size();
    if (keeps_much || alone().executed.size() >= commit_at_ || all_.run.next_frame() < gvt) {
      commit_before(std::min(gvt, duration));
      commit_at_ = alone().executed.size() + kCommitAfter;
      since_commit_ = 0;
      adapt_optimism_window();
    }
  }
}

// For tests: an event after a callback is executed before it.
Due Coordinator::in_place_of(const Due& callback) {
  engines::EventQueue<Due>& queue = all_.domains.front().queue;
  std::vector<Due> late{callback};
  while (queue.front().key.kind == StampKind::kCallback && queue.size() > 1)
    late.push_back(queue.pop());
  const Due next = queue.pop();
  for (const Due& due : late) queue.push(due);
  return next;
}

// ---- The first event of all ---------------------------------------------------------------------

Domain* Coordinator::next_domain() {
  Domain* next = nullptr;
  for (Domain& domain : all_.domains)
    if (!domain.queue.empty() && (!next || domain.queue.front().key < next->queue.front().key))
      next = &domain;
  return next;
}

double Coordinator::next_time() {
  const Domain* next = next_domain();
  return next ? next->queue.front().key.time : kInfinity;
}

// The mean over bodies of the time of one advance.
double Coordinator::first_optimism_window() const {
  const FlightWorld& world = all_.world();
  double sum = 0.0;
  for (const int i : world.movers()) {
    const double speed = world.first_flight(i).velocity_world.norm() +
                         std::sqrt(0.5 * world.gravity_world().norm() * all_.lengths.advance);
    sum += world.is_ball(i) && speed > 0
               ? std::min(all_.lengths.advance / speed, all_.run.duration())
               : all_.run.step();
  }
  return world.movers().empty()
             ? all_.run.step()
             : kOptimismWindowSteps * sum / static_cast<double>(world.movers().size());
}

// The first event of all: this one, or the queues' first, in whose place it is put back.
Due Coordinator::first_before(const Due& due) {
  Domain* next = next_domain();
  if (!next || !(next->queue.front().key < due.key)) return due;
  const Due first = next->queue.pop();
  all_.domain_of(due.key).queue.push(due);
  return first;
}

// A step that failed on a flight that has ended before it: it was never taken.
bool Coordinator::is_stale_fault(const Due& due) {
  return due.key.kind == StampKind::kFault && !alone().is_to_come(due);
}

// A body at its limit of states waits until global virtual time has passed some of them. The first
// event of all need not wait.
void Coordinator::work_alone_at(Due due) {
  // A step that failed was computed ahead: it counts where nothing before it is left to do.
  if (due.key.kind == StampKind::kFault) due = first_before(due);
  if (is_stale_fault(due)) return;
  if (all_.most_states > 0 && !alone().has_room(due)) {
    ++alone().counters.held_back;
    due = first_before(due);
    // what is committed as before a fault ends with the frame of its instant
    if (is_stale_fault(due)) return;
    commit_before(due.key);
    alone().purge(due);
  }
  const Domain* next = next_domain();
  working_at_ = next && next->queue.front().key < due.key ? next->queue.front().key : due.key;
  alone().work_at(due);
  working_at_.reset();
}

// ---- Optimism --------------------------------------------------------------------------------

void Coordinator::adapt_optimism_window() {
  // it cuts no advance short; it only measures epochs
  if (all_.threads == 1 && all_.regions > 1 && !all_.world().processes()) return adapt_epochs();
  // events that wait for the late callback would wait for the window too
  if (all_.faults.late_callbacks) return;
  std::uint64_t done = 0, undone = 0;
  for (const auto& worker : workers_) {
    done += worker->counters.integrations;
    undone += worker->counters.undone_integrations;
  }
  if (done - done_before_ < kIntegrationsToJudgeBy) return;
  const double share =
      static_cast<double>(undone - undone_before_) / static_cast<double>(done - done_before_);
  done_before_ = done;
  undone_before_ = undone;
  round_ = share < kHardlyUndone ? kLongRound : kRound;
  const double first =
      all_.regions > 1 ? first_optimism_window_ : kOptimismWindowAlone * first_optimism_window_;
  if (share > kTooMuchUndone)
    all_.optimism_window =
        std::max(kNarrowest * first,
                 kNarrow * (all_.optimism_window < kInfinity ? all_.optimism_window : first));
  else if (share < kTooLittleUndone)
    all_.optimism_window = all_.regions > 1
                               ? std::min(kWidest * first, kWiden * all_.optimism_window)
                           : all_.optimism_window > first ? kInfinity
                                                          : kWiden * all_.optimism_window;
}

// With one thread states are kept until the end of an epoch, so an epoch must not have many more
// events than bodies, however fast these have become.
void Coordinator::adapt_epochs() {
  std::uint64_t done = 0;
  for (const auto& worker : workers_) done += worker->counters.integrations;
  const double a_body = static_cast<double>(done - std::exchange(done_before_, done)) /
                        static_cast<double>(all_.world().movers().size());
  if (a_body > kMostInARound)
    all_.optimism_window *= std::max(0.1, kMostInARound / a_body);
  else if (a_body < 0.25 * kMostInARound)
    all_.optimism_window =
        std::min(kWidest * first_optimism_window_, kWiden * all_.optimism_window);
}

// ---- End -------------------------------------------------------------------------------------

// Every flight has been dropped, discarded, or is a body's last: segments and records that are
// still held by no flight are leaks.
void Coordinator::check_nothing_leaked() {
  for (const int body : all_.world().movers())
    for (std::size_t k = 0; k < all_.histories[body].size(); ++k) {
      all_.world().release(all_.histories[body][k]);
      if (all_.histories[body][k].change >= 0) all_.changes.release(all_.histories[body][k].change);
    }
  require(all_.world().all_processes().segments().alive() == 0 && all_.changes.alive() == 0,
          "no segment or change outlives its flights");
}

void Coordinator::end(const std::string& stopped_by) {
  for (const auto& worker : workers_) {
    for (const Executed& event : worker->executed)  // of a run that was stopped
      if (is_rolled_back(event)) worker->counters.anti_messages += anti_messages_of(event);
    all_.run.counters.add(worker->counters);
    all_.run.cost.pair_checks += worker->cost.pair_checks;
    all_.run.cost.narrow.gap_evaluations += worker->cost.narrow.gap_evaluations;
    all_.run.cost.narrow.root_findings += worker->cost.narrow.root_findings;
  }
  if (workers_.size() > 1) {
    const auto works_less = [](const auto& x, const auto& y) {
      return x->worked_at < y->worked_at;
    };
    all_.run.counters.least_of_a_thread =
        (*std::min_element(workers_.begin() + 1, workers_.begin() + 1 + all_.regions, works_less))
            ->worked_at;
  }
  all_.run.counters.states_kept = static_cast<std::uint64_t>(most_kept_);
  hand_over_moves();
  all_.run.end(stopped_by);
}

// Before frames are committed: who sees a frame sees the moves that led to it.
void Coordinator::hand_over_moves() {
  if (!record_) return;
  const std::vector<VirtualTimes::Move>& moves = alone().moves;
  record_->moves.insert(record_->moves.end(),
                        moves.begin() + static_cast<std::ptrdiff_t>(record_->moves.size()),
                        moves.end());
  record_->is_cut = alone().has_more_moves;
}

void run_fast_timewarp(const scene::Scene& scene, const Laws& laws,
                       const engines::RunOptions& options, TrajectorySink& sink,
                       VirtualTimes* record, const engines::RollbackCheck* watch) {
  if (options.most_states != 0 && options.most_states < kFewestStates)
    throw UserError("--most-states " + std::to_string(options.most_states),
                    fmt::format("a process in contact needs {}", kFewestStates),
                    fmt::format("Give {} or more, or 0: as many as it takes.", kFewestStates));
  if (options.threads < 1 || options.threads > kMostThreads)
    throw UserError("--threads " + std::to_string(options.threads),
                    fmt::format("expected a number from 1 to {}", kMostThreads),
                    "More threads than cores do not help.");
  require(options.faults.regions >= 0 && options.faults.regions <= kRegionIds,
          fmt::format("FaultInjection::regions is from 0 to {}, and not {}: the owner of a body is "
                      "stored in a byte",
                      kRegionIds, options.faults.regions));
  Coordinator(scene, laws, options, sink, record, watch).run();
}

}  // namespace tumble::a4
