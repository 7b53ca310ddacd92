// Only the effects that a scene calls for are simulated: counters of every other effect stay at 0.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "tests/engines/effect_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

/// By effect: the events that tell of it.
const std::map<std::string, std::vector<EventKind>> kEventsOf = {
    {"friction", {EventKind::kSlide}},
    {"contact", {EventKind::kContact}},
    {"point force", {EventKind::kForceOn, EventKind::kForceOff}},
    {"collision", {EventKind::kCollision}},
    {"sleep", {EventKind::kSleep}},
};

TEST(Effects, OnlyWhatASceneAsksForRuns) {
  const Laws laws = reference_laws();
  // Effects that stand on others.
  const std::map<std::string, std::vector<std::string>> brings = {
      {"motor", {"joint"}},
      {"water", {"gravity"}},
      {"contact", {"gravity"}},
      {"friction", {"contact", "gravity"}},
      {"sleep", {"contact", "gravity"}}};
  for (const auto& [effect, add] : kEffects) {
    scene::Scene scene = bare();
    add(scene);
    const Trajectory result = run(scene, laws);
    EXPECT_EQ(result.stopped_by, "") << effect;
    std::vector<std::string> expected{effect};
    if (const auto more = brings.find(effect); more != brings.end())
      expected.insert(expected.end(), more->second.begin(), more->second.end());
    for (const auto& [other, counters] : kCountersOf) {
      const bool asked = std::find(expected.begin(), expected.end(), other) != expected.end();
      for (const std::string& counter : counters) {
        const std::uint64_t count = result.counters.counts.at(counter);
        if (asked)
          EXPECT_GT(count, 0u) << counter << " in a scene with " << effect;
        else
          EXPECT_EQ(count, 0u) << counter << " in a scene with " << effect;
      }
      if (!kEventsOf.contains(other)) continue;
      for (const EventKind kind : kEventsOf.at(other)) {
        const bool told = std::any_of(result.events.begin(), result.events.end(),
                                      [&](const Event& event) { return event.kind == kind; });
        EXPECT_EQ(told, asked) << "events of " << other << " in a scene with " << effect;
      }
    }
  }
}

// A callback comes from a program, not from a scene: it is called by the engines that go from event
// to event, as often as it was asked for.
TEST(Effects, ACallbackIsCalledWhereAProgramGivesOne) {
  const Laws laws = reference_laws();
  for (const char* engine : {"ordered", "ca"})
    for (const int asked : {0, 3}) {
      engines::RunOptions options;
      options.engine = engine;
      for (int k = 0; k < asked; ++k)
        options.callbacks.push_back({0.1 * (k + 1), {0, 1}, [](int, RigidBodyState& state) {
                                       state.momentum_world.x() += 0.1;
                                     }});
      EXPECT_EQ(run_with(bare(), laws, options).counters.counts.at("callback_calls"),
                static_cast<std::uint64_t>(asked))
          << engine;
    }
}

TEST(Effects, AStageIsTimedWhereItIsThere) {
  const Laws laws = reference_laws();
  // What every run does, and what an effect adds to it.
  const std::map<std::string, std::vector<std::string>> stages_of = {
      {"gravity", {}},
      {"spring", {"forces"}},
      {"rod", {"forces", "constraints"}},
      {"motor", {"forces", "constraints", "control"}},
      {"collision", {"impacts"}},
      {"sleep", {"contacts", "sleep"}}};
  for (const auto& [effect, stages] : stages_of) {
    scene::Scene scene = bare();
    kEffects.at(effect)(scene);
    for (const auto& [stage, seconds] : run(scene, laws).counters.stage_seconds) {
      const bool there = stage == "integration" || stage == "collision" || stage == "recording" ||
                         std::find(stages.begin(), stages.end(), stage) != stages.end();
      EXPECT_EQ(seconds > 0.0, there) << stage << " in a scene with " << effect;
    }
  }
}

/// A stack of five at rest, 20 balls that fall a kilometre above it, or both.
scene::Scene stack_and_balls(bool stack, bool balls) {
  std::vector<scene::BodySpec> bodies{plane("floor", Vector3d::Zero(), Vector3d::UnitZ())};
  for (int i = 0; i < 5 && stack; ++i)
    bodies.push_back(
        box("box " + std::to_string(i), {0.5, 0.5, 0.5}, 1.0, {0, 0, 0.5 + i}, Vector3d::Zero()));
  for (int i = 0; i < 20 && balls; ++i)
    bodies.push_back(ball("ball " + std::to_string(i), 0.1, 1.0, {3.0 * i, 0, 1000}, {0, 1, 0}));
  for (scene::BodySpec& body : bodies) {
    body.restitution = 0.0;
    body.friction = 0.5;
  }
  scene::Scene scene = scene_of(bodies, 1.0, Vector3d(0, 0, -9.81));
  scene.contact.emplace();
  return scene;
}

TEST(Effects, BodiesInFlightPayNothingForAStackAndItNothingForThem) {
  const Laws laws = reference_laws();
  const auto counts = [&](bool stack, bool balls) {
    return run(stack_and_balls(stack, balls), laws).counters.counts;
  };
  const auto alone = counts(true, false), flying = counts(false, true), both = counts(true, true);
  for (const char* counter :
       {"candidate_pairs", "gap_evaluations", "root_findings", "contact_solves", "contact_points",
        "friction_points", "contact_sweeps", "contact_factorisations", "position_corrections"}) {
    EXPECT_EQ(flying.at(counter), 0u) << counter;
    EXPECT_EQ(both.at(counter), alone.at(counter)) << counter;
  }
  for (const char* counter :
       {"integrations", "undone_integrations", "derivative_evaluations", "gravity_calls"})
    EXPECT_EQ(both.at(counter), alone.at(counter) + flying.at(counter)) << counter;
  EXPECT_GT(alone.at("contact_solves"), 0u);
  EXPECT_EQ(both.at("steps"), alone.at("steps"));
}

// Bodies that may not meet are not looked at by collision finding.
TEST(Effects, BodiesThatDoNotCollideCostNoCollisionFinding) {
  scene::Scene scene = bare();
  scene.bodies[0].velocity_m_s = {5, 0, 0};
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  const Trajectory result = run(scene, reference_laws());
  for (const char* counter : {"candidate_pairs", "gap_evaluations", "root_findings", "impacts"})
    EXPECT_EQ(result.counters.counts.at(counter), 0u) << counter;
}

}  // namespace
}  // namespace tumble::testing
