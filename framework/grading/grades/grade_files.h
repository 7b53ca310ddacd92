/// The files of a grade: for Gradescope, for Canvas, and the grader's own record.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// results.json for Gradescope (autograder specification of May 2023). Hidden tests are visible
/// after grades are published. It contains no times: the same submission and the same grader give
/// the same bytes.
std::string gradescope_json(const Grade& grade);

/// gradebook.csv for Canvas: Student, ID, SIS Login ID, Section, the assignment; then a row of
/// points possible, then the students. A grade without a score is blank, which Canvas reads as "no
/// score".
std::string gradebook_csv(const std::string& assignment_title, const std::vector<Grade>& grades);

/// A cell of a CSV file: one line, quoted if necessary, and never a formula.
std::string csv_cell(const std::string& raw);
/// The cell of a student's name, which is never read as the row of points possible.
std::string csv_name(const std::string& name);

/// record.json: the grade with its key, and the digests of digests_below().
struct GradeRecord {
  Grade grade;
  GradeKey key;
  std::string assignment;                    // "a1"
  std::map<std::string, std::string> files;  // path in the folder -> digest
};

/// @param machine_key  signs the record: its field "mac" is the HMAC-SHA-256 of all other fields
std::string record_json(const GradeRecord& record, const std::string& machine_key);

/// Results of an earlier run in a submission's folder.
struct EarlierRun {
  // only if it is signed by this key, for this assignment and folder, and no file has changed
  std::optional<GradeRecord> record;
  std::string problem;  // why it is not trusted; empty if it is, or if there is none
};
EarlierRun read_earlier_run(const std::filesystem::path& folder, const std::string& assignment,
                            const std::string& machine_key);

/// Digests of all files of a folder, by path, but of record.json and of the handout, which is put
/// there last and is everybody's.
std::map<std::string, std::string> digests_below(const std::filesystem::path& folder);

/// Writes results.json, index.html and record.json of a grade into its folder, which already has
/// its pictures. A page that cannot be made says so, and is a fault of the record.
/// @param laws  without a script: its code does not run in its pages
void write_grade(const modules::ModuleKind& kind, const Grade& grade, const GradeKey& key,
                 const std::filesystem::path& folder, const std::string& machine_key,
                 const PageLaws& laws = {});

}  // namespace tumble::grading
