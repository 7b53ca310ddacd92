/// Grades submissions: each is compiled and judged in the sandbox and gets a results.json and a
/// page; a gradebook and an index are over all.
///
///   OUT/index.html                 every submission with its score
///   OUT/gradebook.csv              for Canvas: blank if the grader failed or found no file, so
///   that no old score is lowered
///   OUT/ledger.jsonl               every result that was ever put here, as a chain of digests
///   (ledger.h); changes by a regrade
///   OUT/NAME/index.html            scores, stories, pictures
///   OUT/NAME/results.json          in Gradescope's format
///   OUT/NAME/record.json           the ledger's entry, signed by this machine's key
///   (machine_key.h), without which an earlier run does not count
///   OUT/NAME/media/...             SCENE.png, SCENE.mp4, SCENE.html (plays the run)
///   OUT/times.json                 durations; the only file that differs between two equal runs
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// Grades all into `out`. It can be interrupted at any time and started again: finished and
/// unchanged results are reused.
/// @pre  this process has no threads, because it forks
/// @return in the order of the submissions
/// @throws UserError as OutputFolder, CourseSnapshot and require_rubric_of_judge, before anything
///   is written
std::vector<Grade> grade_submissions(const Course& course, const std::string& id,
                                     const FoundSubmissions& submissions,
                                     const std::filesystem::path& out,
                                     const GradeOptions& options = {});

}  // namespace tumble::grading
