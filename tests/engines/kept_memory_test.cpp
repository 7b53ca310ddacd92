// What is kept from question to question for speed alone: caches of pairs, places in problems.
#include <set>

#include <gtest/gtest.h>

#include "framework/engines/stepping/body_places.h"
#include "framework/engines/stepping/pair_caches.h"

namespace tumble::testing {
namespace {

using engines::BodyPlaces;
using engines::PairCaches;

TEST(PairCaches, EachPairHasItsOwnAndKeepsIt) {
  constexpr int kBodies = 100;  // 4,950 pairs: fewer than are forgotten
  PairCaches caches;
  std::set<collision::PairCache*> all;
  for (int a = 0; a < kBodies; ++a)
    for (int b = a + 1; b < kBodies; ++b) {
      collision::PairCache* const cache = caches.of(a, b);
      EXPECT_EQ(cache->served, 0) << "a new pair, " << a << " and " << b;
      cache->served = kBodies * a + b;
      all.insert(cache);
    }
  EXPECT_EQ(all.size(), kBodies * (kBodies - 1) / 2u);
  for (int a = 0; a < kBodies; ++a)
    for (int b = a + 1; b < kBodies; ++b) EXPECT_EQ(caches.of(a, b)->served, kBodies * a + b);
}

TEST(PairCaches, TooManyAreForgottenAndBeginAnew) {
  PairCaches caches;
  int begun_anew = 0;
  for (int round = 0; round < 2; ++round)
    for (int b = 1; b < 30000; ++b) {
      collision::PairCache* const cache = caches.of(0, b);
      if (cache->served != 0) {
        EXPECT_EQ(cache->served, b);
      } else {
        ++begun_anew;
      }
      cache->served = b;
      EXPECT_EQ(caches.of(0, b)->served, b);
    }
  EXPECT_GT(begun_anew, 30000) << "no memory holds them all";
}

TEST(BodyPlaces, AreGivenOnceAndForgottenByTheNextProblem) {
  BodyPlaces places;
  places.begin(5);
  EXPECT_EQ(places.enter(3, 0), 0);
  EXPECT_EQ(places.enter(1, 1), 1);
  EXPECT_EQ(places.enter(3, 2), 0) << "it has one";
  EXPECT_EQ(places.at(1), 1);
  EXPECT_THROW(places.at(2), std::exception);
  places.begin(7);
  EXPECT_THROW(places.at(3), std::exception) << "of the problem before";
  EXPECT_EQ(places.enter(6, 0), 0);
  EXPECT_EQ(places.enter(3, 1), 1);
}

}  // namespace
}  // namespace tumble::testing
