/// What is asked of a run beside its scene and laws: the same for every engine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/dynamics/world.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// Makes a scheduler's life hard, for tests: none of it may change what is committed.
struct FaultInjection {
  std::uint64_t seed = 0;
  bool shuffle = false;  // processes begin in an order drawn by lot
  // events up to so far ahead of global virtual time are taken in an order drawn by lot
  double disorder_s = 0.0;
  // before every so many events a process drawn by lot is rolled back; 0: never
  int rollback_every = 0;
  double rollback_s = 0.0;  // by up to this
  // with one thread: callbacks are taken after all that others could do without them
  bool late_callbacks = false;
  double delay_s = 0.0;  // threads are held up, now and then, by up to this
  // room is cut into so many, at most 255, however few bodies there are; 0: as it pays
  int regions = 0;
};

/// What a program does to bodies while they move: at `time` it is handed the state of each of
/// `bodies`, and may change velocities (not places). It must depend on nothing else: an engine that
/// goes back in time calls it again, and only what it did last is committed.
struct Callback {
  double time;              // [s]
  std::vector<int> bodies;  // movable, ascending
  std::function<void(int body, RigidBodyState& state)> act;
};

/// Which bodies move together at a committed frame, by the flights of that instant: tests of
/// islands look at it.
struct Membership {
  double time;  // [s]
  // by body: of the process that it is part of; -1: it flies freely, or is immovable
  std::vector<int> segments;
  std::vector<int> first_members;  // by body: the least body that moves with it, perhaps itself
};

/// An instant at which a hand may act: the end of a step, in the coordinates that the engine uses.
struct HandMoment {
  double time;  // [s]
  const World& world;
  const std::vector<RigidBodyState>& states;  // by body
  Vector3d origin_world = Vector3d::Zero();   // of these coordinates [m]
};
/// What a person does to a run while it goes: asked at the end of every step, it answers with a
/// scene that holds new entries of steady forces and nothing else, which begin at that instant or
/// later. Places are in the coordinates of the moment. The run is the same, bit for bit, as one
/// whose scene had these entries, behind its own, from the start.
using Hand = std::function<std::optional<scene::Scene>(const HandMoment&)>;

struct RunOptions;
/// An engine that stands outside the framework: timewarp, whose scheduler is an assignment's (see
/// framework/README.md).
using Engine = std::function<void(const scene::Scene& scene, const Laws& laws,
                                  const RunOptions& options, TrajectorySink& sink)>;

struct RunOptions {
  std::string engine;  // a word of engine_words(); empty: the scene's, or rd
  FaultInjection faults;
  // of the fast timewarp; what is committed is the same with any number
  int threads = 1;
  // of a body that the fast timewarp keeps, at least 8; 0: as many as it takes
  int most_states = 0;
  // what "tw" is where the laws hold no scheduling; empty: there is no scheduler
  Engine timewarp;
  // "laws": bodies go by the laws' integration; "auto": in closed form where nothing but gravity
  // acts.
  std::string propagator;
  // Empty: laws for rd, which shows a student's work; the
  // others know closed forms only
  std::optional<double> step_s;      // overrides the scene's
  std::optional<double> duration_s;  // overrides the scene's
  double frame_rate_hz = 60.0;       // of recorded frames
  // of further frames; who judges a run asks for those of its checks (instants_of_checks) [s]
  std::vector<double> instants_s;
  std::vector<Callback> callbacks;  // in order of time
  // of rd only; empty: nobody acts
  Hand hand;
  // called at each frame by the engines that go from event to event; empty: not called
  std::function<void(const Membership&)> on_membership;
  std::string command;  // for the record
};

}  // namespace tumble::engines
