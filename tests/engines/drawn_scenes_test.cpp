// Random scenes whose islands fuse, split and are hit: every event-driven engine commits the same
// trace.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

Trajectory run_with(const std::string& engine, int threads, const scene::Scene& scene,
                    const engines::FaultInjection& faults = {}) {
  static const Laws laws = reference_laws();
  engines::RunOptions options;
  options.engine = engine;
  options.threads = threads;
  options.faults = faults;
  return run_as_told(std::move(options), scene, laws);
}

// A row of boxes that stand or fall a short way, and balls thrown at them: with and without
// friction and restitution, with impacts located or resolved within steps.
scene::Scene thrown_at_a_row(std::uint64_t seed) {
  Random random(seed);
  std::vector<scene::BodySpec> bodies{plane("floor", {0, 0, 0}, {0, 0, 1})};
  const int boxes = 2 + static_cast<int>(random.below(5)),
            balls = 1 + static_cast<int>(random.below(4));
  for (int i = 0; i < boxes; ++i) {
    // [m], half of it
    const double height = random.below(2) == 0 ? 0.1 : 0.2,
                 drop = random.below(3) == 0 ? random.between(0.0, 0.1) : 0.0;
    bodies.push_back(box("box" + std::to_string(i), {0.1, 0.1, height}, 1.0,
                         {0.35 * i, 0, height + drop}, Vector3d::Zero()));
  }
  for (int i = 0; i < balls; ++i) {
    const Vector3d from(random.between(-0.5, 0.35 * boxes), -0.8 - 0.3 * i,
                        random.between(0.1, 0.35)),
        velocity(random.between(-0.5, 0.5), random.between(1.5, 4.0), random.between(0.0, 1.5));
    bodies.push_back(ball("ball" + std::to_string(i), 0.06, 0.5, from, velocity));
  }
  const double restitution = seed % 2 == 0 ? 0.0 : 0.3;
  for (scene::BodySpec& body : bodies) {
    body.restitution = restitution;
    body.friction = random.below(4) == 0 ? 0.0 : 0.5;
  }
  scene::Scene scene = scene_of(std::move(bodies), 0.6, kEarth);
  scene.contact = scene::ContactSpec{};
  if (seed % 4 < 2) scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  scene.step_s = 1.0 / 480.0;
  return scene;
}

TEST(LogicalProcesses, OfScenesDrawnByLotCommitTheReferencesTrace) {
  std::size_t events = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const scene::Scene scene = thrown_at_a_row(seed);
    const Trajectory reference = run_with("ordered", 1, scene);
    EXPECT_EQ(reference.stopped_by, "") << "seed " << seed;
    events += reference.events.size();
    EXPECT_EQ(difference(reference, run_with("ca", 1, scene)), "") << "seed " << seed;
    for (const int threads : {1, 2}) {
      EXPECT_EQ(difference(reference, run_with("tw", threads, scene)), "")
          << "seed " << seed << ", " << threads << " threads";
      EXPECT_EQ(difference(reference, run_with("tw", threads, scene, {seed, true, 0.05, 7, 0.02})),
                "")
          << "seed " << seed << ", " << threads << " threads, by lot";
    }
    for (const Frame& frame : reference.frames)
      ASSERT_GE(frame.smallest_gap, 0.0) << "seed " << seed << " at " << frame.time << " s";
  }
  EXPECT_GT(events, 600U);
}

}  // namespace
}  // namespace tumble::testing
