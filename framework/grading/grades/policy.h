/// What a course's rules make of points: late days, penalties, attempts, groups, extensions, points
/// given by hand. Pure functions: the same rules and facts give the same points.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

enum class AttemptThatCounts { kBest, kLast };

/// The rules of one assignment.
struct Policy {
  std::int64_t due_s = 0;       // when it is due, seconds since 1970, UTC
  std::int64_t grace_s = 0;     // after `due_s`, without a consequence
  int free_late_days = 0;       // of each student, where the roster gives no other number
  double percent_a_day = 10.0;  // of the points reached, for each late day that is not free
  double cap_percent = 50.0;    // no penalty is higher
  AttemptThatCounts attempt = AttemptThatCounts::kBest;
  bool groups = false;  // an attempt of one member counts for all members of a group
};

/// Points that a person gives instead of the tests, and what for.
struct PointsByHand {
  double points = 0.0;
  std::string why;
};

/// A student of the roster, with what is different for this one.
struct Person {
  std::string name, id, group;        // group may be empty
  std::optional<int> free_late_days;  // left to this student; empty: the policy's
  // an extension; empty: the policy's [s since 1970, UTC]
  std::optional<std::int64_t> due_s = std::nullopt;
  std::optional<PointsByHand> by_hand = std::nullopt;
};

/// When a submission was handed in, and by whom.
struct HandIn {
  std::string submission;   // name of its folder or file
  std::string student;      // name or id in the roster; empty: as the submission is called
  std::int64_t time_s = 0;  // seconds since 1970, UTC
};

/// Days that a submission is late: 0 until the end of grace, then every day begun since it was due.
int late_days(const Policy& policy, std::int64_t handed_in_s);

/// @param days  late, >= 0
/// @param free  days that cost nothing, >= 0
/// @return percent of the points that are lost: in [0, cap_percent], never less for more days
double penalty_percent(const Policy& policy, int days, int free);

/// @param percent  in [0, 100]
/// @return points that are left, in [0, points]
double points_after(double points, double percent);

/// What a student gets, and why.
struct Standing {
  Person person;
  bool is_in_roster = true;
  std::string submission, folder;  // that counts; empty: none
  std::size_t attempts = 0;
  bool is_time_known = false;
  int late_days = 0, free_days = 0;  // free_days: of them, those that cost nothing
  std::optional<double> before;      // points before the rules; empty: no score
  double percent = 0.0;              // penalty
  std::optional<double> after;       // points after the rules; empty: somebody has to decide
  std::string why;
};

/// One standing a person of the roster, in its order, then one for each submission of nobody in it.
/// Nobody gets 0 points for want of a submission, of a time or of an entry: these have no score,
/// and `why` says so. A submission of unknown time has no penalty. Points by hand are what is left
/// after all rules; `why` says them with what the rules would give.
std::vector<Standing> apply_policy(const Policy& policy, const std::vector<Person>& roster,
                                   const std::vector<HandIn>& hand_ins,
                                   const std::vector<Grade>& grades);

}  // namespace tumble::grading
