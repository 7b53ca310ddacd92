// Scenes of the course in other units: a run that differs compares what has a unit with a plain
// number.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engines/other_units.h"
#include "tests/engines/reference_runs.h"
#include "tests/support/places.h"

namespace tumble::testing::units_test {
namespace {

Trajectory run_in(const nlohmann::json& scene, const std::filesystem::path& file,
                  const std::string& engine, const OtherUnits& units) {
  static const Laws laws = reference_laws();
  engines::RunOptions options;
  options.engine = engine;
  options.frame_rate_hz = 60.0 * units.of(0, -1, 0);
  return run_as_told(std::move(options), scene::parse_scene(scene.dump(), file), laws);
}

struct Tried {
  const char* scene;
  double duration_s;
  std::vector<const char*> engines;
};
class OtherUnitsOf : public ::testing::TestWithParam<Tried> {};

// Frame for frame to the last bit. Lengths from picometres to megametres, seconds to thousandths,
// masses to a millionth of a millionth and back; the exponents are even, so that roots are exact.
TEST_P(OtherUnitsOf, AScenesMotionIsTheSame) {
  const std::filesystem::path file = test::source_dir() + "/" + GetParam().scene;
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  nlohmann::json scene = with_defaults_said(text.str(), file);
  scene["duration_s"] = GetParam().duration_s;
  scene.erase("checks");  // of the end of its own duration
  for (const char* engine : GetParam().engines) {
    const Trajectory expected = run_in(scene, file, engine, {});
    EXPECT_EQ(expected.stopped_by, "");
    for (const OtherUnits units :
         {OtherUnits{-40, 0, 0}, {0, 0, 20}, {20, 10, -20}, {-20, -10, 40}}) {
      SCOPED_TRACE(::testing::Message()
                   << engine << ", lengths times 2^" << units.length << ", times 2^" << units.time
                   << ", masses 2^" << units.mass);
      const Trajectory found = run_in(in_other_units(scene, units), file, engine, units);
      EXPECT_EQ(faults_of(found), faults_of(expected));
      ASSERT_EQ(found.frames.size(), expected.frames.size());
      for (std::size_t k = 0; k < found.frames.size(); ++k)
        for (std::size_t i = 0; i < expected.bodies.size(); ++i) {
          const BodyPose &one = expected.frames[k].poses[i], &other = found.frames[k].poses[i];
          ASSERT_EQ(Vector3d(units.of(-1, 0, 0) * other.com_world), one.com_world)
              << expected.bodies[i].name << " at " << expected.frames[k].time << " s";
          ASSERT_EQ(other.world_from_body.coeffs(), one.world_from_body.coeffs())
              << expected.bodies[i].name << " at " << expected.frames[k].time << " s";
        }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Course, OtherUnitsOf,
    ::testing::Values(
        Tried{"assignments/a1_impulse/scenes/collide_off_centre_e05.json", 0.6, {"rd", "tw"}},
        Tried{"assignments/a3_constraints/scenes/four_bar.json", 0.6, {"rd", "tw"}},
        Tried{"assignments/a3_constraints/scenes/blocks_on_an_incline.json", 0.6, {"rd", "tw"}},
        Tried{"assignments/a3_constraints/scenes/card_tent.json", 0.6, {"rd", "tw"}},
        Tried{"assignments/a3_constraints/scenes/floating_box.json", 0.6, {"rd", "tw"}},
        // solves contacts by all means (contact_newton.h), after 0.4 s
        Tried{"assignments/a3_constraints/scenes/thin_arch.json", 0.425, {"ordered"}},
        // a heap at rest, in which impulses cancel
        Tried{"tests/engines/broken_scenes/rocking_boxes.json", 0.5, {"rd"}}),
    [](const auto& of) { return std::filesystem::path(of.param.scene).stem().string(); });

}  // namespace
}  // namespace tumble::testing::units_test
