#include "framework/engines/contact/lasting_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/collision/gap.h"
#include "framework/core/numbers.h"
#include "framework/engines/stepping/body_groups.h"
#include "framework/engines/base/guarded_laws.h"

namespace tumble::engines {
namespace {

constexpr double kRounding = 64;          // of coordinates far from the origin, in the shell
constexpr double kBand = 8.0;             // shells: nearer than this two touch
constexpr double kUnseenRoom = 1e-9;      // of the way in a step: what the tolerance of the impulses leaves between bodies that touch
constexpr double kApart = 32.0;           // shells: farther than this, and than the rest speed goes in a step, a contact has ended
constexpr double kAssembled = 1e-6;       // of the smaller body: a scene's models have single precision; what does not bounce and is this near at the start stands on each other
constexpr long kMostCutsABody = 1000;     // of a step, by contacts that ask for shorter ones
constexpr std::uint64_t kMostSweeps = 300'000;   // of the contact solver in a step: some 200 problems that all stayed unsolved
constexpr double kReach = 0.25;           // of the smaller body: points farther away are not looked at
constexpr double kDeep = 0.01;            // of the smaller body: deeper than this no step leads, save in heaps; a point that is gets a second look
constexpr double kDeeper = 1.1;           // of how far the two are in each other
constexpr double kMostTurn = 0.05;        // rad: a group with contacts that turns twice as far gets shorter steps; what is left is of second order
constexpr double kSlips = 1e-4;           // of the rest speed: slower than this nothing slides, though friction may be all there can be
constexpr double kTurns = 1e-5;           // rad: where nothing turns more in a step, forces of its start do for the whole; errors of energy go with this
constexpr int kCurvedRounds = 2;          // where a curved surface touches at the step's end hangs on how it turns in it: a second look leaves a thirtieth of the error
constexpr std::size_t kContactsOfAHeap = 60;   // in_step: so many are asked for by a few sweeps
// Of the heap's speed: what its sweeps leave at the worst of hundreds of contacts (0.28 in the bowl of 200 models, whose energy and gaps are right) its shell
// and the next step take up. Where as much is left as there was, no answer was found at all.
constexpr double kHeapSolved = 1.0;
constexpr double kMidway = 0.3;           // of the smaller body: how far from each other points of one contact may lie at the middle of a step
constexpr int kFrameRounds = 6;           // of drawing apart what a frame within a step shows

}  // namespace

void LastingContacts::begin(Pair pair, const collision::Gap& gap) {
  if (!lasting_.insert(pair).second) return;
  ++counters_.contacts_begun;
  sink_.event({moving_.time(), EventKind::kContact, pair.first, pair.second, gap.point_b_world, gap.normal_b_to_a_world, 0.0, 0.0});
}

void LastingContacts::begin_where_touching(const std::vector<Pair>& pairs) {
  for (const Pair& pair : pairs) {
    const collision::Gap gap = gap_of(pair, moving_.states());
    const double within = std::max(shell(pair), is_dead(pair) ? kAssembled * size_of(pair) : 0.0);
    if (gap.distance > within) continue;
    const Points points = points_at(pair, moving_.states(), within);
    const Body a = moving_.body_at_impact(pair.first), b = moving_.body_at_impact(pair.second);
    const bool slow = std::all_of(points.begin(), points.end(), [&](const collision::NearPoint& p) {
      const Vector3d relative = a.velocity_world + a.omega_world.cross(point_of(pair, p) - a.com_world) - b.velocity_world - b.omega_world.cross(point_of(pair, p) - b.com_world);
      return std::abs(relative.dot(p.normal_b_to_a_world)) < rest_speed_;
    });
    if (slow) begin(pair, gap);
  }
  draw_apart();
}

// A scene's places are rounded: of bodies wedged between others no single shift takes that back.
void LastingContacts::draw_apart() {
  std::vector<RigidBodyState> states = moving_.states();
  const auto closed = [&](const Pair& pair) { return distance_of(pair, states, 0.0) < 0; };
  for (const Group& group : groups({lasting_.begin(), lasting_.end()})) {
    if (std::none_of(group.pairs.begin(), group.pairs.end(), closed)) continue;
    keep_apart(group, group.pairs, states, moving_.time());
    for (const int body : group.bodies) moving_.set_state(body, states[body]);
  }
}

// Where forces act: on the surface of the body that moves, so that a rolling ball's arm is its radius; between two that move, in the middle.
Vector3d LastingContacts::point_of(Pair pair, const collision::NearPoint& p) const {
  if (moving_.world().bodies[pair.second].immovable()) return p.point_a_world;
  if (moving_.world().bodies[pair.first].immovable()) return p.point_b_world;
  return 0.5 * (p.point_a_world + p.point_b_world);
}

double LastingContacts::friction(Pair pair) const {
  if (!built::kFriction) return 0.0;
  return std::min(moving_.world().bodies[pair.first].friction, moving_.world().bodies[pair.second].friction);
}

bool LastingContacts::is_dead(Pair pair) const { return std::min(moving_.world().bodies[pair.first].restitution, moving_.world().bodies[pair.second].restitution) == 0.0; }

bool LastingContacts::plastic(Pair pair) const {
  if (locates() && heaped_.empty()) return false;
  return is_dead(pair) && (!locates() || heaped_.contains(pair.first) || heaped_.contains(pair.second));
}

double LastingContacts::size_of(Pair pair) const { return std::min(moving_.shape(pair.first).bounding_radius(), moving_.shape(pair.second).bounding_radius()); }

double LastingContacts::shell(Pair pair) const {
  const double size = size_of(pair);
  const auto far = [&](int body) { return moving_.world().bodies[body].immovable() ? 0.0 : moving_.state(body).com_world.cwiseAbs().maxCoeff(); };
  return kContactMargin * size + kRounding * kEpsilon * (size + std::max(far(pair.first), far(pair.second)));
}

// How much nearer the two can come in the step.
double LastingContacts::reach(Pair pair) {
  const double h = moving_.target() - moving_.time();
  const auto motion = [&](int body) {
    const collision::MotionState start = moving_.motion_at(body, moving_.time()), end = moving_.motion_at(body, moving_.target());
    const double radius = moving_.shape(body).is_half_space() ? 0.0 : moving_.shape(body).bounding_radius();
    return std::max(start.velocity_world.norm(), end.velocity_world.norm()) + std::max(start.omega_world.norm(), end.omega_world.norm()) * radius;
  };
  const double size = size_of(pair);
  const double way = (reaches_.empty() ? motion(pair.first) + motion(pair.second) : reaches_[pair.first] + reaches_[pair.second]) * h;
  return std::min(kReach * size, way) + kApart * shell(pair);
}

// Where blows are dealt with in the step, a body may be as fast by its end as any that can meet it. [m/s], by body
std::vector<double> LastingContacts::speeds_about(const std::vector<Pair>& candidates) {
  std::vector<double> speeds(moving_.size(), 0.0);
  std::vector<char> meets(moving_.size(), 0);
  for (const auto& [a, b] : candidates) meets[a] = meets[b] = 1;
  for (int i = 0; i < moving_.size(); ++i)
    for (const double t : {moving_.time(), moving_.target()}) {
      if (!meets[i] || (!moving_.can_move(i) && !moving_.is_driven(i))) continue;
      const collision::MotionState state = moving_.motion_at(i, t);
      speeds[i] = std::max(speeds[i], state.velocity_world.norm() + (moving_.shape(i).is_half_space() ? 0.0 : state.omega_world.norm() * moving_.shape(i).bounding_radius()));
    }
  std::vector<double> about = speeds;
  for (const auto& [a, b] : candidates) {
    about[a] = std::max(about[a], speeds[b]);
    about[b] = std::max(about[b], speeds[a]);
  }
  for (int i = 0; i < moving_.size(); ++i)
    if (!moving_.can_move(i)) about[i] = speeds[i];
  return about;
}

collision::Pose LastingContacts::pose(int body, const std::vector<RigidBodyState>& states) const {
  return {states[body].com_world, states[body].world_from_body};
}

LastingContacts::Points LastingContacts::points_at(Pair pair, const std::vector<RigidBodyState>& states, double reach) const {
  Points points = collision::near_points(moving_.shape(pair.first), pose(pair.first, states), moving_.shape(pair.second), pose(pair.second, states), reach,
                                         moving_.pair_cache(pair.first, pair.second));
  // Two that touch at corners may face each other along any direction, and a column along it may go in at a narrow side and out at the far end:
  // no point is deeper than the two are in each other.
  if (std::any_of(points.begin(), points.end(), [&](const collision::NearPoint& p) { return p.gap < -kDeep * size_of(pair); })) {
    const collision::Gap deepest = gap_of(pair, states);
    std::erase_if(points, [&](const collision::NearPoint& p) { return p.gap < std::min(0.0, kDeeper * deepest.distance); });
    if (points.empty() && deepest.distance <= reach) points.push_back({deepest.point_a_world, deepest.point_b_world, deepest.normal_b_to_a_world, deepest.distance});
  }
  return points;
}

collision::Gap LastingContacts::gap_of(Pair pair, const std::vector<RigidBodyState>& states) const {
  return collision::compute_gap(moving_.shape(pair.first), pose(pair.first, states), moving_.shape(pair.second), pose(pair.second, states),
                                moving_.pair_cache(pair.first, pair.second));
}

// Above `limit` a bound from below.
double LastingContacts::distance_of(Pair pair, const std::vector<RigidBodyState>& states, double limit) const {
  return collision::gap_distance(moving_.shape(pair.first), pose(pair.first, states), moving_.shape(pair.second), pose(pair.second, states),
                                 moving_.pair_cache(pair.first, pair.second), limit);
}

double LastingContacts::least_gap_of(Pair pair, const std::vector<RigidBodyState>& states) const {
  return collision::least_gap(moving_.shape(pair.first), pose(pair.first, states), moving_.shape(pair.second), pose(pair.second, states));
}

std::vector<LastingContacts::Group> LastingContacts::groups(const std::vector<Pair>& touching) {
  const int n = moving_.size();
  const std::vector<int> leader = group_leaders(moving_, touching);
  std::map<int, Group> by_leader;
  for (const auto& pair : touching) by_leader[leader[moving_.can_move(pair.first) ? pair.first : pair.second]].pairs.push_back(pair);
  for (int i = 0; i < n; ++i) {
    if (!moving_.can_move(i)) continue;
    const auto group = by_leader.find(leader[i]);
    if (group == by_leader.end()) continue;
    group->second.bodies.push_back(i);
    const int linked = moving_.linked_group(i);
    if (linked >= 0 && moving_.linked_groups()[linked].bodies().front() == i) group->second.linked.push_back(linked);
  }
  std::vector<Group> result;
  for (auto& [first, group] : by_leader) result.push_back(std::move(group));
  return result;
}

std::vector<LastingContacts::Touch> LastingContacts::touches_of(const Group& group) {
  std::vector<Touch> touches;
  for (const Pair& pair : group.pairs)
    for (const collision::NearPoint& point : points_.at(pair)) {
      const double thickness = shell(pair), room = point.gap - thickness;
      const bool lands = room > kBand * thickness + kUnseenRoom * reach(pair);
      touches.push_back({pair, point, lands ? -room / (moving_.target() - moving_.time()) : 0.0, lands, Vector3d::Zero(), point.gap});
    }
  return touches;
}

std::optional<double> LastingContacts::advance(const std::vector<Pair>& candidates) {
  const StageTimer timer(counters_.contact_seconds);
  const double h = moving_.target() - moving_.time();
  step_ = std::max(step_, h);
  points_.clear();
  forces_.clear();
  groups_.clear();
  unsolved_ = {};
  std::vector<Pair> touching;
  const bool in_step = !locates() || !heaped_.empty();
  reaches_ = in_step ? speeds_about(candidates) : std::vector<double>{};
  for (const Pair& pair : candidates) {
    if (!lasting_.contains(pair) && !plastic(pair)) continue;
    if (in_step) {
      const double within = reach(pair);
      if (least_gap_of(pair, moving_.states()) <= within && distance_of(pair, moving_.states(), within) <= within) touching.push_back(pair);
      continue;
    }
    Points points = points_at(pair, moving_.states(), reach(pair));
    if (points.empty()) continue;
    touching.push_back(pair);
    points_.emplace(pair, std::move(points));
  }
  if (touching.empty()) return std::nullopt;
  groups_ = groups(touching);
  for (Group& group : groups_) group.pile = is_pile(group);
  heaped_.clear();
  for (const Group& group : groups_)
    if (group.pile && locates()) heaped_.insert(group.bodies.begin(), group.bodies.end());
  if (in_step)
    for (Group& group : groups_) {
      for (const Pair& pair : group.pairs) points_.emplace(pair, group.pile ? Points{} : points_at(pair, moving_.states(), reach(pair)));
    }
  note_near_pairs(candidates);
  next_warm_.clear();
  next_stuck_.clear();
  if (const auto earlier = take_steps(h)) {
    require_progress();
    return earlier;
  }
  warm_ = std::move(next_warm_);
  tried_.clear();
  stuck_ = std::move(next_stuck_);
  return std::nullopt;
}

// Every group's step. @return the earliest target that one of them asks for: the step begins again for all, and once for many groups is
// cheaper than once for each. Of ends of sliding, the one that is looked for is that of the earliest. The group that asked last is asked first,
// and as long as it asks the others' steps would be in vain: one that lies at rest is not solved again for each blow of a pile elsewhere.
std::optional<double> LastingContacts::take_steps(double h) {
  const auto step = [&](const Group& group) { return group.pile ? take_pile_step(group, h) : take_step(group, h); };
  const auto first = std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) { return std::binary_search(group.bodies.begin(), group.bodies.end(), asked_last_); });
  if (first != groups_.end())
    if (const auto earlier = step(*first)) return earlier;
  const auto of_first = static_cast<std::ptrdiff_t>(forces_.size());
  std::ptrdiff_t before_first = 0;   // forces of groups that stand before it
  std::optional<double> earliest;
  std::optional<Locating> of_earliest;
  for (const Group& group : groups_) {
    if (first != groups_.end() && &group == &*first) {
      before_first = static_cast<std::ptrdiff_t>(forces_.size()) - of_first;
      continue;
    }
    const std::optional<Locating> before = locating_;
    const std::optional<double> earlier = step(group);
    if (earlier && (!earliest || *earlier < *earliest)) {
      earliest = earlier;
      of_earliest = locating_;
      asked_last_ = group.bodies.front();
    }
    locating_ = before;
  }
  if (earliest) locating_ = of_earliest;
  std::rotate(forces_.begin(), forces_.begin() + of_first, forces_.begin() + of_first + before_first);   // in the order of the groups
  return earliest;
}

// A step has been cut once more: contacts that ask for ever shorter ones, or whose problems all stay unsolved, would take hours.
void LastingContacts::require_progress() {
  const double t = moving_.time();
  if (!(cut_since_ <= t && t < cut_since_ + step_)) {
    cut_since_ = t;
    cuts_ = 0;
    sweeps_ = 0;
  }
  ++cuts_;
  const auto who = [&] {
    const auto asked = std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) { return std::binary_search(group.bodies.begin(), group.bodies.end(), asked_last_); });
    return asked == groups_.end() ? std::string("bodies") : names_of(moving_.world(), asked->bodies);
  };
  constexpr const char* kRemedy = "masses or sizes that differ less, or a shorter \"step_s\", may help";
  if (sweeps_ > kMostSweeps)
    throw StoppedRun(fmt::format("{}: what their contacts, rods and joints ask for together stays unsolved, also in the shortest parts of a step of {:.3g} s. They may contradict each other; {}", who(), step_, kRemedy));
  if (cuts_ > kMostCutsABody * static_cast<long>(moving_.size()))
    throw StoppedRun(fmt::format("{}: their contacts ask for more than {} steps within one of {:.3g} s; {}", who(), cuts_ - 1, step_, kRemedy));
}

void LastingContacts::note_near_pairs(const std::vector<Pair>& candidates) {
  std::vector<Group*> group_of(moving_.size(), nullptr);
  for (Group& group : groups_)
    for (const int body : group.bodies) group_of[body] = &group;
  for (const Pair& pair : candidates) {
    Group *const a = group_of[pair.first], *const b = group_of[pair.second];
    if (a) a->near.push_back(pair);
    if (b && b != a) b->near.push_back(pair);
  }
}

bool LastingContacts::is_curved(const Group& group) const {
  return std::any_of(group.bodies.begin(), group.bodies.end(), [&](int body) { return moving_.shape(body).ellipsoid() != nullptr; }) ||
         std::any_of(group.pairs.begin(), group.pairs.end(), [&](const Pair& pair) { return are_balls(pair); });
}

bool LastingContacts::are_balls(Pair pair) const { return moving_.shape(pair.first).is_ball() && moving_.shape(pair.second).is_ball(); }

// A ball has one point on another, however far it has gone from where it was.
double LastingContacts::same_within(Pair pair) const { return are_balls(pair) ? std::numeric_limits<double>::infinity() : kMidway * size_of(pair); }

// Of the fastest point of the group's bodies. [m/s]
double LastingContacts::speed(const Group& group) const {
  double fastest = 0.0;
  for (const int index : group.bodies) {
    const Body body = moving_.body_at_impact(index);
    fastest = std::max(fastest, body.velocity_world.norm() + body.omega_world.norm() * moving_.shape(index).bounding_radius());
  }
  return fastest;
}

// One group's step. @return an earlier target (or the same after a blow) to begin the step again with
std::optional<double> LastingContacts::take_step(const Group& group, double h) {
  std::vector<Touch> touches = touches_of(group);
  const bool located = locates(), moves = located && speed(group) > kMoves * rest_speed_;
  if (moves && strike_what_is_down(group, touches)) return moving_.target();
  ContactProblem problem = problem_of(group, touches, moving_.states(), h);
  const bool parts = let_part(group, touches, problem);
  ContactSolution solution = solve(group, problem, h);
  remember(touches, problem, solution, h, tried_);
  bool landing = lands(touches, solution);
  if (moves && comes_down(group, touches, problem, solution, h)) {
    if (becomes_heap(group)) return moving_.target();
    if (const auto again = sort_out_landings(group, touches, h)) return again;
    problem = problem_of(group, touches, moving_.states(), h);
    solution = solve(group, problem, h);
    landing = false;
  } else if (landing && parts) {   // on straight paths what hops has not left
    keep_together(touches, problem);
    solution = solve(group, problem, h);
    landing = lands(touches, solution);
  }
  std::vector<RigidBodyState> ends = ends_of(group, problem, solution, h, landing);
  const double turn = std::max(largest_turn(group, ends, h), turn_of_normals(group, ends));
  if (located && turn > 2 * kMostTurn && h > kShortest * step_) return moving_.time() + h * kMostTurn / turn;
  std::vector<RigidBodyState> middle;
  std::vector<Touch> used = touches;
  const int rounds = turn <= kTurns ? 0 : is_curved(group) ? kCurvedRounds : 1;
  for (int round = 0; round < rounds && !landing; ++round) {
    if (round > 0) ends = ends_of(group, problem, solution, h, landing, &ends);
    middle = moving_.states();
    used = touches_midway(group, touches, ends, middle);
    problem = problem_of(group, used, middle, h, &ends);
    for (std::size_t i = 0; i < used.size(); ++i) problem.contacts[i].guess_world = solution.impulses_world[i];   // the same points, a little farther on
    solution = solve(group, problem, h);
    landing = lands(used, solution);
  }
  require_numbers(group, solution);
  if (const auto stop = located ? stop_of_sliding(problem, touches, solution, h) : std::nullopt) return stop;
  if (!give_paths(group, used, middle.empty() ? moving_.states() : middle, problem, solution, h, landing, middle.empty() ? nullptr : &ends)) {
    if (!located && group.linked.empty()) return take_pile_step(group, h);
    if (h > kShortest * step_) return moving_.time() + 0.5 * h;
  }
  if (located && h > kShortestForEnergy * step_ && gains_energy(group)) return moving_.time() + 0.5 * h;
  keep_warm(group, touches, problem, solution, h);
  return std::nullopt;
}

void LastingContacts::note_unsolved(const Group& group, const ContactSolution& solution, double h) {
  const bool is_heap = group.pile || (rules_.plastic_impacts == scene::PlasticImpacts::kInStep && solution.impulses_world.size() > kContactsOfAHeap);
  const double allowed = is_heap ? kHeapSolved : kContactSolved;
  if (solution.converged || solution.residual <= allowed) return;
  unsolved_.note(RunWatch::Kind::kContactUnsolved, names_of(moving_.world(), group.bodies), {solution.residual, allowed, moving_.time(), h});
}

void LastingContacts::require_numbers(const Group& group, const ContactSolution& solution) const {
  for (std::size_t k = 0; k < group.bodies.size(); ++k)
    if (!solution.velocities[k].linear_world.allFinite() || !solution.velocities[k].angular_world.allFinite())
      throw StoppedRun("lasting contact: the impulses on body '" + moving_.world().bodies[group.bodies[k]].name + "' are not numbers");
}

// Puts a solution's impulses where the next problem of these pairs finds its guesses.
void LastingContacts::remember(const std::vector<Touch>& touches, const ContactProblem& problem, const ContactSolution& solution, double h, std::map<Pair, std::vector<Warm>>& store) const {
  for (std::size_t i = 0; i < touches.size(); ++i) {
    std::vector<Warm>& known = store[touches[i].pair];
    if (i == 0 || touches[i].pair != touches[i - 1].pair) known.clear();
    const RigidBodyState& a = moving_.state(touches[i].pair.first);
    known.push_back({a.world_from_body.conjugate() * (problem.contacts[i].point_world - a.com_world), solution.impulses_world[i], h});
  }
}

// What the next step remembers of this one's impulses.
void LastingContacts::keep_warm(const Group& group, const std::vector<Touch>& touches, const ContactProblem& problem, const ContactSolution& solution, double h) {
  note_unsolved(group, solution, h);
  remember(touches, problem, solution, h, next_warm_);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Vector3d force = solution.impulses_world[i] / h, point = problem.contacts[i].point_world;
    const bool slides = solution.modes[i] == ContactMode::kSlide && !force.isZero(0.0) && slip_speed(problem, i, solution.velocities) > kSlips * rest_speed_;
    if (i == 0 || touches[i].pair != touches[i - 1].pair) next_stuck_.insert(touches[i].pair);
    if (slides) next_stuck_.erase(touches[i].pair);
    if (!force.isZero(0.0)) forces_.push_back({touches[i].pair.first, touches[i].pair.second, point, touches[i].point.normal_b_to_a_world, force});
  }
}

void LastingContacts::open_gaps(std::vector<RigidBodyState>& states, double t) {
  const RunCounters before = counters_;   // what is looked at must not show in what a run counts
  const double left = (moving_.target() - t) / (moving_.target() - moving_.time());
  for (const Group& group : groups_) {
    // A path that leads straight to the step's end has the velocity of that end all along. Momenta that change evenly show no energy that
    // neither end has.
    if (!group.linked.empty()) continue;   // momenta of these are on their rods and joints
    for (const int body : group.bodies) {
      const RigidBodyState &start = moving_.state(body), &end = moving_.path_end(body);
      states[body].momentum_world = left * start.momentum_world + (1 - left) * end.momentum_world;
      states[body].angular_momentum_world = left * start.angular_momentum_world + (1 - left) * end.angular_momentum_world;
    }
  }
  const auto closed = [&](const Pair& pair) { return least_gap_of(pair, states) < 0 && distance_of(pair, states) < 0; };
  bool any = true;
  for (int round = 0; round < kFrameRounds && any; ++round) {   // one group's shifts may close another's gaps
    any = false;
    for (const Group& group : groups_) {
      if (std::none_of(group.near.begin(), group.near.end(), closed)) continue;
      any = true;
      std::vector<double> gaps(group.near.size(), 0.0);
      if (group.pile || !keep_apart(group, group.near, states, t)) keep_pile_apart(group, group.near, states, t, gaps);
    }
  }
  counters_ = before;
}

void LastingContacts::draw_apart(const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t) {
  const RunCounters before = counters_;   // as above
  const auto closed = [&](const Pair& pair) { return least_gap_of(pair, states) < 0 && distance_of(pair, states) < 0; };
  for (int round = 0; round < kFrameRounds && std::any_of(pairs.begin(), pairs.end(), closed); ++round)
    for (const Group& group : groups(pairs)) {
      if (std::none_of(group.pairs.begin(), group.pairs.end(), closed)) continue;
      std::vector<double> gaps(group.pairs.size(), 0.0);
      if (!keep_apart(group, group.pairs, states, t)) keep_pile_apart(group, group.pairs, states, t, gaps);
    }
  counters_ = before;
}

// A ball has been carried by another to where nothing presses them together: no force in the step, and along the normal
//   a_n = n . (g_a - g_b) + v_t^2 / R > 0,   R the distance of their centres, v_t their velocity along the surface.
bool LastingContacts::flies_off(Pair pair, const std::vector<RigidBodyState>& states) const {
  if (!are_balls(pair)) return false;
  const auto pushes = [&](const ContactPoint& point) { return point.body_a == pair.first && point.body_b == pair.second; };
  if (std::any_of(forces_.begin(), forces_.end(), pushes)) return false;
  Vector3d gravity = Vector3d::Zero(), velocity = Vector3d::Zero();   // of the first against the second
  for (const auto& [body, sign] : {std::pair{pair.first, 1.0}, std::pair{pair.second, -1.0}}) {
    const WorldBody& b = moving_.world().bodies[body];
    velocity += sign * (b.immovable() ? prescribed_velocity(b, moving_.time()) : Vector3d(b.inertia.inverse_mass * states[body].momentum_world));
    if (!b.immovable() && moving_.world().gravity_world) gravity += sign * *moving_.world().gravity_world;
  }
  const Vector3d between = states[pair.first].com_world - states[pair.second].com_world, n = between.normalized();
  const double normal_speed = n.dot(velocity);
  return normal_speed > 0 && n.dot(gravity) + (velocity - normal_speed * n).squaredNorm() / between.norm() > 0;
}

bool LastingContacts::commit() {
  const StageTimer timer(counters_.contact_seconds);
  if (groups_.empty()) return true;
  counters_.watch.add(std::exchange(unsolved_, {}));
  bool apart = true;
  std::vector<RigidBodyState> states = moving_.states();
  for (const Group& group : groups_) {
    std::vector<double> gaps(group.near.size(), 0.0);
    if (group.pile) {
      apart = keep_pile_apart(group, group.near, states, moving_.time(), gaps) && apart;
    } else {
      keep_apart(group, group.near, states, moving_.time());
      apart = false;
    }
    for (const int body : group.bodies) moving_.set_state(body, states[body]);
    for (std::size_t k = 0; k < group.near.size(); ++k) {
      const Pair& pair = group.near[k];
      if (!keeps(pair)) continue;
      const bool lasted = lasts(pair);
      const bool trembles = lasted && !flies_off(pair, states);   // what comes back need not begin anew
      const double near = std::max(group.pile ? 2 * room_of(pair) : kApart * shell(pair), trembles ? rest_speed_ * step_ : 0.0);
      const bool touches = (group.pile ? gaps[k] : distance_of(pair, states, near)) <= near;
      if (touches == lasted) continue;
      const collision::Gap gap = gap_of(pair, states);
      if (touches) {
        begin(pair, gap);
      } else {
        lasting_.erase(pair);
        ++counters_.contacts_ended;
        sink_.event({moving_.time(), EventKind::kBreak, pair.first, pair.second, gap.point_b_world, gap.normal_b_to_a_world, 0.0, 0.0});
      }
    }
  }
  return apart;
}

}  // namespace tumble::engines
