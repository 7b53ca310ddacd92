// Pictures: the same run gives the same bytes; pixel and ray are consistent.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/render/camera.h"
#include "framework/render/captions.h"
#include "framework/render/picture.h"
#include "tests/render/render_fixtures.h"

namespace tumble::render {
namespace {

std::string png_bytes(double time_s = 0.5) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("tumble_picture_" + std::to_string(getpid()) + ".png");
  write_picture(file, falling_ball(), ball_at(2.0), time_s, small());
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  in.close();
  std::filesystem::remove(file);
  return bytes;
}

TEST(Picture, SameRunSameBytes) {
  const std::string once = png_bytes();
  EXPECT_GT(once.size(), 1000u);
  EXPECT_EQ(once, png_bytes());
}

// The run ends at 0.5 s.
TEST(Picture, FileHasTheTimeOfTheFrameThatIsDrawn) { EXPECT_EQ(png_bytes(99.0), png_bytes(0.5)); }

// A right submission is drawn as the reference is: its distance is none, whatever the words say.
TEST(Picture, ViewsOfTheSameRunAreNotApart) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("tumble_views_" + std::to_string(getpid()) + ".png");
  PictureOptions options = small();
  options.width = 400;  // as in a graded page: words stay as large where a picture is smaller
  options.height = 300;
  const auto apart = [&](double other_m) {
    write_side_by_side_picture(file, falling_ball(),
                               {{ball_at(2.0), "submission"}, {ball_at(other_m), "reference"}}, 0.0,
                               options);
    const double distance = distance_of_views(read_png(file));
    std::filesystem::remove(file);
    return distance;
  };
  EXPECT_EQ(apart(2.0), 0.0);
  EXPECT_GT(apart(1.5), 1.0);  // of 255: a ball of another place covers some percent of a view
}

// 5000 km away, floats are half a metre apart. The shift is a multiple of the strong lines' 5 m, so
// that the grid is the same.
TEST(Picture, FarFromTheOriginIsAsNearIt) {
  scene::Scene scene = falling_ball();
  Trajectory run = ball_at(2.0);
  const Image near = make_picture(scene, run, 0.0, small());
  const Vector3d away(5e6, -5e6, 1e6);
  scene.camera.eye_m += away;
  scene.camera.target_m += away;
  for (Frame& frame : run.frames)
    for (BodyPose& pose : frame.poses) pose.com_world += away;
  // Roundings of 1e-9 m change a pixel on an edge here and there: much less than one level.
  EXPECT_LT(colour_distance(near, make_picture(scene, run, 0.0, small())), 1.0);
}

TEST(Captions, SuccessiveFramesHaveDifferentTimes) {
  const auto times = [](double spacing_s) {
    Trajectory run = ball_at(2.0);
    for (std::size_t i = 0; i < run.frames.size(); ++i)
      run.frames[i].time = static_cast<double>(i) * spacing_s;
    return time_text(run, 1);
  };
  EXPECT_EQ(times(0.5), "t = 0.50 s");
  EXPECT_EQ(times(0.01), "t = 0.01 s");
  EXPECT_EQ(times(1.0 / 60), "t = 0.02 s");
  EXPECT_EQ(times(0.001), "t = 0.001 s");
  EXPECT_EQ(times(2.5e-5), "t = 0.00003 s");
  EXPECT_EQ(times(1e-12), "t = 0.000000000 s");
  EXPECT_EQ(times(0.0), "t = 0.00 s");
  Trajectory alone = ball_at(2.0);
  alone.frames.pop_back();
  EXPECT_EQ(time_text(alone, 0), "t = 0.00 s");
}

TEST(Picture, RunOfAnotherSceneIsRefused) {
  Trajectory run = ball_at(2.0);
  run.bodies.pop_back();
  EXPECT_THROW(make_picture(falling_ball(), run, 0.0, small()), UserError);
}

TEST(Picture, RunWithoutFramesIsRefused) {
  Trajectory run = ball_at(2.0);
  run.frames.clear();
  EXPECT_THROW(make_picture(falling_ball(), run, 0.0, small()), UserError);
}

// Two films of one scene differ by one of these: it must stand in their words.
TEST(Captions, NameEveryModuleThatTheRunAsked) {
  TrajectoryInfo info;
  info.engine = "tw";
  info.step_s = 0.1;
  info.scheduling_source = "submission";
  info.impulse_source = info.integrator_source = "reference";
  info.constraint_source = "none";
  EXPECT_EQ(made_by(info),
            "timewarp, step 1/10 s · scheduler: submission · impulses, motion: reference");
  info.scheduling_source = "a4 work/mine/a4_timewarp.cpp";
  EXPECT_NE(made_by(info).find("scheduler: a4 a4_timewarp.cpp ·"), std::string::npos);
  info.scheduling_source = "none";
  info.constraint_source = "submission";
  EXPECT_NE(made_by(info).find("impulses, motion: reference · constraints: submission"),
            std::string::npos);
}

// By hand: a line of size 10 reaches from 200 - 12.5 down. Labels grow downwards, from their top.
TEST(Captions, TheReasonOfAStopStandsAboveALabelInItsWay) {
  EXPECT_EQ(clear_baseline(200, 150, 10, {{40, 175, 195}}), 172.0);   // 175 - 3
  EXPECT_EQ(clear_baseline(200, 150, 10, {{160, 175, 195}}), 200.0);  // beside it
  EXPECT_EQ(clear_baseline(200, 150, 10, {{40, 160, 180}}), 200.0);   // above it
  EXPECT_EQ(clear_baseline(200, 150, 10, {{40, 205, 225}}), 200.0);   // below it
}

double luminance_of(const std::uint8_t* pixel) {
  double sum = 0.0;
  for (const auto& [i, share] : {std::pair(0, 0.2126), {1, 0.7152}, {2, 0.0722}})
    sum += share * std::pow((pixel[i] / 255.0 + 0.055) / 1.055, 2.4);
  return sum;
}

// WCAG 2.1 asks for a contrast of 4.5. Without a plate the soft ink has 1.1 on a grey of 60.
TEST(TextWriter, CanBeReadOnADarkGroundAndLeavesALightOneAsItIs) {
  const TextWriter writer;
  for (const std::uint8_t grey : {60, 250}) {
    Image image(200, 40);
    std::fill_n(image.pixel(0, 0), 200 * 40 * 3, grey);
    writer.write(image, "timewarp", 50, 25, 11, kSoft);
    double darkest = 1.0;
    for (int x = 50; x < 100; ++x)
      for (int y = 15; y < 28; ++y) darkest = std::min(darkest, luminance_of(image.pixel(x, y)));
    const double beside = luminance_of(image.pixel(49, 27));  // of the plate: no letter is there
    EXPECT_GE((beside + 0.05) / (darkest + 0.05), 4.4) << int(grey);  // rounded to whole steps
    EXPECT_EQ(*image.pixel(49, 27) == grey, grey == 250);
    EXPECT_EQ(*image.pixel(20, 27), grey);
  }
}

TEST(Camera, RayThroughTheImageOfAPointHitsThePoint) {
  const View view = view_of(falling_ball().camera);
  for (const Vector3d& point : {Vector3d(0, 0, 1), Vector3d(1.3, 0.4, 0.2), Vector3d(-2, 5, 3)}) {
    const auto pixel = project(view, 640, 480, point);
    ASSERT_TRUE(pixel.has_value());
    const Ray ray = pixel_ray(view, 640, 480, pixel->x(), pixel->y());
    const Vector3d along = (point - view.eye_world).normalized();
    // About ten roundings of numbers near 1; an error of half a pixel is 1e-3.
    EXPECT_LT((ray.direction_world - along).norm(), 1e-14);
    EXPECT_EQ(ray.origin_world, view.eye_world);
  }
}

TEST(Camera, PointBehindTheEyeHasNoImage) {
  EXPECT_FALSE(project(view_of(falling_ball().camera), 640, 480, {0, -10, 3}).has_value());
}

}  // namespace
}  // namespace tumble::render
