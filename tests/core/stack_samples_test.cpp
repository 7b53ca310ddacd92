// Shares of CPU time by stack samples, against the times for which the same functions are made to
// run.
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/stack_samples.h"

namespace tumble::testing {

// Not inlined, and with external names, so that samples can be attributed to them.
[[gnu::noinline]] double spin_for_samples(double seconds) {
  double x = 1.0;
  for (const double until = thread_seconds() + seconds; thread_seconds() < until;)
    for (int k = 0; k < 1000; ++k) x = std::sqrt(x + 1.0);
  return x;
}
[[gnu::noinline]] double quick_part_of_samples() { return 1.0 + spin_for_samples(0.1); }
[[gnu::noinline]] double slow_part_of_samples() { return 1.0 + spin_for_samples(0.5); }
[[gnu::noinline]] double set_up_of_samples() { return 1.0 + slow_part_of_samples(); }

namespace {

const std::vector<StackSamples::Part> kParts = {
    {"quick", {"tumble::testing::quick_part_of_samples"}},
    {"slow", {"tumble::testing::slow_part_of_samples"}}};
constexpr double kSigmas = 5.0;

/// Takes samples of the work, again where they are few: where the host of a virtual machine is
/// busy, most ticks pass unnoticed, 7 of 60 are left.
template <class Work>
void take(StackSamples& samples, const Work& work) {
  constexpr std::size_t kEnough = 25;  // half a second at 10 ms has 50
  for (int round = 0; round < 10 && samples.shares({}, {}).samples < kEnough; ++round) {
    samples.begin();
    work();
    samples.end();
  }
}

// The standard error of N independent samples; evenly spaced samples have a smaller one.
void expect_share(const StackSamples::Shares& shares, std::size_t part, double expected) {
  ASSERT_GT(shares.samples, 8U);
  EXPECT_NEAR(shares.of_part[part], expected,
              kSigmas * std::sqrt(expected * (1 - expected) / static_cast<double>(shares.samples)));
}

TEST(StackSamples, MeasureTheShareOfEachPart) {
  StackSamples samples;
  take(samples, [] {
    quick_part_of_samples();
    slow_part_of_samples();
  });
  const auto shares = samples.shares(kParts, {});
  expect_share(shares, 0, 1.0 / 6.0);
  expect_share(shares, 1, 5.0 / 6.0);
  EXPECT_LT(shares.rest, 0.05);
}

TEST(StackSamples, BelongToTheInnermostPart) {
  StackSamples samples;
  take(samples, slow_part_of_samples);
  const auto shares = samples.shares({{"outer", {"tumble::testing::slow_part_of_samples"}},
                                      {"inner", {"tumble::testing::spin_for_samples"}}},
                                     {});
  EXPECT_LT(shares.of_part[0], 0.05);
  EXPECT_GT(shares.of_part[1], 0.9);
}

TEST(StackSamples, BelongToThePartWithTheLongestMatchingPrefix) {
  StackSamples samples;
  take(samples, slow_part_of_samples);
  EXPECT_GT(
      samples.shares({{"all", {"tumble::testing::s"}}, {"this", {"tumble::testing::spin_for"}}}, {})
          .of_part[1],
      0.9);
}

TEST(StackSamples, LeaveOutExcludedFunctions) {
  StackSamples samples;
  take(samples, [] {
    quick_part_of_samples();
    set_up_of_samples();
  });
  expect_share(samples.shares(kParts, {}), 1, 5.0 / 6.0);
  expect_share(samples.shares(kParts, {}), 0, 1.0 / 6.0);
  EXPECT_GT(samples.shares(kParts, {"tumble::testing::set_up_of_samples"}).of_part[0], 0.9);
}

TEST(StackSamples, SeeAllThreads) {
  StackSamples samples;
  samples.begin();
  std::thread other(slow_part_of_samples);
  quick_part_of_samples();
  other.join();
  samples.end();
  // 5/6 on a machine that is free; on a busy one the system gives a thread that waits for a core
  // samples of the other's time (0.53 was seen). None, if only the thread that began were seen.
  EXPECT_GT(samples.shares(kParts, {}).of_part[1], 0.25);
}

TEST(StackSamples, TakenTwiceAtOnceAreRefusedAndAfterTheEndThereAreNone) {
  StackSamples first, second;
  first.begin();
  EXPECT_THROW(second.begin(), PreconditionError);
  first.end();
  second.begin();
  second.end();
  slow_part_of_samples();
  EXPECT_LE(second.shares(kParts, {}).samples, 1U);  // the timer may fire between begin and end
}

TEST(StackSamples, KnowFunctionsByTheirNames) {
  EXPECT_TRUE(StackSamples::is_known("tumble::testing::slow_part"));
  EXPECT_TRUE(
      StackSamples::is_known("tumble::testing::StackSamples_KnowFunctionsByTheirNames_Test"))
      << "within an unnamed namespace";
  EXPECT_FALSE(StackSamples::is_known("tumble::testing::no_function_has_such_a_name"));
}

}  // namespace
}  // namespace tumble::testing
