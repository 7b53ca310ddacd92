/// What one submission's grading process does, and what its parent finds when it has ended.
///
///   OUT/.making-NAME/NAME/   the draft: the written files contain the final name. What lies beside
///                            it begins with a dot, as no folder of a submission does
///   OUT/NAME/                the result in place
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/batch_work.h"
#include "framework/grading/grades/page_code.h"
#include "framework/grading/sandbox/protection.h"

namespace tumble::grading {

/// What is the same for all submissions of a grading; outlives whatever refers to it.
struct GradingTerms {
  const Course& course;
  std::string id;
  const modules::ModuleKind& kind;
  const GradeOptions& options;
  const GradeProtection& protection;
  Rubric rubric;
  std::string key;            // that signs results
  std::filesystem::path out;  // where results are put in place
};

class OneGrading {
 public:
  explicit OneGrading(const GradingTerms& terms) : terms_(terms) {}

  std::filesystem::path place_of(const GradedWork& work) const { return terms_.out / work.folder; }
  std::filesystem::path draft_of(const GradedWork& work) const;
  std::filesystem::path made_of(const GradedWork& work) const;

  /// Before the first grade(). Where the code cannot be made, every grade says why.
  void prepare_page_code();
  /// Why pages have no right law though it was asked for; empty where they have one.
  std::string why_no_right_law() const;

  /// In the submission's own process, which has no children but the sandbox: the whole result, in
  /// made_of(work). The message of an exception is left beside the draft, for ended().
  void grade(const GradedWork& work) const;

  /// In the parent: the result that the process has left in made_of(work). Where it failed behind
  /// the verdicts, they and the points stand; where it failed before, the record is a fault's,
  /// without a score, and so is the page.
  /// @param status  of the process, as waitpid gives it
  GradeRecord ended(const GradedWork& work, int status) const;

  /// Writes a record in place of what the process has left. @param record  gets its files
  void write_made(const GradedWork& work, GradeRecord& record) const;

  /// The earlier result, if there is one, with all details: read again.
  std::optional<GradeRecord> earlier_record(const GradedWork& work) const;

  void note_protection(Grade& grade) const;

 private:
  std::filesystem::path verdicts_of(const GradedWork& work) const;
  std::filesystem::path fault_of(const GradedWork& work) const;
  void keep_verdicts(const GradedWork& work, Grade judged) const;
  bool has_no_code() const;
  void add_page_code(const GradedWork& work, Grade& grade, bool is_rerun) const;
  std::string why_it_ended(const GradedWork& work, int status) const;
  std::optional<GradeRecord> verdicts_left(const GradedWork& work, int status) const;

  const GradingTerms& terms_;
  std::optional<PageCode> page_code_;  // made where a submission is open
  std::string page_code_fault_;        // why it could not be made
};

}  // namespace tumble::grading
