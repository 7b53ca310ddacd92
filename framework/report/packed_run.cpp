// Order of the channels, for F kept frames, C of them with contacts:
//   times (F); by moving body: position (3), quaternion x y z w (4), velocity (3), angular velocity
//   (3), F each; series, F each;
//   number of contacts per frame (C); of all contacts in order: body_a, body_b, point (3), force
//   (3); of events: time, kind, body_a, body_b, point (3), normal (3), impulse, normal velocity
//   before and after. Positions and points are given from the page's origin (player_scene.h).
#include "framework/report/packed_run.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "framework/core/zip.h"
#include "framework/effects/registry.h"
#include "framework/report/channels.h"
#include "framework/report/comparison.h"
#include "framework/report/player_scene.h"
#include "framework/trajectory/fault_words.h"

namespace tumble::report {
namespace {

// Rounding of curves, speeds and arrows relative to the run's largest value: less than the width of
// a line on any screen.
constexpr double kCurve = 1e-6, kSpeed = 1.5e-5, kArrow = 1e-3;
constexpr double kPlace = 1e-6;        // relative to the distance of the camera's target
constexpr double kTurn = 1.0 / 32768;  // of a quaternion's components: 6e-5 rad
// s; of a run shorter than 0.01 s so much of its end
constexpr double kTime = 1.0 / 1048576, kTimeShare = 1e-4;

using Value = std::function<double(std::size_t)>;

std::vector<double> gathered(std::size_t count, const Value& value) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = value(i);
  return values;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  return largest;
}

class RunPacker {
 public:
  RunPacker(const scene::Scene& scene, const PlayedRun& played, double sight_m,
            const PlayerOptions& options)
      : run_(played.run), origin_world_(page_origin(scene)), sight_m_(sight_m), options_(options) {
    find_moving();
    choose_frames();
  }

  PackedRun pack(const scene::Scene& scene, const std::string& label,
                 const std::vector<double>& apart_m) {
    PackedRun packed;
    packed.times_s = gathered(frames_.size(), [&](std::size_t k) { return frame(k).time; });
    writer_.add(packed.times_s, time_quantum(), 2);
    add_poses();
    packed.series = all_series(scene, apart_m);
    nlohmann::ordered_json series = nlohmann::ordered_json::array();
    for (const Series& s : packed.series) {
      writer_.add(s.values, quantum_of(kCurve * largest_of(s.values)), 2);
      series.push_back({{"plot", s.plot}, {"name", s.name}, {"unit", s.unit}});
    }
    const std::size_t contacts = add_contacts();
    add_events();
    packed.channels = deflated(writer_.bytes());
    packed.head = {{"label", label},
                   {"engine", run_.info.engine},
                   {"step", run_.info.step_s},
                   {"impulses", run_.info.impulse_source},
                   {"motion", run_.info.integrator_source},
                   {"constraints", run_.info.constraint_source},
                   {"scheduler", run_.info.scheduling_source},
                   {"stopped", run_.stopped_by},
                   {"faults", in_words(run_.counters.faults)},
                   {"frames", frames_.size()},
                   {"stride", stride_},
                   {"moving", moving_},
                   {"resting", resting_},
                   {"series", series},
                   {"contactStride", contact_stride_},
                   {"contacts", contacts},
                   {"events", run_.events.size()},
                   {"bytes", writer_.bytes().size()}};
    return packed;
  }

 private:
  const Frame& frame(std::size_t k) const { return run_.frames[frames_[k]]; }

  double time_quantum() const {
    return std::min(kTime, quantum_of(kTimeShare * run_.frames.back().time));
  }

  // Separates moving bodies from those with a constant pose.
  void find_moving() {
    const Frame& first = run_.frames.front();
    for (std::size_t i = 0; i < run_.bodies.size(); ++i) {
      const auto differs = [&](const Frame& f) {
        return !(f.poses[i].com_world == first.poses[i].com_world &&
                 f.poses[i].world_from_body.coeffs() == first.poses[i].world_from_body.coeffs());
      };
      if (std::any_of(run_.frames.begin(), run_.frames.end(), differs)) {
        moving_.push_back(i);
        continue;
      }
      const Vector3d p = first.poses[i].com_world - origin_world_;
      const auto& q = first.poses[i].world_from_body.coeffs();
      resting_.push_back(
          {{"body", i}, {"pose", {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}}});
    }
  }

  void choose_frames() {
    const std::size_t poses = moving_.size() * run_.frames.size();
    stride_ = std::max<std::size_t>(1, (poses + options_.most_poses - 1) / options_.most_poses);
    for (std::size_t f = 0; f < run_.frames.size(); f += stride_) frames_.push_back(f);
    if (frames_.back() + 1 != run_.frames.size()) frames_.push_back(run_.frames.size() - 1);
  }

  double largest(Vector3d BodyPose::*part) const {
    double most = 0.0;
    for (const std::size_t f : frames_)
      for (const std::size_t body : moving_) {
        const double size = (run_.frames[f].poses[body].*part).norm();
        if (std::isfinite(size)) most = std::max(most, size);
      }
    return most;
  }

  void add_poses() {
    const double place = quantum_of(kPlace * sight_m_),
                 speed = quantum_of(kSpeed * largest(&BodyPose::velocity_world)),
                 turn = quantum_of(kSpeed * largest(&BodyPose::omega_world));
    const auto add = [&](double quantum, const Value& value) {
      writer_.add(gathered(frames_.size(), value), quantum, 2);
    };
    for (const std::size_t body : moving_) {
      const auto pose = [&, body](std::size_t k) -> const BodyPose& {
        return frame(k).poses[body];
      };
      const std::vector<double> signs = steady_signs(body);
      for (int i = 0; i < 3; ++i)
        add(place, [&](std::size_t k) { return pose(k).com_world[i] - origin_world_[i]; });
      for (int i = 0; i < 4; ++i)
        add(kTurn, [&](std::size_t k) { return signs[k] * pose(k).world_from_body.coeffs()[i]; });
      for (int i = 0; i < 3; ++i)
        add(speed, [&](std::size_t k) { return pose(k).velocity_world[i]; });
      for (int i = 0; i < 3; ++i) add(turn, [&](std::size_t k) { return pose(k).omega_world[i]; });
    }
  }

  // q and -q are the same rotation: signs are chosen so that successive quaternions are close and
  // differences stay small.
  std::vector<double> steady_signs(std::size_t body) const {
    std::vector<double> signs;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      if (k == 0) {
        signs.push_back(1.0);
        continue;
      }
      const double along = frame(k).poses[body].world_from_body.coeffs().dot(
          frame(k - 1).poses[body].world_from_body.coeffs());
      signs.push_back(along < 0 ? -signs.back() : signs.back());
    }
    return signs;
  }

  std::vector<Series> all_series(const scene::Scene& scene,
                                 const std::vector<double>& apart_m) const {
    std::vector<Series> all;
    const auto add = [&](const char* plot, const std::string& name, const char* unit,
                         const Value& value) {
      all.push_back({plot, name, unit, gathered(frames_.size(), value)});
    };
    const auto total = [](const Frame& f) { return f.kinetic_energy + f.potential_energy; };
    const double at_start = total(run_.frames.front());
    if (!apart_m.empty())
      add("apart", "farthest point of any body", "m",
          [&](std::size_t k) { return apart_m[frames_[k]]; });
    add("energy", "kinetic", "J", [&](std::size_t k) { return frame(k).kinetic_energy; });
    add("energy", "potential", "J", [&](std::size_t k) { return frame(k).potential_energy; });
    add("energy", "total", "J", [&](std::size_t k) { return total(frame(k)); });
    add("drift", "E − E(0)", "J", [&](std::size_t k) { return total(frame(k)) - at_start; });
    for (int i = 0; i < 3; ++i)
      add("momentum", std::string(1, "xyz"[i]), "kg m/s",
          [&, i](std::size_t k) { return frame(k).momentum_world[i]; });
    for (int i = 0; i < 3; ++i)
      add("spin", std::string(1, "xyz"[i]), "kg m\u00b2/s",
          [&, i](std::size_t k) { return frame(k).angular_momentum_world[i]; });
    if (std::any_of(run_.frames.begin(), run_.frames.end(),
                    [](const Frame& f) { return std::isfinite(f.smallest_gap); }))
      add("gap", "smallest gap", "m", [&](std::size_t k) { return frame(k).smallest_gap; });
    const auto add_forces = [&](const auto& links, const char* plot,
                                std::vector<double> Frame::*forces) {
      for (std::size_t i = 0; i < links.size(); ++i)
        add(plot, links[i].name, "N", [&, i, forces](std::size_t k) {
          return i < (frame(k).*forces).size() ? (frame(k).*forces)[i] : kUnset;
        });
    };
    for (const effects::Effect* effect : effects::all())
      if (const auto kept = effect->measured_as())
        add_forces(effect->links(scene), effect->key().c_str(), kept);
    return all;
  }

  std::size_t add_contacts() {
    std::size_t all = 0;
    for (const std::size_t f : frames_) all += run_.frames[f].contacts.size();
    contact_stride_ =
        std::max<std::size_t>(1, (all + options_.most_contacts - 1) / options_.most_contacts);
    std::vector<double> counts;
    std::vector<const ContactPoint*> points;
    for (std::size_t k = 0; k < frames_.size(); k += contact_stride_) {
      counts.push_back(static_cast<double>(frame(k).contacts.size()));
      for (const ContactPoint& point : frame(k).contacts) points.push_back(&point);
    }
    writer_.add(counts, 1.0, 1);
    double strongest = 0.0;
    for (const ContactPoint* point : points)
      strongest = std::max(strongest, point->force_on_a_world.norm());
    const auto add = [&](double quantum, const std::function<double(const ContactPoint&)>& value) {
      writer_.add(gathered(points.size(), [&](std::size_t i) { return value(*points[i]); }),
                  quantum, 1);
    };
    add(1.0, [](const ContactPoint& c) { return c.body_a; });
    add(1.0, [](const ContactPoint& c) { return c.body_b; });
    for (int i = 0; i < 3; ++i)
      add(quantum_of(10 * kPlace * sight_m_),
          [&, i](const ContactPoint& c) { return c.point_world[i] - origin_world_[i]; });
    for (int i = 0; i < 3; ++i)
      add(quantum_of(kArrow * strongest),
          [i](const ContactPoint& c) { return c.force_on_a_world[i]; });
    return points.size();
  }

  void add_events() {
    const auto add = [&](double quantum, int order,
                         const std::function<double(const Event&)>& value) {
      std::vector<double> values;
      for (const Event& event : run_.events) values.push_back(value(event));
      writer_.add(values, quantum > 0 ? quantum : quantum_of(kCurve * largest_of(values)), order);
    };
    add(time_quantum(), 1, [](const Event& e) { return e.time; });
    add(1.0, 0, [](const Event& e) { return static_cast<double>(e.kind); });
    add(1.0, 0, [](const Event& e) { return e.body_a; });
    add(1.0, 0, [](const Event& e) { return e.body_b; });
    for (int i = 0; i < 3; ++i)
      add(quantum_of(10 * kPlace * sight_m_), 0,
          [&, i](const Event& e) { return e.point_world[i] - origin_world_[i]; });
    for (int i = 0; i < 3; ++i)
      add(kTurn, 0, [i](const Event& e) { return e.normal_b_to_a_world[i]; });
    add(0, 0, [](const Event& e) { return e.impulse; });
    add(0, 0, [](const Event& e) { return e.normal_velocity_before; });
    add(0, 0, [](const Event& e) { return e.normal_velocity_after; });
  }

  const Trajectory& run_;
  Vector3d origin_world_;  // of the page [m]
  double sight_m_;
  const PlayerOptions& options_;
  std::vector<std::size_t> moving_, frames_;
  nlohmann::ordered_json resting_ = nlohmann::ordered_json::array();
  std::size_t stride_ = 1, contact_stride_ = 1;
  ChannelWriter writer_;
};

}  // namespace

PackedRun pack_run(const scene::Scene& scene, const PlayedRun& played,
                   const std::vector<double>& apart_m, double sight_m,
                   const PlayerOptions& options) {
  return RunPacker(scene, played, sight_m, options).pack(scene, played.label, apart_m);
}

}  // namespace tumble::report
