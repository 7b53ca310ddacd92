/// What becomes of a new result: it is put in place, or an earlier one stays, or a person is asked.
///
/// A person is asked where the score of an unchanged file would become lower than that of the
/// earlier result, or than the last one in the ledger, which keeps a score whose result was lost,
/// changed, put back from an older copy or signed by a key that was lost.
#pragma once

#include <string>

#include "framework/grading/grades/batch_work.h"

namespace tumble::grading {

enum class Placing {
  kNew,      // the new result is put in place
  kAsk,      // it would lower a score: a person is asked
  kEarlier,  // it is not final, and the earlier result of the same file is: that one stays
  // It is not final, and the ledger has a score of the same file, whose result lies in place and
  // does not count: what lies there stays, and there is no score.
  kUntouched,
};

/// What a new result is compared with.
struct Standards {
  const LedgerScore* in_ledger = nullptr;  // the folder's last score; null: none
  bool guards_changed_files = false;       // a person is asked also where the file changed
  bool is_place_taken = false;             // something lies in place
};

/// @param work  its `earlier` is the result that counted before; without a record: none did
Placing placing_of(const GradedWork& work, const GradeRecord& now, const Standards& standards);

/// Whether the new result has a lower score than the earlier one, or none, where a person is asked.
bool lowers_earlier(const GradedWork& work, const GradeRecord& now, bool guards_changed_files);

/// "10 -> 0: the ledger holds 10, and the result itself is missing"
std::string change_from_ledger(const GradedWork& work, const Grade& now, const LedgerScore& last);

/// What is put in place where a result is missing and the new one waits for an answer: no score,
/// marked as held, so that it never counts as a result. Students see that it is missing, and no
/// more.
GradeRecord held_record(const GradedWork& work, const std::string& id, const Rubric& rubric,
                        const std::string& change);

}  // namespace tumble::grading
