#include "framework/engines/events/advancement.h"

#include <algorithm>
#include <limits>
#include <queue>

#include "framework/collision/sweep.h"
#include "framework/collision/time_bound.h"
#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/base/guarded_laws.h"

namespace tumble::engines {
namespace {

// A pair whose bound gains at most this part of the step is searched for its impact instead: every
// bound advances all bodies, and gains only a fixed part of the remaining distance.
constexpr double kWorthCreeping = 0.1;

// a callback is valid for every flight of its bodies
constexpr std::uint32_t kAnyFlight = std::numeric_limits<std::uint32_t>::max();

struct Bound {
  EventStamp key;  // its due time; an exact bound has the impact's stamp
  bool is_exact;
  std::uint32_t version_a, version_b;  // of the flights that it was computed for
};
struct Later {
  // Impacts of one instant in their order; bounds that are not exact before them, because their
  // impact may be at that very instant.
  bool operator()(const Bound& x, const Bound& y) const {
    if (x.key.time == y.key.time && x.is_exact != y.is_exact) return x.is_exact;
    return y.key < x.key;
  }
};

class AdvancementRun {
 public:
  AdvancementRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                 TrajectorySink& sink)
      : run_(scene, laws, options, sink) {
    for (int i = 0; i < run_.world().size(); ++i) flights_.push_back(run_.world().first_flight(i));
    now_.resize(flights_.size());
  }

  void run() {
    std::string stopped_by;
    try {
      do step();
      while (!(end_ > run_.duration()));  // the last instant is part of the run
      at_ = kInfinity;
      draw_before(kInfinity);
    } catch (const StoppedRun& stop) {
      stopped_by = stop.what();
    }
    for (const int i : run_.world().movers())
      run_.world().stand(flights_[i], run_.stands_until(stopped_by, at_));
    run_.end(stopped_by);
  }

 private:
  // Advances to the end of the largest step, at most to the end of the run.
  void step() {
    ++run_.counters.steps;
    if (run_.world().processes()) run_.world().processes()->segments().forget_before(time_);
    at_ = time_;
    end_ = run_.impacts().window_end(time_);
    queue_ = {};
    boxes_.clear();
    for (int i = 0; i < run_.world().size(); ++i) boxes_.push_back(box_of(i));
    for (const auto& [a, b] : collision::overlapping_pairs(boxes_)) look_ahead(a, b);
    for (const int body : run_.world().movers()) look_for_own_end(body);
    for (std::size_t k = called_;
         built::kCallback && k < run_.callbacks().size() && run_.callbacks()[k].time < end_; ++k)
      queue_.push({run_.callbacks()[k], true, kAnyFlight, kAnyFlight});
    while (!queue_.empty() && queue_.top().key.time < end_ &&
           queue_.top().key.time <= run_.duration()) {
      const Bound bound = queue_.top();
      queue_.pop();
      const int a = bound.key.body_a, b = bound.key.body_b;
      if (bound.version_a != kAnyFlight && (flights_[a].version != bound.version_a ||
                                            (b >= 0 && flights_[b].version != bound.version_b)))
        continue;
      at_ = bound.key.time;
      advance_all(bound.key.time);
      if (bound.key.kind == StampKind::kFault) run_.commit_frame_at(bound.key, flight_of());
      if (bound.is_exact)
        work_at(bound.key);
      else
        look_ahead(a, b);
    }
    at_ = std::min(end_, run_.duration());
    advance_all(at_);
    if (end_ > run_.duration()) time_ = run_.duration();
  }

  // Advances every body to t.
  void advance_all(double t) {
    if (t == time_) return;
    draw_before(t);
    const StageTimer timer(run_.counters.integration_seconds);
    for (const int i : run_.world().movers()) now_[i] = run_.world().motion_at(i, flights_[i], t);
    run_.counters.integrations += run_.world().movers().size();
    time_ = t;
  }

  // Computes a new lower bound on the pair's impact, if it lies within the step.
  void look_ahead(int a, int b) {
    const FlightWorld& world = run_.world();
    if (!world.may_collide(a, b) || world.is_internal(a, flights_[a], b, flights_[b])) return;
    const StageTimer timer(run_.counters.collision_seconds);
    double due;
    bool is_exact = true;
    if (run_.impacts().has_closed_form(a, flights_[a], b, flights_[b])) {
      due = run_.impacts().first_impact(a, flights_[a], b, flights_[b], time_, end_, run_.cost);
    } else {
      ++run_.cost.pair_checks;
      ++run_.cost.narrow.gap_evaluations;
      const auto motion = [&](int i) { return world.motion_at(i, flights_[i], time_); };
      // A bound holds for as long as both motions are smooth.
      const double left =
          world.smooth_until(flights_[a], time_, world.smooth_until(flights_[b], time_, end_)) -
          time_;
      if (!(left > 0)) return;
      const auto bound = collision::bound_time_apart(
          world.shape(a), motion(a), world.bounds(a, flights_[a], time_), world.shape(b), motion(b),
          world.bounds(b, flights_[b], time_), left);
      if (time_ + left >= end_ && bound.duration >= left &&
          bound.gap >= kNegligible * std::min(world.radius(a), world.radius(b)))
        return;
      is_exact = bound.duration < kWorthCreeping * run_.step() ||
                 bound.gap < kNegligible * std::min(world.radius(a), world.radius(b));
      due = is_exact ? run_.impacts().first_impact(a, flights_[a], b, flights_[b], time_, end_,
                                                   run_.cost)
                     : time_ + (1 - kNegligible) * bound.duration;
    }
    if (!(due < end_)) return;
    EventStamp key = key_of_impact(a, flights_[a], b, flights_[b], due);
    queue_.push({key, is_exact, flights_[key.body_a].version, flights_[key.body_b].version});
  }

  void look_for_own_end(int body) {
    if (const auto key = run_.own_end(body, flights_[body], end_))
      queue_.push({*key, true, flights_[body].version, 0});
  }

  Discontinuity outcome_of(const EventStamp& key) {
    if (key.kind == StampKind::kProcess || key.kind == StampKind::kFault)
      return run_.end_of_segment(key, flights_[key.body_a]);
    if (key.kind == StampKind::kCollision)
      return run_.resolve_impact(key, flights_[key.body_a], flights_[key.body_b]);
    ++called_;
    return run_.call(key, flight_of());
  }

  void work_at(const EventStamp& key) {
    const int a = key.body_a, b = key.body_b;
    Discontinuity discontinuity = outcome_of(key);
    run_.watch_order(key, flight_of());
    run_.commit(discontinuity);
    // The flights that begin replace those of the pair or of the processes.
    std::vector<int> changed;
    if (discontinuity.begun.empty()) {
      for (const auto& [body, flight] :
           {std::pair{a, &discontinuity.a}, std::pair{b, &discontinuity.b}})
        if (run_.world().can_move(body)) discontinuity.begun.push_back({body, *flight});
    } else {
      for (const BegunFlight& begun : discontinuity.begun) {
        run_.world().stand(flights_[begun.body], key.time);
        run_.world().release(flights_[begun.body]);
      }
    }
    for (BegunFlight& begun : discontinuity.begun) {
      begun.flight.version = ++version_;
      flights_[begun.body] = begun.flight;
      boxes_[begun.body] = box_of(begun.body);
      changed.push_back(begun.body);
    }
    // New bounds: for the pair, then for every changed body with all bodies within reach.
    if (key.kind == StampKind::kCollision) look_ahead(a, b);
    const auto this_pair = [&](int body, int other) {
      return key.kind == StampKind::kCollision && std::minmax(body, other) == std::minmax(a, b);
    };
    for (const int body : changed) {
      look_for_own_end(body);
      for (int other = 0; other < run_.world().size(); ++other)
        if (other != body && !this_pair(body, other) && touches(body, other) &&
            !(other < body && std::find(changed.begin(), changed.end(), other) != changed.end()))
          look_ahead(body, other);
    }
  }

  // The volume that the body sweeps until the step's end: a parabola deviates from the box of its
  // end points by at most a s^2 / 8.
  collision::SweptBox box_of(int body) const {
    const FlightWorld& world = run_.world();
    const Flight& flight = flights_[body];
    const bool moves = world.can_move(body) || !world.is_still(body);
    if (flight.segment >= 0) {
      collision::SweptBox box{Vector3d::Constant(kInfinity), Vector3d::Constant(-kInfinity), true};
      world.extend_by_path(body, flight, time_, end_, box.low, box.high);
      const Vector3d margin = Vector3d::Constant(world.radius(body) * (1 + kNegligible)) +
                              kCoordinateRounding * (box.low.cwiseAbs() + box.high.cwiseAbs());
      return {box.low - margin, box.high + margin, true};
    }
    const Vector3d from = world.position(body, flight, time_),
                   to = world.position(body, flight, end_);
    double bulge = world.acceleration(body, flight).norm();
    if (!world.can_move(body)) {
      const scene::PrescribedMotion& m = world.world().bodies[body].motion;
      bulge = m.amplitude_m.norm() * m.angular_frequency_rad_s * m.angular_frequency_rad_s;
    }
    const double s = end_ - time_;
    const Vector3d margin =
        Vector3d::Constant(world.radius(body) * (1 + kNegligible) + bulge * s * s / 8) +
        kNegligible * (from - to).cwiseAbs() + kCoordinateRounding * from.cwiseAbs();
    return {from.cwiseMin(to) - margin, from.cwiseMax(to) + margin, moves};
  }
  bool touches(int a, int b) const {
    return (boxes_[a].low.array() <= boxes_[b].high.array()).all() &&
           (boxes_[b].low.array() <= boxes_[a].high.array()).all();
  }

  void draw_before(double t) {
    while (run_.next_frame() < t) run_.commit_frame(flight_of());
  }
  FlightOf flight_of() const {
    return [this](int body) -> const Flight& { return flights_[body]; };
  }

  FlightRun run_;
  std::vector<Flight> flights_;              // by body
  std::vector<collision::MotionState> now_;  // by body: state at time_
  std::vector<collision::SweptBox> boxes_;   // by body, until the step's end
  std::priority_queue<Bound, std::vector<Bound>, Later> queue_;
  double time_ = 0.0, end_ = 0.0;  // [s]
  double at_ = 0.0;                // nothing before it is left to do [s]
  std::uint32_t version_ = 0;
  std::size_t called_ = 0;  // callbacks
};

}  // namespace

void run_advancement(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                     TrajectorySink& sink) {
  AdvancementRun(scene, laws, options, sink).run();
}

}  // namespace tumble::engines
