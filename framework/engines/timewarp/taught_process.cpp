#include "framework/engines/timewarp/taught_process.h"

#include <algorithm>

namespace tumble::engines {
namespace {

constexpr double kSweptSlack = 1e-9;      // of lengths, on boxes: rounding hides nothing
constexpr double kBoxRounding = 1e-14;  // of coordinates
constexpr std::size_t kMostKept = 2, kFewKept = 16;   // of the boxes that are there, and so many: what a heap may hold

}  // namespace

double until_end(const FlightWorld& world, const Flight& flight, double t) {
  if (flight.passage < 0) return t;
  const PassageEnd* end = world.processes()->passages().end_by(flight.passage, t);
  return end ? std::min(t, end->time) : t;
}

void SweptBox::add(std::uint64_t id, const Box& box) {
  alive_.emplace(id, box);
  if (kept() >= kMostKept * alive_.size() + kFewKept) return rebuild();
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    bounds_[axis].emplace(-box.low[static_cast<Eigen::Index>(axis)], id);
    bounds_[kAxes + axis].emplace(box.high[static_cast<Eigen::Index>(axis)], id);
  }
}

std::size_t SweptBox::kept() const {
  std::size_t most = 0;
  for (const auto& heap : bounds_) most = std::max(most, heap.size());
  return most;
}

// Of what is there alone. So many have been added since the last time that it costs each of them no more than its own place did.
void SweptBox::rebuild() {
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    std::vector<Bound> lows, highs;
    for (const auto& [id, box] : alive_) {
      lows.emplace_back(-box.low[static_cast<Eigen::Index>(axis)], id);
      highs.emplace_back(box.high[static_cast<Eigen::Index>(axis)], id);
    }
    bounds_[axis] = Heap({}, std::move(lows));
    bounds_[kAxes + axis] = Heap({}, std::move(highs));
  }
}

Box SweptBox::box() const {
  Box box;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    for (std::size_t heap : {axis, kAxes + axis})
      while (!bounds_[heap].empty() && !alive_.contains(bounds_[heap].top().second)) bounds_[heap].pop();
    if (bounds_[axis].empty()) return Box{};
    box.low[static_cast<Eigen::Index>(axis)] = -bounds_[axis].top().first;
    box.high[static_cast<Eigen::Index>(axis)] = bounds_[kAxes + axis].top().first;
  }
  return box;
}

TaughtProcess::TaughtProcess(const FlightWorld& world, int body) : world_(world), body_(body) {
  const Flight& first = world.first_flight(body);
  push(first.begin, first, {first.begin, 0, EventClass::kCollision, -1, -1}, box_of(first, first.begin, first.begin));
}

const KeptState* TaughtProcess::at(double t) const {
  const auto later = std::upper_bound(states_.begin(), states_.end(), t, [](double time, const KeptState& state) { return time < state.time; });
  return later == states_.begin() ? nullptr : &*std::prev(later);
}

std::vector<double> TaughtProcess::times() const {
  std::vector<double> times;
  for (const KeptState& state : states_) times.push_back(state.time);
  return times;
}

void TaughtProcess::integrate_to(double t) {
  const KeptState last = states_.back();
  push(t, last.flight, last.began, box_of(last.flight, last.time, t));
}

void TaughtProcess::begin(const Flight& flight, const EventKey& began) { push(flight.begin, flight, began, box_of(flight, flight.begin, flight.begin)); }

// A passage is let go of with the last state that names it.
void TaughtProcess::drop_latest() {
  const KeptState dropped = states_.back();
  swept_.remove(dropped.id);
  states_.pop_back();
  if (states_.empty() || states_.back().flight.serial != dropped.flight.serial) world_.release(dropped.flight);
}

void TaughtProcess::drop_oldest(std::size_t count) {
  const auto end = states_.begin() + static_cast<std::ptrdiff_t>(count);
  for (auto state = states_.begin(); state != end; ++state) {
    swept_.remove(state->id);
    if (std::next(state) == states_.end() || std::next(state)->flight.serial != state->flight.serial) world_.release(state->flight);
  }
  states_.erase(states_.begin(), end);
}

void TaughtProcess::push(double time, const Flight& flight, const EventKey& began, const Box& box) {
  states_.push_back({next_id_, time, flight, began});
  swept_.add(next_id_++, box);
}

// A parabola leaves the box of its ends by at most a s^2 / 8; a body that turns stays in the ball around it.
Box TaughtProcess::box_of(const Flight& flight, double from, double to) const {
  if (flight.passage >= 0) {
    Box way;
    world_.take_in_way(body_, flight, until_end(world_, flight, from), until_end(world_, flight, to), way.low, way.high);
    const Vector3d margin = Vector3d::Constant(world_.radius(body_) * (1 + kSweptSlack)) + kSweptSlack * (way.high - way.low) + kBoxRounding * (way.low.cwiseAbs() + way.high.cwiseAbs());
    return {way.low - margin, way.high + margin};
  }
  const double s = to - from;
  const Vector3d first = world_.position(body_, flight, from), last = world_.position(body_, flight, to);
  const Vector3d margin = world_.acceleration(body_, flight).cwiseAbs() * (s * s / 8) + Vector3d::Constant(world_.radius(body_) * (1 + kSweptSlack)) + kSweptSlack * (last - first).cwiseAbs() +
                          kBoxRounding * (first.cwiseAbs() + last.cwiseAbs());
  return {first.cwiseMin(last) - margin, first.cwiseMax(last) + margin};
}

// It goes its prescribed way: a straight line, and no farther off it than its amplitude.
Box box_of_immovable(const FlightWorld& world, int body, double duration) {
  const Box box = box_around(world.shape(body), world.first_flight(body).world_from_body);
  if (world.is_half_space(body)) return box;
  const scene::PrescribedMotion& m = world.world().bodies[static_cast<std::size_t>(body)].motion;
  const Vector3d start = world.first_flight(body).com_world, end = start + m.velocity_m_s * duration;
  const Vector3d reach = m.amplitude_m.cwiseAbs() + Vector3d::Constant(kSweptSlack * world.radius(body));
  return {start.cwiseMin(end) + box.low - reach, start.cwiseMax(end) + box.high + reach};
}

}  // namespace tumble::engines
