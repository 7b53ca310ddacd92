#include "framework/grading/grades/one_grading.h"

#include <sys/wait.h>

#include <utility>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "framework/grading/grades/changes.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_submission.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/grades/stages.h"

namespace tumble::grading {

namespace fs = std::filesystem;

// ---- Places -------------------------------------------------------------------------------------

fs::path OneGrading::draft_of(const GradedWork& work) const {
  return terms_.out / draft_name(work.folder);
}

fs::path OneGrading::made_of(const GradedWork& work) const { return draft_of(work) / work.folder; }

// A record of the verdicts alone, for the case that a stage behind them ends the process.
fs::path OneGrading::verdicts_of(const GradedWork& work) const {
  return draft_of(work) / ".verdicts" / work.folder;
}

fs::path OneGrading::fault_of(const GradedWork& work) const {
  return draft_of(work) / ".fault.txt";
}

std::optional<GradeRecord> OneGrading::earlier_record(const GradedWork& work) const {
  if (!work.earlier.record) return std::nullopt;
  return read_earlier_run(work.earlier_place, terms_.id, terms_.key).record;
}

// ---- The submission's own process ---------------------------------------------------------------

void OneGrading::prepare_page_code() {
  try {
    page_code_.emplace(terms_.course, terms_.id, terms_.options.page_code());
  } catch (const std::exception& error) {
    page_code_fault_ = error.what();
    page_code_.emplace(terms_.course, terms_.id, CodeInPages::kNone);
  }
}

std::string OneGrading::why_no_right_law() const {
  return page_code_ ? page_code_->laws().why_no_right : "";
}

void OneGrading::grade(const GradedWork& work) const {
  const GradeOptions& options = terms_.options;
  try {
    fs::create_directories(made_of(work));
    GradeOptions own = options;
    own.progress = {};
    const std::optional<GradeRecord> earlier = earlier_record(work);
    std::optional<Grade> grade;
    // only points have changed: added up again, not run again
    if (earlier && verdicts_stand(work, options) && !options.again)
      grade = graded_by(terms_.rubric, earlier->grade);
    GradeKey key = work.key;
    const bool is_rerun = !grade;
    if (is_rerun) {
      grade = grade_submission(terms_.course, terms_.id, *work.submission, made_of(work), own,
                               [&](const Grade& judged) { keep_verdicts(work, judged); });
      note_protection(*grade);
    }
    grade->folder = work.folder;
    if (!is_rerun || !options.media)
      keep_media(work.earlier_place, made_of(work), earlier, *grade, key);
    if (is_rerun) forget_page_code(made_of(work));
    if (!options.media && has_no_code()) key.pictures.clear();
    if (grade->state == GradeState::kJudged) add_page_code(work, *grade, is_rerun);
    grade->change.clear();
    grade->changes.clear();
    if (earlier) note_changes(*earlier, key, *grade);
    PageLaws laws = page_code_->laws();
    laws.script = page_script(terms_.course, terms_.id);  // also for modules of an earlier run
    write_grade(terms_.kind, *grade, key, made_of(work), terms_.key, laws);
  } catch (const std::exception& error) {
    write_whole(fault_of(work), error.what());
    throw;
  }
}

void OneGrading::keep_verdicts(const GradedWork& work, Grade judged) const {
  note_protection(judged);
  judged.folder = work.folder;
  GradeKey key = work.key;
  key.pictures.clear();
  write_whole(verdicts_of(work) / "record.json",
              record_json({std::move(judged), key, terms_.id, {}}, terms_.key));
}

// Whether pages get no code now though the assignment has some. Pictures that are kept then belong
// to a page with code: the next run that is to have both makes them.
bool OneGrading::has_no_code() const {
  return terms_.options.page_code() == CodeInPages::kNone && !page_code_->laws().script.empty();
}

// Where only points have changed, the submission's own module is there already.
void OneGrading::add_page_code(const GradedWork& work, Grade& grade, bool is_rerun) const {
  const char* const what = "the code in its page";
  if (!page_code_fault_.empty()) return note_failed_stage(grade, what, page_code_fault_);
  if (!is_rerun) return;
  run_stage(grade, what,
            [&] { grade.no_page_code = page_code_->add(work.submission->source, made_of(work)); });
}

void OneGrading::note_protection(Grade& grade) const {
  grade.sandbox = terms_.protection.words;
  grade.is_official = terms_.protection.is_official;
  if (!terms_.protection.note.empty()) grade.notes.push_back(terms_.protection.note);
}

// ---- Its parent ---------------------------------------------------------------------------------

GradeRecord OneGrading::ended(const GradedWork& work, int status) const {
  if (status == 0)
    if (auto made = read_earlier_run(made_of(work), terms_.id, terms_.key).record)
      return *std::move(made);
  if (auto verdicts = verdicts_left(work, status)) return *std::move(verdicts);
  GradeRecord fault = fault_record(work, terms_.id, terms_.rubric, why_it_ended(work, status));
  note_protection(fault.grade);
  write_made(work, fault);
  return fault;
}

std::optional<GradeRecord> OneGrading::verdicts_left(const GradedWork& work, int status) const {
  std::optional<GradeRecord> record =
      read_earlier_run(verdicts_of(work), terms_.id, terms_.key).record;
  if (!record) return std::nullopt;
  note_failed_stage(record->grade, "pictures and pages", why_it_ended(work, status));
  if (const auto earlier = earlier_record(work)) note_changes(*earlier, record->key, record->grade);
  write_made(work, *record);
  return record;
}

std::string OneGrading::why_it_ended(const GradedWork& work, int status) const {
  const std::string why = text_of(fault_of(work));
  if (!why.empty()) return why;
  return WIFSIGNALED(status)
             ? fmt::format("the grading process ended with signal {}", WTERMSIG(status))
             : "the grading process left no result";
}

void OneGrading::write_made(const GradedWork& work, GradeRecord& record) const {
  fs::remove_all(made_of(work));
  fs::create_directories(made_of(work));
  keep_media(work.earlier_place, made_of(work), earlier_record(work), record.grade, record.key);
  write_grade(terms_.kind, record.grade, record.key, made_of(work), terms_.key);
  record.files = digests_below(made_of(work));
}

}  // namespace tumble::grading
