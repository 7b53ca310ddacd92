/// What contacts remember from one step to the next: plain data, copied with a state of the bodies.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/core/math.h"
#include "framework/core/numbers.h"
#include "framework/dynamics/body.h"
#include "framework/engines/contact/pair_table.h"

namespace tumble::engines {

/// An impulse that acted at a contact: the warm start of the next problem.
struct KnownImpulse {
  Vector3d point_body_a, impulse_world;  // [m], on A [N s]
  double duration;                       // of the step that it was spread over [s]
};

/// The end of sliding that is being looked for: two steps of different lengths say what stops it.
struct SlidingSearch {
  std::pair<int, int> pair;
  double start, duration, impulse;  // [s], [s], [N s]
  bool found;
};

struct ContactMemory {
  using Pair = std::pair<int, int>;  // bodies, first < second

  std::set<Pair> persistent;  // pairs in contact
  // those that touched at the start, until a step on the grid has been taken
  std::set<Pair> apart_at_start;
  double longest_step = 0.0;  // so far, at least that of the scene's grid [s]
  // Warm start: of the last step, and of attempts at the one that has begun.
  PairTable<std::vector<KnownImpulse>> last_impulses;
  std::map<Pair, std::vector<KnownImpulse>> tried_impulses;
  // What contacts pressed bodies with in the last step that was not very short, its mean: of bodies
  // on which forces act that follow their motion (MovingWorld::lead_pressed).
  std::map<int, Wrench> pressing;
  std::set<Pair> stuck;  // pairs with friction that did not slide in the last step
  // pairs of islands whose links left open which contact carries a load, in the last step
  std::set<Pair> sharing;
  // Pairs that rods, joints or walls leave no room for a margin between them, and until when [s].
  std::map<Pair, double> without_margin;
  // Large islands: bodies whose island has, or has had since it last came to rest, too many impacts
  // a step to locate each.
  std::set<int> in_large_island;
  // impacts that cut a step were counted since [s], and how many of each island, by its first body
  double impacts_counted_from = -kInfinity;
  std::map<int, int> impacts_counted;
  // points landed last [s], and how often at that instant
  double activated_at = -kInfinity;
  int activations_there = 0;
  // Ends of sliding.
  double searched_from = -kInfinity;  // were looked for since [s], and how often
  int searches = 0;
  std::optional<SlidingSearch> sliding_search;
  // Progress: how often the step was cut since, and sweeps of the solver for impulses and for
  // corrections, without those of large islands.
  double cut_since = -kInfinity;  // [s]
  long cuts = 0;
  std::uint64_t sweeps = 0;
  // problems of islands that a driven body presses, unsolved from one instant on [s], and how many
  double jammed_at = -kInfinity;
  int jams = 0;
  // body of the island that last asked for an earlier target
  int asked_last = -1;
};

}  // namespace tumble::engines
