/// The files that a grade is written to: for Gradescope, for Canvas, and our own record of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/grade.h"

namespace tumble::grading {

/// results.json for Gradescope (autograder specification of May 2023). Hidden tests show after grades are published.
/// No time stands in it: the same submission and the same grader give the same bytes.
std::string gradescope_json(const Grade& grade);

/// gradebook.csv for Canvas: Student, ID, SIS Login ID, Section, the assignment; then a row of points possible, then the
/// students. A grade that is not final is blank, which Canvas reads as "no score".
std::string gradebook_csv(const std::string& assignment_title, const std::vector<Grade>& grades);

/// What a grade was made from, so that an unchanged one need not be made again.
struct GradeKey {
  std::string submission;   // digest of source, problem and notes
  std::string grader;       // digest of judge, worker, tests, rubric, headers, compiler
  std::string pictures;     // digest of scenes and options; empty: without pictures
};

/// record.json: the whole grade, with its key and the digest of results.json.
std::string record_json(const Grade& grade, const GradeKey& key, const std::string& results_digest);

struct GradeRecord {
  Grade grade;
  GradeKey key;
  std::string results_digest;
};
/// @return empty where there is none, or it cannot be understood: then the grade is made again
std::optional<GradeRecord> read_record(const std::filesystem::path& file);

/// ledger.json over all.
std::string ledger_json(const std::string& id, const std::vector<GradeRecord>& records);

}  // namespace tumble::grading
