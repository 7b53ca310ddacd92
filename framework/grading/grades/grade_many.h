/// Grades submissions: compiled and judged in the sandbox, each with its results.json and page; a gradebook and an index over all.
///
///   OUT/index.html                 every submission with its score
///   OUT/gradebook.csv              for Canvas: blank where the grader failed or found no file, so that no old score is lowered
///   OUT/ledger.json                what was graded with what: digests of submission, grader and result; what a regrade changed
///   OUT/NAME/index.html            scores, stories, pictures
///   OUT/NAME/results.json          in Gradescope's format
///   OUT/NAME/record.json           the ledger's entry, signed by this machine's key (machine_key.h): an earlier run counts only so
///   OUT/NAME/media/...             SCENE.png, SCENE.mp4, SCENE.html (plays the run)
///   OUT/times.json                 how long things took; the one file that differs between two equal runs
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// Grades all into `out`. Can be ended at any time and started again: what is done and unchanged is taken over.
/// @pre  this process runs no thread: it forks
/// @return in the order of the submissions
/// @throws UserError as OutputFolder, CourseSnapshot and require_rubric_of_judge do, before anything is written
std::vector<Grade> grade_submissions(const Course& course, const std::string& id, const FoundSubmissions& submissions,
                                     const std::filesystem::path& out, const GradeOptions& options = {});

}  // namespace tumble::grading
