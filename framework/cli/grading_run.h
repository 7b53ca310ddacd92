/// One grading of a folder of submissions, as `grade` and `regrade` ask for it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/cli/verb.h"
#include "framework/grading/grades/grade.h"

namespace tumble::cli {

struct GradingRequest {
  std::string id;                     // of the assignment
  std::filesystem::path folder, out;  // of submissions, of results
  std::string sandbox;                // a kind; empty: the strongest
  std::filesystem::path policy;       // policy.json; empty: none
  grading::GradeOptions options;      // progress and notice are set by run_grading
  // what runs before this process grades, such as shards on other machines; may be empty
  std::function<void(std::size_t submissions, const grading::GradeOptions& options)> before = {};
};

/// Cores of this machine: submissions graded at a time, unless the user says otherwise.
int default_jobs();

/// Grades, with progress on stderr, and writes every file of the folder of results. Sets the exit
/// code of `context` where a score or a page is missing.
/// @throws UserError as grade_submissions
std::vector<grading::Grade> run_grading(Context& context, const GradingRequest& request);

/// The tests that changed, a line each, indented.
void print_changes(const std::vector<grading::TestChange>& changes, std::size_t indent);

}  // namespace tumble::cli
