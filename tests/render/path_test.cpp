// Frames of a drawn path: every frame that is left out is near the path, and the path is short.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/render/path.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {
namespace {

constexpr std::size_t kFrames = 1000;
constexpr double kSlack = 3e-3;  // m
constexpr double kTurn = 2 * std::numbers::pi;

Trajectory run_along(const std::function<Vector3d(double)>& place, std::size_t frames = kFrames) {
  Trajectory run;
  run.bodies = {{"ball", false}};
  for (std::size_t f = 0; f < frames; ++f) {
    Frame frame{};
    frame.time = static_cast<double>(f);
    frame.poses = {
        {place(frame.time), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()}};
    run.frames.push_back(frame);
  }
  return run;
}

double distance_to_line(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const double squared = (b - a).squaredNorm();
  const double share = squared > 0.0 ? std::clamp((point - a).dot(b - a) / squared, 0.0, 1.0) : 0.0;
  return (point - (a + share * (b - a))).norm();
}

// The farthest that any frame is from the path, wherever the path ends.
double farthest(const Trajectory& run, const std::vector<std::size_t>& kept) {
  const auto place = [&](std::size_t f) { return run.frames[f].poses[0].com_world; };
  double most = 0.0;
  for (std::size_t k = 1; k < kept.size(); ++k)
    for (std::size_t tip = kept[k - 1] + 1; tip <= kept[k]; ++tip)
      for (std::size_t f = kept[k - 1] + 1; f < tip; ++f)
        most = std::max(most, distance_to_line(place(f), place(kept[k - 1]), place(tip)));
  return most;
}

TEST(Path, PassesEveryFrameThatItLeavesOut) {
  const std::pair<const char*, std::function<Vector3d(double)>> motions[] = {
      {"circle",
       [](double t) {
         const double angle = kTurn * t / 97.3;
         return Vector3d(std::cos(angle), 0, std::sin(angle));
       }},
      {"knot",
       [](double t) {
         return Vector3d(std::cos(0.01 * t), std::sin(0.013 * t), std::sin(0.017 * t + 1));
       }},
      {"bounces", [](double t) { return Vector3d(0.002 * t, 0, std::abs(std::sin(0.021 * t))); }},
      {"to and fro",
       [](double t) { return Vector3d(1e-2 * std::abs(std::fmod(t, 200.0) - 100.0), 0, 0); }},
      {"slowly to and fro",
       [](double t) { return Vector3d(1e-4 * std::abs(std::fmod(t, 400.0) - 200.0), 0, 0); }},
  };
  for (const auto& [name, place] : motions) {
    const Trajectory run = run_along(place);
    const auto kept = path_frames(run, 0, kSlack);
    EXPECT_EQ(kept.front(), 0u) << name;
    EXPECT_EQ(kept.back(), kFrames - 1) << name;
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end())) << name;
    EXPECT_LE(farthest(run, kept), 1.5 * kSlack) << name;
  }
}

TEST(Path, OfABodyAtRestOrInStraightMotionIsOneLine) {
  const std::vector<std::size_t> ends = {0, kFrames - 1};
  const Vector3d start(1, 2, 3), step(0.01, -0.02, 0.003);
  EXPECT_EQ(path_frames(run_along([&](double) { return start; }), 0, kSlack), ends);
  EXPECT_EQ(path_frames(run_along([&](double t) { return Vector3d(start + t * step); }), 0, kSlack),
            ends);
}

// A chord over the angle e of a unit circle deviates by 1 - cos(e / 2) from its arc.
TEST(Path, OfACircleHasLittleMorePiecesThanItNeeds) {
  constexpr double kFramesPerTurn = 973.0;
  constexpr std::size_t kLong = 20000;
  const Trajectory run = run_along(
      [](double t) {
        const double angle = kTurn * t / kFramesPerTurn;
        return Vector3d(std::cos(angle), 0, std::sin(angle));
      },
      kLong);
  const double needed = kLong / kFramesPerTurn * kTurn / (2 * std::acos(1 - kSlack));
  const auto pieces = static_cast<double>(path_frames(run, 0, kSlack).size() - 1);
  // A piece has 24 frames: one less, by rounding, is 4 % more pieces.
  EXPECT_LT(pieces, 1.1 * needed);
  // Chords up to 1.5 of the slack would be longer by the root of that.
  EXPECT_GT(pieces, needed / 1.3);
}

TEST(Path, LeavesOutPosesThatAreNotFinite) {
  Trajectory run = run_along([](double t) { return Vector3d(0.01 * t, 0, 0); });
  for (const std::size_t f : {std::size_t{0}, std::size_t{500}, kFrames - 1})
    run.frames[f].poses[0].com_world.y() = kUnset;
  EXPECT_EQ(path_frames(run, 0, kSlack), (std::vector<std::size_t>{1, kFrames - 2}));
  for (Frame& frame : run.frames) frame.poses[0].com_world.y() = kUnset;
  EXPECT_TRUE(path_frames(run, 0, kSlack).empty());
}

}  // namespace
}  // namespace tumble::render
