/// A submission and its grade, as plain data.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/cause.h"
#include "framework/grading/grades/cost_section.h"
#include "framework/grading/course/course.h"
#include "framework/grading/grades/media.h"
#include "framework/grading/grades/own_tests_grade.h"
#include "framework/grading/grades/page_code.h"
#include "framework/grading/grades/shard.h"
#include "framework/grading/grades/test_change.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// A submission to be graded.
struct Submission {
  std::string name;  // for display; may contain any bytes
  // the file that implements the module's header; empty where `problem` says why
  std::filesystem::path source;
  // for the grader: why there is nothing to compile; empty: there is a source
  std::string problem;
  std::vector<std::string> notes;        // unusual, but no obstacle
  std::filesystem::path own_tests = {};  // a file of tests beside the source; may be empty
  std::string student_id = {};  // Canvas's number of the student, if the file's name has one
};

/// The content of a folder of submissions.
struct FoundSubmissions {
  std::filesystem::path folder;
  std::vector<Submission> all;  // by name
  // entries that are not submissions, each with the reason; files that systems leave in every
  // folder are left out
  std::vector<std::string> passed_over;
  // where archives were unpacked; sources may be in it
  std::unique_ptr<PrivateFolder> unpacked = {};
};

/// A test of the rubric with its result.
struct ScoredTest {
  RubricItem item;
  TestResult result;
  double score = 0.0;
};

/// What a page of a class shows of the tests of one submission. Submissions of one rubric share its
/// items.
struct TestMarks {
  std::shared_ptr<const std::vector<RubricItem>> items;
  std::vector<Verdict> verdicts;  // by item
};

enum class GradeState {
  kJudged,
  kNothingToCompile,  // Submission::problem
  kDoesNotCompile,
  kGraderFault,  // the score is meaningless
};

/// The inputs of a grade, as digests, so that an unchanged submission need not be graded again.
struct GradeKey {
  std::string submission;  // source, problem and notes
  // everything that decides a verdict: judge, worker, tests, headers, compiler, time limit
  std::string judging;
  std::string rubric;    // points, levels and titles
  std::string pictures;  // scenes and options; empty: without pictures
};

struct Grade {
  std::string name;    // of the submission
  std::string folder;  // below OUT: the name, safe for a path
  GradeState state = GradeState::kGraderFault;
  // the compiler's errors, or another obstacle; empty when judged
  std::string story;
  std::vector<std::string> notes;
  std::vector<ScoredTest> tests;  // in the rubric's order
  TestMarks marks;                // in place of `tests` where their details were let go of
  std::vector<Cause> causes;      // of what is not right, the costliest first
  std::vector<SceneMedia> media;
  CostSection cost;  // only on the page, not in the record
  OwnTestsGrade own_tests;
  double score = 0.0, possible = 0.0;
  // nothing has changed since an earlier run, whose results are kept
  bool taken_over = false;
  // lower than the ledger's score, whose own result is lost or not trusted, and nobody has agreed:
  // it has no score, and is no entry of the ledger
  bool is_held = false;
  // "80 -> 85: the tests changed"; empty without an earlier, different result
  std::string change;
  std::vector<TestChange> changes;   // test by test
  std::vector<std::string> remarks;  // for the grader only, because they name other submissions
  std::string student_id;            // of the submission
  std::string sandbox;               // what protected the grader, in words
  bool is_official = true;           // the policy accepts that protection
  bool has_handout = false;          // handout.html, which stories link to
  std::string no_page_code = {};     // why its code does not run in its page, where it was to
  // for the grader only: "the pictures: why", of each stage behind the verdicts that failed
  // (stages.h)
  std::vector<std::string> faults = {};

  /// Calls `see` with every test, also where only marks are left.
  void each_verdict(const std::function<void(const RubricItem&, Verdict)>& see) const;
  std::size_t count(Verdict verdict) const;
  /// Whether no test ended in a fault of the grader or because the machine was too busy.
  bool is_final() const;
  /// Whether a gradebook may have the score: it is final, a file was found, and it is not held.
  bool has_score() const {
    return is_final() && state != GradeState::kNothingToCompile && !is_held;
  }
};

struct GradeProgress {
  std::size_t done = 0, total = 0;
  std::string finished;  // name of the submission just finished; may be empty
  double left_s = 0.0;   // estimated time left; negative: unknown
};

/// A submission that a regrade would lower.
struct Lowering {
  std::string name, change;         // "80 -> 75: the tests changed"
  std::vector<TestChange> changes;  // test by test
  // the higher score stands in the ledger alone: without a yes it is not put in its place, and the
  // gradebook has none
  bool is_only_in_ledger = false;
};

struct GradeOptions {
  // only these of the submissions, into OUT/.shards
  std::optional<Shard> shard;
  double budget_s = 60.0;  // for all tests of a submission together: TimeBudget
  // submissions graded at the same time, each in a separate process
  int jobs = 1;
  bool media = true;
  // names of the only submissions that get pictures. Empty: all
  std::vector<std::string> media_of;
  bool cost = true;  // measures what accuracy costs with a submission's methods, for its page
  MediaOptions media_options;
  // whose code runs in a page; nothing: the submission's where pictures are made
  std::optional<CodeInPages> code_in_pages;
  CodeInPages page_code() const {
    return code_in_pages.value_or(media ? CodeInPages::kOwn : CodeInPages::kNone);
  }
  bool draws(const std::string& name) const {
    return media && (media_of.empty() || std::ranges::count(media_of, name) > 0);
  }
  // a kind of sandbox that is used although the policy refuses it; results are marked
  std::string accepted_sandbox;
  std::vector<std::filesystem::path> scenes;  // empty: the assignment's demo scenes
  // names of submissions; others keep what they have. Empty: all
  std::vector<std::string> only;
  bool again = false;  // also what has not changed
  // Asked once, after all are graded, whether the scores of these may be lowered. Answers no, or is
  // empty: they keep their earlier results. Where the file changed it is asked only if
  // `guard_changed_files`.
  std::function<bool(const std::vector<Lowering>&)> may_lower;
  bool guard_changed_files = false;
  std::filesystem::path policy;  // kept in the manifest
  bool mend_list = false;        // a manifest that cannot be read is made anew
  // called with each grade once its result lies in place, in any order: the one time that its
  // stories are at hand
  std::function<void(const Grade&)> each;
  // called with the folder of results and all grades, without their stories, before the folder is
  // released: writes more pages, and the gradebook of a policy. What it throws ends the grading
  std::function<void(const std::filesystem::path&, const std::vector<Grade>&)> overview;
  // called where a page of the class could not be made, with the reason, when all grades are in
  // place; empty: the exception goes on
  std::function<void(const std::string& what, const std::string& why)> failed;
  std::function<void(const GradeProgress&)> progress;
  // called with a sentence for the user; may be empty
  std::function<void(const std::string&)> notice;
};

}  // namespace tumble::grading
