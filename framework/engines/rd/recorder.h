/// Frames of a run, at exact frame times, without touching the committed path.
#pragma once

#include "framework/engines/base/frame_times.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

class PersistentContacts;
class Sleepers;

/// Smallest gap over all pairs that may collide; infinite where there is none. [m] Pairs of bodies
/// that stand still from frame to frame (asleep, or immovable) are measured once.
class SmallestGap {
 public:
  double measure(const MovingWorld& moving, const std::vector<RigidBodyState>& states);

 private:
  void sort_bodies(const MovingWorld& moving);

  // bodies for collision; those that pass each other, like the links of a chain, apart
  std::vector<int> meets_all_, meets_others_;
  std::vector<char> still_;  // by body, when still_gap_ was measured
  double still_gap_ = 0.0;   // between two of these [m]
};

class FrameRecorder {
 public:
  FrameRecorder(FrameTimes times, TrajectorySink& sink) : times_(std::move(times)), sink_(sink) {}

  /// Frames hold the forces of these contacts, and what they hold apart is apart in frames within a
  /// step, too.
  void record_contacts_of(PersistentContacts& contacts) { contacts_ = &contacts; }
  void record_contacts_of(const Sleepers& sleepers) { sleepers_ = &sleepers; }

  /// Pushes the frames that lie before `t`, from the paths of the step under way.
  void record_before(MovingWorld& moving, double t);
  /// Pushes the frame that lies at the committed time, if there is one.
  void record_committed(MovingWorld& moving);

 private:
  void push(MovingWorld& moving, double t);

  FrameTimes times_;
  TrajectorySink& sink_;
  PersistentContacts* contacts_ = nullptr;
  const Sleepers* sleepers_ = nullptr;
  SmallestGap smallest_gap_;
};

}  // namespace tumble::engines
