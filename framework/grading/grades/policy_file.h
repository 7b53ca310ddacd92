/// Reads a course's rules: policy.json, and the tables that it names.
///
///   {
///     "due": {"a1": "2026-10-12T23:59:00+02:00"},
///     "roster": "roster.csv",        name,id,group,late_days   (the last two may be left out)
///     "handed_in": "handed_in.csv",  submission,student,time   (student may be left out)
///     "grace_minutes": 15, "free_late_days": 2,
///     "penalty_percent_a_day": 10, "penalty_cap_percent": 50,
///     "attempt": "best", "groups": false
///   }
///
/// "due" and "roster" are needed; the others have the values of Policy. Paths are relative to the
/// policy. Times are ISO 8601 with their offset from UTC ("Z" for none).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/policy.h"

namespace tumble::grading {

struct PolicyFile {
  Policy policy;
  std::vector<Person> roster;
  std::vector<HandIn> hand_ins;
};

/// @throws UserError that names file, line or field, and what was expected: an unknown field, a
///   number outside its range, a person twice, an assignment without a due date
PolicyFile read_policy(const std::filesystem::path& file, const std::string& assignment);

/// Seconds since 1970, UTC, of "2026-10-12T23:59:00+02:00" or "2026-10-12T21:59:00Z".
/// @return empty where the text is no such time
std::optional<std::int64_t> time_of(const std::string& text);

/// The rows of a table with commas between cells, or semicolons where the first line has these and
/// no comma, as spreadsheets write it where a comma is in numbers; a cell in double quotes may hold
/// commas, line breaks, and quotes written twice. Lines without a character are left out.
std::vector<std::vector<std::string>> csv_rows(const std::string& text);

}  // namespace tumble::grading
