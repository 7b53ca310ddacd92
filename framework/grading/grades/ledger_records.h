/// What a ledger and a record of the same folder have to do with each other.
#pragma once

#include <string>

#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/ledger.h"

namespace tumble::grading {

/// An entry for a record that lies in place.
LedgerEntry ledger_entry_of(const GradeRecord& record, const std::string& compiler);

/// Why a record is not trusted that is_older_than_ledger.
inline constexpr const char* kOlderThanLedger =
    "it is older than the ledger's last score of the same file";

/// Whether a record is an earlier one that was put back: the ledger holds a higher score of the
/// same submission. A score that somebody agreed to lower is the ledger's last one.
/// @param last  of the record's folder; null: none
bool is_older_than_ledger(const GradeRecord& record, const LedgerScore* last);

}  // namespace tumble::grading
