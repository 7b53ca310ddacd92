// Own time of a process: computing and sleeping count, waiting for a core does not.
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include <gtest/gtest.h>

#include "framework/grading/verdicts/own_time.h"

namespace tumble::grading {
namespace {

using Clock = std::chrono::steady_clock;

// A child that runs `does` forever, on the first core only.
pid_t child_that(void (*does)()) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  cpu_set_t first;
  CPU_ZERO(&first);
  CPU_SET(0, &first);
  ::sched_setaffinity(0, sizeof first, &first);
  does();
  ::_exit(0);
}
void spin() {
  for (volatile unsigned i = 0;;) i = i + 1;
}
void sleep_on() {
  for (;;) ::pause();
}
void end(pid_t child) {
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

struct Measured {
  double own_s, wall_s;
};
Measured own_over(pid_t child, double wall_s) {
  const ProcessTimes before = process_times(child);
  const auto start = Clock::now();
  ::usleep(static_cast<useconds_t>(wall_s * 1e6));
  const ProcessTimes after = process_times(child);
  const double wall = std::chrono::duration<double>(Clock::now() - start).count();
  return {own_time(before, after, wall), wall};
}

TEST(OwnTime, SleepCountsInFull) {
  const pid_t child = child_that(sleep_on);
  ::usleep(50'000);
  const Measured measured = own_over(child, 0.5);
  end(child);
  EXPECT_GT(measured.own_s, 0.4);
  EXPECT_LE(measured.own_s, measured.wall_s + 0.02);
}

TEST(OwnTime, WaitingForACoreDoesNotCount) {
  // Four busy processes on one core get at most a quarter of it each, whatever else runs; each is
  // always ready.
  pid_t children[4];
  for (pid_t& child : children) child = child_that(spin);
  ::usleep(100'000);
  const Measured measured = own_over(children[0], 2.0);
  for (const pid_t child : children) end(child);
  EXPECT_LT(measured.own_s, 0.6 * measured.wall_s);
}

TEST(OwnTime, OfNoProcessIsWallTime) {
  EXPECT_FALSE(process_times(-1).is_known);
  EXPECT_EQ(own_time({}, process_times(-1), 1.5), 1.5);
}

TEST(OwnTime, ActivityOfSleepersDoesNotGrow) {
  const pid_t child = child_that(sleep_on);
  ::usleep(100'000);
  const double before = activity_below(child);
  ::usleep(300'000);
  EXPECT_NEAR(activity_below(child), before, 0.015);  // one tick of the kernel's clock
  end(child);
}

}  // namespace
}  // namespace tumble::grading
