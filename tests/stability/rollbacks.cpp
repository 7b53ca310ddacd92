// Row 33: bodies at their own local times, and one that comes late.
#include <malloc.h>

#include <fmt/format.h>

#include "framework/engines/events/trace.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

// balls: all that is known of them fits into the nearer caches
constexpr int kOfTenMillion = 1000;
constexpr double kTenMillionEvents = 4400.0;  // s: 2,360 impacts a second
// an hour of them takes two minutes, of 30 a quarter of an hour
constexpr int kRocks = 12;
constexpr int kCap = 8;         // states of a body: the least that is allowed
constexpr double kFlat = 1.05;  // five parts in a hundred

/// Elastic balls that fly to and fro in a box, each meeting another every few tenths of a second:
/// whoever has gone ahead alone is met by one that comes late.
scene::Scene gas(int n) {
  scene::Scene scene = scene::make_sized_scene("gas", n);
  scene.duration_s = 1.5;
  return scene;
}

Trajectory run_by(const std::string& engine, const scene::Scene& scene, const Laws& laws,
                  const engines::FaultInjection& faults = {}) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  options.faults = faults;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

/// What the program holds of the heap, of all threads. [bytes]
double allocated() {
  const struct mallinfo2 now = mallinfo2();
  return static_cast<double>(now.uordblks + now.hblkhd);
}

/// Looks at what is committed as it comes and keeps none of it; and at how much memory the run
/// holds when frames are shown.
class Watch final : public TrajectorySink {
 public:
  /// @param warm_s  when all has come to move as it will [s];  @param middle_s  the time after that
  ///                is compared with the time before
  explicit Watch(double warm_s = 0.0, double middle_s = 0.0) : warm_(warm_s), middle_(middle_s) {}

  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {
    before_ = allocated();
  }
  void frame(const Frame& frame) override {
    if (frame.time < latest) ++out_of_order;
    latest = std::max(latest, frame.time);
    if (frame.time < warm_) return;
    double& most = frame.time < middle_ ? most_early : most_late;
    most = std::max(most, allocated() - before_);
  }
  void event(const Event& event) override {
    if (event.time < latest) ++out_of_order;
    latest = std::max(latest, event.time);
    ++events;
  }
  void end(const Counters& counters, const std::string& why) override {
    counts = counters.counts;
    stopped_by = why;
  }
  double latest = 0.0;
  std::uint64_t events = 0, out_of_order = 0;
  double most_early = 0.0, most_late = 0.0;  // held by the run [bytes]
  std::map<std::string, std::uint64_t> counts;
  std::string stopped_by;

 private:
  double warm_, middle_, before_ = 0.0;
};

engines::RunOptions timewarp_on(int threads) {
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.threads = threads;
  options.frame_rate_hz = 1.0;
  return options;
}

/// From a sixth of the run on, to its middle, is compared with the rest of it.
Watch watch(const scene::Scene& scene, const Laws& laws, int threads = 1, int most_states = 0) {
  Watch watch(scene.duration_s / 6.0, scene.duration_s / 2.0);
  engines::RunOptions options = timewarp_on(threads);
  options.most_states = most_states;
  engines::run_scene(scene, laws, options, watch);
  return watch;
}

constexpr int kOfTheRow = 100'000;

/// A ball hits the next one, that one the next, and so on; when the last has been hit, the first
/// turns out to have been turned back before it began.
Watch row_taken_back(int n, const Laws& laws) {
  scene::Scene scene = scene::make_sized_scene("gas", 1);
  const scene::BodySpec ball = scene.bodies.back();
  scene.bodies.clear();
  const double radius = std::get<scene::SphereSpec>(ball.shape).radius_m;
  for (int i = 0; i < n; ++i) {
    scene.bodies.push_back(ball);
    scene.bodies.back().name = fmt::format("ball_{}", i + 1);
    scene.bodies.back().position_m = Vector3d(2.5 * radius * i, 0, 0);
    scene.bodies.back().velocity_m_s = Vector3d(i == 0 ? 1.0 : 0.0, 0, 0);
    scene.bodies.back().omega_world_rad_s.setZero();
  }
  Watch watch;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.duration_s = 0.5 * radius * n + 0.1;  // a gap of half a radius at 1 m/s
  options.frame_rate_hz = 1e-6;
  options.faults.late_callbacks = true;
  options.callbacks = {{0.01 * radius, {0}, [](int, RigidBodyState& state) {
                          state.momentum_world = -state.momentum_world;
                        }}};
  engines::run_scene(scene, laws, options, watch);
  return watch;
}

/// Rocks that come down the mountain and lie there: what is kept of them does not grow, in bytes,
/// and a cap of eight states a body changes nothing of it.
void memory_of_rocks(const Given& given, const Laws& laws, Findings& findings) {
  scene::Scene scene = scene::make_sized_scene("avalanche", kRocks);
  scene.duration_s = given.is_long ? 3600.0 : 60.0;
  for (const int threads : {1, 2}) {
    const Watch seen = watch(scene, laws, threads);
    const std::string who = fmt::format("{:.0f} s of {} rocks, {} thread{}: ", scene.duration_s,
                                        kRocks, threads, threads == 1 ? "" : "s");
    findings.at_least(who + "simulated", seen.stopped_by.empty() ? seen.latest : 0.0,
                      scene.duration_s, "s", "to its end");
    if (!(seen.most_early > 0)) {
      findings.not_run(who + "bytes", "this program's allocator does not tell what it holds");
      continue;
    }
    findings.at_most(who + "bytes held at most, after the middle over before it",
                     seen.most_late / seen.most_early, kFlat, "",
                     "flat after a warm-up of a sixth");
  }
  scene.duration_s = given.is_long ? 600.0 : 10.0;
  const Watch capped = watch(scene, laws, 1, kCap);
  findings.at_least(fmt::format("{:.0f} s of {} rocks with a cap of {} states a body: simulated",
                                scene.duration_s, kRocks, kCap),
                    capped.stopped_by.empty() ? capped.latest : 0.0, scene.duration_s, "s",
                    "it finishes all the same");
  findings.at_most(fmt::format("{} rocks with a cap of {}: states of a body at most", kRocks, kCap),
                   static_cast<double>(capped.counts.at("most_states_of_a_body")), kCap, "",
                   "the cap is kept");
}

/// Minutes of computing: a long row, and ten million events.
void long_runs(const Laws& laws, Findings& findings) {
  findings.part("a late event at the first of a long row", [&] {
    const Watch seen = row_taken_back(kOfTheRow, laws);
    findings.at_most("row of 100,000: events committed",
                     seen.stopped_by.empty() ? static_cast<double>(seen.events) : 1e9, 1.0, "",
                     "the late one: what came of the first ball's way has not happened");
    findings.at_least("row of 100,000: rollbacks", static_cast<double>(seen.counts.at("rollbacks")),
                      kOfTheRow, "", "each is taken back");
    findings.at_most("row of 100,000: rollbacks ", static_cast<double>(seen.counts.at("rollbacks")),
                     kOfTheRow, "", "and once");
  });
  findings.part("ten million events", [&] {
    scene::Scene scene = scene::make_sized_scene("gas", kOfTenMillion);
    scene.duration_s = kTenMillionEvents;
    const Watch seen = watch(scene, laws);
    findings.at_least("gas of 1,000: events committed", static_cast<double>(seen.events), 1e7, "",
                      "else it was too short");
    if (seen.most_early > 0)
      findings.at_most("gas of 1,000: bytes held at most, after the middle over before it",
                       seen.most_late / seen.most_early, kFlat, "",
                       "flat after a warm-up of a sixth");
    findings.at_most("gas of 1,000: frames and events shown after later ones",
                     static_cast<double>(seen.out_of_order), 0.0, "",
                     "global virtual time only grows, and nothing is shown before it");
  });
}

/// Looks at what elastic balls keep, as it is committed: the energy; and momentum and angular
/// momentum (about the world's origin) less what walls have given, of each collision its impulse
/// and that impulse's moment.
class Conserved final : public TrajectorySink {
 public:
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>& bodies) override {
    bodies_ = bodies;
  }
  void event(const Event& event) override {
    ++collisions;
    const bool a_is_wall = is_wall(event.body_a);
    if (a_is_wall == is_wall(event.body_b)) return;
    const Vector3d impulse_world =
        (a_is_wall ? -event.impulse : event.impulse) * event.normal_b_to_a_world;
    by_walls_world_ += impulse_world;
    turned_by_walls_world_ += event.point_world.cross(impulse_world);
  }
  void frame(const Frame& frame) override {
    if (frame.time == 0.0) {
      first_ = frame;
      for (std::size_t i = 0; i < bodies_.size(); ++i)  // of 1 kg each
        if (!bodies_[i].immovable)
          speeds_ += frame.poses[i].velocity_world.norm(),
              moments_ += frame.poses[i].com_world.norm() * frame.poses[i].velocity_world.norm();
    }
    energy = std::max(
        energy, std::abs(frame.kinetic_energy - first_.kinetic_energy) / first_.kinetic_energy);
    momentum =
        std::max(momentum,
                 (frame.momentum_world - first_.momentum_world - by_walls_world_).norm() / speeds_);
    angular_momentum = std::max(
        angular_momentum,
        (frame.angular_momentum_world - first_.angular_momentum_world - turned_by_walls_world_)
                .norm() /
            moments_);
    by_walls = std::max(by_walls, by_walls_world_.norm() / speeds_);
  }
  void end(const Counters&, const std::string& why) override { stopped_by = why; }

  // largest relative errors; momenta over the sums of m |v| and of |r| m |v| at the start
  double energy = 0.0, momentum = 0.0, angular_momentum = 0.0;
  // the walls' part of the momentum, over the same
  double by_walls = 0.0;
  std::uint64_t collisions = 0;
  std::string stopped_by;

 private:
  bool is_wall(int body) const { return bodies_[static_cast<std::size_t>(body)].immovable; }

  std::vector<TrajectoryBody> bodies_;
  Frame first_;
  // [N s], [N m s]
  Vector3d by_walls_world_ = Vector3d::Zero(), turned_by_walls_world_ = Vector3d::Zero();
  double speeds_ = 0.0, moments_ = 0.0;
};

Conserved conserved(int n, double duration, int threads, const Laws& laws) {
  Conserved seen;
  engines::RunOptions options = timewarp_on(threads);
  options.duration_s = duration;
  engines::run_scene(scene::make_sized_scene("gas", n), laws, options, seen);
  return seen;
}

// Each collision rounds two velocities and a place by an ulp: a walk of 10^6 such steps is 1e-13 of
// the whole, a drift always to one side 1e-10. Impulses too large by a part in 10^9, which no eye
// would see, are caught.
constexpr double kConserved = 1e-10;

/// Ten thousand collisions, or a million, on one thread and on two.
void what_elastic_balls_keep(const Given& given, const Laws& laws, Findings& findings) {
  const int n = given.is_long ? 1000 : 300;
  // 2.36 collisions a ball and second
  const double least = given.is_long ? 1e6 : 1e4, duration = given.is_long ? 450.0 : 15.0;
  for (const int threads : {1, 2}) {
    const Conserved seen = conserved(n, duration, threads, laws);
    const std::string who =
        fmt::format("gas of {}, {} thread{}: ", n, threads, threads == 1 ? "" : "s");
    findings.at_least(who + "collisions",
                      seen.stopped_by.empty() ? static_cast<double>(seen.collisions) : 0.0, least,
                      "", "else it was too short");
    findings.at_most(who + "energy, largest relative error", seen.energy, kConserved, "",
                     "elastic collisions keep it; rounding alone is 1e-13");
    findings.at_most(who + "momentum less what walls gave", seen.momentum, kConserved, "",
                     "over the sum of m |v|");
    findings.at_most(who + "angular momentum less what walls gave", seen.angular_momentum,
                     kConserved, "", "about the origin, over the sum of |r| m |v|");
    findings.at_least(who + "what walls gave", seen.by_walls, 1e-3, "",
                      "walls have a part in the balance");
  }
  Laws wrong = laws;
  wrong.collision_impulse = [law = laws.collision_impulse](const Contact& contact, const Body& a,
                                                           const Body& b, double restitution) {
    return (1.0 + 1e-9) * law(contact, a, b, restitution);
  };
  findings.must_fail("gas of 300, impulses too large by a part in 10^9: energy",
                     conserved(300, 15.0, 1, wrong).energy, kConserved, "", "the measure sees it");
}

/// How many bodies of frames are not, bit for bit, where the other run has them; 1e9 where events
/// differ.
double differences(const Trajectory& a, const Trajectory& b) {
  if (a.frames.size() != b.frames.size() || engines::compare_traces(a, b)) return 1e9;
  double count = 0.0;
  for (std::size_t k = 0; k < a.frames.size(); ++k)
    for (std::size_t i = 0; i < a.bodies.size(); ++i)
      if (a.frames[k].poses[i].com_world != b.frames[k].poses[i].com_world ||
          a.frames[k].poses[i].world_from_body.coeffs() !=
              b.frames[k].poses[i].world_from_body.coeffs())
        ++count;
  return count;
}

void rollback(const Given& given, Findings& findings) {
  if (!engines::fast_timewarp())
    return findings.not_run("timewarp",
                            "this tree has no scheduler of its own: --modules a4=... brings one");
  const scene::Scene scene = gas(60);
  Laws laws = given.laws;
  // the fast scheduler is tried here; a module's decisions are tried by its assignment
  laws.scheduling = {};
  const Trajectory reference = run_by("ordered", scene, laws);
  const int seeds = given.is_long ? 200 : 20;
  double worst = 0.0;
  std::uint64_t rollbacks = 0;
  const auto part_undone = [](const Trajectory& run) {
    return static_cast<double>(run.counters.counts.at("undone_integrations")) /
           static_cast<double>(run.counters.counts.at("integrations"));
  };
  report::Curve by_lot{"by lot", {}, {}, true}, own{"in its own order", {}, {}};
  for (int seed = 1; seed <= seeds; ++seed) {
    const Trajectory run =
        run_by("tw", scene, laws, {static_cast<std::uint64_t>(seed), true, 0.25, 10, 0.05});
    worst = std::max(worst, differences(reference, run));
    rollbacks += run.counters.counts.at("rollbacks");
    by_lot.x.push_back(seed), by_lot.y.push_back(part_undone(run));
  }
  const Trajectory plain = run_by("tw", scene, laws);
  own.x = {1.0, static_cast<double>(seeds)}, own.y = {part_undone(plain), part_undone(plain)};
  findings.plot(
      {"Sixty balls in a box: integrations that were undone, by the order of processing",
       {"order of processing, by lot"},
       {"part of all integrations"},
       {by_lot, own},
       {{0.15, "threshold in its own order"}},
       "However much is undone on the way, what is committed is the same to the last bit."});
  findings.at_most(fmt::format("{} orders of processing by lot: bodies of frames that differ from "
                               "the run in order of time",
                               seeds),
                   worst, 0.0, "", "bit by bit: rolled back is as if it had never been");
  findings.at_least(fmt::format("{} orders of processing by lot: rollbacks a run", seeds),
                    static_cast<double>(rollbacks) / seeds, 10.0, "", "else nothing was tried");
  findings.at_most("in its own order: integrations undone", part_undone(plain), 0.15, "",
                   "work in proportion to the events: at most 15 % of it for nothing");
  // Steps for all bodies end where any of them meets something: the same motion, rounded
  // differently, and impacts multiply that.
  const Trajectory steps = run_by("rd", scene, laws);
  double parted = 0.0;
  for (std::size_t k = 0; k < std::min(reference.frames.size(), steps.frames.size()); ++k)
    for (std::size_t i = 0; i < reference.bodies.size(); ++i)
      parted +=
          reference.frames[k].poses[i].com_world != steps.frames[k].poses[i].com_world ? 1.0 : 0.0;
  findings.must_fail("retroactive detection in steps: bodies of frames that differ in any bit",
                     parted, 0.0, "", "it cuts every flight where any body meets anything");
  findings.part("rocks", [&] { memory_of_rocks(given, laws, findings); });
  findings.part("what elastic balls keep", [&] { what_elastic_balls_keep(given, laws, findings); });
  if (given.is_long) long_runs(laws, findings);
}

}  // namespace

void add_rollbacks(std::vector<Case>& cases) {
  cases.push_back({33, "timewarp rollback",
                   "Many bodies at their own local times, one of which comes late and sends others "
                   "back: the result may not depend on the order of processing, bit by bit.",
                   "a1", rollback});
}

}  // namespace tumble::battery
