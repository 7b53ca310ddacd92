/// Grades submissions: compiled and judged in the sandbox, each with its results.json and page; a gradebook and an index over all.
///
///   OUT/index.html                 every submission with its score
///   OUT/gradebook.csv              for Canvas: blank where the grader failed, so that no old score is lowered
///   OUT/ledger.json                what was graded with what: digests of submission, grader and result
///   OUT/NAME/index.html            scores, stories, pictures
///   OUT/NAME/results.json          in Gradescope's format
///   OUT/NAME/record.json           the ledger's entry; written last, so a folder that has it is whole
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
};

/// One submission a sub-folder, sorted by name. Symbolic links are not followed. Never throws for what a folder holds.
/// @throws UserError when `folder` is no folder or holds no sub-folder
std::vector<Submission> find_submissions(const std::filesystem::path& folder, const modules::ModuleKind& kind);

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
  std::string change;                // "80 -> 85: the grader changed"; empty where there was no other result before

  /// No test of it ended in a fault of the grader.
  bool is_final() const;
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
};

/// Grades one submission into `folder` (made anew), in this process.
/// @return never a partial grade: what could not be judged is kGraderFault
/// @throws UserError when the files cannot be written
Grade grade_submission(const Course& course, const std::string& id, const Submission& submission, const std::filesystem::path& folder,
                       const GradeOptions& options = {});

/// Grades all into `out`. Can be ended at any time and started again: what is done and unchanged is taken over.
/// @pre  this process runs no thread: it forks
/// @return in the order of `submissions`
std::vector<Grade> grade_submissions(const Course& course, const std::string& id, const std::vector<Submission>& submissions,
                                     const std::filesystem::path& out, const GradeOptions& options = {});

}  // namespace tumble::grading
