// Contact sheets, videos, views side by side; both implementations of the GL context; threads of
// the rasteriser change no byte.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/render/frame_painter.h"
#include "framework/render/picture.h"
#include "tests/render/render_fixtures.h"

namespace tumble::render {
namespace {

namespace fs = std::filesystem;

/// A temporary folder for each test.
class Pictures : public ::testing::Test {
 protected:
  Pictures() : folder_(fs::temp_directory_path() / ("tumble_render_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Pictures() override { fs::remove_all(folder_); }

  static std::string output_of(const std::string& command) {
    std::string text;
    std::array<char, 256> part;
    FILE* pipe = popen(command.c_str(), "r");
    while (pipe != nullptr && fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
    if (pipe != nullptr) pclose(pipe);
    return text;
  }
  static std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string probe(const fs::path& video, const std::string& entries) const {
    return output_of("ffprobe -v error -count_frames -select_streams v:0 -show_entries " + entries +
                     " -of csv=p=0 '" + video.string() + "'");
  }

  fs::path folder_;
};

TEST_F(Pictures, VideoHasAFrameForEveryInstantAndHoldsTheLast) {
  PictureOptions options = small();
  options.video_rate_hz = 10;
  write_video(folder_ / "v.mp4", falling_ball(), ball_at(2.0), options);
  // 0.5 s at 10 Hz are six frames with both ends; the last one is held for half a second, five
  // more.
  EXPECT_EQ(probe(folder_ / "v.mp4", "stream=codec_name,width,height,nb_read_frames"),
            "h264,160,120,11\n");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "a draft was left behind";
}

TEST_F(Pictures, SlowMotionHasMoreFrames) {
  PictureOptions options = small();
  options.video_rate_hz = 10;
  options.speed = 0.25;
  write_video(folder_ / "v.mp4", falling_ball(), ball_at(2.0), options);
  EXPECT_EQ(probe(folder_ / "v.mp4", "stream=nb_read_frames"), "26\n");
}

TEST_F(Pictures, SideBySideIsAsWideAsBothAndEachSideShowsItsRun) {
  const Trajectory high = ball_at(2.0), low = ball_at(1.0);
  PictureOptions options = small();
  options.captions = false;
  write_side_by_side_video(folder_ / "v.mp4", falling_ball(),
                           {{high, "submission"}, {low, "reference"}}, options);
  EXPECT_EQ(probe(folder_ / "v.mp4", "stream=width,height"), "322,120\n");
  // The picture changes where the second run does: each half is drawn from its own run.
  write_side_by_side_picture(folder_ / "same.png", falling_ball(), {{high, ""}, {high, ""}}, 0.0,
                             options);
  write_side_by_side_picture(folder_ / "other.png", falling_ball(), {{high, ""}, {low, ""}}, 0.0,
                             options);
  EXPECT_NE(bytes_of(folder_ / "same.png"), bytes_of(folder_ / "other.png"));
}

TEST_F(Pictures, ViewsSideBySideHaveTheScaleOfAllRuns) {
  Trajectory weak = ball_at(2.0), strong = ball_at(1.0);
  for (auto& [run, impulse] : {std::pair<Trajectory&, double>(weak, 1.0), {strong, 4.0}})
    run.events.push_back(
        {0.5, EventKind::kCollision, 0, 1, {0, 0, 0.2}, {0, 0, 1}, impulse, -1.0, 1.0});
  const scene::Scene scene = falling_ball();
  const auto painters =
      painters_side_by_side(scene, {{weak, "submission"}, {strong, "reference"}}, small());
  ASSERT_EQ(painters.size(), 2u);
  for (const auto& painter : painters) {
    EXPECT_EQ(painter->scale().strongest_impulse, 4.0);
    EXPECT_EQ(painter->scale().lowest_m, 0.5 - 0.3);  // of the lower run, at its end
  }
}

TEST_F(Pictures, ContactSheetIsAGridOfHalfSizeViews) {
  write_contact_sheet(folder_ / "s.png", falling_ball(), ball_at(2.0), 9, small());
  // 3 x 80 + 2 x 2, 3 x 60 + 2 x 2
  EXPECT_EQ(probe(folder_ / "s.png", "stream=width,height"), "244,184\n");
}

// A run that was stopped says so where it ends: in the last of 2 x 2 views of 80 x 60 pixels.
TEST_F(Pictures, ContactSheetShowsWhatStoppedTheRun) {
  const auto red = [&](const std::string& stopped_by, bool in_last_view) {
    Trajectory run = ball_at(2.0);
    run.stopped_by = stopped_by;
    write_contact_sheet(folder_ / "s.png", falling_ball(), run, 4, small());
    const Image sheet = read_png(folder_ / "s.png");
    int count = 0;
    for (int y = 0; y < sheet.height; ++y)
      for (int x = 0; x < sheet.width; ++x) {
        const std::uint8_t* p = sheet.pixel(x, y);
        count += p[0] > p[1] + 60 && p[0] > p[2] + 60 && (x > 80 && y > 60) == in_last_view;
      }
    return count;
  };
  EXPECT_EQ(red("", true), 0);
  EXPECT_GT(red("the bodies fell asleep", true), 10);
  EXPECT_EQ(red("the bodies fell asleep", false), 0);
}

TEST_F(Pictures, VideoThatCannotBeWrittenGivesAReasonAndLeavesNothing) {
  try {
    write_video("/proc/no-such-place/v.mp4", falling_ball(), ball_at(2.0), small());
    FAIL() << "was accepted";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("/proc/no-such-place"), std::string::npos)
        << error.what();
  }
}

// In a relative name, as it is typed, ffmpeg could take "12" for a protocol.
TEST_F(Pictures, VideoMayHaveAColonInItsName) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  EXPECT_NO_THROW(write_video("12:30.mp4", falling_ball(), ball_at(2.0), small()));
  fs::current_path(before);
  EXPECT_EQ(probe(folder_ / "12:30.mp4", "stream=codec_name"), "h264\n");
}

TEST_F(Pictures, WithoutFfmpegTheErrorNamesIt) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const auto refused = [](const auto& call) {
    try {
      call();
      ADD_FAILURE() << "was accepted";
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find("ffmpeg is not installed"), std::string::npos)
          << error.what();
    }
  };
  refused([&] { write_video(folder_ / "v.mp4", falling_ball(), ball_at(2.0), small()); });
  refused([&] { expect_video(folder_ / "v.mp4"); });  // before anything is drawn
  setenv("PATH", path.c_str(), 1);
  EXPECT_NO_THROW(expect_video(folder_ / "v.mp4"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Pictures, TellingInstantIsJustAfterTheStrongestImpact) {
  Trajectory run = ball_at(2.0);
  EXPECT_DOUBLE_EQ(telling_instant(run), 0.5 / 3);
  run.frames.clear();
  for (int i = 0; i <= 10; ++i)
    run.frames.push_back(
        {i * 0.1, {}, 0, 0, Vector3d::Zero(), Vector3d::Zero(), 1, {}, {}, {}, {}});
  run.events = {{0.2, EventKind::kCollision, 0, 1, Vector3d::Zero(), Vector3d::UnitZ(), 1.0, -1.0},
                {0.4, EventKind::kCollision, 0, 1, Vector3d::Zero(), Vector3d::UnitZ(), 3.0, -1.0}};
  EXPECT_DOUBLE_EQ(telling_instant(run), 0.6);
}

TEST_F(Pictures, EglAndOsmesaDrawTheSamePicture) {
  const Image osmesa = make_picture(falling_ball(), ball_at(2.0), 0.0, small("osmesa"));
  Image egl;
  try {
    egl = make_picture(falling_ball(), ball_at(2.0), 0.0, small("egl"));
  } catch (const UserError& error) {
    GTEST_SKIP() << "EGL does not work here: " << error.what();
  }
  ASSERT_EQ(egl.rgb.size(), osmesa.rgb.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < egl.rgb.size(); ++i)
    differing += std::abs(egl.rgb[i] - osmesa.rgb[i]) > 8;
  // They may round colours and rasterise triangles' edges differently: one pixel in a hundred.
  EXPECT_LT(differing, osmesa.rgb.size() / 100);
  EXPECT_GT(std::set<std::uint8_t>(osmesa.rgb.begin(), osmesa.rgb.end()).size(), 50u)
      << "the picture is blank";
}

// The rasteriser reads its number of threads once per process: the test starts a process for each
// number.
TEST_F(Pictures, ThreadsChangeNoByte) {
  if (const char* file = std::getenv("TUMBLE_TEST_PICTURE")) {
    write_picture(file, falling_ball(), ball_at(2.0), 0.5, small());
    return;
  }
  const std::string self = fs::canonical("/proc/self/exe").string();
  std::set<std::string> pictures;
  for (const std::string threads : {"0", "1", "2"}) {
    const fs::path file = folder_ / (threads + ".png");
    const std::string command = "LP_NUM_THREADS=" + threads + " OMP_NUM_THREADS=1" + threads +
                                " TUMBLE_TEST_PICTURE='" + file.string() + "' '" + self +
                                "' --gtest_filter=Pictures.ThreadsChangeNoByte > /dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    pictures.insert(bytes_of(file));
  }
  EXPECT_EQ(pictures.size(), 1u);
  EXPECT_GT(pictures.begin()->size(), 1000u);
}

// The ground is far below the body that casts a shadow on it; the shadow is complete.
TEST_F(Pictures, ShadowReachesTheGroundFarBelow) {
  PictureOptions options = small();
  options.captions = options.marks = options.paths = false;
  scene::Scene scene = falling_ball();
  scene.camera.eye_m = {0, -1, 12};
  scene.camera.target_m = {0, 0, 0};
  const Image low = make_picture(scene, ball_at(0.8), 0.0, options),
              high = make_picture(scene, ball_at(6.0), 0.0, options);
  const auto dark = [](const Image& image) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
      count += image.rgb[i] < 170 && std::abs(image.rgb[i] - image.rgb[i + 1]) < 12 &&
               std::abs(image.rgb[i] - image.rgb[i + 2]) < 20;
    return count;
  };
  EXPECT_GT(dark(low), 20u);
  EXPECT_GT(dark(high), 20u);
}

}  // namespace
}  // namespace tumble::render
