#include "framework/grading/grades/ledger_records.h"

#include "framework/core/version.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {

LedgerEntry ledger_entry_of(const GradeRecord& record, const std::string& compiler) {
  const Grade& grade = record.grade;
  const auto results = record.files.find("results.json");
  LedgerEntry entry;
  entry.assignment = record.assignment;
  entry.name = plain_name(grade.name);
  entry.folder = grade.folder;
  entry.submission = record.key.submission;
  entry.judging = record.key.judging;
  entry.rubric = record.key.rubric;
  entry.version = kProgramVersion;
  entry.compiler = compiler;
  entry.sandbox = grade.sandbox;
  entry.is_official = grade.is_official;
  entry.is_final = grade.is_final();
  entry.results = results == record.files.end() ? "missing" : results->second;
  if (grade.has_score()) entry.score = grade.score;
  entry.change = grade.change;
  entry.changes = grade.changes;
  return entry;
}

bool is_older_than_ledger(const GradeRecord& record, const LedgerScore* last) {
  return last && record.grade.has_score() && last->submission == record.key.submission &&
         record.grade.score < last->score;
}

}  // namespace tumble::grading
