/// A submission and its grade, as plain data.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/cost_section.h"
#include "framework/grading/course/course.h"
#include "framework/grading/grades/media.h"
#include "framework/grading/verdicts/verdict.h"

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

}  // namespace tumble::grading
