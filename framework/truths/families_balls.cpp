// bouncing_ball, ball_moving_floor, ball_shaken_floor: a ball (a point mass) on a floor, run by the
// engine with the chosen laws.
#include <algorithm>
#include <cmath>

#include "framework/truths/families.h"
#include "framework/truths/memory_scene.h"
#include "framework/scene/write_entries.h"

namespace tumble::truths {
namespace {

constexpr double kMass = 1.0;  // kg: has no effect
// of the slowest impact in the file: the transition to rest comes after the last of them
constexpr double kRestBelow = 0.5;
// m/s: upper limit; the height of its bounce, 5e-12 m, is still far above the rounding of heights
constexpr double kRestSpeed = 1e-5;

struct BallOnFloor {
  double g, e;
  scene::Scene scene;
};

/// @param duration  [s];  @param slowest_impact  relative speed of the slowest impact that must not
///   end in rest [m/s]
BallOnFloor ball_on_floor(const Case& truth, double duration, double slowest_impact) {
  BallOnFloor world{
      truth.input("g").number(), truth.input("e").number(),
      empty_scene(truth.id, duration, std::min(kRestSpeed, kRestBelow * slowest_impact))};
  scene::EntryWriter{world.scene}("gravity_m_s2", Vector3d(0, 0, -world.g));
  // Some cases give the start separately from the height of the other outputs.
  const double z0 =
      truth.inputs.find("z0") ? truth.input("z0").number() : truth.input("h").number();
  const double v0 = truth.inputs.find("v0") ? truth.input("v0").number() : 0.0;
  world.scene.bodies.push_back(
      ball("ball", kMass, 0.0, Vector3d(0, 0, z0), Vector3d(0, 0, v0), world.e));
  world.scene.bodies.push_back(wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), world.e));
  return world;
}

/// The first n values of a quantity of the impacts; shorter where there were fewer, which fails
/// every comparison.
template <class Quantity>
VectorXd column(const std::vector<Event>& impacts, std::size_t n, const Quantity& quantity) {
  VectorXd values(static_cast<Eigen::Index>(std::min(n, impacts.size())));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values[i] = quantity(impacts[static_cast<std::size_t>(i)]);
  return values;
}

double time_of(const Event& impact) { return impact.time; }
/// Relative speed just after, along the normal: only the impulse changes it.
double speed_after(const Event& impact) {
  return impact.normal_velocity_before + impact.impulse / kMass;
}

// ---- bouncing_ball -----------------------------------------------------------------------------

void compare_rest(const Case& truth, const BallOnFloor& world, const Trajectory& run,
                  Comparison& comparison) {
  const auto rest = std::find_if(run.events.begin(), run.events.end(),
                                 [](const Event& event) { return event.kind == EventKind::kRest; });
  if (rest == run.events.end()) {
    comparison.agree("zeno_time", false, "the ball never came to rest");
    return;
  }
  // The infinitely many impacts below the restitution threshold v take at most 2 v / (g (1 - e)).
  const double floor = truth.floor("zeno_time"),
               left = 2.0 * world.scene.rest_speed_m_s / (world.g * (1.0 - world.e));
  comparison.check("zeno_time", std::abs(rest->time - truth.output("zeno_time").number()), floor,
                   kClosedFormFactor * floor + left,
                   "tolerance: includes the time that rest below 1e-5 m/s cuts off");
  const Vector3d &start = world.scene.bodies[0].position_m,
                 &thrown = world.scene.bodies[0].velocity_m_s;
  // Down from the start; if thrown upwards, first up to the apex and back.
  double path = start.z() + (thrown.z() > 0.0 ? thrown.z() * thrown.z() / world.g : 0.0);
  for (const Event& impact : impacts_of(run))
    path += speed_after(impact) * speed_after(impact) / world.g;
  const double path_left =
      std::pow(world.scene.rest_speed_m_s, 2) / (world.g * (1.0 - world.e * world.e));
  const double path_floor = truth.floor("path_length_total");
  comparison.check("path_length_total", std::abs(path - truth.output("path_length_total").number()),
                   path_floor, kClosedFormFactor * path_floor + path_left,
                   "tolerance: includes the path of the bounces that rest cuts off");
}

void compare_listed_times(const Case& truth, const BallOnFloor& world, const Laws& laws,
                          Comparison& comparison) {
  // A ball at rest lacks the bounces that the transition to rest cuts off, and the file's floor of
  // 0 leaves no room: their height is added.
  const double v_rest = world.scene.rest_speed_m_s;
  for (const Value& time : truth.input("times").list()) {
    const std::string z = "z_t" + time.text(), v = "v_t" + time.text();
    const Frame frame = frame_at(world.scene, laws, time.number());
    const double z_error = std::abs(frame.poses[0].com_world.z() - truth.output(z).number());
    const double v_error = std::abs(frame.poses[0].velocity_world.z() - truth.output(v).number());
    const bool rests = frame.poses[0].velocity_world.isZero(0.0);
    const auto check = [&](const std::string& output, double error, double left) {
      const double mark = kClosedFormFactor * truth.floor(output);
      comparison.check(output, error, truth.floor(output), rests ? mark + left : mark,
                       rests ? "tolerance: at rest, includes the bounces that rest cuts off" : "");
    };
    check(z, z_error, v_rest * v_rest / (2.0 * world.g));
    check(v, v_error, v_rest);
  }
}

}  // namespace

void compare_bouncing_ball(const Case& truth, const Laws& laws, Comparison& comparison) {
  const VectorXd times = truth.output("impact_times").vector(),
                 speeds = truth.output("speed_after_impact").vector();
  const bool zeno = truth.has_output("zeno_time");
  const double last = std::max(times.maxCoeff(), zeno ? truth.output("zeno_time").number() : 0.0);
  BallOnFloor world = ball_on_floor(truth, 1.01 * last + 0.1, speeds.minCoeff());
  const Trajectory run = run_in_memory(world.scene, laws, kNoFrames);
  const std::vector<Event> impacts = impacts_of(run);
  const auto count = static_cast<std::size_t>(times.size());
  comparison.closed_form(truth, "impact_times", column(impacts, count, time_of));
  comparison.closed_form(truth, "speed_after_impact", column(impacts, count, speed_after));
  comparison.closed_form(truth, "apex_height_after_impact",
                         column(impacts, count, [&](const Event& impact) {
                           return speed_after(impact) * speed_after(impact) / (2.0 * world.g);
                         }));
  if (zeno) compare_rest(truth, world, run, comparison);
  compare_listed_times(truth, world, laws, comparison);
}

// ---- ball_moving_floor -------------------------------------------------------------------------

namespace {

/// Impact times and the ball's own velocities, on a floor that moves at floor_velocity(t).
template <class FloorVelocity>
void compare_impacts(const Case& truth, const std::vector<Event>& impacts,
                     const FloorVelocity& floor_velocity, Comparison& comparison) {
  const auto count = static_cast<std::size_t>(truth.output("impact_times").list().size());
  comparison.closed_form(truth, "impact_times", column(impacts, count, time_of));
  comparison.closed_form(truth, "ball_velocity_before",
                         column(impacts, count, [&](const Event& impact) {
                           return floor_velocity(impact.time) + impact.normal_velocity_before;
                         }));
  comparison.closed_form(truth, "ball_velocity_after",
                         column(impacts, count, [&](const Event& impact) {
                           return floor_velocity(impact.time) + speed_after(impact);
                         }));
}

}  // namespace

void compare_moving_floor(const Case& truth, const Laws& laws, Comparison& comparison) {
  const double V = truth.input("V_floor").number();
  const VectorXd times = truth.output("impact_times").vector(),
                 after = truth.output("ball_velocity_after").vector();
  const double zeno = truth.output("zeno_time").number();
  BallOnFloor world = ball_on_floor(truth, 1.01 * std::max(times.maxCoeff(), zeno) + 0.1,
                                    (after.array() - V).minCoeff());
  scene::BodySpec& floor = world.scene.bodies[1];
  floor.position_m.z() = truth.input("z0_floor").number();
  floor.motion = scene::PrescribedMotion{};
  floor.motion->velocity_m_s.z() = V;
  const Trajectory run = run_in_memory(world.scene, laws, kNoFrames);
  const std::vector<Event> impacts = impacts_of(run);
  compare_impacts(
      truth, impacts, [V](double) { return V; }, comparison);
  comparison.closed_form(truth, "impact_height",
                         column(impacts, static_cast<std::size_t>(times.size()),
                                [](const Event& impact) { return impact.point_world.z(); }));

  const auto rest = std::find_if(run.events.begin(), run.events.end(),
                                 [](const Event& event) { return event.kind == EventKind::kRest; });
  const double left = 2.0 * world.scene.rest_speed_m_s / (world.g * (1.0 - world.e)),
               floor_of_zeno = truth.floor("zeno_time");
  if (rest == run.events.end())
    comparison.agree("zeno_time", false, "the ball never came to rest on the floor");
  else
    comparison.check("zeno_time", std::abs(rest->time - zeno), floor_of_zeno,
                     kClosedFormFactor * floor_of_zeno + left,
                     "tolerance: includes the time that rest cuts off");
}

// ---- ball_shaken_floor -------------------------------------------------------------------------

void compare_shaken_floor(const Case& truth, const Laws& laws, Comparison& comparison) {
  const double A = truth.input("A").number(), w = truth.input("omega").number();
  const auto floor_velocity = [=](double t) { return A * w * std::cos(w * t); };
  const VectorXd times = truth.output("impact_times").vector(),
                 after = truth.output("ball_velocity_after").vector();
  double slowest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < times.size(); ++i)
    slowest = std::min(slowest, after[i] - floor_velocity(times[i]));
  BallOnFloor world = ball_on_floor(truth, 1.01 * times.maxCoeff(), slowest);
  scene::PrescribedMotion shake;
  shake.amplitude_m.z() = A;
  shake.angular_frequency_rad_s = w;
  world.scene.bodies[1].motion = shake;
  compare_impacts(truth, impacts_of(run_in_memory(world.scene, laws, kNoFrames)), floor_velocity,
                  comparison);
}

}  // namespace tumble::truths
