/// Small scenes driven by the scheduler under test. Not for students' own tests (aN_fixtures.h is):
/// they are linked without an engine.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"
#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {

/// Balls of radius 0.1 m and 1 kg, restitution 1.
scene::BodySpec ball(const std::string& name, const Vector3d& position, const Vector3d& velocity);
/// A wall that is a half-space; its normal points to where the balls are.
scene::BodySpec wall(const std::string& name, const Vector3d& position, const Vector3d& normal);
scene::Scene scene_of(std::vector<scene::BodySpec> bodies, double duration_s, double step_s);
/// n balls at lot's places in a box of walls, at speeds of about 1 m/s.
scene::Scene balls_in_a_box(int n, std::uint64_t seed, double duration_s);
/// Balls that do not bounce and have friction: one drops between two that touch on a floor, a heap
/// that slides apart, and a last one falls on it from `last_at`. Contact groups form and split.
scene::Scene heap_of_balls(const Vector3d& last_at, double duration_s);

/// The scene by the framework's teaching timewarp on the decisions under test.
Trajectory run_by_the_scheduler(const scene::Scene& scene);
/// The same, which must end well: every committed event the ordered reference's, and at least so
/// many of them.
Trajectory expect_the_references_trace(const scene::Scene& scene, std::size_t least_events,
                                       const std::string& what);

}  // namespace tumble::a4_testing
