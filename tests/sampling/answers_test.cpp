// What is said of answers: their errors over CPU time, and when they are not to be trusted.
#include "framework/sampling/accuracy.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tumble::sampling {
namespace {

/// A chain of one number whose sample i is `value(i)`, all of them doing what is asked; a second of
/// CPU time each.
template <typename Value>
Chain chain_from(int samples, const Value& value) {
  Chain chain;
  chain.x = MatrixXd(samples, 1);
  chain.violation = VectorXd::Zero(samples);
  chain.cpu_s = VectorXd(samples);
  for (int i = 0; i < samples; ++i) {
    chain.x(i, 0) = value(i);
    chain.cpu_s[i] = i + 1;
  }
  return chain;
}

Answers truth_of(double mean, double deviation) {
  Answers truth;
  truth.estimates.resize(1);
  truth.estimates[0].answer.mean = mean;
  truth.estimates[0].answer.deviation = deviation;
  return truth;
}

TEST(Accuracy, IsTheDistanceOfEachChainsMeanInDeviations) {
  // Means 5 and 1 against 2 +- 0.5: 6 and -2 deviations off, sqrt((36 + 4)/2) at every length.
  const std::vector<Chain> chains = {chain_from(64, [](int) { return 5.0; }),
                                     chain_from(64, [](int) { return 1.0; })};
  const std::vector<AccuracyPoint> points = accuracy_of(chains, truth_of(2.0, 0.5));
  ASSERT_EQ(points.size(), 7u);  // 1, 2, ..., 64 samples
  for (const AccuracyPoint& point : points) {
    EXPECT_NEAR(point.error, std::sqrt(20.0), 1e-13);
    EXPECT_EQ(point.cpu_s, point.samples);
  }
  EXPECT_EQ(points.back().samples, 64);
}

TEST(Accuracy, LeavesOutSamplesThatDoNotDoItAndBeginningsWithoutAnAnswer) {
  // The first half of one chain does not do what is asked, and its numbers say nothing.
  Chain late = chain_from(64, [](int i) { return i < 32 ? 1e9 : 3.0; });
  late.violation.head(32).setOnes();
  const std::vector<AccuracyPoint> points =
      accuracy_of({late, chain_from(64, [](int) { return 3.0; })}, truth_of(2.0, 1.0));
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].samples, 64);
  EXPECT_NEAR(points[0].error, 1.0, 1e-14);
}

TEST(Accuracy, FallsWithTheRootOfTheTime) {
  // Errors of exactly 1/sqrt(samples): slope -1/2, and a tenth of the error for 100 times the time.
  std::vector<AccuracyPoint> points;
  for (int samples = 1; samples <= 256; samples *= 4)
    points.push_back({samples, 0.5 * samples, 1.0 / std::sqrt(samples)});
  EXPECT_NEAR(slope_of(points), -0.5, 1e-13);
  EXPECT_NEAR(price_of(points, 1.0 / 16.0), 128.0, 1e-10);
  EXPECT_NEAR(price_of(points, 1.0 / 160.0), 12800.0, 1e-8);
  EXPECT_TRUE(std::isinf(price_of({}, 0.1)));
}

Answers good_answers() {
  Answers answers;
  answers.samples = 4000;
  answers.done = 2000;
  answers.simulations = 4400;
  answers.worst_r_hat = 1.004;
  answers.least_effective = 500;
  return answers;
}

std::string doubts_of(const Answers& answers) {
  std::string all;
  for (const std::string& doubt : doubts(answers, 4)) all += doubt + '\n';
  return all;
}

TEST(Doubts, AreNoneWhereChainsHaveMet) {
  EXPECT_EQ(doubts_of(good_answers()), "");
  EXPECT_TRUE(can_be_used(good_answers()));
}

TEST(Doubts, SayNumbersAsSentencesDo) {
  Answers apart = good_answers();
  apart.worst_r_hat = 1.76;  // (1.76^2 - 1) / (1.01^2 - 1) = 104
  EXPECT_NE(doubts_of(apart).find("about 100 times as many"), std::string::npos)
      << doubts_of(apart);
}

TEST(Doubts, NameWhatSpeaksAgainstTheAnswers) {
  Answers apart = good_answers(), nearly = good_answers(), few = good_answers(),
          none = good_answers(), broken = good_answers(), unknown = good_answers();
  apart.worst_r_hat = 1.3;
  nearly.worst_r_hat = 1.05;
  few.least_effective = 40;
  none.done = 0;
  broken.broken = 200;
  unknown.worst_r_hat = kUnset;
  EXPECT_NE(doubts_of(apart).find("have not met (R-hat 1.30)"), std::string::npos);
  // (1.05^2 - 1) / (1.01^2 - 1) = 0.1025 / 0.0201 = 5.1
  EXPECT_NE(doubts_of(nearly).find("About 5.1 times as many samples"), std::string::npos)
      << doubts_of(nearly);
  // 50 of each half of 4 chains
  EXPECT_NE(doubts_of(few).find("40 effective samples, fewer than the 400"), std::string::npos)
      << doubts_of(few);
  EXPECT_NE(doubts_of(none).find("there is no answer"), std::string::npos);
  EXPECT_NE(doubts_of(broken).find("200 of 4400 runs broke"), std::string::npos);
  EXPECT_NE(doubts_of(unknown).find("R-hat is unknown"), std::string::npos);
  for (const Answers& rough : {nearly, few}) EXPECT_TRUE(can_be_used(rough));
  for (const Answers& bad : {apart, none, broken, unknown}) EXPECT_FALSE(can_be_used(bad));
}

}  // namespace
}  // namespace tumble::sampling
