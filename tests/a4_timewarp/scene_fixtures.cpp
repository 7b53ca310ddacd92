#include "tests/a4_timewarp/scene_fixtures.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/core/shortest_turn.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/engines/run.h"

namespace tumble::a4_testing {

scene::BodySpec ball(const std::string& name, const Vector3d& position, const Vector3d& velocity) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::SphereSpec{0.1};
  body.mass_kg = 1.0;
  body.position_m = position;
  body.velocity_m_s = velocity;
  body.restitution = 1.0;
  return body;
}

scene::BodySpec wall(const std::string& name, const Vector3d& position, const Vector3d& normal) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::PlaneSpec{};
  body.world_from_body = shortest_turn(Vector3d::UnitZ(), normal);
  body.position_m = position;
  body.immovable = true;
  body.restitution = 1.0;
  return body;
}

scene::Scene scene_of(std::vector<scene::BodySpec> bodies, double duration_s, double step_s) {
  scene::Scene scene;
  scene.name = "test";
  scene.bodies = std::move(bodies);
  scene.duration_s = duration_s;
  scene.step_s = step_s;
  return scene;
}

scene::Scene balls_in_a_box(int n, std::uint64_t seed, double duration_s) {
  const int across = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(n))));
  const double spacing = 0.45, half = 0.5 * spacing * across;
  std::vector<scene::BodySpec> bodies;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      bodies.push_back(wall("wall " + std::to_string(bodies.size() + 1),
                            side * half * Vector3d::Unit(axis), -side * Vector3d::Unit(axis)));
  Random random(seed);
  for (int i = 0; i < n; ++i) {
    const Vector3d cell(i % across, (i / across) % across, i / (across * across));
    const Vector3d shift(random.between(-0.05, 0.05), random.between(-0.05, 0.05),
                         random.between(-0.05, 0.05)),
        velocity(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    bodies.push_back(ball(
        "ball " + std::to_string(i + 1),
        spacing * (cell + Vector3d::Constant(0.5)) - Vector3d::Constant(half) + shift, velocity));
  }
  return scene_of(std::move(bodies), duration_s, 0.1);
}

scene::Scene heap_of_balls(const Vector3d& last_at, double duration_s) {
  std::vector<scene::BodySpec> bodies{wall("floor", Vector3d::Zero(), {0, 0, 1})};
  bodies.push_back(ball("left", {-0.1, 0, 0.1}, Vector3d::Zero()));
  bodies.push_back(ball("right", {0.1, 0, 0.1}, Vector3d::Zero()));
  bodies.push_back(ball("top", {0.03, 0.01, 0.35}, Vector3d::Zero()));
  bodies.push_back(ball("last", last_at, Vector3d::Zero()));
  for (scene::BodySpec& body : bodies) {
    body.restitution = 0.0;
    body.friction = 0.3;
  }
  scene::Scene scene = scene_of(std::move(bodies), duration_s, 1.0 / 60.0);
  effects::set_gravity(scene, Vector3d(0, 0, -9.81));
  scene.contact = scene::ContactSpec{};
  return scene;
}

namespace {

// Balls of one mass that exchange their normal velocities, and walls that reverse them: enough for
// these scenes. Restitution is 0 or 1.
Laws laws_of_equal_balls() {
  Laws laws = library_laws();
  laws.relative_normal_velocity = [](const Contact& contact, const Body& a, const Body& b) {
    return contact.normal_b_to_a_world.dot(a.velocity_world - b.velocity_world);
  };
  laws.collision_impulse = [approach = laws.relative_normal_velocity](const Contact& contact,
                                                                      const Body& a, const Body& b,
                                                                      double restitution) {
    const bool is_wall = a.inertia.inverse_mass == 0 || b.inertia.inverse_mass == 0;
    return std::max(
        0.0, (is_wall ? -1.0 : -0.5) * (restitution > 0 ? 2.0 : 1.0) * approach(contact, a, b));
  };
  laws.ends_in_contact = [](double, double restitution, double) { return restitution == 0.0; };
  laws.contact_forces = [](const MatrixXd&, const VectorXd&) -> VectorXd {
    throw PreconditionError("these scenes have friction wherever bodies stay in contact");
  };
  laws.apply_impulse = [](const Body& body, const Vector3d& impulse_world, const Vector3d&) {
    return Velocity{body.velocity_world + body.inertia.inverse_mass * impulse_world,
                    body.omega_world};
  };
  const a4::Module& m = a4_module();
  laws.scheduling = {m.comes_before,        m.next_check_time, m.on_collision_check,
                     m.contact_groups,      m.on_group_check,  m.on_callback,
                     m.anti_messages,       m.plan_rollback,   m.after_rollback,
                     m.global_virtual_time, m.may_commit,      m.states_to_purge};
  laws.scheduling_source = "the scheduler under test";
  return laws;
}

}  // namespace

Trajectory run_by_the_scheduler(const scene::Scene& scene) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.frame_rate_hz = 5.0;
  engines::run_scene(scene, laws_of_equal_balls(), options, recorder);
  return recorder.trajectory();
}

Trajectory expect_the_references_trace(const scene::Scene& scene, std::size_t least_events,
                                       const std::string& what) {
  const Trajectory run = run_by_the_scheduler(scene);
  const Story story{.scene = what,
                    .slip =
                        "what was found names the decision; the page of such a run draws it: "
                        "./tumble run late_hit "
                        "--html late_hit.html",
                    .handout = "handouts/a4_timewarp.md#whole-runs"};
  expect_true(run.stopped_by.empty(),
              "every committed event is the ordered reference's, bit for bit", run.stopped_by,
              story);
  if (run.stopped_by.empty())
    expect_true(run.events.size() >= least_events,
                "at least " + std::to_string(least_events) + " committed events",
                std::to_string(run.events.size()), story);
  return run;
}

}  // namespace tumble::a4_testing
