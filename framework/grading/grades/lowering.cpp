#include "framework/grading/grades/lowering.h"

#include <fmt/format.h>

#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

bool is_lower(const GradeRecord& now, double score, const std::string& submission,
              bool guards_changed_files) {
  if (!now.grade.is_final()) return false;
  if (!guards_changed_files && submission != now.key.submission) return false;
  return !now.grade.has_score() || now.grade.score < score;
}

}  // namespace

bool lowers_earlier(const GradedWork& work, const GradeRecord& now, bool guards_changed_files) {
  const std::optional<GradeRecord>& old = work.earlier.record;
  return old && old->grade.has_score() &&
         is_lower(now, old->grade.score, old->key.submission, guards_changed_files);
}

Placing placing_of(const GradedWork& work, const GradeRecord& now, const Standards& standards) {
  const LedgerScore* last = standards.in_ledger;
  const bool guards = standards.guards_changed_files;
  if (now.grade.is_final())
    return lowers_earlier(work, now, guards) ||
                   (last && is_lower(now, last->score, last->submission, guards))
               ? Placing::kAsk
               : Placing::kNew;
  const std::optional<GradeRecord>& old = work.earlier.record;
  if (old)
    return old->grade.is_final() && old->key.submission == now.key.submission ? Placing::kEarlier
                                                                              : Placing::kNew;
  return standards.is_place_taken && last && last->submission == now.key.submission
             ? Placing::kUntouched
             : Placing::kNew;
}

std::string change_from_ledger(const GradedWork& work, const Grade& now, const LedgerScore& last) {
  const bool is_lost = work.earlier.problem.empty() && !work.earlier.record;
  return fmt::format("{0} -> {1}: the ledger holds {0}, and {2}", points_text(last.score),
                     now.has_score() ? points_text(now.score) : "none",
                     is_lost ? "the result itself is missing"
                     : work.earlier.problem.empty()
                         ? "the result in place is another one"
                         : "that result does not count: " + work.earlier.problem);
}

GradeRecord held_record(const GradedWork& work, const std::string& id, const Rubric& rubric,
                        const std::string& change) {
  GradeRecord record = fault_record(
      work, id, rubric, "This result is missing. There is no score until somebody decides.");
  record.grade.is_held = true;
  record.grade.change = change;
  return record;
}

}  // namespace tumble::grading
