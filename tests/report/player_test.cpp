// The player's page as text: channels are restored, comparisons find the first difference, the page
// is self-contained and escapes text.
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/report/channels.h"
#include "framework/report/comparison.h"
#include "framework/report/player_scene.h"
#include "tests/report/player_fixtures.h"

namespace tumble::testing {
namespace {

using namespace report;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Reads one channel, as described in channels.h.
std::vector<double> read_channel(const std::string& bytes, std::size_t count, std::size_t& at) {
  const int head = bytes[at], order = head & 3;
  double quantum = 0;
  std::memcpy(&quantum, &bytes[at + 1], sizeof quantum);
  at += 9;
  const std::size_t mask = at;
  if (head & 4) at += count;
  std::vector<double> values;
  std::int64_t before = 0, earlier = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t zigzag = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes[at++]);
      zigzag |= static_cast<std::uint64_t>(byte & 127) << shift;
      if (byte < 128) break;
    }
    const std::int64_t whole = static_cast<std::int64_t>(zigzag >> 1 ^ -(zigzag & 1)) +
                               (order == 0   ? 0
                                : order == 1 ? before
                                             : 2 * before - earlier);
    values.push_back(head & 4 && bytes[mask + i] != 0 ? kNan
                                                      : static_cast<double>(whole) * quantum);
    earlier = before;
    before = whole;
  }
  return values;
}

TEST(Channels, AreRestoredToHalfAQuantum) {
  const std::vector<double> values = {
      0.0, 1.0, -3.25, 1e6, kNan, 1e6, -1e-3, std::numeric_limits<double>::infinity(), 4.0};
  for (const int order : {0, 1, 2}) {
    ChannelWriter writer;
    writer.add(values, 1.0 / 1024, order);
    writer.add(values, 1.0, order);  // a second one begins where the first ends
    std::size_t at = 0;
    for (const double quantum : {1.0 / 1024, 1.0}) {
      const std::vector<double> back = read_channel(writer.bytes(), values.size(), at);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i]))
          EXPECT_LE(std::abs(back[i] - values[i]), 0.5 * quantum) << order << " " << i;
        else
          EXPECT_TRUE(std::isnan(back[i])) << order << " " << i;
      }
    }
    EXPECT_EQ(at, writer.bytes().size());
  }
}

TEST(Channels, OfAConstantForceTakeOneBytePerValue) {
  std::vector<double> fall;
  for (int k = 0; k < 1000; ++k) fall.push_back(10 - 0.5 * kGravity * k * k / (kRate * kRate));
  ChannelWriter writer;
  // A quantum of 1e-4 m: the second difference, g dt^2 = 2.7e-3 m, is 27 of them and a rounding of
  // at most 2.
  writer.add(fall, 1e-4, 2);
  EXPECT_LE(writer.bytes().size(), 9u + 1000u + 8u);  // the first two values take more
}

TEST(Channels, CoarsenWhereANumberWouldNotFit) {
  ChannelWriter writer;
  writer.add(std::vector<double>{1e30, -1e30}, 1e-12, 2);
  std::size_t at = 0;
  const auto back = read_channel(writer.bytes(), 2, at);
  // 2^-52 of it, times a factor of 8 for the differences
  EXPECT_NEAR(back[0], 1e30, 1e30 * 1e-14);
  EXPECT_NEAR(back[1], -1e30, 1e30 * 1e-14);
}

TEST(Base64, MatchesTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

const std::vector<double> kRadii = {0.25, 0.374, std::numeric_limits<double>::infinity()};

TEST(Comparison, OfARunWithItselfFindsNothing) {
  const Trajectory run = thrown_run();
  const Comparison same = compare(thrown_ball(), kRadii, run, "a", run, "b");
  EXPECT_FALSE(same.first.has_value());
  for (const double apart : same.apart_m) EXPECT_EQ(apart, 0.0);
}

TEST(Comparison, FindsTheImpulseThatDiffers) {
  Trajectory wrong = thrown_run();
  wrong.events[0].impulse = 9.0;
  const auto first =
      compare(thrown_ball(), kRadii, wrong, "submission", thrown_run(), "reference").first;
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->time_s, 0.4);
  EXPECT_EQ(first->what,
            "collision of ball <1> and box: impulse 9 N s in submission, 6 N s in reference");
}

TEST(Comparison, FindsTheFrameFromWhichABodyIsElsewhere) {
  Trajectory wrong = thrown_run();
  for (std::size_t k = 12; k < wrong.frames.size(); ++k)
    wrong.frames[k].poses[0].com_world.x() += 0.01;
  const Comparison found =
      compare(thrown_ball(), kRadii, wrong, "submission", thrown_run(), "reference");
  ASSERT_TRUE(found.first.has_value());
  EXPECT_EQ(found.first->time_s, wrong.frames[12].time);  // 0.2 s: before the events
  EXPECT_EQ(found.first->body, 0);
  EXPECT_NEAR(found.apart_m.back(), 0.01, 1e-12);
}

TEST(Comparison, FindsADifferenceInRotationOnly) {
  Trajectory wrong = thrown_run();
  wrong.frames.back().poses[1].world_from_body =
      wrong.frames.back().poses[1].world_from_body *
      Quaterniond(Eigen::AngleAxisd(0.1, Vector3d::UnitX()));
  const Comparison found =
      compare(thrown_ball(), kRadii, wrong, "submission", thrown_run(), "reference");
  ASSERT_TRUE(found.first.has_value());
  EXPECT_EQ(found.first->body, 1);
  EXPECT_NE(found.first->what.find("box is turned by 0.1 rad from how it is in reference"),
            std::string::npos)
      << found.first->what;
  EXPECT_NEAR(found.apart_m.back(), 0.374 * 0.1, 1e-9);  // radius times angle
}

TEST(Comparison, NamesAnEventThatOnlyOneRunHas) {
  Trajectory less = thrown_run();
  less.events.pop_back();
  const auto first =
      compare(thrown_ball(), kRadii, thrown_run(), "submission", less, "reference").first;
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->what, "box and floor come to rest on each other only in submission");
}

TEST(Comparison, SaysOfAForceWhatItActsOn) {
  Trajectory less = thrown_run(), more = thrown_run();
  less.events.pop_back();
  Event& force = more.events.back();
  force.kind = EventKind::kForceOn;
  force.body_b = -1;
  const auto only = compare(thrown_ball(), kRadii, more, "this run", less, "the run before").first;
  ASSERT_TRUE(only.has_value());
  const std::string name = more.bodies[static_cast<std::size_t>(force.body_a)].name;
  EXPECT_EQ(only->what, "a force on " + name + " begins only in this run");
  Trajectory other = more;
  other.events.back().kind = EventKind::kSlide;
  const auto both = compare(thrown_ball(), kRadii, more, "this run", other, "the run before").first;
  ASSERT_TRUE(both.has_value());
  EXPECT_EQ(both->what.find("a force on " + name + " begins at "), 0u) << both->what;
  EXPECT_NE(both->what.find(", " + name + " begins to slide at "), std::string::npos) << both->what;
}

// A run that stopped is neither the same nor different: the page must not praise it.
TEST(Comparison, SaysWhereOneRunStoppedThatWasTheSameUntilThen) {
  Trajectory stopped = thrown_run();
  stopped.frames.resize(13);
  std::erase_if(stopped.events, [](const Event& event) { return event.time > 0.2; });
  const Comparison found =
      compare(thrown_ball(), kRadii, stopped, "submission", thrown_run(), "reference");
  EXPECT_FALSE(found.first.has_value());
  ASSERT_TRUE(found.early_end.has_value());
  EXPECT_EQ(found.early_end->time_s, stopped.frames.back().time);
  EXPECT_TRUE(found.early_end->is_first);
  EXPECT_FALSE(
      compare(thrown_ball(), kRadii, thrown_run(), "a", thrown_run(), "b").early_end.has_value());
}

// The page contains Debian's libjs-three, which packages.txt lists.
TEST(PlayerPage, IsSelfContained) {
  const std::string page = player_page(thrown_ball(), {{thrown_run(), ""}});
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (const char* word : {"src=", "href=", "@import", "fetch("})
    EXPECT_EQ(page.find(word), std::string::npos) << word;
  // three.js deflated is 250 kB in base64; the player 80 kB, plots without scripts 60 kB
  EXPECT_LT(page.size(), 600'000u);
}

// In the plots that scripts draw, in those without scripts, in the table that is saved.
TEST(PlayerPage, SpellsTheChangeOfEnergyInOneWay) {
  const std::string page = player_page(thrown_ball(), {{thrown_run(), ""}});
  EXPECT_EQ(page.find("E - E(0)"), std::string::npos);
  std::size_t places = 0;
  for (std::size_t at = 0; (at = page.find("E − E(0)", at)) != page.npos; ++at) ++places;
  EXPECT_GE(places, 3u);
}

// A report of a hundred pages has the scripts once, and the same motion once a page.
TEST(PlayerPage, BesideAnotherFileHoldsNoScriptsAndTheSameMotionOnce) {
  PlayerOptions beside;
  beside.three_file = "three.js";
  const std::string alone = player_page(thrown_ball(), {{thrown_run(), ""}}),
                    small = player_page(thrown_ball(), {{thrown_run(), ""}}, beside);
  EXPECT_NE(small.find("three.js is missing, so that the motion cannot be drawn"),
            std::string::npos)
      << "no script runs that could say it";
  EXPECT_NE(small.find("<script src=\"three.js\" onerror=\""), std::string::npos);
  EXPECT_EQ(small.find("class Run"), std::string::npos);
  EXPECT_NE(alone.find("class Run"), std::string::npos);
  EXPECT_NE(alone.find("\"runs\":["), std::string::npos);
  EXPECT_EQ(small.find("\"runs\":["), std::string::npos);  // deflated
  const std::string same =
      player_page(thrown_ball(), {{thrown_run(), "a"}, {thrown_run(), "b"}}, beside);
  EXPECT_NE(same.find("id=\"run0\""), std::string::npos);
  EXPECT_EQ(same.find("id=\"run1\""), std::string::npos);
  Trajectory other = thrown_run();
  other.frames.back().poses.back().com_world.x() += 0.1;
  EXPECT_NE(
      player_page(thrown_ball(), {{thrown_run(), "a"}, {other, "b"}}, beside).find("id=\"run1\""),
      std::string::npos);
}

TEST(PlayerPage, ShowsNamesAsText) {
  const std::string page = player_page(thrown_ball(), {{thrown_run(), "<b>label</b>"}});
  EXPECT_EQ(page.find("ball <1>"), std::string::npos);
  EXPECT_EQ(page.find("<b>label"), std::string::npos);
  EXPECT_NE(page.find("A thrown ball &amp; a turning box"), std::string::npos);
  // in the table for browsers without scripts
  EXPECT_NE(page.find("<td>ball &lt;1&gt;, box</td>"), std::string::npos);
}

TEST(PlayerPage, HasAnOriginOfItsOwnFarFromThatOfTheWorld) {
  scene::Scene scene = thrown_ball();
  EXPECT_TRUE(page_origin(scene).isZero(0.0));
  const Vector3d far(1e6, 2e6, 0);  // m
  scene.camera.eye_m += far;
  scene.camera.target_m += far;
  const double sight_m = (scene.camera.eye_m - scene.camera.target_m).norm();
  EXPECT_LT((page_origin(scene) - scene.camera.target_m).norm(), sight_m);
  scene.grid_spacing_m = 0.3;  // whose lines stay where they are in the world
  const Vector3d spacings = page_origin(scene) / 0.3;
  // two roundings of a number of up to 7e6
  EXPECT_LT((spacings - spacings.array().round().matrix()).norm(), 1e-8);
}

TEST(PlayerPage, HasTheSameBytesForTheSameRun) {
  EXPECT_EQ(player_page(thrown_ball(), {{thrown_run(), ""}}),
            player_page(thrown_ball(), {{thrown_run(), ""}}));
}

TEST(PlayerPage, WithoutThreeJsIsRefused) {
  PlayerOptions elsewhere;
  elsewhere.three = "/nonexistent";
  const Trajectory run = thrown_run();
  try {
    player_page(thrown_ball(), {{run, ""}}, elsewhere);
    FAIL() << "accepted without three.js";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("libjs-three"), std::string::npos);
  }
  EXPECT_THROW(expect_player(elsewhere), UserError);  // told before a run
  EXPECT_NO_THROW(expect_player());
  Trajectory empty = run;
  empty.frames.clear();
  EXPECT_THROW(player_page(thrown_ball(), {{empty, ""}}), UserError);
  Trajectory other = run;
  other.bodies.pop_back();
  EXPECT_THROW(player_page(thrown_ball(), {{other, ""}}), UserError);
}

}  // namespace
}  // namespace tumble::testing
