// Bodies that links, forces and lasting contacts hold together are processes: every event-ordered engine commits the same of them.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "framework/scene/load_scene.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

TEST(Debug, Scene) {
  if (!std::getenv("SCENE")) GTEST_SKIP();
  const scene::Scene scene = scene::load_scene(std::getenv("SCENE"));
  const Laws laws = reference_laws();
  const Trajectory reference = run_by("ordered", scene, {}, 60.0, laws), tw = run_by(std::getenv("ENGINE") ? std::getenv("ENGINE") : "tw", scene, {}, 60.0, laws);
  std::printf("%s\n", difference(reference, tw).c_str());
  const double t = std::atof(std::getenv("T") ? std::getenv("T") : "1e9");
  for (const Trajectory* run : {&reference, &tw}) {
    std::printf("----\n");
    if (std::getenv("ENERGY"))
      for (const Frame& f : run->frames) std::printf("E %.5f %.9g gap %.3g contacts %zu\n", f.time, f.kinetic_energy + f.potential_energy, f.smallest_gap, f.contacts.size());
    for (const Event& e : run->events)
      if (std::abs(e.time - t) < std::atof(std::getenv("DT") ? std::getenv("DT") : "0.02")) std::printf("%.9f kind %d  %d %d  j %.4g vn %.4g -> %.4g\n", e.time, int(e.kind), e.body_a, e.body_b, e.impulse, e.normal_velocity_before, e.normal_velocity_after);
  }
}

}  // namespace
}  // namespace tumble::testing
