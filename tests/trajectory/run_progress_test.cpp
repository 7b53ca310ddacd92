#include "framework/trajectory/run_progress.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace tumble {
namespace {

Frame frame_at(double time) {
  Frame frame;
  frame.time = time;
  return frame;
}

/// What is said of a run that comes to 0.5 of 2 s at once, and then stands still for so long.
std::string said_in(double wait_s, const RunProgress::Pace& pace) {
  TrajectoryRecorder recorder;
  testing::internal::CaptureStderr();
  {
    RunProgress progress(recorder, 2.0, pace);
    progress.frame(frame_at(0.5));
    std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
  }
  EXPECT_EQ(recorder.trajectory().frames.size(), 1u);  // handed on
  return testing::internal::GetCapturedStderr();
}

// One line, written anew from the first column, and taken away at the end.
TEST(RunProgress, OnATerminalItIsOneLineThatIsGoneAtTheEnd) {
  const std::string said = said_in(0.2, {0.05, 0.02, true});
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  EXPECT_TRUE(said.starts_with("\r\033[Ktumble: ")) << said;
  EXPECT_TRUE(said.ends_with("\r\033[K")) << said;
}

TEST(RunProgress, AShortRunSaysNothing) { EXPECT_EQ(said_in(0.01, {100.0, 100.0, false}), ""); }

TEST(RunProgress, ALongRunSaysHowFarItIsAndWhereItStandsStill) {
  // twenty lines on an idle machine, two on any
  const std::string said = said_in(1.0, {0.05, 0.05});
  EXPECT_TRUE(said.starts_with("tumble: 0.5 of 2 s simulated, about 0 s left\n")) << said;
  EXPECT_NE(said.find("0.5 of 2 s simulated, for "), std::string::npos) << said;
  EXPECT_NE(said.find("no frame has come"), std::string::npos) << said;
}

// Work before the first frame is told as what it is; frames that come then are told as ever.
TEST(RunProgress, OfABeatBeforeTheFirstFrameIsToldAsTheReferences) {
  TrajectoryRecorder recorder;
  testing::internal::CaptureStderr();
  {
    RunProgress progress(recorder, 2.0, {0.05, 0.05});
    progress.beat(1.5);
    std::this_thread::sleep_for(std::chrono::duration<double>(0.5));
  }
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(
      said.starts_with("tumble: the ordered reference, which runs first, is at 1.5 of 2 s\n"))
      << said;
  EXPECT_EQ(said.find("simulated"), std::string::npos) << said;
  EXPECT_TRUE(recorder.trajectory().frames.empty());
}

// A sink that stands between hands a beat on.
TEST(PassingSink, HandsABeatOn) {
  struct Beats final : TrajectorySink {
    void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
    void frame(const Frame&) override {}
    void event(const Event&) override {}
    void end(const Counters&, const std::string&) override {}
    void beat(double time_s) override { last = time_s; }
    double last = 0.0;
  } beats;
  PassingSink between(beats);
  RunProgress progress(between, 2.0, {100.0, 100.0, false});
  progress.beat(0.25);
  EXPECT_EQ(beats.last, 0.25);
}

}  // namespace
}  // namespace tumble
