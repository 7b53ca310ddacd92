/// What the tests of a4 share: events and effects in few words, and words for what was found.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assignments/a4_timewarp/a4_timewarp.h"
#include "framework/modules/under_test.h"
#include "tests/support/story.h"

namespace tumble::a4_testing {

using namespace tumble::testing;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The doubles next to a time: virtual times are compared as they are, without any margin.
inline double just_before(double time) { return std::nextafter(time, -kInfinity); }
inline double just_after(double time) { return std::nextafter(time, kInfinity); }

// Bodies of stories, by number.
inline constexpr std::int32_t A = 0, B = 1, C = 2, D = 3, E = 4, kWall = 9;

/// The module under test, whichever of its three bodies is behind it.
inline const a4::Module& a4_module() { return modules::under_test<a4::Module>(); }

/// Handout anchor of equation (A4.n).
inline std::string equation(int n) { return "handouts/a4_timewarp.md#eq-a4-" + std::to_string(n); }

// ---- Events in few words -----------------------------------------------------------------------

inline Stamp impact(double time, std::int32_t a, std::int32_t b, std::uint32_t microstep = 0) {
  return {time, microstep, WorkKind::kCollision, a, b};
}
/// @param receivers  empty: both bodies
ScheduledEvent collision_check(std::int32_t a, std::int32_t b, double safe_time, double time,
                               std::vector<std::int32_t> receivers = {});
ScheduledEvent group_check(std::vector<std::int32_t> members, double safe_time, double time);
ScheduledEvent callback(std::int32_t body, double time);
ScheduledEvent redraw(double time);
/// An impact that was worked at. @param processes  empty: both bodies
Effect effect(double time, std::int32_t a, std::int32_t b,
              std::vector<std::int32_t> processes = {});
/// A body back to before the impact of two others, or of itself and another.
inline Rollback back(std::int32_t body, const Stamp& stamp) { return {body, stamp}; }

// ---- Words -------------------------------------------------------------------------------------

bool same(const Stamp& x, const Stamp& y);
bool same(const Rollback& x, const Rollback& y);
std::string name_of(std::int32_t body);
std::string show(const Stamp& stamp);
std::string show(const ScheduledEvent& event);
std::string show(const std::vector<Rollback>& rollbacks);
std::string show(const std::vector<std::vector<std::int32_t>>& groups);
using testing::show;

/// The same rollbacks in the same order.
void expect_rollbacks(const std::vector<Rollback>& found, const std::vector<Rollback>& expected,
                      const Story& story);
/// The two times that a decision may change; the rest must be as it was.
void expect_times(const ScheduledEvent& found, const ScheduledEvent& before, double safe_time,
                  double time, const Story& story);

}  // namespace tumble::a4_testing
