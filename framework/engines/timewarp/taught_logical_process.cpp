#include "framework/engines/timewarp/taught_logical_process.h"

#include <algorithm>

namespace tumble::engines {
namespace {

// of the boxes that are there, and so many: what a heap may hold
constexpr std::size_t kMostKept = 2, kFewKept = 16;

}  // namespace

double until_end(const FlightWorld& world, const Flight& flight, double t) {
  if (flight.segment < 0) return t;
  IslandSegments& segments = world.processes()->segments();
  if (const auto failed = segments.failed_by(flight.segment, t)) return *failed;
  const SegmentEnd* end = segments.end_by(flight.segment, t);
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

// Rebuilds the heaps from the current boxes. Enough boxes were added since the last rebuild that
// the amortised cost per box is constant.
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
      while (!bounds_[heap].empty() && !alive_.contains(bounds_[heap].top().second))
        bounds_[heap].pop();
    if (bounds_[axis].empty()) return Box{};
    box.low[static_cast<Eigen::Index>(axis)] = -bounds_[axis].top().first;
    box.high[static_cast<Eigen::Index>(axis)] = bounds_[kAxes + axis].top().first;
  }
  return box;
}

TaughtLogicalProcess::TaughtLogicalProcess(const FlightWorld& world, int body)
    : world_(world), body_(body) {
  const Flight& first = world.first_flight(body);
  push(first.begin, first, {first.begin, 0, StampKind::kCollision, -1, -1},
       box_of(first, first.begin, first.begin));
}

const KeptState* TaughtLogicalProcess::at(double t) const {
  const auto later =
      std::upper_bound(states_.begin(), states_.end(), t,
                       [](double time, const KeptState& state) { return time < state.time; });
  return later == states_.begin() ? nullptr : &*std::prev(later);
}

const Flight& TaughtLogicalProcess::before(double t) const {
  const auto not_before =
      std::lower_bound(states_.begin(), states_.end(), t,
                       [](const KeptState& state, double time) { return state.time < time; });
  return (not_before == states_.begin() ? not_before : std::prev(not_before))->flight;
}

std::vector<double> TaughtLogicalProcess::times() const {
  std::vector<double> times;
  for (const KeptState& state : states_) times.push_back(state.time);
  return times;
}

void TaughtLogicalProcess::integrate_to(double t) {
  const KeptState last = states_.back();
  push(t, last.flight, last.began, box_of(last.flight, last.time, t));
}

void TaughtLogicalProcess::begin(const Flight& flight, const EventStamp& began) {
  push(flight.begin, flight, began, box_of(flight, flight.begin, flight.begin));
}

// A segment is let go of with the last state that names it.
void TaughtLogicalProcess::drop_latest() {
  const KeptState dropped = states_.back();
  swept_.remove(dropped.id);
  states_.pop_back();
  if (states_.empty() || states_.back().flight.version != dropped.flight.version)
    world_.release(dropped.flight);
}

void TaughtLogicalProcess::drop_oldest(std::size_t count) {
  const auto end = states_.begin() + static_cast<std::ptrdiff_t>(count);
  for (auto state = states_.begin(); state != end; ++state) {
    swept_.remove(state->id);
    const auto next = std::next(state);
    if (next != states_.end() && next->flight.version == state->flight.version) continue;
    if (next != states_.end()) world_.stand(state->flight, next->flight.begin);
    world_.release(state->flight);
  }
  states_.erase(states_.begin(), end);
}

void TaughtLogicalProcess::stand(double until) const {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const bool is_last = k + 1 == states_.size();
    const Flight& flight = states_[k].flight;
    if (!is_last && states_[k + 1].flight.version == flight.version) continue;
    world_.stand(flight, is_last ? until : std::min(until, states_[k + 1].flight.begin));
  }
}

void TaughtLogicalProcess::push(double time, const Flight& flight, const EventStamp& began,
                                const Box& box) {
  states_.push_back({next_id_, time, flight, began});
  swept_.add(next_id_++, box);
}

Box TaughtLogicalProcess::box_of(const Flight& flight, double from, double to) const {
  return swept_box(world_, body_, flight, until_end(world_, flight, from),
                   until_end(world_, flight, to));
}

}  // namespace tumble::engines
