// Grades all submissions of a folder, each in a separate process, a few at a time, so that a
// failure affects only one.
#include <fcntl.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "framework/grading/compiler/compile.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/grade_many.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/course/machine_key.h"
#include "framework/grading/grades/grade_submission.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/course/processes.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Work {
  const Submission* submission;
  std::string folder;
  GradeKey key;
  EarlierRun earlier;
  GradeRecord record;  // the final one
  std::vector<std::string> remarks;
  double seconds = 0.0;
  bool is_of_shard = false;  // graded by a shard, taken over now
};

class Batch {
 public:
  Batch(const Course& course, const std::string& id, const fs::path& submissions,
        const fs::path& out, const GradeOptions& options)
      : protection_(protection_of_grades(options.accepted_sandbox)),
        snapshot_(course, id),
        course_(snapshot_.course()),
        id_(id),
        kind_(course.registry->find(id)),
        options_(options) {
    require_rubric_of_judge(course_, id);
    rubric_ = rubric_of(course_, id);
    refuse_key_in(out);
    out_ = out;
    if (options.shard) fs::remove(done_file(out, *options.shard));
    output_.emplace(options.shard ? shard_folder(out, *options.shard) : out, submissions, id);
    key_ = machine_key();
    if (!key_.notice.empty()) notice(key_.notice);
  }

  std::vector<Grade> run(std::vector<Submission> submissions) {
    std::vector<std::string> folders = folders_for(submissions);
    if (options_.shard) keep_own(submissions, folders);
    read_once(submissions);
    plan(submissions, folders);
    grade_open_ones();
    if (options_.shard) return end_shard();
    std::vector<Grade> grades = write_overview();
    remove_shards(output_->path());
    return grades;
  }

 private:
  // Results are published; the key that signs them must not be.
  static void refuse_key_in(const fs::path& out) {
    std::error_code failed;
    const fs::path key = fs::weakly_canonical(machine_key_file(), failed),
                   folder = fs::weakly_canonical(fs::absolute(out), failed);
    const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), key.begin(), key.end());
    if (!key.empty() && end == folder.end())
      throw UserError(
          key.string(),
          "is the key of this machine, and is inside the folder of results " + folder.string(),
          "Name another file in TUMBLE_GRADER_KEY, or another folder with --out.");
  }

  void notice(const std::string& sentence) const {
    if (options_.notice) options_.notice(sentence);
  }

  // A file may change while others are graded: digests, comparisons and compilation all use one
  // copy, read here.
  void read_once(std::vector<Submission>& submissions) {
    std::size_t number = 0;
    for (Submission& submission : submissions) {
      if (submission.source.empty()) continue;
      std::string why;
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

  // Names of folders are unique, but a student may have two flat files: each gets its own folder.
  static std::vector<std::string> folders_for(const std::vector<Submission>& submissions) {
    std::set<std::string> taken;
    std::vector<std::string> folders;
    for (const Submission& submission : submissions) {
      std::string folder = folder_of(submission.name);
      for (int again = 2; !taken.insert(folder).second; ++again)
        folder = folder_of(submission.name + '\0' + std::to_string(again));
      folders.push_back(folder);
    }
    return folders;
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
    for (std::size_t i = 0; i < submissions.size(); ++i) {
      const Submission& submission = submissions[i];
      Work work{&submission,
                folders[i],
                {submission_digest(submission), judging, rubric_digest(rubric_), pictures},
                {},
                {},
                {},
                0.0};
      if (output_->owns(work.folder))
        work.earlier = read_earlier_run(place_of(work), id_, key_.bytes);
      if (options_.shard && !work.earlier.record) read_result_of_class(work);
      work_.push_back(std::move(work));
    }
    output_->claim({folders.begin(), folders.end()});
    if (!options_.shard) take_over_from_shards();
    remark_equal_files();
    report_doubles();
    report_distrusted();
    for (Work& work : work_) {
      if (is_current(work)) {
        work.record = *work.earlier.record;
        work.record.grade.taken_over = !work.is_of_shard;
        ++done_;
      } else {
        open_.push_back(&work);
      }
    }
  }

  // For a shard the earlier result is that of the class, and where it is current nothing is to be
  // done.
  void read_result_of_class(Work& work) const {
    const fs::path place = out_ / work.folder;
    if (fs::is_directory(fs::symlink_status(place)))
      work.earlier = read_earlier_run(place, id_, key_.bytes);
  }

  // What a shard has finished is put in place as if this process had graded it, changes since the
  // result before included.
  void take_over_from_shards() {
    const std::vector<fs::path> shards = shard_folders(output_->path());
    for (Work& work : work_) {
      if (is_current(work)) continue;
      for (const fs::path& shard : shards) {
        if (!fs::is_directory(fs::symlink_status(shard / work.folder))) continue;
        Work made = work;
        made.earlier = read_earlier_run(shard / work.folder, id_, key_.bytes);
        if (!is_current(made)) {
          if (!made.earlier.problem.empty()) work.earlier.problem = made.earlier.problem;
          continue;
        }
        fs::create_directories(draft_of(work));
        put_in_place(shard / work.folder, place_of(work), draft_of(work) / "old");
        fs::remove_all(draft_of(work));
        work.earlier = made.earlier;
        work.is_of_shard = true;
        break;
      }
    }
  }

  // A shard has no gradebook: only the class has.
  std::vector<Grade> end_shard() const {
    std::vector<Grade> grades;
    for (const Work& work : work_) grades.push_back(work.record.grade);
    write_whole(done_file(out_, *options_.shard),
                fmt::format("{} of {} submissions graded, {} were current\n", fresh_, work_.size(),
                            work_.size() - fresh_));
    return grades;
  }

  // Identical files under two names get a remark, which students do not see because it names
  // others.
  void remark_equal_files() {
    std::map<std::string, std::vector<Work*>> by_digest;
    for (Work& work : work_)
      if (!work.submission->source.empty())
        by_digest[digest_of_file(work.submission->source)].push_back(&work);
    for (const auto& [bytes, equal] : by_digest)
      for (Work* work : equal)
        for (const Work* other : equal)
          if (other != work)
            work->remarks.push_back("the same file, byte for byte, as that of " +
                                    plain_name(other->submission->name));
  }

  // For example a folder and a flat file of one name: two rows of one student, of which a gradebook
  // keeps the last.
  void report_doubles() {
    std::map<std::pair<std::string, std::string>, std::vector<Work*>> by_student;
    for (Work& work : work_)
      by_student[{work.submission->name, work.submission->student_id}].push_back(&work);
    for (const auto& [student, works] : by_student) {
      if (works.size() < 2) continue;
      notice(
          fmt::format("{}: {} submissions of that name: the gradebook has a row for each, and a "
                      "system that reads it may keep the last. Leave only one.",
                      plain_name(student.first), works.size()));
      for (Work* work : works)
        work->remarks.push_back(fmt::format("one of {} submissions of this name", works.size()));
    }
  }

  void report_distrusted() const {
    constexpr std::size_t kNamed = 5;
    std::size_t count = 0;
    for (const Work& work : work_) {
      if (work.earlier.problem.empty()) continue;
      if (++count <= kNamed)
        notice(plain_name(work.submission->name) + ": the earlier result is not reused, because " +
               work.earlier.problem + "; graded again");
    }
    if (count > kNamed) notice(fmt::format("... and {} more", count - kNamed));
  }

  bool pictures_do(const Work& work) const {
    return !options_.media || work.earlier.record->key.pictures == work.key.pictures;
  }
  bool verdicts_stand(const Work& work) const {
    if (!work.earlier.record || !work.earlier.record->grade.is_final()) return false;
    const GradeKey& old = work.earlier.record->key;
    return old.submission == work.key.submission && old.judging == work.key.judging &&
           pictures_do(work);
  }
  bool is_current(const Work& work) const {
    return verdicts_stand(work) && work.earlier.record->key.rubric == work.key.rubric;
  }

  void grade_open_ones() {
    start_ = Clock::now();
    report_progress("");
    const auto work = [&](std::size_t i) { grade_one(*open_[i]); };
    run_in_processes(
        open_.size(), options_.jobs, work,
        [&](std::size_t i, int status, double seconds) {
          open_[i]->seconds = seconds;
          settle(*open_[i], status);
          ++done_;
          ++fresh_;
          report_progress(open_[i]->submission->name);
        },
        [this] { clear_drafts(); });
  }

  // Removes unfinished results; finished ones stay, and are reused by the next run.
  void clear_drafts() const {
    std::error_code ignored;
    for (const Work& work : work_) fs::remove_all(draft_of(work), ignored);
    // this process ends by a signal, without running destructors
    for (const fs::path& folder : {course_.build, sources_.path()}) fs::remove_all(folder, ignored);
    fmt::print(stderr,
               "stopped: {} of {} submissions are graded; the same command continues from here\n",
               done_, work_.size());
  }

  fs::path place_of(const Work& work) const { return output_->path() / work.folder; }
  fs::path draft_of(const Work& work) const { return output_->path() / draft_name(work.folder); }
  // The draft's folder has the final name inside, because the written files contain it.
  fs::path made_of(const Work& work) const { return draft_of(work) / work.folder; }

  // Runs in a separate process. The message of an exception is left beside the draft, for the
  // parent.
  void grade_one(const Work& work) const {
    try {
      fs::create_directories(made_of(work));
      GradeOptions own = options_;
      own.progress = {};
      std::optional<Grade> grade;
      // only points have changed: added up again, not run again
      if (verdicts_stand(work)) grade = graded_by(rubric_, work.earlier.record->grade);
      GradeKey key = work.key;
      const bool is_rerun = !grade;
      if (is_rerun) {
        grade = grade_submission(course_, id_, *work.submission, made_of(work), own);
        note_protection(*grade);
      }
      grade->folder = work.folder;
      if (!is_rerun || !options_.media) keep_media(work, *grade, key);
      grade->change.clear();
      grade->changes.clear();
      if (work.earlier.record) compare(*work.earlier.record, key, *grade);
      write_grade(kind_, *grade, key, made_of(work), key_.bytes);
    } catch (const std::exception& error) {
      write_whole(draft_of(work) / "fault.txt", error.what());
      throw;
    }
  }

  void note_protection(Grade& grade) const {
    grade.sandbox = protection_.words;
    grade.is_official = protection_.is_official;
    if (!protection_.note.empty()) grade.notes.push_back(protection_.note);
  }

  // Keeps the pictures of an earlier run if none are made now: their files always, and on the page
  // if the earlier record describes them.
  void keep_media(const Work& work, Grade& grade, GradeKey& key) const {
    fs::path from = place_of(work) / "media";
    if (options_.shard && !fs::exists(from)) from = out_ / work.folder / "media";
    const fs::path to = made_of(work) / "media";
    if (!fs::is_directory(fs::symlink_status(from))) return;
    fs::create_directories(to);
    for (const auto& entry : fs::directory_iterator(from)) {
      std::error_code failed;
      fs::create_hard_link(entry.path(), to / entry.path().filename(), failed);
      if (failed) fs::copy_file(entry.path(), to / entry.path().filename());
    }
    if (!work.earlier.record || work.earlier.record->grade.media.empty()) return;
    const GradeRecord& earlier = *work.earlier.record;
    grade.media = earlier.grade.media;
    const bool is_same = earlier.key.submission == work.key.submission;
    key.pictures = is_same ? earlier.key.pictures : "";
    const std::string note =
        "the pictures are of an earlier version of the file (no new ones were made)";
    std::erase(grade.notes, note);
    const bool were_old = std::find(earlier.grade.notes.begin(), earlier.grade.notes.end(), note) !=
                          earlier.grade.notes.end();
    if (!is_same || were_old) grade.notes.push_back(note);
  }

  // Lists the changes by a regrade, test by test.
  static void compare(const GradeRecord& old, const GradeKey& key, Grade& now) {
    const char* reason = old.key.submission != key.submission ? "the submission changed"
                         : old.key.judging != key.judging     ? "the tests or the grader changed"
                         : old.key.rubric != key.rubric       ? "the rubric changed"
                                                              : "run again";
    const auto said = [](const ScoredTest& test) {
      return fmt::format("{}, {} of {}", words(test.result.verdict), points_text(test.score),
                         points_text(test.item.points));
    };
    std::map<std::string, std::string> before;
    for (const ScoredTest& test : old.grade.tests) before[test.item.test] = said(test);
    for (const ScoredTest& test : now.tests) {
      const auto it = before.find(test.item.test);
      const std::string was = it == before.end() ? "absent" : it->second;
      if (was != said(test))
        now.changes.push_back({test.item.test, test.item.title, was, said(test), reason});
      if (it != before.end()) before.erase(it);
    }
    for (const auto& [test, was] : before)
      now.changes.push_back({test, test, was, "absent", reason});
    if (old.grade.score != now.score && old.grade.has_score() && now.has_score())
      now.change =
          fmt::format("{} -> {}: {}", points_text(old.grade.score), points_text(now.score), reason);
    else if (old.grade.has_score() != now.has_score())
      now.change =
          fmt::format("{} -> {}: {}", old.grade.has_score() ? points_text(old.grade.score) : "none",
                      now.has_score() ? points_text(now.score) : "none", reason);
  }

  // Puts a finished submission in place. After a fault of the grader an old result stays.
  void settle(Work& work, int status) {
    const fs::path draft = draft_of(work), made = made_of(work), place = place_of(work);
    std::optional<GradeRecord> record;
    if (status == 0) record = read_earlier_run(made, id_, key_.bytes).record;
    if (!record) record = write_fault(work, status);
    const std::optional<GradeRecord>& earlier = work.earlier.record;
    const bool old_stands = earlier && earlier->grade.is_final() &&
                            earlier->key.submission == work.key.submission &&
                            !record->grade.is_final();
    if (old_stands) {
      work.record = *earlier;
      work.record.grade.change =
          "the grader failed on a new run; this is the result of the earlier one";
    } else {
      put_in_place(made, place, draft / "old");
      work.record = *record;
    }
    std::error_code ignored;
    fs::remove_all(draft, ignored);
  }

  // A reader sees the whole old folder or the whole new one: they are exchanged atomically where
  // the file system can.
  static void put_in_place(const fs::path& made, const fs::path& place, const fs::path& aside) {
    if (!fs::exists(fs::symlink_status(place))) return fs::rename(made, place);
    if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) == 0) return;
    fs::rename(place, aside);
    fs::rename(made, place);
  }

  // The grading process itself failed: writes a page that says so, without a score.
  GradeRecord write_fault(const Work& work, int status) {
    std::string why;
    std::ifstream said(draft_of(work) / "fault.txt");
    why.assign(std::istreambuf_iterator<char>(said), {});
    if (why.empty())
      why = WIFSIGNALED(status)
                ? fmt::format("the grading process ended with signal {}", WTERMSIG(status))
                : "the grading process left no result";
    GradeRecord record;
    record.key = work.key;
    record.key.pictures.clear();
    record.assignment = id_;
    Grade& grade = record.grade;
    grade.name = work.submission->name;
    grade.folder = work.folder;
    grade.notes = work.submission->notes;
    grade.story = why;
    note_protection(grade);
    grade.tests = score_nothing(rubric_, Verdict::kGraderFault, why);
    add_up(grade);
    fs::remove_all(made_of(work));
    fs::create_directories(made_of(work));
    keep_media(work, grade, record.key);
    write_grade(kind_, grade, record.key, made_of(work), key_.bytes);
    record.files = digests_below(made_of(work));
    return record;
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

  std::vector<Grade> write_overview() {
    std::vector<Grade> grades;
    std::vector<GradeRecord> records;
    nlohmann::ordered_json times = {{"command", course_.command},
                                    {"seconds", nlohmann::ordered_json::object()}};
    for (Work& work : work_) {
      work.record.grade.name = work.submission->name;
      work.record.grade.remarks = work.remarks;
      work.record.grade.student_id = work.submission->student_id;
      grades.push_back(work.record.grade);
      records.push_back(work.record);
      if (work.seconds > 0.0) times["seconds"][work.folder] = work.seconds;
    }
    const fs::path& out = output_->path();
    write_whole(out / "gradebook.csv", gradebook_csv(kind_.title, grades));
    write_whole(out / "ledger.json", ledger_json(id_, records));
    index_page(kind_, grades).write(out / "index.html");
    write_whole(out / "times.json",
                times.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
    return grades;
  }

  // before anything else: where it is too weak, nothing is copied or written
  const GradeProtection protection_;
  const CourseSnapshot snapshot_;
  const PrivateFolder sources_;
  const Course& course_;
  const std::string id_;
  const modules::ModuleKind& kind_;
  const GradeOptions& options_;
  fs::path out_;  // of the class, also for a shard
  Rubric rubric_;
  std::optional<OutputFolder> output_;
  MachineKey key_;
  std::vector<Work> work_;
  std::vector<Work*> open_;
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
