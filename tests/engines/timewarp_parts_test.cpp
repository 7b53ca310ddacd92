// Components of timewarp schedulers: state queues, event queue, active pairs, the comparison of
// traces.
#include <cstring>
#include <deque>
#include <set>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/engines/timewarp/active_pairs.h"
#include "framework/engines/timewarp/event_queue.h"
#include "framework/engines/timewarp/flight_histories.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace {

using engines::Box;
using engines::Flight;

Flight flight_at(double begin, std::uint32_t version, Random& random) {
  Flight flight;
  flight.begin = begin;
  flight.version = version;
  flight.com_world = Vector3d(random.unit(), random.unit(), random.unit());
  flight.velocity_world = Vector3d(random.unit(), random.unit(), random.unit());
  flight.world_from_body = Quaterniond(random.unit(), random.unit(), random.unit(), random.unit());
  flight.omega_body = Vector3d(random.unit(), random.unit(), random.unit());
  return flight;
}

// Every number of a flight, bit for bit, without padding.
bool same_bytes(const Flight& x, const Flight& y) {
  const auto same = [](const auto& u, const auto& v) {
    return std::memcmp(u.data(), v.data(), sizeof(double) * static_cast<std::size_t>(u.size())) ==
           0;
  };
  return std::memcmp(&x.begin, &y.begin, sizeof x.begin) == 0 && same(x.com_world, y.com_world) &&
         same(x.velocity_world, y.velocity_world) &&
         same(x.world_from_body.coeffs(), y.world_from_body.coeffs()) &&
         same(x.omega_body, y.omega_body) && x.partner == y.partner &&
         x.partner_version == y.partner_version && x.microstep == y.microstep &&
         x.version == y.version && x.is_resting == y.is_resting;
}

TEST(FlightHistories, AreTheSameBytesAfterOneToFiftyFlightsAndARollback) {
  Random random(4);
  for (int steps = 1; steps <= 50; ++steps) {
    engines::FlightHistories histories(3);
    std::deque<Flight> expected;
    std::uint32_t version = 0;
    double t = 0.0;
    for (int k = 0; k < 7; ++k) {
      expected.push_back(flight_at(t, version++, random));
      histories.push(1, expected.back());
      t += random.unit();
    }
    for (int k = 0; k < steps; ++k)
      histories.push(1, flight_at(t += random.unit(), version++, random));
    for (int k = 0; k < steps; ++k) histories.pop(1);
    const double gvt = expected[3].begin + 1e-9;  // what ended before is not needed any more
    histories.purge(1, gvt);
    ASSERT_EQ(histories[1].size(), 4U);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_TRUE(same_bytes(histories[1][k], expected[k + 3])) << steps << " steps, flight " << k;
    EXPECT_EQ(histories[1].at(gvt), 0U);
    EXPECT_EQ(histories[1].find(expected[5].version), 2U);
    EXPECT_EQ(histories[1].find(expected[1].version), histories[1].size());
    EXPECT_EQ(histories[0].size() + histories[2].size(), 0U);
  }
}

// A body that once had many flights soon holds memory only for what it needs; its flights stay
// unchanged wherever they are stored.
TEST(FlightHistories, GiveBackTheMemoryOfFlightsThatAreGone) {
  Random random(7);
  engines::FlightHistories histories(1);
  std::deque<Flight> expected;
  double t = 0.0;
  const auto push = [&](int flights) {
    for (int k = 0; k < flights; ++k) {
      expected.push_back(
          flight_at(t += 0.1 + random.unit(), static_cast<std::uint32_t>(k), random));
      histories.push(0, expected.back());
    }
  };
  const auto keep = [&](std::size_t flights) {
    while (expected.size() > flights) expected.pop_front();
    histories.purge(0, expected.front().begin + 1e-9);
    ASSERT_EQ(histories[0].size(), flights);
    for (std::size_t k = 0; k < flights; ++k)
      EXPECT_TRUE(same_bytes(histories[0][k], expected[k])) << "of " << flights << ", flight " << k;
  };
  const std::size_t first = histories[0].held();
  push(1000);
  EXPECT_GE(histories[0].held(), 1000U);
  for (int k = 0; k < 20; ++k) {
    keep(3);
    push(1);
  }
  EXPECT_LE(histories[0].held(), 4U * 4U);
  for (int k = 0; k < 20; ++k) {
    keep(1);
    push(1);
  }
  EXPECT_EQ(histories[0].held(), first);
}

// Ten events wait at any time, a tenth of a bin apart, over two cycles of the bins: memory is held
// for some tens, not for each bin that was ever used.
TEST(EventQueue, HoldsNoMoreMemoryHoweverLongItGoesOn) {
  struct Item {
    engines::EventStamp key;
  };
  engines::EventQueue<Item> queue(1.0);
  for (int k = 0; k < 100'000; ++k) {
    queue.push({{0.1 * k, 0, engines::StampKind::kCollision, 0, 1}});
    if (k >= 10) queue.pop();
  }
  EXPECT_EQ(queue.size(), 10U);
  EXPECT_LT(queue.held(), 200U);
}

// For every width of bins: one heap, some per bin, most bins empty, all far ahead.
TEST(EventQueue, GivesKeysInTheirOrderWhateverTheOrderTheyCameIn) {
  struct Item {
    engines::EventStamp key;
  };
  for (const double width : {std::numeric_limits<double>::infinity(), 0.7, 1e-3, 1e-7}) {
    Random random(5);
    engines::EventQueue<Item> queue(width);
    std::multiset<std::tuple<double, std::uint32_t, int, int>> expected;
    const auto content = [](const Item& item) {
      return std::tuple(item.key.time, item.key.microstep, item.key.body_a, item.key.body_b);
    };
    double now = 0.0;
    for (int k = 0; k < 6000; ++k) {
      if (k < 4000) {
        const int a = static_cast<int>(random.below(50));
        const double time = random.below(3) == 0
                                ? now
                                : now + 0.25 * static_cast<double>(random.below(40)) *
                                            (random.below(9) == 0 ? 100.0 : 1.0);
        const Item item{{time, static_cast<std::uint32_t>(random.below(3)),
                         engines::StampKind::kCollision, a,
                         a + 1 + static_cast<int>(random.below(50))}};
        queue.push(item);
        expected.insert(content(item));
        if (random.below(20) == 0) {  // a rollback: earlier than what was popped last
          const Item early{{0.5 * now, 0, engines::StampKind::kCollision, 1, 2}};
          queue.push(early);
          expected.insert(content(early));
        }
      }
      if (k % 3 != 2 && !queue.empty()) {
        ASSERT_EQ(content(queue.front()), *expected.begin()) << "width " << width;
        now = queue.pop().key.time;
        expected.erase(expected.begin());
      }
      ASSERT_EQ(queue.size(), expected.size());
    }
  }
}

TEST(EventStamp, PutsCauseBeforeEffectWhereNoTimePasses) {
  // Body 5 is hit at t and, at t, hits body 1: the effect has the lower bodies.
  const engines::EventStamp cause{1.0, 0, engines::StampKind::kCollision, 5, 9},
      effect{1.0, 1, engines::StampKind::kCollision, 1, 5};
  EXPECT_LT(cause, effect);
  EXPECT_FALSE(effect < cause);
}

TEST(ActivePairs, AreThePairsOfOverlappingBoxesEachReportedOnce) {
  Random random(6);
  constexpr int kBodies = 150;
  engines::ActivePairs pairs(kBodies, 0.7);
  const auto random_box = [&](int body) {
    // some are wide
    const double size = body % 40 == 0 ? 30.0 : random.between(0.1, body % 7 == 0 ? 3.0 : 0.8);
    const Vector3d middle(random.between(-5, 5), random.between(-5, 5), random.between(-5, 5));
    return Box{middle - Vector3d::Constant(0.5 * size), middle + Vector3d::Constant(0.5 * size)};
  };
  for (int body = 0; body < kBodies; ++body) pairs.set_box(body, random_box(body));
  for (int round = 0; round < 20; ++round) {
    for (int moved = 0; moved < 60; ++moved) {
      const int body = static_cast<int>(random.below(kBodies));
      pairs.set_box(body, random_box(body));
    }
    for (int body = 0; body < kBodies; ++body) {
      std::multiset<int> found;
      pairs.for_each_partner(body, [&](int other) { found.insert(other); });
      std::multiset<int> expected;
      for (int other = 0; other < kBodies; ++other)
        if (other != body && pairs.box(body).overlaps(pairs.box(other))) expected.insert(other);
      ASSERT_EQ(found, expected) << "body " << body << ", round " << round;
    }
  }
}

TEST(ActivePairs, OfGridsThatShareBodiesKeepToTheirOwn) {
  Random random(7);
  constexpr int kBodies = 90, kGrids = 3;
  engines::ActivePairs::Entries entries(kBodies);
  std::vector<engines::ActivePairs> grids;
  for (int k = 0; k < kGrids; ++k) grids.emplace_back(entries, k, kBodies / kGrids, 0.7);
  std::vector<std::size_t> home(kBodies);
  for (int round = 0; round < 20; ++round) {
    for (int body = 0; body < kBodies; ++body) {
      const std::size_t next = random.below(kGrids);
      // no effect on the two grids that do not hold it
      for (engines::ActivePairs& grid : grids) grid.remove(body);
      ASSERT_FALSE(grids[home[static_cast<std::size_t>(body)]].holds(body));
      // some are wide
      const Vector3d middle(random.between(-2, 2), random.between(-2, 2), random.between(-2, 2)),
          half = Vector3d::Constant(body % 20 == 0 ? 15.0 : 0.5);
      grids[next].set_box(body, {middle - half, middle + half});
      home[static_cast<std::size_t>(body)] = next;
    }
    for (int body = 0; body < kBodies; ++body)
      for (std::size_t k = 0; k < kGrids; ++k) {
        std::multiset<int> found, expected;
        grids[k].for_each_in(grids[home[static_cast<std::size_t>(body)]].box(body),
                             [&](int other) { found.insert(other); });
        for (int other = 0; other < kBodies; ++other)
          if (home[static_cast<std::size_t>(other)] == k &&
              grids[k].box(body).overlaps(grids[k].box(other)))
            expected.insert(other);
        ASSERT_EQ(found, expected) << "body " << body << ", grid " << k << ", round " << round;
        ASSERT_EQ(grids[k].holds(body), home[static_cast<std::size_t>(body)] == k);
      }
  }
}

// The comparison names the first event that differs from the reference.
class TraceJudge : public ::testing::Test {
 protected:
  const Trajectory reference = run_by("ordered", sized("gas", 20, 2.0));
  Trajectory run = reference;
};

TEST_F(TraceJudge, IsSilentWhereTracesAreEqual) {
  ASSERT_GT(reference.events.size(), 20U);
  EXPECT_FALSE(engines::compare_traces(reference, run).has_value());
  EXPECT_EQ(engines::trace_hash(reference), engines::trace_hash(run));
}

TEST_F(TraceJudge, NamesAnImpulseThatIsOffByOneBit) {
  run.events[7].impulse = std::nextafter(run.events[7].impulse, 10.0);
  const auto parted = engines::compare_traces(reference, run);
  ASSERT_TRUE(parted.has_value());
  EXPECT_EQ(parted->index, 7U);
  EXPECT_NE(parted->story.find("event 8 of the committed trace"), std::string::npos)
      << parted->story;
  EXPECT_NE(parted->story.find("a state that had been rolled back"), std::string::npos)
      << parted->story;
  EXPECT_NE(engines::trace_hash(reference), engines::trace_hash(run));
}

TEST_F(TraceJudge, DistinguishesALostEventFromAnExtraOne) {
  run.events.pop_back();
  EXPECT_NE(engines::compare_traces(reference, run)->story.find("an event was lost"),
            std::string::npos);
  run = reference;
  run.events.insert(run.events.begin() + 4, run.events[9]);
  EXPECT_NE(engines::compare_traces(reference, run)->story.find("an event was not rolled back"),
            std::string::npos);
}

}  // namespace
}  // namespace tumble::testing
