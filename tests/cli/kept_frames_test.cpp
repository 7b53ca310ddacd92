// Frames that a run keeps: memory does not grow with a long run that nobody looks at.
#include "framework/cli/kept_frames.h"

#include <gtest/gtest.h>

namespace tumble::testing {
namespace {

using cli::kept_frames;

constexpr double kRate = 60.0;

TEST(KeptFrames, AnOrdinaryRunKeepsAllWhetherItIsShownOrNot) {
  for (const bool is_shown : {false, true})
    for (const double duration : {0.2, 60.0, 600.0}) {
      const auto kept = kept_frames(kRate, duration, 10, is_shown);
      EXPECT_EQ(kept.rate_hz, kRate);
      EXPECT_EQ(kept.notice, "");
      EXPECT_EQ(kept.warning, "");
    }
}

TEST(KeptFrames, ALongRunThatIsNotShownKeepsAsManyAsOneOfTenMinutesAndSaysSo) {
  for (const double duration : {601.0, 5e4, 1e9}) {
    const auto kept = kept_frames(kRate, duration, 10, false);
    EXPECT_NEAR(kept.rate_hz * duration, kRate * 600.0, 1e-6);
    EXPECT_NE(kept.notice.find("--trajectory"), std::string::npos) << kept.notice;
    EXPECT_EQ(kept.warning, "");
  }
}

// 5e4 s at 60 a second are 3e6 frames.
TEST(KeptFrames, ALongRunThatIsShownKeepsAllAndWarnsOfItsMemory) {
  const auto kept = kept_frames(kRate, 5e4, 10, true);
  EXPECT_EQ(kept.rate_hz, kRate);
  EXPECT_EQ(kept.notice, "");
  EXPECT_NE(kept.warning.find("GB"), std::string::npos) << kept.warning;
  EXPECT_NE(kept.warning.find("--duration-s"), std::string::npos) << kept.warning;
}

}  // namespace
}  // namespace tumble::testing
