/// Island trajectory segments: the motion of processes whose bodies cannot fly freely because of
/// links, forces or persistent contacts, each from the discontinuity that begins it to the next.
///
/// A segment is to such a process what a flight is to a free body, and flights name their segment.
/// It is computed step by step, as far as it is queried. It depends on its start state alone, not
/// on the order of queries. Some segments end by themselves: at an impact within the process, or
/// where a contact begins or opens. The members of a segment never change: a body that joins or
/// leaves begins new segments.
///
/// A step that cannot be taken (a law fails, a state is not a number) is kept, and stops nothing:
/// it was computed ahead of what other processes do, and an impact with one of them may end the
/// segment before it. The segment is known up to that step's start, where it stands; an engine
/// raises the failure where it is the next event of all. Where the response to an impact within the
/// process fails, the step up to the impact stands, and the segment is known up to there. Only a
/// run that is out of time stops at once.
///
/// Threads may share them if one thread at a time uses each segment and each set of members; data
/// that segments share is locked.
#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "framework/core/stable_table.h"
#include "framework/engines/events/process_world.h"

namespace tumble::engines {

/// The end of a segment that ends by itself, and the state after it.
struct SegmentEnd {
  double time;  // [s]
  ProcessState after;
  // empty where members have only moved too far apart to be one process
  std::vector<Event> events;
  // what a run in which it comes to that must not keep silent; null: nothing
  std::unique_ptr<RunWatch> noted{};
};

class IslandSegments {
 public:
  IslandSegments(const World& whole, ShapeOf shape_of, const Laws& laws, ProcessRules rules);
  /// @param falls_apart  whether the members of a state no longer form one process
  void ask(std::function<bool(const ProcessState&)> falls_apart) {
    falls_apart_ = std::move(falls_apart);
  }
  IslandSegments(const IslandSegments&) = delete;
  IslandSegments& operator=(const IslandSegments&) = delete;

  /// Begins a segment. Each member holds it once, until it releases it. @return its index
  int begin(const ProcessState& state);
  void release(int segment);
  /// What is before `until` on the segment is part of the run, whatever happens: what its steps
  /// before then have noted counts. What its end has noted goes with the event there (SegmentEnd).
  /// Called before the flights on it are released; a rollback releases them without it. [s]
  void stand(int segment, double until);
  /// Times before this are not queried any more. [s]
  void forget_before(double t);
  /// But not times from this on. Called while one thread runs alone. [s]
  void remember_from(double t) { remembered_ = t; }
  /// true: several threads use segments from now on; false: one thread again. Called while one
  /// thread runs alone.
  void share(bool shared) { is_shared_ = shared; }

  const std::vector<int>& members(int segment) const { return at(segment).start->members; }
  double began(int segment) const { return at(segment).start->time; }
  /// Index of a body among the members.
  std::size_t place(int segment, int body) const;

  /// The segment's end, if it ends by itself at `to` or before; else null.
  const SegmentEnd* end_by(int segment, double to);
  /// The start of the step that could not be taken, or the impact without a response, if that is
  /// `to` or before. [s]
  std::optional<double> failed_by(int segment, double to);
  /// Whether it is an impact that failed. @pre failed_by answered
  bool fails_to_respond(int segment) const;
  /// Throws what that step threw. @pre failed_by answered
  [[noreturn]] void raise(int segment) const;
  /// The end of the step that contains t; t itself where the segment has ended or failed by then.
  /// [s]
  double step_end(int segment, double t);
  /// The process state at an instant. @pre the segment has not ended before it
  /// @throws what the failed step threw, for instants after its start by more than rounding leaves
  ///   of a step; so do all that follow
  ProcessState state_at(int segment, double t);
  RigidBodyState body_state(int segment, int body, double t);
  /// The states of all members for a picture, in their order: bodies in contact do not overlap
  /// within a step either, and links hold.
  std::vector<RigidBodyState> shown_at(int segment, double t);
  collision::MotionState motion_at(int segment, int body, double t);
  /// The step that contains t.
  const ProcessStep& step_at(int segment, double t);

  /// The start state.
  const ProcessState& start(int segment) const { return *at(segment).start; }
  /// Calls work(step) for the steps that intersect [from, to], as far as they could be taken.
  template <class Work>
  void for_each_step(int segment, double from, double to, const Work& work) {
    reach(segment, to);
    const std::deque<ProcessStep>& steps = at(segment).steps;
    for (auto step = first_since(steps, from); step != steps.end() && step->from.time <= to; ++step)
      work(*step);
  }
  /// The motion of one body along one step, for a search for impacts. @pre low < high lie in one
  /// step
  collision::Motion motion_in_step(int segment, int body, double low);
  /// Calls work(step, index of the body among the members, from, to) for the steps that cover
  /// [from, to]; times after the segment's end or failure are left out.
  template <class Work>
  void for_each_step(int segment, int body, double from, double to, const Work& work) {
    reach(segment, to);
    const std::size_t member = place(segment, body);
    const std::deque<ProcessStep>& steps = at(segment).steps;
    for (auto step = first_since(steps, from); step != steps.end() && step->from.time <= to; ++step)
      work(*step, member, std::max(from, step->from.time), std::min(to, step->end));
  }

  /// A process world of these members, for single queries. @param still  an immovable body that one
  /// of them meets; -1: none
  ProcessWorld& world_of(const std::vector<int>& members, int still = -1);

  /// Segments that are held.
  std::size_t alive() const { return segments_.taken(); }
  /// Steps in memory now, of all segments.
  std::size_t kept() const { return kept_; }
  /// Steps in memory of one segment.
  std::size_t kept(int segment) const { return at(segment).steps.size(); }
  /// Adds the counters of all process worlds.
  void add_counts_to(RunCounters& counters) const;

 private:
  /// The first that does not end before it.
  static std::deque<ProcessStep>::const_iterator first_since(const std::deque<ProcessStep>& steps,
                                                             double t) {
    return std::partition_point(steps.begin(), steps.end(),
                                [&](const ProcessStep& step) { return step.end < t; });
  }

  struct CachedWorld {
    // one for each world, because another thread may count for another world
    RunCounters counters;
    std::unique_ptr<ProcessWorld> world;
    int users = 0;
  };
  struct Segment {
    std::optional<ProcessState> start;
    std::deque<ProcessStep> steps;
    std::optional<ProcessState> front;  // the state after the last step
    std::optional<SegmentEnd> end;
    // of the step from `front`, or of the response to an impact there; null: none has failed
    std::exception_ptr failure;
    bool fails_to_respond = false;  // the latter
    bool has_notes = false;         // some step has
    CachedWorld* cached_world = nullptr;
    int holders = 0, idle = 0;
  };

  Segment& at(int segment) { return *segments_[segment]; }
  const Segment& at(int segment) const { return *segments_[segment]; }
  CachedWorld& cached_world(const std::vector<int>& members, int still);
  void reach(int segment, double t);
  void take_step(Segment& segment);
  void keep(Segment& segment, ProcessStep step);
  void count(std::unique_ptr<RunWatch> noted);
  void stand_at(Segment& segment, ProcessState state, std::exception_ptr failure);
  std::exception_ptr named(const std::exception_ptr& failure, double t,
                           const Segment& segment) const;
  ProcessWorld::Outcome outcome_of_step(Segment& segment) const;
  std::string names(const std::vector<int>& members) const;

  // process worlds that are cached for later use
  static constexpr std::size_t kMostCachedWorlds = 512;

  const World& whole_;
  const EntriesByBody entries_;
  ShapeOf shape_of_;
  std::function<bool(const ProcessState&)> falls_apart_;
  const Laws& laws_;
  ProcessRules rules_;
  std::vector<int> obstacles_;  // immovable bodies that persistent contacts may touch
  std::map<std::pair<std::vector<int>, int>, CachedWorld> worlds_;
  StableTable<std::unique_ptr<Segment>> segments_;
  // size of worlds_ at which unused worlds are deleted
  std::size_t clear_at_ = kMostCachedWorlds;
  RunCounters past_;  // of deleted worlds; the notes of steps that stand
  std::mutex mutex_;  // guards worlds_, past_, segment indices, and holders
  bool is_shared_ = false;
  double forgotten_ = 0.0, remembered_ = kInfinity;
  std::atomic<std::size_t> kept_ = 0;
  std::uint64_t begun_ = 0, let_go_ = 0;  // segments
};

}  // namespace tumble::engines
