// A sample of random scenes: none crashes, hangs, opens, overlaps or gains energy without a report.
// fuzz_scenes draws thousands.
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "tests/fuzz/draw_scene.h"
#include "tests/fuzz/run_scene_file.h"
#include "tests/fuzz/shrink_scene.h"

namespace tumble::fuzz {
namespace {

Verdict verdict_of(const Json& scene, const std::string& engine) {
  const PrivateFolder folder;
  std::ofstream(folder.path() / "scene.json") << scene.dump(1);
  return run_scene_file(folder.path() / "scene.json", {"", engine, folder.path()});
}

TEST(Fuzz, TheSameNumberIsTheSameScene) {
  EXPECT_EQ(draw_scene(7).dump(), draw_scene(7).dump());
  EXPECT_NE(draw_scene(7).dump(), draw_scene(8).dump());
}

TEST(Fuzz, FiftyQuickScenesEndRightOrWithAReason) {
  int right = 0;
  const std::vector<std::string> engines{"rd", "rd", "ca", "tw", "ordered"};
  for (std::uint64_t number = 51; number <= 100; ++number) {
    const std::string& engine = engines[number % engines.size()];
    const Verdict verdict = verdict_of(draw_scene(number, {true, engine != "rd"}), engine);
    EXPECT_FALSE(verdict.is_failure())
        << verdict.family << ": " << verdict.words << "\n  fuzz_scenes --quick --from " << number
        << " --count 1 --engine " << engine;
    right += verdict.outcome == Outcome::kRight;
  }
  EXPECT_GE(right, 30) << "most must run: what is refused tests nothing";
}

/// A ball that falls for a second.
Json falling() {
  return Json::parse(
      R"({"title": "t", "duration_s": 1, "gravity_m_s2": [0, 0, -9.81],
        "bodies": [{"name": "b", "shape": {"sphere": {"radius_m": 0.1}}, "mass_kg": 1}]})");
}

TEST(Fuzz, ARunIsJudgedFromItsPlaces) {
  EXPECT_EQ(verdict_of(falling(), "rd").outcome, Outcome::kRight);
  Json odd = falling();
  odd["bodies"][0]["mass_kg"] = -1;
  EXPECT_EQ(verdict_of(odd, "rd").outcome, Outcome::kRefused);
}

// Found by fuzzing: heavy bodies on light and small ones, and rocking boxes. Their contacts added
// energy, and the runs ended with 0.
TEST(Fuzz, ContactsThatGainedEnergyGainNoneNow) {
  for (const char* name :
       {"slab_on_small_balls", "light_balls_under_a_heavy_one", "rocking_boxes"}) {
    const PrivateFolder folder;
    const std::filesystem::path file = std::filesystem::path(test::source_dir()) /
                                       "tests/engines/broken_scenes" /
                                       (std::string(name) + ".json");
    const Verdict verdict = run_scene_file(file, {"", "rd", folder.path()});
    EXPECT_EQ(verdict.outcome, Outcome::kRight) << name << ": " << verdict.words;
  }
}

TEST(Fuzz, AFailingSceneShrinksToWhatMatters) {
  Json scene = draw_scene(3);
  scene["bodies"].push_back(
      Json::parse(R"({"name": "culprit", "shape": {"sphere": {"radius_m": 0.1}}, "mass_kg": 1})"));
  const auto has_culprit = [](const Json& smaller) {
    for (const auto& body : smaller["bodies"])
      if (body["name"] == "culprit") return true;
    return false;
  };
  const Json small = shrink_scene(scene, has_culprit);
  EXPECT_EQ(small["bodies"].size(), 1u);
  for (const char* key : {"gravity_m_s2", "contact", "joints", "springs", "rods"})
    EXPECT_FALSE(small.contains(key)) << key;
}

}  // namespace
}  // namespace tumble::fuzz
