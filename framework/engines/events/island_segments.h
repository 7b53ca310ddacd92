/// Passages: the motion of processes that links, forces or lasting contacts keep from flying freely, each from the discontinuity that
/// began it to its next.
///
/// A passage is to such a process what a flight is to a free body, and flights name theirs. It is worked out step by step, as far as
/// somebody asks; where it leads depends on its beginning alone, whoever asks, and when. Some
/// end by themselves: an impact within the process, a contact that begins or opens. Membership of a passage never changes: what joins or
/// leaves begins others.
///
/// Threads may share them, as long as each passage, and each set of members, is one thread's affair at a time; what they do share is locked.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "framework/core/stable_table.h"
#include "framework/engines/events/process_world.h"

namespace tumble::engines {

/// Where a passage ends by itself, and what comes after.
struct PassageEnd {
  double time;                       // [s]
  ProcessState after;
  std::vector<Event> events;         // none where members only have come too far apart to be one process
};

class Passages {
 public:
  Passages(const World& whole, ShapeOf shape_of, const Laws& laws, ProcessRules rules);
  /// @param falls_apart  whether the members of a state are one process no more
  void ask(std::function<bool(const ProcessState&)> falls_apart) { falls_apart_ = std::move(falls_apart); }
  Passages(const Passages&) = delete;
  Passages& operator=(const Passages&) = delete;

  /// Begins a passage; its members hold it, each once, until they release it. @return its number
  int begin(const ProcessState& state);
  void release(int passage);
  /// Nobody asks for what lies before this any more. [s]
  void forget_before(double t);
  /// From now on several threads work with passages, or one alone again. By the one thread that works at that moment.
  void share(bool shared) { is_shared_ = shared; }

  const std::vector<int>& members(int passage) const { return at(passage).start->members; }
  double began(int passage) const { return at(passage).start->time; }
  /// Place of a body among the members.
  std::size_t place(int passage, int body) const;

  /// Where it ends by itself, if that is at `to` or before; else null.
  const PassageEnd* end_by(int passage, double to);
  /// The end of the step that holds t; t itself where the passage has ended there. [s]
  double step_end(int passage, double t);
  /// Everything at an instant. @pre the passage has not ended before it
  ProcessState state_at(int passage, double t);
  RigidBodyState body_state(int passage, int body, double t);
  /// The states of all members, by place among them, as a picture shows them: what lies on each other does not overlap within a step either, and links hold.
  std::vector<RigidBodyState> shown_at(int passage, double t);
  collision::MotionState motion_at(int passage, int body, double t);
  /// The step that holds t.
  const ProcessStep& step_at(int passage, double t);

  /// What it began with.
  const ProcessState& start(int passage) const { return *at(passage).start; }
  /// Calls work(step) for the steps that hold times in [from, to].
  template <class Work>
  void for_each_step(int passage, double from, double to, const Work& work) {
    reach(passage, to);
    for (const ProcessStep& step : at(passage).steps)
      if (step.end >= from && step.from.time <= to) work(step);
  }
  /// One body along one step: what a search for impacts looks at. @pre low < high lie in one step
  collision::Motion motion_in_step(int passage, int body, double low);
  /// Calls work(step, place of the body among the members, from, to) for the steps that cover [from, to]; what lies behind the end is no part.
  template <class Work>
  void for_each_step(int passage, int body, double from, double to, const Work& work) {
    reach(passage, to);
    const std::size_t member = place(passage, body);
    for (const ProcessStep& step : at(passage).steps)
      if (step.end >= from && step.from.time <= to) work(step, member, std::max(from, step.from.time), std::min(to, step.end));
  }

  /// A small world of these members, for a question or two. @param still  an immovable body that one of them meets; -1: none
  ProcessWorld& world_of(const std::vector<int>& members, int still = -1);

  /// Passages that somebody holds.
  std::size_t alive() const { return passages_.taken(); }
  /// Steps that are kept, now and at most wherever that was asked.
  std::size_t kept() const { return kept_; }
  /// Of one passage: steps that are kept.
  std::size_t kept(int passage) const { return at(passage).steps.size(); }
  /// What their small worlds counted.
  void add_counts_to(RunCounters& counters) const;

 private:
  struct Machine {
    RunCounters counters;      // of its own: another thread may be counting for another one
    std::unique_ptr<ProcessWorld> world;
    int users = 0;
  };
  struct Passage {
    std::optional<ProcessState> start;
    std::deque<ProcessStep> steps;
    std::optional<ProcessState> front;      // where the last step led
    std::optional<PassageEnd> end;
    Machine* machine = nullptr;
    int holders = 0, idle = 0;
  };

  Passage& at(int passage) { return *passages_[passage]; }
  const Passage& at(int passage) const { return *passages_[passage]; }
  Machine& machine_of(const std::vector<int>& members, int still);
  void reach(int passage, double t);
  void take_step(Passage& passage);
  std::string names(const std::vector<int>& members) const;

  static constexpr std::size_t kMachines = 512;   // small worlds that are kept for another time

  const World& whole_;
  const EntriesByBody entries_;
  ShapeOf shape_of_;
  std::function<bool(const ProcessState&)> falls_apart_;
  const Laws& laws_;
  ProcessRules rules_;
  std::vector<int> obstacles_;              // immovable ones that lasting contacts may touch
  std::map<std::pair<std::vector<int>, int>, Machine> machines_;
  StableTable<std::unique_ptr<Passage>> passages_;
  std::size_t clear_at_ = kMachines;        // of machines_: those that nobody uses are thrown away
  RunCounters past_;                        // of small worlds that are gone
  std::mutex mutex_;                        // of machines_, of numbers of passages, and of who holds them
  bool is_shared_ = false;
  double forgotten_ = 0.0;
  std::atomic<std::size_t> kept_ = 0;
  std::uint64_t begun_ = 0, let_go_ = 0;    // passages
};

}  // namespace tumble::engines
