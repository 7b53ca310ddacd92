// Impossible links, or links without effect, are refused with the line, the JSON pointer, the value
// found and the remedy.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/scene/load_scene.h"

namespace tumble::scene::link_refusals_test {
namespace {

const std::string kStart = R"({
"title": "t", "duration_s": 1, "bodies": [
  { "name": "wall", "shape": { "plane": {} }, "immovable": true },
  { "name": "rail", "shape": { "box": { "size_m": [1, 1, 1] } }, "immovable": true },
  { "name": "ball", "shape": { "sphere": { "radius_m": 0.1 } },
    "mass_kg": 1, "position_m": [0, 0, 2] },
  { "name": "bob", "shape": { "sphere": { "radius_m": 0.1 } },
    "mass_kg": 1, "position_m": [0, 0, 1] }
],
)";  // the next text is in line 8

std::string refusal(const std::string& more) {
  try {
    parse_scene(kStart + more + "\n}", "s.json");
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_words(const std::string& more, const std::vector<std::string>& words) {
  const std::string refused = refusal(more);
  for (const auto& word : words)
    EXPECT_NE(refused.find(word), std::string::npos) << "expected '" << word << "' in: " << refused;
}

std::string spring(const std::string& a, const std::string& b,
                   const std::string& rest = R"("stiffness_n_m": 1)") {
  return R"("springs": [{ "a": )" + a + R"(, "b": )" + b + ", " + rest + " }]";
}
std::string rod(const std::string& a, const std::string& b, const std::string& rest = "") {
  return R"("rods": [{ "a": )" + a + R"(, "b": )" + b + rest + " }]";
}
std::string joint(const std::string& rest) {
  return R"("joints": [{ "name": "knee", "point_m": [0, 0, 1], )" + rest + " }]";
}
std::string chain(
    const std::string& rest,
    const std::string& link =
        R"({ "name": "bead", "shape": { "sphere": { "radius_m": 0.1 } }, "mass_kg": 1 })") {
  return R"("chains": [{ "links": 3, "from": { "body": "ball" }, "link": )" + link + ", " + rest +
         " }]";
}

const std::string kBall = R"({ "body": "ball" })", kBob = R"({ "body": "bob" })",
                  kOrigin = R"({ "point_world_m": [0, 0, 0] })";

TEST(LinkRefusals, WhatIsRightIsAccepted) {
  EXPECT_EQ(refusal(spring(kBall, kBob)), "accepted");
  EXPECT_EQ(refusal(rod(kBall, kOrigin, R"(, "length_m": 2)")), "accepted");
  EXPECT_EQ(refusal(joint(R"("kind": "ball", "body_a": "ball", "body_b": "bob")")), "accepted");
}

TEST(LinkRefusals, AMistypedBodyIsNamedWithItsNeighbour) {
  expect_words(spring(R"({ "body": "bal" })", kBob),
               {"s.json:10", "/springs/0/a/body", "no body is named 'bal'", "Did you mean 'ball'",
                "Bodies: wall, rail, ball, bob"});
  expect_words(joint(R"("kind": "ball", "body_a": "ball", "body_b": "bobb")"),
               {"/joints/0/body_b", "Did you mean 'bob'"});
  expect_words(R"("drag": [{ "body": "ballon", "linear_n_s_m": 1 }])",
               {"/drag/0/body", "Did you mean 'ball'"});
  expect_words(R"("apart": [["ball", "bop"]])", {"/apart/0/1", "Did you mean 'bob'"});
}

TEST(LinkRefusals, AnAnchorIsOnePointOfOneThing) {
  expect_words(
      spring(R"({ "body": "ball", "point_body_m": [0, 0, 0], "point_world_m": [0, 0, 0] })", kBob),
      {"/springs/0/a", "given twice, by point_body_m and by point_world_m"});
  expect_words(spring(R"({ "point_body_m": [0, 0, 0] })", kBob),
               {"/springs/0/a", "point_body_m is about a body, and none is named"});
  expect_words(spring(R"({ "body": "ball", "vertex": 3 })", kBob),
               {"/springs/0/a/vertex", "body 'ball' has no vertices"});
  expect_words(spring(R"({ "body": "rail", "vertex": 8 })", kBob),
               {"/springs/0/a/vertex", "found 8", "'rail' has 8 vertices", "from 0 to 7"});
  expect_words(spring(R"({ "body": "ball", "vertx": 3 })", kBob),
               {"/springs/0/a/vertx", "Did you mean 'vertex'"});
  expect_words(spring("{}", kBob), {"/springs/0/a", "a point of a body"});
}

TEST(LinkRefusals, ASpringThatCannotBe) {
  expect_words(spring(kBall, kBall), {"/springs/0", "from body 'ball' to the same point of it"});
  expect_words(spring(kBall, R"({ "body": "ball", "point_body_m": [0, 0, 0.1] })"),
               {"itself, which moves nothing"});
  expect_words(spring(kBall, kBob, R"("stiffness_n_m": -5)"),
               {"/springs/0/stiffness_n_m", "found -5", "at least 0 [N/m]"});
  expect_words(spring(kBall, kBob, R"("damping_n_s_m": 1)"),
               {"/springs/0", "'stiffness_n_m' is missing"});
  expect_words(spring(R"({ "body": "wall" })", kOrigin),
               {"spring 'spring 1' ties 'wall' to the world: neither can move"});
}

TEST(LinkRefusals, ARodThatDoesNotFitSaysByHowMuch) {
  expect_words(rod(kBall, kBob, R"(, "length_m": 0.75)"),
               {"/rods/0/length_m", "0.75 m long", "1 m apart at the start", "0.25 m too far",
                "Leave length_m out"});
  expect_words(rod(kBall, kBob, R"(, "length_m": 1.00000001)"), {"too near"});
  EXPECT_EQ(refusal(rod(kBall, kBob, R"(, "length_m": 1.0000000001)")), "accepted");
  // 0.01 m at 10^6 m from the origin: the places themselves have no more digits
  const std::string far = R"({ "body": "ball", "point_body_m": [1000000.07, 0, 0] })",
                    beside = R"({ "point_world_m": [1000000.06, 0, 2] })";
  EXPECT_EQ(refusal(rod(far, beside, R"(, "length_m": 0.01)")), "accepted");
  expect_words(rod(far, beside, R"(, "length_m": 0.010001)"), {"too near"});
  expect_words(rod(kBall, R"({ "point_world_m": [0, 0, 2] })"),
               {"/rods/0", "no length", "anchored at the same place", "joint of kind \"ball\""});
  expect_words(rod(kBall, kBob, R"(, "length_m": 0)"), {"/rods/0/length_m", "above 0"});
}

TEST(LinkRefusals, AJointThatCannotBe) {
  expect_words(joint(R"("kind": "hinge", "body_a": "ball")"),
               {"/joints/0", "a hinge needs the key 'axis'"});
  expect_words(joint(R"("kind": "hinge", "body_a": "ball", "axis": [0, 0, 0])"),
               {"/joints/0/axis", "zero vector"});
  expect_words(joint(R"("kind": "ball", "body_a": "ball", "axis": [0, 0, 1])"),
               {"/joints/0/axis", "has no axis"});
  expect_words(joint(R"("kind": "ball", "body_a": "wall", "body_b": "rail")"),
               {"joint 'knee' joins 'wall' and 'rail': neither can move"});
  expect_words(joint(R"("kind": "weld", "body_a": "ball", "body_b": "ball")"),
               {"joins body 'ball' to itself"});
  expect_words(joint(R"("kind": "hing", "body_a": "ball")"),
               {"/joints/0/kind", "Did you mean 'hinge'"});
}

TEST(LinkRefusals, AMotorTurnsAHingeAndNothingElse) {
  const std::string ball_joint = joint(R"("kind": "ball", "body_a": "ball")"),
                    hinge = joint(R"("kind": "hinge", "body_a": "ball", "axis": [1, 0, 0])");
  expect_words(ball_joint + R"(, "motors": [{ "joint": "knee", "stiffness_n_m_rad": 1 }])",
               {"/motors/0/joint", "'knee' is no hinge", "has no hinge"});
  expect_words(hinge + R"(, "motors": [{ "joint": "knie", "stiffness_n_m_rad": 1 }])",
               {"no joint is named 'knie'", "Did you mean 'knee'", "Hinges: knee."});
  expect_words(hinge + R"(, "motors": [{ "joint": "knee" }])", {"/motors/0", "would do nothing"});
  expect_words(hinge + R"(, "motors": [{ "joint": "knee", "stiffness_n_m_rad": 1,
                   "amplitude_rad": 1, "frequency_hz": 500 }])",
               {"/motors/0/frequency_hz", "looks every 0.01 s", "50 times a second", "0.001"});
}

TEST(LinkRefusals, NamesOfLinksAreTheirOwn) {
  expect_words(
      joint(R"("kind": "ball", "body_a": "ball")") +
          R"(, "rods": [{ "name": "knee", "a": { "body": "ball" }, "b": { "body": "bob" } }])",
      {"/joints/0", "'knee' is taken by /rods/0"});
}

TEST(LinkRefusals, FrictionDragAndStabilisationThatWouldDoNothing) {
  expect_words(R"("stabilisation": { "kind": "none" })",
               {"/stabilisation", "neither rods nor joints"});
  expect_words(R"("coordinates": "reduced")", {"/coordinates", "neither rods nor joints"});
  expect_words(R"("drag": [{ "body": "wall", "linear_n_s_m": 1 }])", {"/drag/0/body", "immovable"});
  expect_words(R"("drag": [{ "body": "ball" }])", {"/drag/0", "would do nothing"});
  expect_words(
      R"("repeat": [{ "counts": [2, 1, 1], "spacing_m": [1, 0, 0],
        "body": { "name": "b", "shape": { "sphere": { "radius_m": 0.1 } },
        "mass_kg": 1, "friction": 0.5 } }])",
      {"/repeat/0/body/friction", "persistent contact only", "Add \"contact\": {}"});
  expect_words(
      R"("repeat": [{ "counts": [2, 1, 1], "spacing_m": [1, 0, 0],
        "body": { "name": "b", "shape": { "sphere": { "radius_m": 0.1 } },
        "mass_kg": 1, "friction": -0.5 } }])",
      {"/repeat/0/body/friction", "found -0.5", "at least 0"});
}

TEST(LinkRefusals, AChainThatCannotBeLaid) {
  expect_words(chain(R"("kind": "rods", "direction": [0, 0, -1])"),
               {"/chains/0", "key 'spacing_m' is missing", "or \"to\""});
  expect_words(chain(R"("kind": "rods", "direction": [0, 0, 0], "spacing_m": 1)"),
               {"/chains/0/direction", "zero vector"});
  expect_words(chain(R"("kind": "rods", "to": { "body": "bob" }, "spacing_m": 1)"),
               {"/chains/0/spacing_m", "ends at \"to\""});
  expect_words(chain(R"("kind": "rods", "to": { "point_world_m": [0, 0, 2] })"),
               {"/chains/0/to", "ends where it begins"});
  expect_words(chain(R"("kind": "springs", "to": { "body": "bob" })"),
               {"/chains/0", "needs the key 'stiffness_n_m'"});
  expect_words(chain(R"("kind": "rods", "to": { "body": "bob" }, "stiffness_n_m": 4)"),
               {"/chains/0/stiffness_n_m", "choose \"springs\""});
  expect_words(chain(R"("kind": "hinges", "to": { "body": "bob" })"),
               {"/chains/0", "needs the key 'axis'"});
  expect_words(chain(R"("kind": "rods", "to": { "body": "bob" })",
                     R"({ "name": "bead", "shape": { "sphere": { "radius_m": 0.1 } },
            "mass_kg": 1, "position_m": [0, 0, 0] })"),
               {"/chains/0/link/position_m", "determines the positions of its links"});
}

TEST(LinkRefusals, AForceBeginsBeforeTheSceneEnds) {
  expect_words(R"("point_forces": [{ "body": "ball", "force_n": [1, 0, 0], "point_m": [0, 0, 2],
                   "start_s": 2, "duration_s": 1 }])",
               {"/point_forces/0/start_s", "ends at 1 s", "duration_s"});
}

}  // namespace
}  // namespace tumble::scene::link_refusals_test
