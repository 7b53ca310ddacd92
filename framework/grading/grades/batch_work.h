/// The submissions of one grading, each with what is known of it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/ledger.h"

namespace tumble::grading {

struct GradedWork {
  const Submission* submission = nullptr;
  std::string folder;
  GradeKey key;
  EarlierRun earlier;
  std::filesystem::path earlier_place;  // the folder that `earlier` was read from
  GradeRecord record;                   // the final one
  LedgerEntry entry;                    // of `record`, until it is appended
  bool is_settled = false;              // `record` is final and lies in place
  bool is_left_out = false;             // not asked for, and without an earlier result
  bool is_untouched = false;            // what lies in place is not `record`: no entry
  std::vector<std::string> remarks;
  double seconds = 0.0;  // that it took, now
};

/// Whether this submission is to be graded, or keeps what it has.
bool is_asked_for(const GradedWork& work, const GradeOptions& options);

/// Whether the earlier result is final, of this submission and grader, and lacks nothing that is
/// asked for now: only its points may have changed.
bool verdicts_stand(const GradedWork& work, const GradeOptions& options);

/// Whether the earlier result is what grading would give now.
bool is_current(const GradedWork& work, const GradeOptions& options);

/// Whether the earlier result is what grading would give now but for a stage behind the verdicts
/// that failed (stages.h).
bool is_current_but_for_a_stage(const GradedWork& work, const GradeOptions& options);

/// What stays in memory of the submissions of a class: some hundred bytes each, and one list of
/// tests for all that have the same.
class MarksOfClass {
 public:
  /// Lets go of what only the page of a submission shows: stories, plots, causes, checks of scenes,
  /// digests. Of its tests the marks stay. The memory is given back.
  void let_go_of_details(GradeRecord& record);

 private:
  std::shared_ptr<const std::vector<RubricItem>> items_;
};

/// The record of a submission whose grading failed: no score, and `why` as the story of every test.
GradeRecord fault_record(const GradedWork& work, const std::string& id, const Rubric& rubric,
                         const std::string& why);

using Notice = std::function<void(const std::string& sentence)>;

/// By submission, the name of its folder of results. Names are unique, but a student may have two
/// flat files: each gets its own folder.
std::vector<std::string> folders_for(const std::vector<Submission>& submissions);

/// Identical files under two names get a remark, which students do not see because it names others.
void remark_equal_files(std::vector<GradedWork>& all);

/// Two submissions of one name, for example a folder and a flat file: two rows of one student, of
/// which a gradebook keeps the last. They get a remark and a notice.
void report_doubles(std::vector<GradedWork>& all, const Notice& notice);

/// A notice for each of the first earlier results that are not reused, with the reason. Those that
/// are left out are not graded again: their notice is the overview's.
void report_distrusted(const std::vector<GradedWork>& all, const Notice& notice);

/// Results are published; the key that signs them must not be.
/// @throws UserError when the key of this machine is inside the folder of results
void refuse_key_in(const std::filesystem::path& out);

/// @throws UserError for the first of the names that no submission has, with the nearest
void refuse_unknown_names(const std::vector<std::string>& only,
                          const std::vector<Submission>& submissions);

}  // namespace tumble::grading
