// All submissions of a folder: a process for each, a few at a time, so that what happens in one stays in one.
#include <sys/wait.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "framework/grading/grade.h"
#include "framework/grading/grade_files.h"
#include "framework/grading/grade_key.h"
#include "framework/grading/grade_pages.h"
#include "framework/grading/processes.h"
#include "framework/grading/scoring.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Work {
  const Submission* submission;
  std::string folder;
  GradeKey key;
  std::optional<GradeRecord> old;
  GradeRecord record;       // as it stands in the end
  double seconds = 0.0;
};

class Batch {
 public:
  Batch(const Course& course, const std::string& id, const fs::path& out, const GradeOptions& options)
      : course_(course), id_(id), out_(out), options_(options) {}

  std::vector<Grade> run(const std::vector<Submission>& submissions) {
    fs::create_directories(out_);
    plan(submissions);
    grade_open_ones();
    return write_overview();
  }

 private:
  // Takes over what is whole and unchanged.
  void plan(const std::vector<Submission>& submissions) {
    const std::string grader = grader_digest(course_, id_, options_.budget_s), pictures = pictures_digest(course_, id_, options_);
    std::set<std::string> folders;
    for (const Submission& submission : submissions) {
      Work work{&submission, folder_of(submission.name), {submission_digest(submission), grader, pictures}, {}, {}, 0.0};
      if (!folders.insert(work.folder).second) throw UserError(submission.name, "two submissions have this name", "Give each a name of its own.");
      std::error_code ignored;
      fs::remove_all(draft_of(work), ignored);  // of a run that was ended in the middle
      work.old = read_record(out_ / work.folder / "record.json");
      if (work.old && work.old->results_digest != digest_of_file(out_ / work.folder / "results.json")) work.old.reset();
      work_.push_back(std::move(work));
    }
    for (Work& work : work_) {
      if (is_current(work)) {
        work.record = *work.old;
        work.record.grade.taken_over = true;
        ++done_;
      } else {
        open_.push_back(&work);
      }
    }
  }

  bool is_current(const Work& work) const {
    if (!work.old || !work.old->grade.is_final()) return false;
    const GradeKey& old = work.old->key;
    const bool pictures_do = !options_.media || old.pictures == work.key.pictures;
    return old.submission == work.key.submission && old.grader == work.key.grader && pictures_do;
  }

  void grade_open_ones() {
    start_ = Clock::now();
    tell("");
    const auto work = [&](std::size_t i) { grade_one(*open_[i]); };
    run_in_processes(open_.size(), options_.jobs, work, [&](std::size_t i, int status, double seconds) {
      open_[i]->seconds = seconds;
      settle(*open_[i], status);
      ++done_;
      ++fresh_;
      tell(open_[i]->submission->name);
    }, [this] { clear_drafts(); });
  }

  // What is half done goes; what is done stands, and is taken over by the next run.
  void clear_drafts() const {
    std::error_code ignored;
    for (const Work& work : work_) fs::remove_all(draft_of(work), ignored);
    fmt::print(stderr, "stopped: {} of {} submissions are graded; the same command goes on from here\n", done_, work_.size());
  }

  fs::path draft_of(const Work& work) const { return out_ / (".making-" + work.folder); }

  // In a process of its own. What goes wrong is left beside the draft, for the parent to read.
  void grade_one(const Work& work) const {
    try {
      GradeOptions own = options_;
      own.progress = {};
      // The draft's name must not show in what is written: it is named as it will be.
      grade_submission(course_, id_, *work.submission, draft_of(work) / work.folder, own);
    } catch (const std::exception& error) {
      write_whole(draft_of(work) / "fault.txt", error.what());
      throw;
    }
  }

  // Puts a finished submission in place. A fault of ours leaves an old result standing.
  void settle(Work& work, int status) {
    const fs::path draft = draft_of(work), made = draft / work.folder, place = out_ / work.folder;
    std::optional<GradeRecord> record = status == 0 ? read_record(made / "record.json") : std::nullopt;
    if (!record) {
      record = write_fault(work, status);
    }
    record->grade.name = work.submission->name;
    const bool old_stands = work.old && work.old->grade.is_final() && work.old->key.submission == work.key.submission && !record->grade.is_final();
    if (old_stands) {
      work.record = *work.old;
      work.record.grade.change = "the grader failed on a new run; this is the result of the earlier one";
    } else {
      if (work.old) record->grade.change = change(*work.old, *record);
      if (!record->grade.change.empty()) write_whole(made / "record.json", record_json(record->grade, record->key, record->results_digest));
      const fs::path old = draft / "old";
      if (fs::exists(place)) fs::rename(place, old);
      fs::rename(made, place);
      work.record = *record;
    }
    std::error_code ignored;
    fs::remove_all(draft, ignored);
  }

  static std::string change(const GradeRecord& old, const GradeRecord& now) {
    if (old.grade.score == now.grade.score || !old.grade.is_final() || !now.grade.is_final()) return "";
    const char* reason = old.key.submission != now.key.submission ? "the submission changed" : "the grader changed";
    return fmt::format("{} -> {}: {}", points_text(old.grade.score), points_text(now.grade.score), reason);
  }

  // The grading process itself failed: a page that says so, and no score.
  GradeRecord write_fault(const Work& work, int status) {
    std::string why;
    std::ifstream said(draft_of(work) / "fault.txt");
    why.assign(std::istreambuf_iterator<char>(said), {});
    if (why.empty()) why = WIFSIGNALED(status) ? fmt::format("the grading process ended with signal {}", WTERMSIG(status)) : "the grading process left no result";
    GradeRecord record;
    record.key = work.key;
    Grade& grade = record.grade;
    grade.name = work.submission->name;
    grade.folder = work.folder;
    grade.notes = work.submission->notes;
    grade.story = why;
    grade.tests = score_nothing(rubric_of(course_, id_), Verdict::kGraderFault, why);
    add_up(grade);
    const fs::path made = draft_of(work) / work.folder;
    fs::remove_all(made);
    const std::string results = gradescope_json(grade);
    record.results_digest = digest(results);
    write_whole(made / "results.json", results);
    submission_page(course_.registry->find(id_), grade, "Tumble").write(made / "index.html");
    write_whole(made / "record.json", record_json(grade, record.key, record.results_digest));
    return record;
  }

  void tell(const std::string& finished) const {
    if (!options_.progress) return;
    GradeProgress progress{done_, work_.size(), finished, -1.0};
    if (fresh_ > 0) {
      const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
      progress.left_s = spent / static_cast<double>(fresh_) * static_cast<double>(work_.size() - done_);
    }
    options_.progress(progress);
  }

  std::vector<Grade> write_overview() {
    std::vector<Grade> grades;
    std::vector<GradeRecord> records;
    nlohmann::ordered_json times = {{"command", course_.command}, {"seconds", nlohmann::ordered_json::object()}};
    for (Work& work : work_) {
      work.record.grade.name = work.submission->name;
      grades.push_back(work.record.grade);
      records.push_back(work.record);
      if (work.seconds > 0.0) times["seconds"][work.folder] = work.seconds;
    }
    const modules::ModuleKind& kind = course_.registry->find(id_);
    write_whole(out_ / "gradebook.csv", gradebook_csv(kind.title, grades));
    write_whole(out_ / "ledger.json", ledger_json(id_, records));
    index_page(kind, grades).write(out_ / "index.html");
    write_whole(out_ / "times.json", times.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
    return grades;
  }

  const Course& course_;
  const std::string id_;
  const fs::path out_;
  const GradeOptions& options_;
  std::vector<Work> work_;
  std::vector<Work*> open_;
  std::size_t done_ = 0, fresh_ = 0;
  Clock::time_point start_;
};

}  // namespace

std::vector<Grade> grade_submissions(const Course& course, const std::string& id, const std::vector<Submission>& submissions, const fs::path& out,
                                     const GradeOptions& options) {
  return Batch(course, id, out, options).run(submissions);
}

}  // namespace tumble::grading
