// An effect is on exactly where an entry calls for it, and names that entry.
#include "framework/scene/effects.h"

#include <gtest/gtest.h>

#include "framework/scene/load_scene.h"

namespace tumble::scene {
namespace {

Scene scene_with(const std::string& ball_more, const std::string& more) {
  return parse_scene(R"({ "title": "t", "duration_s": 1, "bodies": [
    { "name": "floor", "shape": { "plane": {} }, "immovable": true )" +
                         ball_more + R"( },
    { "name": "ball", "shape": { "sphere": { "radius_m": 0.1 } },
      "mass_kg": 1, "position_m": [0, 0, 1] )" +
                         ball_more + " }]" + more + " }",
                     "s.json");
}

std::vector<std::string> names_on(const Scene& scene) {
  std::vector<std::string> names;
  for (const EffectUse& effect : effects_of(scene))
    if (effect.is_on()) names.push_back(effect.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Effects, OnlyWhatAnEntryAsksForIsOn) {
  EXPECT_EQ(names_on(scene_with("", "")), (Names{"collision"}));
  EXPECT_EQ(names_on(scene_with(R"(, "collides": false)", "")), Names{});
  EXPECT_EQ(
      names_on(scene_with("", R"(, "gravity_m_s2": [0, 0, -9.81], "contact": { "sleep": true })")),
      (Names{"gravity", "collision", "persistent contact", "sleep"}));
  EXPECT_EQ(names_on(scene_with(R"(, "friction": 0.4)", R"(, "contact": {})")),
            (Names{"collision", "persistent contact", "friction"}));
  EXPECT_EQ(names_on(scene_with("",
                                R"(, "drag": [{ "body": "ball", "linear_n_s_m": 1 }],
            "springs": [{ "a": { "body": "ball" }, "b": { "body": "floor" },
            "stiffness_n_m": 1 }])")),
            (Names{"spring", "drag", "collision"}));
  EXPECT_EQ(
      names_on(scene_with(
          R"(, "collides": false)",
          R"(, "joints": [{ "name": "h", "kind": "hinge", "body_a": "ball", "point_m": [0, 0, 2],
            "axis": [1, 0, 0] }], "motors": [{ "joint": "h", "damping_n_m_s_rad": 1 }],
    "rods": [{ "a": { "body": "ball" }, "b": { "point_world_m": [0, 0, 2] } }])")),
      (Names{"rod", "joint", "motor"}));
}

TEST(Effects, AnAskerIsNamedByItsEntry) {
  const auto effects = effects_of(scene_with(
      "", R"(, "rods": [{ "a": { "body": "ball" }, "b": { "point_world_m": [0, 0, 2] } }])"));
  for (const EffectUse& effect : effects)
    if (effect.name == "rod") {
      ASSERT_EQ(effect.askers.size(), 1u);
      EXPECT_EQ(effect.askers[0].pointer, "/rods/0");
      EXPECT_EQ(effect.askers[0].what, "rod 1: ball to the world, 1 m");
    }
}

TEST(Effects, AnAskerIsFoundByItsLine) {
  const Scene scene =
      scene_with(R"(, "friction": 0.4)", ", \"contact\": {},\n \"gravity_m_s2\": [0, 0, -9.81]");
  std::map<std::string, int> lines;
  for (const EffectUse& effect : effects_of(scene))
    if (effect.is_on()) lines[effect.name] = effect.askers.back().line;
  EXPECT_EQ(lines.at("collision"), 3);  // the ball's
  EXPECT_EQ(lines.at("friction"), 4);
  EXPECT_EQ(lines.at("persistent contact"), 4);
  EXPECT_EQ(lines.at("gravity"), 5);
  Scene in_memory = scene;
  in_memory.lines.clear();
  EXPECT_EQ(effects_of(in_memory)[0].askers[0].line, 0);
}

TEST(Effects, WhatSeemsToBeAskedForAndIsNotSaysWhy) {
  Scene scene = scene_with("", R"(, "contact": {})");
  // only one of the two has friction: the smaller coefficient of a pair counts
  scene.bodies[1].friction = 0.5;
  for (const EffectUse& effect : effects_of(scene))
    if (effect.name == "friction") {
      EXPECT_FALSE(effect.is_on());
      EXPECT_NE(effect.note.find("the smaller coefficient counts"), std::string::npos)
          << effect.note;
    }
}

}  // namespace
}  // namespace tumble::scene
