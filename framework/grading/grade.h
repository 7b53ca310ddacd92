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
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/cost_section.h"
#include "framework/grading/course.h"
#include "framework/grading/media.h"
#include "framework/grading/verdict.h"

namespace tumble::grading {

/// What stands to be graded.
struct Submission {
  std::string name;                    // shown to people; any bytes
  std::filesystem::path source;        // the file that implements the module's header; empty where `problem` says why
  std::string problem;                 // for the grader: why there is nothing to compile; empty: there is
  std::vector<std::string> notes;      // what was odd but not in the way
  std::string student_id = {};         // Canvas's number of the student, where the file's name has it
};

/// What lies in a folder of submissions.
struct FoundSubmissions {
  std::filesystem::path folder;
  std::vector<Submission> all;         // by name
  std::vector<std::string> passed_over;   // entries that are no submission, each with the reason; what every such folder holds is left out
};

/// One submission a sub-folder, or a file where Canvas has put them flat (STUDENT_ID_ID_FILE.cpp). Symbolic links are not followed.
/// Never throws for what a folder holds.
/// @throws UserError when `folder` is no folder or holds no submission
FoundSubmissions find_submissions(const std::filesystem::path& folder, const modules::ModuleKind& kind);

/// A test of the rubric, as it went.
struct ScoredTest {
  RubricItem item;
  TestResult result;
  double score = 0.0;
};

enum class GradeState {
  kJudged,
  kNothingToCompile,   // Submission::problem
  kDoesNotCompile,
  kGraderFault,        // ours: the score says nothing
};

/// What a grade was made from, as digests, so that an unchanged one need not be made again.
struct GradeKey {
  std::string submission;   // source, problem and notes
  std::string judging;      // judge, worker, tests, headers, compiler, time: what decides a verdict
  std::string rubric;       // points, levels and titles
  std::string pictures;     // scenes and options; empty: without pictures
};

/// A test of which an earlier run of the same submission's folder said something else.
struct TestChange {
  std::string test, title;
  std::string before, after;         // "wrong, 0 of 5"
  std::string reason;                // "the submission changed"
};

struct Grade {
  std::string name;                  // of the submission
  std::string folder;                // below OUT: the name, made safe for a path
  GradeState state = GradeState::kGraderFault;
  std::string story;                 // the compiler's words, or what else was in the way; empty when judged
  std::vector<std::string> notes;
  std::vector<ScoredTest> tests;     // in the rubric's order
  std::vector<SceneMedia> media;
  CostSection cost;                  // on the page only, not in the record
  double score = 0.0, possible = 0.0;
  bool taken_over = false;           // nothing had changed since an earlier run: its results stand
  std::string change;                // "80 -> 85: the tests changed"; empty where there was no other result before
  std::vector<TestChange> changes;   // test by test
  std::vector<std::string> remarks;  // for the grader alone: what names other submissions
  std::string student_id;            // as of the submission

  /// No test of it ended in a fault of the grader, or because the machine was too busy.
  bool is_final() const;
  /// A number that a gradebook may hold: final, and of a file that was found.
  bool has_score() const { return is_final() && state != GradeState::kNothingToCompile; }
};

struct GradeProgress {
  std::size_t done = 0, total = 0;
  std::string finished;              // name of the submission that has just been finished; may be empty
  double left_s = 0.0;               // time left, estimated; negative: not known yet
};

struct GradeOptions {
  double budget_s = 60.0;            // for all tests of a submission together: TimeBudget
  int jobs = 1;                      // submissions at the same time, each in a process of its own
  bool media = true;
  MediaOptions media_options;
  std::vector<std::filesystem::path> scenes;   // empty: the assignment's demo scenes
  std::function<void(const GradeProgress&)> progress;
  std::function<void(const std::string&)> notice;   // a sentence for the person at the terminal; may be empty
};

/// Grades one submission in this process; makes its pictures in `folder` and writes nothing else there.
/// @return never a partial grade: what could not be judged is kGraderFault
/// @throws UserError when the pictures cannot be written
Grade grade_submission(const Course& course, const std::string& id, const Submission& submission, const std::filesystem::path& folder,
                       const GradeOptions& options = {});

/// The points of an earlier run's verdicts under another rubric.
/// @return empty where the rubric names a test that the earlier run has no verdict on: then it must be run again
std::optional<Grade> graded_by(const Rubric& rubric, Grade earlier);

/// Grades all into `out`. Can be ended at any time and started again: what is done and unchanged is taken over.
/// @pre  this process runs no thread: it forks
/// @return in the order of the submissions
/// @throws UserError as OutputFolder, CourseSnapshot and require_rubric_of_judge do, before anything is written
std::vector<Grade> grade_submissions(const Course& course, const std::string& id, const FoundSubmissions& submissions,
                                     const std::filesystem::path& out, const GradeOptions& options = {});

}  // namespace tumble::grading
