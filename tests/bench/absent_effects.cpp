// The cost of an effect that a scene does not call for. Run by absent_effects.sh under callgrind,
// once as it is and once built without the effect.
//
//   bench_... cost EFFECT     runs a scene without the effect that often tests for its absence
//   bench_... calls EFFECT    runs a scene with the effect, and prints the number of calls of its
//                             code
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "framework/core/error.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "tests/engines/effect_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

/// Twelve bodies in two rows; they fly apart without contact.
scene::Scene flying(double duration) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 6; ++i) {
    bodies.push_back(ball("ball " + std::to_string(i), 0.1, 1.0, {1.0 * i, 0, 0}, {0, 0, 0.1 * i}));
    bodies.push_back(
        box("box " + std::to_string(i), {0.1, 0.2, 0.3}, 1.0, {1.0 * i, 2, 0}, {0, 0.1 * i, 0}));
    bodies.back().omega_world_rad_s = {0.1, 0.2, 0.3};
  }
  return scene_of(bodies, duration);
}

/// The same, and they must not collide.
scene::Scene passing(double duration) {
  scene::Scene scene = flying(duration);
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  return scene;
}

/// The same flight, linked in pairs by one kind of link.
scene::Scene tied(double duration, const std::string& link) {
  scene::Scene scene = flying(duration);
  for (int i = 0; i < 6; ++i) {
    const std::string a = "ball " + std::to_string(i), b = "box " + std::to_string(i),
                      name = "link " + std::to_string(i);
    if (link == "spring")
      scene.effects.of<effects::SpringSpec>().push_back(
          {name, {a, Vector3d::Zero()}, {b, Vector3d::Zero()}, 10.0, 0.1, 2.0});
    if (link == "drag") scene.effects.of<effects::DragSpec>().push_back({a, 0.1, 0.1});
    if (link == "rod")
      scene.effects.of<effects::RodSpec>().push_back(
          {name, {a, Vector3d::Zero()}, {b, Vector3d::Zero()}, 2.0});
    if (link == "joint")
      scene.effects.of<effects::JointSpec>().push_back(
          {name, effects::JointKind::kHinge, a, b, {1.0 * i, 1, 0}, Vector3d::UnitZ()});
  }
  if (link == "rod" || link == "joint") scene.stabilisation.emplace();
  return scene;
}

/// Three boxes on one another; without contacts they bounce on the floor instead.
scene::Scene stack(double duration, double friction, bool lasting) {
  scene::Scene scene = scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ())}, duration,
                                Vector3d(0, 0, -9.81));
  for (int i = 0; i < 3; ++i) {
    if (lasting)
      scene.bodies.push_back(
          box("box " + std::to_string(i), {0.5, 0.5, 0.5}, 1.0, {0, 0, 0.5 + i}, Vector3d::Zero()));
    else
      scene.bodies.push_back(
          ball("ball " + std::to_string(i), 0.2, 1.0, {1.0 * i, 0, 1.0 + i}, Vector3d::Zero()));
  }
  for (scene::BodySpec& body : scene.bodies) {
    body.friction = friction;
    body.restitution = lasting ? 0.0 : 0.9;
  }
  if (lasting) scene.contact.emplace();
  return scene;
}

scene::Scene scene_without(const std::string& effect) {
  if (effect == "gravity" || effect == "point_force") return flying(10.0);
  if (effect == "spring") return tied(4.0, "drag");
  if (effect == "drag") return tied(4.0, "spring");
  if (effect == "rod" || effect == "motor") return tied(2.0, "joint");
  if (effect == "joint") return tied(2.0, "rod");
  if (effect == "collision") return passing(10.0);
  if (effect == "contact" || effect == "callback") return stack(5.0, 0.0, false);
  if (effect == "friction") return stack(1.0, 0.0, true);
  if (effect == "sleep") return stack(1.0, 0.5, true);
  return tied(4.0, "spring");  // for an effect that acts on islands
}

/// Callbacks come from a program, for event-driven engines; other effects from the scene, in steps.
engines::RunOptions options_about(const std::string& effect) {
  engines::RunOptions options;
  if (effect == "callback") options.engine = "ca";
  return options;
}

std::uint64_t calls_of_callback() {
  engines::RunOptions options = options_about("callback");
  options.callbacks.push_back(
      {0.1, {0}, [](int, RigidBodyState& state) { state.momentum_world.x() += 0.1; }});
  return run_with(bare(), reference_laws(), options).counters.counts.at("callback_calls");
}

std::uint64_t calls_of(std::string effect) {
  if (effect == "callback") return calls_of_callback();
  std::replace(effect.begin(), effect.end(), '_', ' ');
  scene::Scene scene = bare();
  if (!kEffects.contains(effect)) {
    std::fprintf(stderr,
                 "no scene asks for '%s': add one to kEffects, and its counter to kCountersOf, in "
                 "tests/engines/effect_scenes.h\n",
                 effect.c_str());
    std::exit(2);
  }
  kEffects.at(effect)(scene);
  Trajectory result;
  try {
    result = run(scene, reference_laws());
  } catch (const UserError&) {
    return 0;  // an unknown effect
  }
  std::uint64_t calls = 0;
  for (const std::string& counter : kCountersOf.at(effect))
    calls += result.counters.counts.at(counter);
  return calls;
}

}  // namespace
}  // namespace tumble::testing

int main(int count, char** words) {
  using namespace tumble::testing;
  if (count != 3) return 2;
  const std::string what = words[1], effect = words[2];
  if (what == "calls")
    std::printf("%llu\n", static_cast<unsigned long long>(calls_of(effect)));
  else
    std::printf(
        "%zu frames\n",
        run_with(scene_without(effect), reference_laws(), options_about(effect)).frames.size());
  return 0;
}
