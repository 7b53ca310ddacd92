/// The files that a grade is written to: for Gradescope, for Canvas, and our own record of it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// results.json for Gradescope (autograder specification of May 2023). Hidden tests show after grades are published.
/// No time stands in it: the same submission and the same grader give the same bytes.
std::string gradescope_json(const Grade& grade);

/// gradebook.csv for Canvas: Student, ID, SIS Login ID, Section, the assignment; then a row of points possible, then the
/// students. A grade that is not final, or of a file that was not found, is blank, which Canvas reads as "no score".
std::string gradebook_csv(const std::string& assignment_title, const std::vector<Grade>& grades);

/// record.json: the whole grade with its key, and the digest of every other file of its folder.
struct GradeRecord {
  Grade grade;
  GradeKey key;
  std::string assignment;                       // "a1"
  std::map<std::string, std::string> files;     // path in the folder -> digest
};

/// @param machine_key  what the record is signed with: its field "mac" is the HMAC-SHA-256 of all the rest
std::string record_json(const GradeRecord& record, const std::string& machine_key);

/// What an earlier run left in a submission's folder.
struct EarlierRun {
  std::optional<GradeRecord> record;   // only where it is signed by this key, for this assignment and folder, and no file has changed
  std::string problem;                 // why it is not trusted; empty where it is, or where there is none
};
EarlierRun read_earlier_run(const std::filesystem::path& folder, const std::string& assignment, const std::string& machine_key);

/// Digests of all files of a folder but record.json, by path.
std::map<std::string, std::string> digests_below(const std::filesystem::path& folder);

/// results.json, index.html and record.json of a grade, into its folder; what its pictures are is there already.
void write_grade(const modules::ModuleKind& kind, const Grade& grade, const GradeKey& key, const std::filesystem::path& folder, const std::string& machine_key);

/// ledger.json over all.
std::string ledger_json(const std::string& id, const std::vector<GradeRecord>& records);

}  // namespace tumble::grading
