#include "framework/engines/events/flight_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include <fmt/format.h>

#include "framework/collision/gap.h"
#include "framework/collision/sweep.h"
#include "framework/core/error.h"
#include "framework/effects/build_world.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/start_overlaps.h"

namespace tumble::engines {
namespace {

constexpr int kMostNudges = 20;  // iterations that remove overlaps of a few roundings

// Shapes that many bodies share are built once: equal balls, boxes, and models of the same file at
// the same scale.
std::string recipe_of(const scene::BodySpec& body, int index) {
  if (const auto* sphere = std::get_if<scene::SphereSpec>(&body.shape))
    return fmt::format("sphere {:a}", sphere->radius_m);
  if (const auto* box = std::get_if<scene::BoxSpec>(&body.shape))
    return fmt::format("box {:a} {:a} {:a}", box->half_extents_m.x(), box->half_extents_m.y(),
                       box->half_extents_m.z());
  if (const auto* model = std::get_if<scene::ModelSpec>(&body.shape))
    return fmt::format("model {} {} {:a}", model->file, model->object, model->metres_per_unit);
  return fmt::format("alone {}", index);
}

}  // namespace

std::string unfollowed_entry(const scene::Scene& scene) {
  if (scene.contact && scene.contact->sleep) return "\"sleep\" of \"contact\"";
  return "";
}

FlightWorld::FlightWorld(const scene::Scene& scene, const std::string& engine, const Laws& laws,
                         ProcessRules rules) {
  const std::string where = scene.file.empty() ? scene.name : scene.file.string();
  if (const std::string entry = unfollowed_entry(scene); !entry.empty())
    throw UserError(
        where,
        fmt::format(
            "{} is not supported by --engine {}: islands have their own local virtual time there",
            entry, engine),
        "leave it out, or use --engine rd");
  world_ = build_world(scene);
  if (world_.gravity_world) gravity_world_ = *world_.gravity_world;
  std::map<std::string, int> known;
  // Shapes, first flights and facts of all bodies; equal shapes once.
  for (int i = 0; i < size(); ++i) {
    const WorldBody& body = world_.bodies[i];
    const auto [found, is_new] =
        known.try_emplace(recipe_of(scene.bodies[i], i), static_cast<int>(shapes_.size()));
    if (is_new) shapes_.emplace_back(body.shape);
    const collision::CollisionShape& shape = shapes_[found->second];
    const bool moves = !body.immovable();
    rotations_.emplace_back(moves ? body.inertia.inertia_body : Matrix3d(Matrix3d::Identity()));
    Flight flight;
    flight.com_world = body.state.com_world;
    flight.world_from_body = body.state.world_from_body;
    if (moves) {
      flight.velocity_world = scene.bodies[i].velocity_m_s;
      flight.omega_body = flight.world_from_body.conjugate() * scene.bodies[i].omega_world_rad_s;
    }
    facts_.push_back({shape.bounding_radius(), found->second, moves, shape.is_ball(),
                      !moves && !is_driven(body.motion), shape.is_half_space(), body.collides,
                      moves && body.passes_movable});
    first_.push_back(flight);
    matter_.push_back({body.inertia, body.restitution});
    if (moves)
      movers_.push_back(i);
    else if (body.collides)
      obstacles_.push_back(i);
  }
  // Overlaps at the start, then the processes that exist from the start.
  turning_.resize(first_.size());
  refuse_overlap(scene);
  processes_ = std::make_unique<LogicalProcesses>(
      world_, [this](int body) { return &shape(body); }, laws, rules);
  if (processes_->holds_any()) start_processes();
}

// Begins the processes of bodies that are linked, driven by forces, or in contact at the start.
void FlightWorld::start_processes() {
  std::vector<RigidBodyState> states;
  for (int i = 0; i < size(); ++i) {
    states.push_back(world_.bodies[i].state);
    states.back().com_world = first_[i].com_world;
  }
  std::vector<BodyPair> touching;
  for (const auto& [a, b] : near_at_start_) {
    if (!world_.contact) break;
    const auto pose = [&](int k) {
      return collision::Pose{first_[k].com_world, first_[k].world_from_body};
    };
    if (collision::gap_distance(shape(a), pose(a), shape(b), pose(b)) <=
        kNegligible * std::min(radius(a), radius(b)))
      touching.emplace_back(a, b);
  }
  LogicalProcesses::Start start = processes_->start(states, touching);
  for (BegunFlight& begun : start.flights) first_[begun.body] = begun.flight;
  start_events_ = std::move(start.events);
  std::sort(start_events_.begin(), start_events_.end(), [](const Event& a, const Event& b) {
    return std::pair(a.body_a, a.body_b) < std::pair(b.body_a, b.body_b);
  });
}

bool FlightWorld::may_collide(int a, int b) const {
  const Facts &first = facts_[a], &second = facts_[b];
  if (!(first.can_move || second.can_move) || !first.collides || !second.collides ||
      (first.passes && second.passes))
    return false;
  return world_.apart.empty() || !std::binary_search(world_.apart.begin(), world_.apart.end(),
                                                     std::pair(std::min(a, b), std::max(a, b)));
}

// Refuses bodies that overlap by more than rounding; separates those that overlap by rounding.
void FlightWorld::refuse_overlap(const scene::Scene& scene) {
  // Candidate pairs, by boxes.
  std::vector<collision::SweptBox> boxes;
  for (int i = 0; i < size(); ++i)
    boxes.push_back(
        start_box(shape(i), {first_[i].com_world, first_[i].world_from_body}, can_move(i)));
  auto pairs = collision::overlapping_pairs(boxes);
  std::erase_if(pairs, [&](const auto& pair) { return !may_collide(pair.first, pair.second); });
  near_at_start_ = pairs;
  // Overlaps beyond rounding are refused.
  const auto pose = [&](int k) {
    return collision::Pose{first_[k].com_world, first_[k].world_from_body};
  };
  std::vector<StartPair> near;
  for (const auto& [a, b] : pairs)
    look_at_start(a, b, shape(a), pose(a), shape(b), pose(b),
                  kRoundOff * collision::gap_scale(shape(a), pose(a), shape(b), pose(b)), near);
  refuse_overlaps(scene.file.empty() ? scene.name : scene.file.string(), scene, near);
  // Overlaps of rounding size are removed, by moving one body along the normal.
  // with persistent contacts, processes separate their members themselves
  for (int round = 0; round < kMostNudges && !scene.contact; ++round) {
    bool clean = true;
    for (const auto& [a, b] : pairs) {
      const collision::Gap gap = collision::compute_gap(shape(a), pose(a), shape(b), pose(b));
      if (gap.distance >= 0) continue;
      clean = false;
      const int mover = can_move(a) ? a : b;
      const double way = -gap.distance + round * std::numeric_limits<double>::epsilon() *
                                             first_[mover].com_world.cwiseAbs().maxCoeff();
      first_[mover].com_world += (mover == a ? way : -way) * gap.normal_b_to_a_world;
    }
    if (clean) return;
  }
}

class FlightWorld::HeldTurning {
 public:
  HeldTurning(const FlightWorld& world, int body, const Flight& flight)
      : turning(*world.turning_[body]), is_held_(world.is_shared_) {
    while (is_held_ && turning.is_held.test_and_set(std::memory_order_acquire))
      std::this_thread::yield();
    world.turn_to(body, flight, turning);
  }
  ~HeldTurning() {
    if (is_held_) turning.is_held.clear(std::memory_order_release);
  }
  HeldTurning(const HeldTurning&) = delete;
  HeldTurning& operator=(const HeldTurning&) = delete;

  Turning& turning;

 private:
  const bool is_held_;
};

Spin FlightWorld::spin(int body, const Flight& flight, double t) const {
  // Most balls do not rotate, and a resting body rotates uniformly (it is a ball, or it does not
  // rotate).
  if (flight.segment >= 0) {
    const RigidBodyState now = processes_->segments().body_state(flight.segment, body, t);
    return {now.world_from_body,
            inertia(body).inverse_inertia_body *
                (now.world_from_body.conjugate() * now.angular_momentum_world)};
  }
  if (!facts_[body].can_move || t == flight.begin || flight.omega_body.isZero(0.0))
    return {flight.world_from_body, flight.omega_body};
  const Spin start{flight.world_from_body, flight.omega_body};
  if (!rotations_[body].is_asymmetric()) return rotations_[body].after(start, t - flight.begin);
  const HeldTurning held = turning(body, flight);
  Turning& now = held.turning;
  const std::int64_t k = static_cast<std::int64_t>((t - flight.begin) / now.reach);
  const auto begin_of = [&](std::int64_t part) { return static_cast<double>(part) * now.reach; };
  // no longer cached: start again
  if (k <= now.newest - static_cast<std::int64_t>(now.series.size())) now.newest = -1;
  while (now.newest < k) {
    const Spin next =
        now.newest < 0
            ? start
            : now.series[static_cast<std::size_t>(now.newest) % now.series.size()].at(now.reach);
    ++now.newest;
    now.series[static_cast<std::size_t>(now.newest) % now.series.size()] =
        SpinSeries(rotations_[body].moments(), rotations_[body].body_from_principal(), next);
  }
  return now.series[static_cast<std::size_t>(k) % now.series.size()].at(t - flight.begin -
                                                                        begin_of(k));
}

void FlightWorld::share(bool shared) {
  is_shared_ = shared;
  processes_->segments().share(shared);
  if (!shared) return;
  // create all while one thread runs: none is created while several do
  for (const int body : movers_)
    if (!is_ball(body) && !turning_[body]) turning_[body] = std::make_unique<Turning>();
}

FlightWorld::HeldTurning FlightWorld::turning(int body, const Flight& flight) const {
  if (!turning_[body]) turning_[body] = std::make_unique<Turning>();
  return {*this, body, flight};
}

void FlightWorld::turn_to(int body, const Flight& flight, Turning& now) const {
  if (now.begin == flight.begin && now.omega_body == flight.omega_body &&
      now.world_from_body.coeffs() == flight.world_from_body.coeffs())
    return;
  now.begin = flight.begin;
  now.omega_body = flight.omega_body;
  now.world_from_body = flight.world_from_body;
  now.newest = -1;
  RigidBodyState state{Vector3d::Zero(), flight.world_from_body, Vector3d::Zero(),
                       Vector3d::Zero()};
  state.angular_momentum_world =
      flight.world_from_body * (world_.bodies[body].inertia.inertia_body * flight.omega_body);
  // torque-free: valid for all times
  now.bounds = bound_rotation(state, world_.bodies[body].inertia, {0.0});
  now.reach = SpinSeries::reach(rotations_[body].moments(), now.bounds.angular_speed);
}

collision::MotionState FlightWorld::motion_at(int body, const Flight& flight, double t) const {
  if (flight.segment >= 0) return processes_->segments().motion_at(flight.segment, body, t);
  const Spin now = spin(body, flight, t);
  return {{position(body, flight, t), now.world_from_body},
          velocity(body, flight, t),
          now.world_from_body * now.omega_body};
}

collision::MotionBounds FlightWorld::bounds(int body, const Flight& flight, double t) const {
  if (flight.segment >= 0)
    return processes_->segments().motion_in_step(flight.segment, body, t).bounds;
  collision::MotionBounds bounds;
  bounds.acceleration_world = acceleration(body, flight);
  if (!facts_[body].can_move) {
    const scene::PrescribedMotion& m = world_.bodies[body].motion;
    bounds.acceleration_deviation =
        m.amplitude_m.norm() * m.angular_frequency_rad_s * m.angular_frequency_rad_s;
    return bounds;
  }
  // its rotation has no effect on collisions
  if (is_ball(body) || flight.omega_body.isZero(0.0)) return bounds;
  const RotationBounds turns = turning(body, flight).turning.bounds;
  bounds.angular_speed = turns.angular_speed;
  bounds.angular_acceleration = turns.angular_acceleration;
  return bounds;
}

collision::Motion FlightWorld::motion_from(int body, const Flight& flight, double low) const {
  if (flight.segment >= 0) return processes_->segments().motion_in_step(flight.segment, body, low);
  return {[this, body, at = &flight](double t) { return motion_at(body, *at, t); },
          bounds(body, flight, low)};
}

// A path whose second derivative is at most a deviates from the box of its end points by at most a
// s^2 / 8.
void FlightWorld::extend_by_path(int body, const Flight& flight, double from, double to,
                                 Vector3d& low, Vector3d& high) const {
  const auto take = [&](const Vector3d& first, const Vector3d& last, const Vector3d& acceleration,
                        double s) {
    const Vector3d bulge = acceleration * (s * s / 8);
    low = low.cwiseMin(first.cwiseMin(last) - bulge);
    high = high.cwiseMax(first.cwiseMax(last) + bulge);
  };
  if (flight.segment < 0)
    return take(position(body, flight, from), position(body, flight, to),
                acceleration(body, flight).cwiseAbs(), to - from);
  processes_->segments().for_each_step(
      flight.segment, body, from, to,
      [&](const ProcessStep& step, std::size_t member, double begin, double end) {
        const collision::MotionBounds bounds =
            step.paths.empty() ? collision::MotionBounds{} : step.paths[member].bounds();
        take(step.state_at(member, begin).com_world, step.state_at(member, end).com_world,
             bounds.acceleration_world.cwiseAbs() +
                 Vector3d::Constant(bounds.acceleration_deviation),
             end - begin);
      });
}

RigidBodyState FlightWorld::state(int body, const Flight& flight, double t) const {
  if (flight.segment >= 0) return processes_->segments().body_state(flight.segment, body, t);
  const Spin now = spin(body, flight, t);
  RigidBodyState state{position(body, flight, t), now.world_from_body, Vector3d::Zero(),
                       Vector3d::Zero()};
  if (!facts_[body].can_move) return state;
  const Inertia& inertia = world_.bodies[body].inertia;
  state.momentum_world = inertia.mass * velocity(body, flight, t);
  state.angular_momentum_world = now.world_from_body * (inertia.inertia_body * now.omega_body);
  return state;
}

Body FlightWorld::body_at(int body, const Flight& flight, double t) const {
  const Spin now = spin(body, flight, t);
  return {inertia(body), position(body, flight, t), now.world_from_body, velocity(body, flight, t),
          now.world_from_body * now.omega_body};
}

}  // namespace tumble::engines
