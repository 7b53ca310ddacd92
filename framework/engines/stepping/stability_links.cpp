// How hard rods and joints may pull in a run, and the fastest swing of bodies between joints that
// do.
//
// Where a run starts its links may carry nothing (a chain held out level); a moment later they
// carry all that hangs on them, and what its fall adds. So what limits a step is not what stands in
// the start.
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include <fmt/format.h>

#include "framework/core/decompositions.h"
#include "framework/dynamics/anchors.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/stability.h"

namespace tumble::engines {
namespace {

// of a line's length: what starts nearer to where it hangs than this falls before its links pull
constexpr double kTaut = 0.999;

/// Movable bodies as a tree that hangs from what does not move: each on the carrier by which it is
/// nearest to it.
class Hanging {
 public:
  Hanging(const World& world, const std::vector<effects::Carrier>& carriers)
      : world_(world), carriers_(carriers), hung_(world.bodies.size()) {
    for (const WorldBody& body : world.bodies) states_.push_back(body.state);
    ends_on_.resize(world.bodies.size());
    for (std::size_t k = 0; k < carriers.size(); ++k)
      for (const Anchor* anchor : {&carriers[k].a, &carriers[k].b})
        if (is_movable(*anchor)) ends_on_[static_cast<std::size_t>(anchor->body)].push_back(k);
  }

  /// The load of each carrier: the weight below it, and what holds the way round of all that energy
  /// can set going there:
  ///   T = M g + 2 (E_kinetic + E_fall) / R
  /// with R how far down the line the mass below lies from where it all hangs. Where the links hang
  /// loose first, or the fall pulls harder than the weight, they come taut with a jerk: what falls
  /// is turned round by a light body that takes all its energy and passes the line at  sqrt(M / m)
  /// times its speed, so that the second part is so much larger.
  bool by_falling() const { return by_falling_; }
  /// @param loads  by carrier
  void find_loads(std::vector<double>& loads) {
    hang();
    const double gravity = world_.gravity_world ? world_.gravity_world->norm() : 0.0;
    double energy = 0.0;  // of all that hangs: kinetic, and what it can fall by
    for (const int body : order_) {
      const WorldBody& hanging = world_.bodies[static_cast<std::size_t>(body)];
      const Hung& hung = hung_[static_cast<std::size_t>(body)];
      energy += kinetic_energy(hanging.state, hanging.inertia) +
                hanging.inertia.mass * gravity * std::max(0.0, hung.depth - hung.down);
    }
    // below each, itself included
    std::vector<double> mass(world_.bodies.size(), 0.0), moment(world_.bodies.size(), 0.0);
    for (auto body = order_.rbegin(); body != order_.rend(); ++body) {
      const auto i = static_cast<std::size_t>(*body);
      mass[i] += world_.bodies[i].inertia.mass;
      moment[i] += world_.bodies[i].inertia.mass * hung_[i].depth;
      if (hung_[i].above >= 0) {
        mass[static_cast<std::size_t>(hung_[i].above)] += mass[i];
        moment[static_cast<std::size_t>(hung_[i].above)] += moment[i];
      }
      const double weight = mass[i] * gravity,
                   swing = 2.0 * energy * mass[i] /
                           std::max(moment[i], std::numeric_limits<double>::min());
      const bool is_jerked = swing > weight || hung_[i].distance < kTaut * hung_[i].depth;
      by_falling_ = by_falling_ || is_jerked;
      loads[hung_[i].carrier] =
          weight + swing * (is_jerked ? std::sqrt(mass[i] / lighter_of(*body)) : 1.0);
    }
  }

 private:
  struct Hung {
    // of its centre, along the carriers [m]
    double depth = std::numeric_limits<double>::infinity();
    double down = 0.0;      // of its centre now, below where it all hangs, along gravity [m]
    double distance = 0.0;  // of its centre now, from there [m]
    int above = -1;
    std::size_t carrier = 0;
  };

  // Of the body and the one that it hangs on. [kg]
  double lighter_of(int body) const {
    const Hung& hung = hung_[static_cast<std::size_t>(body)];
    const double own = world_.bodies[static_cast<std::size_t>(body)].inertia.mass;
    return hung.above < 0
               ? own
               : std::min(own, world_.bodies[static_cast<std::size_t>(hung.above)].inertia.mass);
  }
  bool is_movable(const Anchor& anchor) const {
    return anchor.body >= 0 && !world_.bodies[static_cast<std::size_t>(anchor.body)].immovable();
  }
  Vector3d down() const {
    return world_.gravity_world && !world_.gravity_world->isZero(0.0)
               ? world_.gravity_world->normalized()
               : Vector3d(Vector3d::UnitZ());
  }

  void hang() {
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
    const auto reach = [&](std::size_t k, const Anchor& to, double depth, int above,
                           const Vector3d& root) {
      Hung& hung = hung_[static_cast<std::size_t>(to.body)];
      const double reached = depth + carriers_[k].length + to.point_body.norm();
      if (!(reached < hung.depth)) return;
      const Vector3d from_root = states_[static_cast<std::size_t>(to.body)].com_world - root;
      hung = {reached, down().dot(from_root), from_root.norm(), above, k};
      next.emplace(reached, to.body);
    };
    std::vector<Vector3d> roots(world_.bodies.size(), Vector3d::Zero());
    for (std::size_t k = 0; k < carriers_.size(); ++k)
      for (const auto& [from, to] :
           {std::pair{carriers_[k].a, carriers_[k].b}, std::pair{carriers_[k].b, carriers_[k].a}})
        if (!is_movable(from) && is_movable(to)) {
          const Vector3d root = anchor_point(from, states_);
          const double before = hung_[static_cast<std::size_t>(to.body)].depth;
          reach(k, to, 0.0, -1, root);
          if (hung_[static_cast<std::size_t>(to.body)].depth < before)
            roots[static_cast<std::size_t>(to.body)] = root;
        }
    std::vector<char> done(world_.bodies.size(), 0);
    while (!next.empty()) {
      const int body = next.top().second;
      next.pop();
      if (std::exchange(done[static_cast<std::size_t>(body)], 1)) continue;
      order_.push_back(body);
      for (const std::size_t k : ends_on_[static_cast<std::size_t>(body)]) {
        const bool is_a = carriers_[k].a.body == body;
        const Anchor &from = is_a ? carriers_[k].a : carriers_[k].b,
                     &to = is_a ? carriers_[k].b : carriers_[k].a;
        if (!is_movable(to) || done[static_cast<std::size_t>(to.body)]) continue;
        const double before = hung_[static_cast<std::size_t>(to.body)].depth;
        reach(k, to, hung_[static_cast<std::size_t>(body)].depth + from.point_body.norm(), body,
              roots[static_cast<std::size_t>(body)]);
        if (hung_[static_cast<std::size_t>(to.body)].depth < before)
          roots[static_cast<std::size_t>(to.body)] = roots[static_cast<std::size_t>(body)];
      }
    }
  }

  const World& world_;
  const std::vector<effects::Carrier>& carriers_;
  std::vector<RigidBodyState> states_;
  std::vector<Hung> hung_;
  std::vector<std::vector<std::size_t>> ends_on_;  // by body
  std::vector<int> order_;                         // from where they hang outwards
  bool by_falling_ = false;
};

}  // namespace

Carriers::Carriers(const World& world) {
  for (std::size_t k = 0; k < effects::all().size(); ++k) {
    effects::all()[k]->append_carriers(world, all);
    effect.resize(all.size(), k);
  }
}

LinkLoads largest_link_loads(const World& world, const std::vector<effects::Carrier>& carriers) {
  LinkLoads found{std::vector<double>(carriers.size(), 0.0)};
  if (carriers.empty()) return found;
  Hanging hanging(world, carriers);
  hanging.find_loads(found.loads);
  found.by_falling = hanging.by_falling();
  return found;
}

// For turns by small angles of bodies that hang on each other the energy is at most  1/2 sum_i
// (sum_k T_k |r_ik|) angle_i^2  and the kinetic one at least  1/2 sum_i I_i angle_i'^2, so that
// w^2 <= max_i  sum_k T_k |r_ik| / I_i.  A row of equal bars reaches it: neighbours turn to and
// fro. A body whose joint does not move swings about that, and I_i is its moment there: a small bob
// is a pendulum.
std::optional<StepLimit> judge_joints(const World& world,
                                      const std::vector<effects::Carrier>& carriers,
                                      const std::vector<double>& loads, const Laws& laws,
                                      double step) {
  std::vector<double> stiffness(world.bodies.size(), 0.0);
  std::vector<char> turns(world.bodies.size(), 0);
  std::vector<double> arm_to_fixed(world.bodies.size(), 0.0);  // [m]
  const auto stays = [&](const Anchor& anchor) {
    return anchor.body < 0 || world.bodies[static_cast<std::size_t>(anchor.body)].immovable();
  };
  for (const bool of_joints : {true, false})  // sums in this order
    for (std::size_t k = 0; k < carriers.size(); ++k) {
      if ((carriers[k].length == 0.0) != of_joints) continue;
      for (const Anchor* anchor : {&carriers[k].a, &carriers[k].b}) {
        if (anchor->body < 0) continue;
        stiffness[static_cast<std::size_t>(anchor->body)] += loads[k] * anchor->point_body.norm();
        if (carriers[k].turns) turns[static_cast<std::size_t>(anchor->body)] = 1;
        const bool is_a = anchor == &carriers[k].a;
        if (of_joints && stays(is_a ? carriers[k].b : carriers[k].a))
          arm_to_fixed[static_cast<std::size_t>(anchor->body)] =
              std::max(arm_to_fixed[static_cast<std::size_t>(anchor->body)],
                       is_a ? carriers[k].arm_a : carriers[k].arm_b);
      }
    }
  double squared = 0.0;
  std::size_t fastest = 0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].immovable() || !turns[i] || stiffness[i] == 0.0) continue;
    // About an axis across its arm: a slender body does not swing about itself, which is its least
    // moment.
    const Vector3d moments = symmetric_eigen(world.bodies[i].inertia.inertia_body).values;
    const double moment =
        moments[1] + world.bodies[i].inertia.mass * arm_to_fixed[i] * arm_to_fixed[i];
    if (!(moment > 0) || !(stiffness[i] / moment > squared)) continue;
    squared = stiffness[i] / moment;
    fastest = i;
  }
  if (!(squared > 0)) return std::nullopt;
  const double frequency = std::sqrt(squared),
               amplified = amplification(laws, frequency, 0.0, step);
  if (amplified <= 1.0 + kNegligible) return std::nullopt;
  return StepLimit{
      fmt::format(
          "the swing of body '{}' between its joints (up to {:.4g} rad/s where they carry most)",
          world.bodies[fastest].name, frequency),
      amplified, largest_stable_step(laws, frequency, 0.0, step), "longer or fewer links"};
}

}  // namespace tumble::engines
