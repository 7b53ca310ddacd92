// Common mistakes in scene files: each is refused with the file's line, the JSON pointer, the value
// found and the remedy.
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/scene/build_shape.h"
#include "framework/scene/load_scene.h"

namespace tumble::scene::refusals_test {
namespace {

const std::string kBall =
    R"({ "name": "ball", "shape": { "sphere": { "radius_m": 0.1 } }, "mass_kg": 1 })";

std::string scene_with(const std::string& body, const std::string& more = "") {
  return "{\n  \"title\": \"t\",\n  \"duration_s\": 1,\n  \"bodies\": [\n" + body + "\n  ]" + more +
         "\n}\n";
}

/// The message of a refused text; "" where it is accepted.
std::string refusal(const std::string& text) {
  try {
    const Scene scene = parse_scene(text, "s.json");
    build_solids(scene, test::source_dir());
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

void expect_words(const std::string& refused, const std::vector<std::string>& words) {
  for (const auto& word : words)
    EXPECT_NE(refused.find(word), std::string::npos) << "expected '" << word << "' in: " << refused;
}

std::string body_with(const std::string& more) {
  return R"({ "name": "ball", "shape": { "sphere": { "radius_m": 0.1 } }, )" + more + " }";
}

TEST(SceneRefusals, ARightSceneIsAccepted) { EXPECT_EQ(refusal(scene_with(kBall)), ""); }

TEST(SceneRefusals, AMistypedKeyIsNamedWithItsNeighbour) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "velocty_m_s": [1, 0, 0])"))),
               {"s.json:5", "/bodies/0/velocty_m_s", "Did you mean 'velocity_m_s'"});
}

TEST(SceneRefusals, AKeyAtAWrongLevelIsNamedWithWhereItBelongs) {
  expect_words(refusal(scene_with(kBall, ", \"friction\": 0.3")),
               {"s.json:6", "unknown key 'friction'. It is a key of: body."});
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "radius_m": 0.1)"))),
               {"/bodies/0/radius_m", "It is a key of: sphere."});
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "gravity_m_s2": [0, 0, -9.81])"))),
               {"/bodies/0/gravity_m_s2", "It is a key of: the scene itself."});
}

TEST(SceneRefusals, AnUnknownKeyIsToldWhatTheObjectIs) {
  expect_words(
      refusal(scene_with(R"({ "name": "floor", "shape": { "plane": { "normal": [0, 0, 1] } } })")),
      {"/bodies/0/shape/plane/normal", "Known here (an immovable half-space",
       "+z is its normal): drawn_half_extent_m."});
}

// As springs and rods name their ends, and joints do not.
TEST(SceneRefusals, AKeyThatIsAPartOfTheRightOneIsNamedWithIt) {
  expect_words(
      refusal(scene_with(kBall,
                         R"(, "joints": [{ "kind": "ball", "a": "ball", "point_m": [0, 0, 1] }])")),
      {"/joints/0/a", "Did you mean 'body_a'?"});
}

TEST(SceneRefusals, WhereAnObjectOrASwitchIsExpectedItsValuesAreSaid) {
  expect_words(refusal(scene_with(R"({ "name": "b", "mass_kg": 1, "shape": { "sphere": 0.3 } })")),
               {"/bodies/0/shape/sphere", "expected an object: a ball; its keys: radius_m"});
  expect_words(refusal(scene_with(body_with(R"("immovable": "yes")"))),
               {"/bodies/0/immovable", "found the text \"yes\"", "expected true or false"});
}

TEST(SceneRefusals, ACommentIsNamedAsWhatJsonHasNot) {
  expect_words(refusal("{\n  \"title\": \"t\", // a line\n}"), {"s.json:2", "no comments"});
}

TEST(SceneRefusals, AKeyWithoutItsUnitIsNamedWithIt) {
  expect_words(refusal(scene_with(body_with(R"("mass": 1)"))),
               {"/bodies/0/mass", "Did you mean 'mass_kg'"});
}

TEST(SceneRefusals, AUnitInTheValueIsFoundAndTheNumberExpected) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": "2 kg")"))),
               {"/bodies/0/mass_kg", "found the text \"2 kg\"", "expected a number above 0 [kg]"});
}

TEST(SceneRefusals, OnlyABoxIsDrawnAsADie) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "drawn_as": "die")"))),
               {"/bodies/0/drawn_as", "only a box"});
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "drawn_as": "dye")"))),
               {"/bodies/0/drawn_as", "die"});
}

TEST(SceneRefusals, WhatSwingsHasAnAngularFrequency) {
  expect_words(refusal(scene_with(
                   body_with(R"("immovable": true, "motion": { "amplitude_m": [0, 0, 1] })"))),
               {"/bodies/0/motion/amplitude_m", "would stand still", "angular_frequency_rad_s"});
}

TEST(SceneRefusals, ANegativeMassSaysWhatAMassIs) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": -2)"))),
               {"/bodies/0/mass_kg", "found -2", "above 0"});
}

TEST(SceneRefusals, NaNIsNotJson) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": NaN)"))),
               {"s.json:5", "not JSON", "no NaN"});
}

TEST(SceneRefusals, NeitherMassNorDensitySaysBoth) {
  expect_words(
      refusal(scene_with(R"({ "name": "ball", "shape": { "sphere": { "radius_m": 0.1 } } })")),
      {"/bodies/0", "neither density_kg_m3 nor mass_kg"});
}

TEST(SceneRefusals, AVectorOfTwoNumbersIsCounted) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "position_m": [1, 2])"))),
               {"/bodies/0/position_m", "list of 2", "three numbers"});
}

TEST(SceneRefusals, AMissingModelNamesTheFile) {
  expect_words(refusal(scene_with(
                   R"({ "name": "pawn", "shape": { "model": { "file": "chess_prawn.3ds" } },
            "mass_kg": 1 })")),
               {"s.json:5: /bodies/0/shape/model", "pawn", "chess_prawn.3ds",
                "Did you mean 'chess_pawn.3ds'"});
}

TEST(SceneRefusals, AnUnknownBodyInACheckListsTheBodies) {
  const std::string checks =
      R"(, "checks": [{ "kind": "event_count", "body": "bal", "expected": [1],
        "tolerance": 0, "why": "w" }])";
  expect_words(refusal(scene_with(kBall, checks)),
               {"/checks/0/body", "no body is named 'bal'", "Did you mean 'ball'"});
}

TEST(SceneRefusals, AnUnknownKindOfCheckIsNamedWithItsNeighbour) {
  const std::string checks = R"(, "checks": [{ "kind": "enrgy", "tolerance": 0, "why": "w" }])";
  expect_words(refusal(scene_with(kBall, checks)), {"/checks/0/kind", "Did you mean 'energy'"});
}

TEST(SceneRefusals, AKeyThatAKindOfCheckDoesNotUseIsRefused) {
  const auto refused = [](const std::string& keys) {
    return refusal(
        scene_with(kBall, R"(, "checks": [{ "tolerance": 0, "why": "w", "kind": )" + keys + " }]"));
  };
  for (const auto& [keys, key] : {std::pair{R"("energy", "body": "ball")", "body"},
                                  {R"("energy", "axis": [0, 0, 1])", "axis"},
                                  {R"("energy", "expected": [1])", "expected"},
                                  {R"("gap", "at_s": 0.1)", "at_s"},
                                  {R"("flips", "body": "ball", "axis": [0, 0, 1], "expected": [1],
                                       "bodies": ["ball", "ball"])",
                                   "bodies"}})
    expect_words(refused(keys),
                 {std::string("/checks/0/") + key, "has no key '" + std::string(key)});
  expect_words(refused(R"("drift", "body": "ball", "bodies": ["ball", "ball"])"),
               {"/checks/0/body", "either 'body' or 'bodies'"});
  EXPECT_EQ(refused(R"("drift", "body": "ball", "at_s": 0.1)"), "");
  EXPECT_EQ(refused(R"("momentum", "expected": [1, 2, 3], "at_s": 0.1)"), "");
  EXPECT_EQ(refused(R"("event_count", "other": "ball", "expected": [1])"), "");
}

TEST(SceneRefusals, AnInstantOfACheckIsWithinTheRun) {
  const auto refused = [](const std::string& at_s) {
    return refusal(scene_with(kBall, R"(, "checks": [{ "kind": "energy", "tolerance": 0,
      "why": "w", "at_s": )" + at_s + " }]"));
  };
  expect_words(refused("1e6"), {"/checks/0/at_s", "the run has ended by then"});
  expect_words(refused("0"), {"/checks/0/at_s", "an instant above 0"});
}

TEST(SceneRefusals, ATakenNameIsReportedWithItsOwner) {
  expect_words(refusal(scene_with(kBall + ",\n" + kBall)),
               {"s.json:6", "/bodies/1/name", "taken by /bodies/0"});
}

TEST(SceneRefusals, AQuaternionThatIsNotUnitSaysItsLength) {
  expect_words(refusal(scene_with(
                   body_with(R"("mass_kg": 1, "orientation": { "quaternion": [1, 1, 0, 0] })"))),
               {"/bodies/0/orientation/quaternion", "unit quaternion"});
}

TEST(SceneRefusals, AKeyThatStandsTwiceIsRefused) {
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "mass_kg": 2)"))),
               {"/bodies/0/mass_kg", "twice"});
}

TEST(SceneRefusals, AnEllipsoidMeetsPlanesOnlyAndSaysWhatElseItMayMeet) {
  const std::string egg =
      R"({ "name": "egg", "shape": { "ellipsoid": { "semi_axes_m": [0.2, 0.1, 0.1] } },
        "mass_kg": 1, "position_m": [0, 0, 1] })";
  const std::string floor = R"({ "name": "floor", "shape": { "plane": {} }, "immovable": true })";
  EXPECT_EQ(refusal(scene_with(egg + ",\n" + floor)), "");
  expect_words(refusal(scene_with(kBall + ",\n" + egg)),
               {"s.json:6", "/bodies/1", "'egg' is an ellipsoid and may meet 'ball'", "planes only",
                "apart"});
  EXPECT_EQ(refusal(scene_with(kBall + ",\n" + egg, R"(, "apart": [["egg", "ball"]])")), "");
}

TEST(SceneRefusals, AnEllipsoidBesideItsCentreOfMassNeedsMomentsOfItsOwn) {
  const auto egg = [](const std::string& more) {
    return scene_with(
        R"({ "name": "egg", "shape": { "ellipsoid": { "semi_axes_m": [0.2, 0.1, 0.1],
          "center_m": [0, 0, 0.05] } }, )" +
        more + " }");
  };
  expect_words(refusal(egg(R"("mass_kg": 1)")),
               {"/bodies/0/shape/ellipsoid/center_m", "not of one density", "inertia_body_kg_m2"});
  EXPECT_EQ(refusal(egg(
                R"("mass_kg": 1, "inertia_body_kg_m2": [[2e-4, -2e-5, 0], [-2e-5, 16e-4, 0],
            [0, 0, 17e-4]])")),
            "");
}

TEST(SceneRefusals, WhatIsNoObjectSaysThatASceneIs) {
  expect_words(refusal("[]"), {"s.json:1", "found the list []", "expected an object"});
}

TEST(SceneRefusals, ADurationOrStepThatIsNotAboveZeroSaysSo) {
  for (const std::string key : {"step_s", "duration_s"})
    for (const std::string value : {"0", "-1"}) {
      std::string text = scene_with(kBall, key == "step_s" ? ", \"step_s\": " + value : "");
      if (key == "duration_s")
        text.replace(text.find("\"duration_s\": 1"), 15, "\"duration_s\": " + value);
      expect_words(refusal(text), {"/" + key, "found " + value, "a number above 0"});
    }
}

TEST(SceneRefusals, AStepIsNotLongerThanTheRun) {
  const auto lasting = [](const std::string& more) {
    std::string text = scene_with(kBall, more);
    text.replace(text.find("\"duration_s\": 1"), 15, "\"duration_s\": 0.01");
    return refusal(text);
  };
  expect_words(lasting(", \"step_s\": 0.02"), {"/step_s", "longer than the whole run"});
  EXPECT_EQ(lasting(", \"step_s\": 0.01"), "");
  EXPECT_EQ(lasting(""), "");  // nobody gave 1/60 s
}

// 1e-320 kg has no inverse in doubles, and (1e200 m/s)^2 no value: errors that follow from them
// would not name their cause.
TEST(SceneRefusals, NumbersThatDoublesCannotSquareAreNamed) {
  for (const std::string mass : {"1e-320", "1e-61", "1e300", "1e61"})
    expect_words(refusal(scene_with(body_with("\"mass_kg\": " + mass))),
                 {"s.json:5", "/bodies/0/mass_kg", "found", "compute"});
  expect_words(refusal(scene_with(body_with(R"("mass_kg": 1, "velocity_m_s": [0, -1e200, 0])"))),
               {"/bodies/0/velocity_m_s/1", "too large"});
  expect_words(refusal(scene_with(body_with("\"mass_kg\": 1e999"))),
               {"s.json:5", "1e999", "a double can hold"});
  for (const std::string mass : {"1e-60", "1e60"})
    EXPECT_EQ(refusal(scene_with(body_with("\"mass_kg\": " + mass))), "");
  EXPECT_EQ(refusal(scene_with(body_with(R"("mass_kg": 1, "velocity_m_s": [0, -0.0, 1e-60])"))),
            "");
}

TEST(SceneRefusals, ListsWithinListsAreFollowedToSomeDepth) {
  EXPECT_NE(refusal("{ \"bodies\": " + std::string(2000, '[') + std::string(2000, ']') + " }")
                .find("brackets"),
            std::string::npos);
}

// The places of values are as long as they are deep: noted to the end of such a file they would
// take memory with the square of its length, 5 GB for 50 kB.
TEST(SceneRefusals, BracketsThatNeverCloseAreRefusedBeforeTheyAreRead) {
  expect_words(refusal("[\n" + std::string(3000, '[')), {"s.json:2", "deeper", "brackets"});
}

// Where the parser stops at a byte of several, its own message ends in half a character.
TEST(SceneRefusals, TextInAnotherEncodingIsNamedWithARemedy) {
  std::string wide = "\xff\xfe";
  for (const char c : scene_with(kBall)) wide += c, wide += '\0';
  expect_words(refusal(wide), {"s.json: the file is written in UTF-16", "Save it as UTF-8"});
  expect_words(refusal("{\n\"title\": \"Caf\xe9\"}"),
               {"s.json:2:14: found the byte 0xe9, which is not UTF-8", "Save the file as UTF-8"});
  expect_words(refusal("{\n\u201ctitle\u201d: \"\"}"),
               {"s.json:2:1", "found \u201c outside of a text in double quotes"});
}

TEST(SceneRefusals, ATrailingCommaIsNotJson) {
  expect_words(refusal(scene_with(kBall + ",")), {"not JSON", "none after the last"});
}

}  // namespace
}  // namespace tumble::scene::refusals_test
