#include "framework/grading/grades/policy.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

constexpr std::int64_t kDay_s = 24 * 60 * 60;

// A submission with the student whose it is.
struct Attempt {
  const Grade* grade = nullptr;
  const HandIn* hand_in = nullptr;  // none: its time is unknown
  std::size_t person = 0;           // in the roster; its size: nobody there
};

std::size_t person_called(const std::vector<Person>& roster, const std::string& word) {
  for (std::size_t i = 0; i < roster.size(); ++i)
    if (!word.empty() && (roster[i].id == word || roster[i].name == word)) return i;
  return roster.size();
}

std::vector<Attempt> attempts_of(const std::vector<Person>& roster,
                                 const std::vector<HandIn>& hand_ins,
                                 const std::vector<Grade>& grades) {
  std::map<std::string, const HandIn*> by_submission;
  for (const HandIn& hand_in : hand_ins) by_submission[hand_in.submission] = &hand_in;
  std::vector<Attempt> attempts;
  for (const Grade& grade : grades) {
    Attempt attempt{&grade, nullptr, roster.size()};
    const auto it = by_submission.find(grade.name);
    if (it != by_submission.end()) attempt.hand_in = it->second;
    if (attempt.hand_in && !attempt.hand_in->student.empty())
      attempt.person = person_called(roster, attempt.hand_in->student);
    else if (attempt.person = person_called(roster, grade.student_id);
             attempt.person == roster.size())
      attempt.person = person_called(roster, grade.name);
    attempts.push_back(attempt);
  }
  return attempts;
}

std::string reason_of(const Standing& standing) {
  std::string why;
  if (standing.attempts > 1)
    why = fmt::format("{} of {} attempts counts; ", plain_name(standing.submission),
                      standing.attempts);
  if (!standing.is_time_known) return why + "the time of handing in is unknown: no penalty";
  if (standing.late_days == 0)
    return why + (standing.person.due_s ? "in time, by an extension" : "in time");
  why += fmt::format("{} day{} late{}", standing.late_days, standing.late_days == 1 ? "" : "s",
                     standing.person.due_s ? " after an extension" : "");
  if (standing.free_days > 0) why += fmt::format(", {} of them free", standing.free_days);
  return why + (standing.percent > 0.0 ? fmt::format(": -{} %", points_text(standing.percent))
                                       : std::string(": no penalty"));
}

Standing standing_of(const Policy& policy, const Person& person, const Attempt& attempt) {
  Standing standing;
  standing.person = person;
  standing.submission = attempt.grade->name;
  standing.folder = attempt.grade->folder;
  standing.attempts = 1;
  if (attempt.hand_in) {
    standing.is_time_known = true;
    Policy own = policy;
    own.due_s = person.due_s.value_or(policy.due_s);
    standing.late_days = late_days(own, attempt.hand_in->time_s);
    standing.free_days =
        std::min(standing.late_days, person.free_late_days.value_or(policy.free_late_days));
    standing.percent = penalty_percent(policy, standing.late_days, standing.free_days);
  }
  if (!attempt.grade->has_score()) return standing;
  standing.before = attempt.grade->score;
  standing.after = points_after(attempt.grade->score, standing.percent);
  return standing;
}

bool counts_more(const Policy& policy, const Attempt& a, const Standing& sa, const Attempt& b,
                 const Standing& sb) {
  if (policy.attempt == AttemptThatCounts::kBest) return sa.after > sb.after;
  const auto time = [](const Attempt& x) { return x.hand_in ? x.hand_in->time_s : INT64_MIN; };
  return time(a) > time(b);
}

Standing best_of(const Policy& policy, const Person& person, const std::vector<Attempt>& attempts) {
  Standing chosen;
  chosen.person = person;
  chosen.why = "nothing was handed in: no score, somebody has to decide";
  const auto timeless = std::find_if(attempts.begin(), attempts.end(),
                                     [](const Attempt& attempt) { return !attempt.hand_in; });
  if (policy.attempt == AttemptThatCounts::kLast && attempts.size() > 1 &&
      timeless != attempts.end()) {
    chosen.submission = timeless->grade->name;
    chosen.folder = timeless->grade->folder;
    chosen.attempts = attempts.size();
    chosen.why = fmt::format(
        "{} has no time, so which of {} attempts is the last is unknown: no score, add its row to "
        "the file of times",
        plain_name(chosen.submission), attempts.size());
    return chosen;
  }
  const Attempt* counted = nullptr;
  for (const Attempt& attempt : attempts) {
    // A result that may still change leaves open which attempt counts.
    if (attempt.grade->is_held) {
      chosen = standing_of(policy, person, attempt);
      chosen.attempts = attempts.size();
      chosen.why = plain_name(chosen.submission) +
                   " would be lower than in the ledger: no score until tumble regrade is answered";
      return chosen;
    }
    if (!attempt.grade->is_final()) {
      chosen = standing_of(policy, person, attempt);
      chosen.attempts = attempts.size();
      chosen.why = plain_name(chosen.submission) + " has no final result: grade it again";
      return chosen;
    }
    if (counted && !attempt.grade->has_score()) continue;
    const Standing standing = standing_of(policy, person, attempt);
    if (counted && chosen.before && !counts_more(policy, attempt, standing, *counted, chosen))
      continue;
    chosen = standing;
    counted = &attempt;
  }
  if (!counted) return chosen;
  chosen.attempts = attempts.size();
  chosen.why =
      chosen.before ? reason_of(chosen) : "no file was found to grade: no score, somebody decides";
  return chosen;
}

Standing with_points_by_hand(Standing standing) {
  const std::optional<PointsByHand>& given = standing.person.by_hand;
  if (!given) return standing;
  standing.why = fmt::format(
      "{} points by hand, {}; {}{}", points_text(given->points), plain_name(given->why),
      standing.after ? fmt::format("the rules give {}: ", points_text(*standing.after)) : "",
      standing.why);
  standing.after = given->points;
  return standing;
}

Standing of_nobody(const Attempt& attempt) {
  Standing standing;
  standing.person.name = attempt.grade->name;
  standing.person.id = attempt.grade->student_id;
  standing.is_in_roster = false;
  standing.submission = attempt.grade->name;
  standing.folder = attempt.grade->folder;
  standing.attempts = 1;
  if (attempt.grade->has_score()) standing.before = attempt.grade->score;
  standing.why =
      attempt.hand_in && !attempt.hand_in->student.empty()
          ? "its student, " + plain_name(attempt.hand_in->student) + ", is not in the roster"
          : "not in the roster: add a name or an id, or a row to the file of times";
  return standing;
}

}  // namespace

int late_days(const Policy& policy, std::int64_t handed_in_s) {
  const std::int64_t late_s = handed_in_s - policy.due_s;
  if (late_s <= policy.grace_s || late_s <= 0) return 0;
  return static_cast<int>((late_s + kDay_s - 1) / kDay_s);
}

double penalty_percent(const Policy& policy, int days, int free) {
  const int counted = std::max(0, days - std::max(0, free));
  return std::clamp(policy.percent_a_day * counted, 0.0,
                    std::clamp(policy.cap_percent, 0.0, 100.0));
}

double points_after(double points, double percent) {
  const double left = points * (100.0 - std::clamp(percent, 0.0, 100.0)) / 100.0;
  return std::clamp(left, 0.0, std::max(0.0, points));  // rounding may exceed `points`
}

std::vector<Standing> apply_policy(const Policy& policy, const std::vector<Person>& roster,
                                   const std::vector<HandIn>& hand_ins,
                                   const std::vector<Grade>& grades) {
  const std::vector<Attempt> attempts = attempts_of(roster, hand_ins, grades);
  std::vector<Standing> standings;
  for (std::size_t i = 0; i < roster.size(); ++i) {
    std::vector<Attempt> own;
    for (const Attempt& attempt : attempts) {
      if (attempt.person == roster.size()) continue;
      const bool shares = policy.groups && !roster[i].group.empty() &&
                          roster[attempt.person].group == roster[i].group;
      if (attempt.person == i || shares) own.push_back(attempt);
    }
    standings.push_back(with_points_by_hand(best_of(policy, roster[i], own)));
  }
  for (const Attempt& attempt : attempts)
    if (attempt.person == roster.size()) standings.push_back(of_nobody(attempt));
  return standings;
}

}  // namespace tumble::grading
