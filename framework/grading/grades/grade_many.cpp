// Grades all submissions of a folder, each in a separate process, a few at a time, so that a
// failure affects only one.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "framework/grading/compiler/compile.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/grade_many.h"
#include "framework/grading/grades/batch_work.h"
#include "framework/grading/grades/class_overview.h"
#include "framework/grading/grades/one_grading.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/grades/ledger_records.h"
#include "framework/grading/grades/lowering.h"
#include "framework/grading/course/machine_key.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/grades/own_tests.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/sandbox/sandbox_user.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/farm/processes.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Work = GradedWork;

class Batch {
 public:
  Batch(const Course& course, const std::string& id, const fs::path& submissions,
        const fs::path& out, const GradeOptions& options)
      : protection_(protection_of_grades(options.accepted_sandbox)),
        snapshot_(course, id),
        options_(options),
        terms_{
            snapshot_.course(), id, course.registry->find(id), options, protection_, {}, {}, {}} {
    require_rubric_of_judge(course_, id);
    terms_.rubric = rubric_of(course_, id);
    refuse_key_in(out);
    out_ = out;
    if (options.shard) fs::remove(done_file(out, *options.shard));
    output_.emplace(options.shard ? shard_folder(out, *options.shard) : out, submissions, id,
                    RunSettings{id, fs::canonical(submissions), options.budget_s, options.media,
                                options.policy, word_of(options.page_code())},
                    options.mend_list && !options.shard ? BrokenList::kMend : BrokenList::kRefuse);
    terms_.out = output_->path();
    if (!options.shard) ledger_.emplace(terms_.out / kLedgerFile);
    if (ledger_ && ledger_->was_mended())
      notice(
          "the last line of the ledger was unfinished, because a run was killed while it wrote "
          "it; it is written again");
    const MachineKey key = machine_key();
    if (!key.notice.empty()) notice(key.notice);
    terms_.key = key.bytes;
  }

  std::vector<Grade> run(std::vector<Submission> submissions) {
    refuse_unknown_names(options_.only, submissions);
    std::vector<std::string> folders = folders_for(submissions);
    if (options_.shard) keep_own(submissions, folders);
    read_once(submissions);
    plan(submissions, folders);
    grade_open_ones();
    if (options_.shard) return end_shard();
    decide_lowerings();
    std::vector<Grade> grades = write_overview(terms_, work_);
    remove_shards(output_->path());
    return grades;
  }

 private:
  void notice(const std::string& sentence) const {
    if (options_.notice) options_.notice(sentence);
  }

  // A file may change while others are graded: digests, comparisons and compilation all use one
  // copy, read here.
  void read_once(std::vector<Submission>& submissions) {
    std::size_t number = 0;
    for (Submission& submission : submissions) {
      std::string why;
      if (!submission.own_tests.empty()) {
        const auto tests = read_plain_file(submission.own_tests, CompileLimits{}.source_bytes, why);
        const fs::path copy =
            sources_.path() / std::to_string(number++) / submission.own_tests.filename();
        if (tests)
          write_whole(copy, *tests);
        else
          submission.notes.push_back("its own tests were not run: " + why);
        submission.own_tests = tests ? copy : fs::path();
      }
      if (submission.source.empty()) continue;
      const auto text = read_plain_file(submission.source, CompileLimits{}.source_bytes, why);
      const fs::path copy =
          sources_.path() / std::to_string(number++) / submission.source.filename();
      if (text)
        write_whole(copy, *text);
      else
        submission.problem = plain_name(submission.source.filename().string()) + ' ' + why;
      submission.source = text ? copy : fs::path();
    }
  }

  void keep_own(std::vector<Submission>& submissions, std::vector<std::string>& folders) const {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < submissions.size(); ++i) {
      if (!options_.shard->holds(i)) continue;
      std::swap(submissions[kept], submissions[i]);
      std::swap(folders[kept++], folders[i]);
    }
    submissions.resize(kept);
    folders.resize(kept);
  }

  // Reuses earlier results that are complete, signed and unchanged.
  void plan(const std::vector<Submission>& submissions, const std::vector<std::string>& folders) {
    const std::string judging = digest(grader_digest(course_, id_, options_.budget_s) +
                                       protection_.words),
                      pictures = pictures_digest(course_, id_, options_);
    const bool has_tests = std::any_of(submissions.begin(), submissions.end(),
                                       [](const Submission& s) { return !s.own_tests.empty(); });
    std::string own_tests;
    if (has_tests && wants_own_tests(course_, id_)) {
      prepare_own_tests(course_, id_);
      own_tests = own_tests_digest(course_, id_);
    }
    for (std::size_t i = 0; i < submissions.size(); ++i) {
      Work work;
      work.submission = &submissions[i];
      work.folder = folders[i];
      work.key = {submission_digest(submissions[i]),
                  submissions[i].own_tests.empty() ? judging : digest(judging + own_tests),
                  rubric_digest(terms_.rubric), pictures};
      read_earlier(work);
      take_over_or_open(work);
      work_.push_back(std::move(work));
    }
    output_->claim({folders.begin(), folders.end()});
    const Notice tell = [this](const std::string& sentence) { notice(sentence); };
    remark_equal_files(work_);
    report_doubles(work_, tell);
    if (!options_.shard) finished_ = finished_by_shards(output_->path());
    report_distrusted(work_, tell);
    for (Work& work : work_) {
      if (work.is_settled) continue;
      if (!settle_from_shard(work)) open_.push_back(&work);
    }
    done_ = work_.size() - open_.size();
    log_settled();
  }

  // For a shard without a result of its own the earlier result is that of the class, and where it
  // is current nothing is to be done.
  void read_earlier(Work& work) const {
    work.earlier_place = one_.place_of(work);
    if (output_->owns(work.folder))
      work.earlier = read_earlier_run(work.earlier_place, id_, terms_.key);
    distrust_older_than_ledger(work);
    const fs::path of_class = out_ / work.folder;
    if (!options_.shard || work.earlier.record || !fs::is_directory(fs::symlink_status(of_class)))
      return;
    work.earlier_place = of_class;
    work.earlier = read_earlier_run(of_class, id_, terms_.key);
  }

  // A signed result may be an old one that was put back.
  void distrust_older_than_ledger(Work& work) const {
    if (ledger_ && work.earlier.record &&
        is_older_than_ledger(*work.earlier.record, ledger_->last_score(work.folder)))
      work.earlier = {{}, kOlderThanLedger};
  }

  void take_over_or_open(Work& work) {
    if (is_asked_for(work, options_) && (options_.again || !is_current(work, options_))) {
      if (work.earlier.record && work.earlier.record->grade.is_held)
        work.earlier.record.reset();  // the result itself is missing
      if (work.earlier.record) marks_.let_go_of_details(*work.earlier.record);
    } else if (work.earlier.record) {
      take_over(work, std::move(*work.earlier.record));
    } else {
      work.is_left_out = work.is_settled = true;
    }
  }

  // What a shard has finished is treated as if this process had made it now. Where a stage behind
  // the verdicts failed there, and no other shard has a result without a fault, the verdicts are
  // taken over with the fault: the next run makes that stage again.
  bool settle_from_shard(Work& work) {
    const auto finished = finished_.find(work.folder);
    if (finished == finished_.end()) return false;
    const fs::path* taken = nullptr;
    for (const fs::path& made : finished->second) {
      Work trial = work;
      trial.earlier = read_earlier_run(made, id_, terms_.key);
      if (!trial.earlier.problem.empty())
        report_distrusted({trial}, [this](const std::string& sentence) { notice(sentence); });
      if (is_current(trial, options_)) {
        taken = &made;
        break;
      }
      if (!taken && is_current_but_for_a_stage(trial, options_)) taken = &made;
    }
    if (!taken) return false;
    fs::create_directories(one_.draft_of(work));
    fs::rename(*taken, one_.made_of(work));
    settle(work, 0);
    return true;
  }

  // A shard has no gradebook: only the class has.
  std::vector<Grade> end_shard() {
    std::vector<Grade> grades;
    for (Work& work : work_) grades.push_back(std::move(work.record.grade));
    write_whole(done_file(out_, *options_.shard),
                fmt::format("{} of {} submissions graded, {} were current\n", fresh_, work_.size(),
                            work_.size() - fresh_));
    return grades;
  }

  void take_over(Work& work, GradeRecord whole) {
    whole.grade.taken_over = true;
    settle_with(work, std::move(whole));
  }

  // `whole` is final and lies in place. A class has a thousand of them: what only its own page
  // shows is let go of.
  void settle_with(Work& work, GradeRecord whole) {
    work.entry = ledger_entry_of(whole, compiler_);
    whole.grade.name = work.submission->name;  // a record replaces bytes that are no UTF-8
    if (options_.each && !options_.shard) options_.each(whole.grade);
    marks_.let_go_of_details(whole);
    work.record = std::move(whole);
    work.earlier.record.reset();
    work.is_settled = true;
  }

  // Entries are appended in the order of the submissions, each as soon as all before it are
  // settled: so the ledger has the same bytes for any number of jobs.
  void log_settled() {
    if (!ledger_) return;
    for (; logged_ < work_.size() && work_[logged_].is_settled; ++logged_)
      if (const Work& work = work_[logged_];
          !work.is_left_out && !work.is_untouched && !work.record.grade.is_held)
        ledger_->append(std::exchange(work_[logged_].entry, LedgerEntry()));
  }

  void grade_open_ones() {
    start_ = Clock::now();
    if (!open_.empty()) one_.prepare_page_code();
    if (const std::string why = one_.why_no_right_law(); !why.empty())
      notice("the right law is in no page: " + why);
    report_progress("");
    const auto work = [&](std::size_t i) { one_.grade(*open_[i]); };
    farm::run_in_processes(
        open_.size(), options_.jobs, work,
        [&](std::size_t i, int status, double seconds) {
          open_[i]->seconds = seconds;
          settle(*open_[i], status);
          log_settled();
          ++done_;
          ++fresh_;
          report_progress(open_[i]->submission->name);
        },
        [this] {
          sweep_stages_of_the_dead();
          clear_drafts();
        });
  }

  // Removes unfinished results; finished ones stay, and are reused by the next run.
  void clear_drafts() const {
    std::error_code ignored;
    for (const Work& work : work_) fs::remove_all(one_.draft_of(work), ignored);
    // this process ends by a signal, without running destructors
    for (const fs::path& folder : {course_.build, sources_.path()}) fs::remove_all(folder, ignored);
    fmt::print(
        stderr,
        "stopped: {} of {} submissions are graded, and kept in {}; the same command continues "
        "from here\n",
        done_, work_.size(), out_.string());
  }

  // Puts a finished submission in place. After a fault of the grader an old result stays.
  void settle(Work& work, int status) {
    const fs::path draft = one_.draft_of(work), place = one_.place_of(work);
    GradeRecord record = one_.ended(work, status);
    const LedgerScore* last = ledger_ ? ledger_->last_score(work.folder) : nullptr;
    const Placing placing = placing_of(
        work, record, {last, options_.guard_changed_files, fs::exists(fs::symlink_status(place))});
    if (placing == Placing::kAsk && !options_.shard)
      return hold_back(work, std::move(record), last);
    if (placing == Placing::kEarlier) {
      GradeRecord old = one_.earlier_record(work).value_or(*work.earlier.record);
      old.grade.change = "the grader failed on a new run; this is the result of the earlier one";
      settle_with(work, std::move(old));
    } else if (placing == Placing::kUntouched) {
      settle_untouched(work, std::move(record));
    } else {
      put_in_place(one_.made_of(work), place, draft / ".old");
      settle_with(work, std::move(record));
    }
    std::error_code ignored;
    fs::remove_all(draft, ignored);
  }

  // Until decide_lowerings.
  void hold_back(Work& work, GradeRecord record, const LedgerScore* last) {
    if (!lowers_earlier(work, record))
      record.grade.change = change_from_ledger(work, record.grade, *last);
    marks_.let_go_of_details(record);
    work.record = std::move(record);
    held_.push_back(&work);
  }

  // What lies in place does not count, and is left as it is.
  void settle_untouched(Work& work, GradeRecord record) {
    record.grade.name = work.submission->name;
    record.grade.media.clear();
    record.grade.change = "the grader failed on a new run; what lies in place stays";
    if (!work.earlier.problem.empty())
      record.grade.change += " and does not count: " + work.earlier.problem;
    marks_.let_go_of_details(record);
    work.record = std::move(record);
    work.is_untouched = work.is_settled = true;
  }

  bool lowers_earlier(const Work& work, const GradeRecord& now) const {
    return grading::lowers_earlier(work, now, options_.guard_changed_files);
  }

  // Asks once for all; results that may not be lowered stay as they were.
  void decide_lowerings() {
    if (held_.empty()) return;
    std::sort(held_.begin(), held_.end());  // the order of the submissions
    std::vector<Lowering> lowerings;
    for (const Work* work : held_) {
      const Grade& grade = work->record.grade;
      lowerings.push_back({work->submission->name, grade.change, grade.changes,
                           !lowers_earlier(*work, work->record)});
    }
    const bool may = options_.may_lower && options_.may_lower(lowerings);
    for (Work* work : held_) {
      const std::string change = work->record.grade.change;
      if (may) {
        put_in_place(one_.made_of(*work), one_.place_of(*work), one_.draft_of(*work) / ".old");
        settle_with(
            *work,
            read_earlier_run(one_.place_of(*work), id_, terms_.key).record.value_or(work->record));
        work->record.grade.change = work->entry.change = change;
      } else if (!lowers_earlier(*work, work->record)) {
        leave_blank(*work);
      } else {
        take_over(*work, one_.earlier_record(*work).value_or(*work->earlier.record));
        work->record.grade.change = "not lowered (" + change + ")";
      }
      std::error_code ignored;
      fs::remove_all(one_.draft_of(*work), ignored);
    }
    log_settled();
  }

  // What lies in place does not count, and is left as it is. No score is written, so that a system
  // that reads the gradebook keeps the one it has; the ledger gets no entry.
  void leave_blank(Work& work) {
    Grade& grade = work.record.grade;
    grade.name = work.submission->name;
    grade.is_held = true;
    grade.change = "not lowered (" + grade.change + ")";
    grade.media.clear();
    if (!fs::exists(fs::symlink_status(one_.place_of(work)))) {
      GradeRecord held = held_record(work, id_, terms_.rubric, grade.change);
      one_.note_protection(held.grade);
      one_.write_made(work, held);
      put_in_place(one_.made_of(work), one_.place_of(work), one_.draft_of(work) / ".old");
    }
    work.is_settled = true;
  }

  void report_progress(const std::string& finished) const {
    if (!options_.progress) return;
    GradeProgress progress{done_, work_.size(), finished, -1.0};
    if (fresh_ > 0) {
      const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
      progress.left_s =
          spent / static_cast<double>(fresh_) * static_cast<double>(work_.size() - done_);
    }
    options_.progress(progress);
  }

  // before anything else: where it is too weak, nothing is copied or written
  const GradeProtection protection_;
  const CourseSnapshot snapshot_;
  const PrivateFolder sources_;
  const GradeOptions& options_;
  GradingTerms terms_;
  const Course& course_ = terms_.course;
  const std::string& id_ = terms_.id;
  OneGrading one_{terms_};
  fs::path out_;  // of the class, also for a shard
  std::optional<OutputFolder> output_;
  FinishedByShards finished_;     // what may be taken over
  std::optional<Ledger> ledger_;  // of the class
  const std::string compiler_ = compiler_in_words();
  MarksOfClass marks_;
  std::vector<Work> work_;
  std::vector<Work*> open_, held_;
  std::size_t logged_ = 0;  // of work_
  std::size_t done_ = 0, fresh_ = 0;
  Clock::time_point start_;
};

}  // namespace

std::vector<Grade> grade_submissions(const Course& course, const std::string& id,
                                     const FoundSubmissions& submissions, const fs::path& out,
                                     const GradeOptions& options) {
  return Batch(course, id, submissions.folder, out, options).run(submissions.all);
}

}  // namespace tumble::grading
