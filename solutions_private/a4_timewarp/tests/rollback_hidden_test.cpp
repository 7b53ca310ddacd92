#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "framework/core/random.h"
#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

// The order of (A4.1), for expected values: no decision is judged by another of the same module.
bool before(const Stamp& x, const Stamp& y) {
  return std::tie(x.time, x.microstep, x.kind, x.body_a, x.body_b) <
         std::tie(y.time, y.microstep, y.kind, y.body_a, y.body_b);
}

struct History {
  std::vector<Effect> effects;
  std::vector<Rollback> first;
};

// Impacts at a few times, so that there are ties, among few bodies, so that there are loops; some
// on walls. One in eight is a callback of two bodies instead, one in eight the change of a group of
// three or fewer.
History random_history(Random& random, std::int32_t bodies, int impacts) {
  History history;
  for (int i = 0; i < impacts; ++i) {
    const double time = 0.125 * static_cast<double>(random.below(20));
    const std::int32_t a = static_cast<std::int32_t>(
                           random.below(static_cast<std::uint64_t>(bodies))),
                       b = static_cast<std::int32_t>(
                           random.below(static_cast<std::uint64_t>(bodies)));
    const std::uint32_t microstep = static_cast<std::uint32_t>(random.below(2));
    const std::uint64_t kind = random.below(8);
    if (kind < 2) {
      std::set<std::int32_t> processes{a, b};
      if (kind == 0)
        processes.insert(
            static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(bodies))));
      history.effects.push_back(
          {{time, microstep, kind == 0 ? WorkKind::kGroup : WorkKind::kCallback, *processes.begin(),
            -1},
           {processes.begin(), processes.end()}});
    } else if (a == b)
      history.effects.push_back({impact(time, a, 99, microstep), {a}});
    else
      history.effects.push_back({impact(time, std::min(a, b), std::max(a, b), microstep),
                                 {std::min(a, b), std::max(a, b)}});
  }
  for (int i = 0; i < 2; ++i) {
    const std::int32_t body =
        static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(bodies)));
    history.first.push_back(
        {body, impact(0.125 * static_cast<double>(random.below(20)), body, 98)});
  }
  return history;
}

// All pairs of a rollback and an effect, again and again until nothing changes.
std::vector<Rollback> by_fixed_point(const History& history) {
  std::map<std::int32_t, Stamp> back_to;
  const auto tell = [&](std::int32_t body, const Stamp& stamp) {
    const auto [known, is_new] = back_to.try_emplace(body, stamp);
    if (is_new) return true;
    if (!before(stamp, known->second)) return false;
    known->second = stamp;
    return true;
  };
  for (const Rollback& rollback : history.first) tell(rollback.body, rollback.stamp);
  for (bool changes = true; changes;) {
    changes = false;
    for (const Effect& effect : history.effects) {
      const bool is_undone =
          std::any_of(effect.processes.begin(), effect.processes.end(), [&](std::int32_t p) {
            return back_to.contains(p) && !before(effect.stamp, back_to.at(p));
          });
      if (!is_undone) continue;
      for (const std::int32_t p : effect.processes) changes = tell(p, effect.stamp) || changes;
    }
  }
  std::vector<Rollback> plan;
  for (const auto& [body, stamp] : back_to) plan.push_back({body, stamp});
  return plan;
}

TEST(PlanRollback, IsComplete) {
  Random random(431);
  for (int i = 0; i < 150; ++i) {
    const History history = random_history(random, 3 + i % 6, 2 + i % 17);
    expect_rollbacks(a4_module().plan_rollback(history.effects, history.first),
                     by_fixed_point(history),
                     {.scene = std::to_string(history.effects.size()) +
                               " effects drawn by lot among " + std::to_string(3 + i % 6) +
                               " bodies, two of which go back: " + show(history.first),
                      .slip = "after it, no body that stays may know of an impact that another has "
                              "forgotten; and no one goes back without need",
                      .handout = equation(8)});
  }
}

TEST(PlanRollback, OfALongChainIsQuick) {
  constexpr std::int32_t kBodies = 2000;
  std::vector<Effect> effects;
  for (std::int32_t i = 0; i + 1 < kBodies; ++i)
    effects.push_back({impact(1.0 + 0.001 * i, i, i + 1), {i, i + 1}});
  const std::vector<Rollback> found =
      a4_module().plan_rollback(effects, {back(0, impact(0.5, 0, 5000))});
  const Story story{
      .scene = "2,000 bodies in a row, each of which hit the next; the first goes back",
      .slip = "every body goes back once, to the impact that it received",
      .handout = equation(8)};
  expect_true(found.size() == kBodies, "2000 bodies", std::to_string(found.size()), story);
  if (found.size() == kBodies)
    expect_true(same(found.back(), back(kBodies - 1, effects.back().stamp)),
                show({back(kBodies - 1, effects.back().stamp)}), show({found.back()}), story);
}

TEST(AntiMessages, KeepTheOrderOfEffects) {
  Random random(432);
  for (int i = 0; i < 100; ++i) {
    const History history = random_history(random, 4, 12);
    const Rollback& rollback = history.first.front();
    std::vector<Rollback> expected;
    for (const Effect& effect : history.effects) {
      if (before(effect.stamp, rollback.stamp) ||
          std::find(effect.processes.begin(), effect.processes.end(), rollback.body) ==
              effect.processes.end())
        continue;
      for (const std::int32_t p : effect.processes)
        if (p != rollback.body) expected.push_back({p, effect.stamp});
    }
    expect_rollbacks(
        a4_module().anti_messages(history.effects, rollback), expected,
        {.scene = "12 effects drawn by lot among 4 bodies and walls; " + show({rollback}),
         .slip = "one message an effect and other process from the rollback on, in the order of "
                 "the effects",
         .handout = equation(7)});
  }
}

TEST(AfterRollback, OfRandomRollbacks) {
  Random random(433);
  for (int i = 0; i < 200; ++i) {
    const double safe = 0.125 * static_cast<double>(random.below(12)),
                 time = safe + 0.125 * static_cast<double>(random.below(4));
    const ScheduledEvent event =
        i % 3 == 0 ? group_check({A, C, D}, safe, time) : collision_check(A, C, safe, time);
    std::vector<Rollback> rollbacks;
    for (std::uint64_t k = random.below(4); k > 0; --k) {
      const std::int32_t body = static_cast<std::int32_t>(random.below(5));
      rollbacks.push_back(
          back(body, impact(0.125 * static_cast<double>(random.below(14)), body, 50)));
    }
    double r = kInfinity;
    for (const Rollback& rollback : rollbacks)
      if (std::find(event.receivers.begin(), event.receivers.end(), rollback.body) !=
          event.receivers.end())
        r = std::min(r, rollback.stamp.time);
    const bool moves = r < safe;
    expect_times(
        a4_module().after_rollback(event, rollbacks), event, moves ? r : safe, moves ? r : time,
        {.scene = show(event) + "; " + show(rollbacks),
         .slip = "the earliest time to which a receiver goes, if it is before the safe time",
         .handout = equation(9)});
  }
}

TEST(GlobalVirtualTime, OfRandomTimes) {
  Random random(434);
  for (int i = 0; i < 100; ++i) {
    std::vector<LocalTime> local_times;
    std::vector<ScheduledEvent> events{redraw(0.0)};
    double least = kInfinity;
    for (std::int32_t k = 0; k < 5; ++k) {
      local_times.push_back({k, random.between(1, 3)});
      const double safe = random.between(0.9, 3);
      events.push_back(collision_check(k, k + 1, safe, safe + random.between(0, 1)));
      least = std::min({least, local_times.back().time, safe});
    }
    const double found = a4_module().global_virtual_time(local_times, events);
    expect_true(found == least, show(least) + " s", show(found) + " s",
                {.scene = "five processes and five checks, times drawn by lot, and a redraw at 0 s",
                 .slip = "the least of all local times and all safe times",
                 .handout = equation(10)});
  }
}

TEST(StatesToPurge, OfRandomHistories) {
  Random random(435);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> times{0.25 * static_cast<double>(random.below(5))};
    for (int k = 0; k < 8; ++k)
      times.push_back(times.back() + 0.25 * static_cast<double>(random.below(3)));
    const double gvt = 0.25 * static_cast<double>(random.below(24));
    const auto earlier = static_cast<std::uint32_t>(
        std::count_if(times.begin(), times.end(), [&](double t) { return t < gvt; }));
    const std::uint32_t expected = earlier > 0 ? earlier - 1 : 0,
                        found = a4_module().states_to_purge(times, gvt);
    expect_true(found == expected, std::to_string(expected), std::to_string(found),
                {.scene = "nine states from " + show(times.front()) + " to " + show(times.back()) +
                          " s, some at one time; global virtual time " + show(gvt) +
                          " s, earlier than it are " + std::to_string(earlier),
                 .slip = "all but the last of those that are earlier",
                 .handout = equation(12)});
  }
}

}  // namespace
}  // namespace tumble::a4_testing
