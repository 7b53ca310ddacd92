/// What a run's first frame shows of its start: velocities and places of bodies on rods and joints
/// that did not fit and were changed. One place for all engines: it compares the frame that they
/// record with the scene.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/passing_sink.h"

namespace tumble::engines {

/// Hands everything on; adds notices to what end() is given.
class StartWatch final : public PassingSink {
 public:
  /// @param scene    as the user wrote it
  /// @param pushed   bodies that a callback acts on at the start: their velocities are not compared
  StartWatch(const scene::Scene& scene, std::set<int> pushed, TrajectorySink& sink)
      : PassingSink(sink), scene_(scene), pushed_(std::move(pushed)) {}

  void add(std::string notice) { notices_.push_back(std::move(notice)); }
  void frame(const Frame& frame) override;
  void end(const Counters& counters, const std::string& stopped_by) override;

 private:
  void compare(const Frame& start);

  const scene::Scene& scene_;
  std::set<int> pushed_;
  bool is_compared_ = false;
  std::vector<std::string> notices_;
};

}  // namespace tumble::engines
