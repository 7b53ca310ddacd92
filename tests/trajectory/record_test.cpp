// What an output says of itself: command, version, scene and seeds.
#include "framework/trajectory/record.h"

#include <gtest/gtest.h>

#include "framework/core/version.h"

namespace tumble {
namespace {

TEST(Record, NamesCommandVersionSceneAndSeeds) {
  TrajectoryInfo info;
  info.command = "tumble run bowl";
  info.version = "0.1.0 (25ccc19a01)";
  info.scene_name = "bowl";
  info.scene_digest = "0123456789abcdef0123456789abcdef";
  info.seeds = {7};
  EXPECT_EQ(record_of(info),
            "tumble run bowl · Tumble 0.1.0 (25ccc19a01) · scene bowl 0123456789abcdef, seed 7");
  info.seeds = {7, 11};
  EXPECT_EQ(
      record_of(info),
      "tumble run bowl · Tumble 0.1.0 (25ccc19a01) · scene bowl 0123456789abcdef, seeds 7, 11");
}

TEST(Record, OfASceneWithASizeHasItsNameOnce) {
  TrajectoryInfo info;
  info.scene_name = "atoms";
  info.scene_digest = "atoms n=300";
  info.seeds = {12};
  EXPECT_EQ(record_of(info), "scene atoms n=300, seed 12");
}

TEST(Record, SaysNothingOfWhatIsNotThere) {
  TrajectoryInfo info;
  info.scene_name = "drop";
  EXPECT_EQ(record_of(info), "scene drop");
  EXPECT_EQ(record_of(TrajectoryInfo{}), "");
}

TEST(Record, TheProgramKnowsItsVersion) { EXPECT_NE(std::string(kProgramVersion), ""); }

}  // namespace
}  // namespace tumble
