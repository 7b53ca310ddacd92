#include "framework/grading/grades/batch_work.h"

#include <algorithm>
#include <map>
#include <set>
#include <type_traits>

#include <fmt/format.h>

#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/grading/course/machine_key.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {

namespace fs = std::filesystem;

namespace {

bool pictures_do(const GradedWork& work, const GradeOptions& options) {
  const bool are_asked_for = options.media || options.page_code() != CodeInPages::kNone;
  return !are_asked_for || work.earlier.record->key.pictures == work.key.pictures;
}

bool has_same_verdicts(const GradedWork& work) {
  if (!work.earlier.record || !work.earlier.record->grade.is_final()) return false;
  const GradeKey& old = work.earlier.record->key;
  return old.submission == work.key.submission && old.judging == work.key.judging;
}

}  // namespace

bool is_asked_for(const GradedWork& work, const GradeOptions& options) {
  const auto& only = options.only;
  return only.empty() || std::find(only.begin(), only.end(), work.submission->name) != only.end();
}

bool verdicts_stand(const GradedWork& work, const GradeOptions& options) {
  return has_same_verdicts(work) && work.earlier.record->grade.faults.empty() &&
         pictures_do(work, options);
}

bool is_current(const GradedWork& work, const GradeOptions& options) {
  return verdicts_stand(work, options) && work.earlier.record->key.rubric == work.key.rubric;
}

bool is_current_but_for_a_stage(const GradedWork& work, const GradeOptions& options) {
  if (!has_same_verdicts(work) || work.earlier.record->grade.faults.empty()) return false;
  // the record of a process that died behind the verdicts has no pictures
  const GradeKey& old = work.earlier.record->key;
  return old.rubric == work.key.rubric && (pictures_do(work, options) || old.pictures.empty());
}

std::vector<std::string> folders_for(const std::vector<Submission>& submissions) {
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

void MarksOfClass::let_go_of_details(GradeRecord& record) {
  const auto empty = [](auto& field) { std::remove_reference_t<decltype(field)>().swap(field); };
  empty(record.files);
  Grade& grade = record.grade;
  grade.cost = CostSection();
  empty(grade.causes);
  if (grade.state == GradeState::kDoesNotCompile) empty(grade.story);
  for (SceneMedia& media : grade.media) {
    empty(media.about);
    empty(media.story);
    empty(media.checks);
    empty(media.functions);
  }
  if (grade.tests.empty()) return;
  std::vector<RubricItem> items;
  for (const ScoredTest& test : grade.tests) {
    items.push_back(test.item);
    grade.marks.verdicts.push_back(test.result.verdict);
  }
  if (!items_ || *items_ != items)
    items_ = std::make_shared<const std::vector<RubricItem>>(std::move(items));
  grade.marks.items = items_;
  empty(grade.tests);
}

GradeRecord fault_record(const GradedWork& work, const std::string& id, const Rubric& rubric,
                         const std::string& why) {
  GradeRecord record;
  record.key = work.key;
  record.key.pictures.clear();
  record.assignment = id;
  Grade& grade = record.grade;
  grade.name = work.submission->name;
  grade.folder = work.folder;
  grade.notes = work.submission->notes;
  grade.story = why;
  grade.tests = score_nothing(rubric, Verdict::kGraderFault, why);
  add_up(grade);
  return record;
}

void remark_equal_files(std::vector<GradedWork>& all) {
  std::map<std::string, std::vector<GradedWork*>> by_digest;
  for (GradedWork& work : all)
    if (!work.submission->source.empty())
      by_digest[digest_of_file(work.submission->source)].push_back(&work);
  constexpr std::size_t kMostNamed = 5;  // of a class that hands in the starter there are many
  for (const auto& [bytes, equal] : by_digest)
    for (GradedWork* work : equal) {
      const std::size_t others = equal.size() - 1, named = std::min(others, kMostNamed);
      std::string names;
      std::size_t k = 0;
      for (auto other = equal.begin(); k < named; ++other) {
        if (*other == work) continue;
        const bool ends_list = ++k == named && named == others;
        names += (k == 1      ? ""
                  : ends_list ? " and "
                              : ", ") +
                 plain_name((*other)->submission->name);
      }
      if (named < others) names += fmt::format(" and {} more", others - named);
      if (others > 0)
        work->remarks.push_back(fmt::format("the same file, byte for byte, as {} of {}",
                                            others == 1 ? "that" : "those", names));
    }
}

void report_doubles(std::vector<GradedWork>& all, const Notice& notice) {
  std::map<std::pair<std::string, std::string>, std::vector<GradedWork*>> by_student;
  for (GradedWork& work : all)
    by_student[{work.submission->name, work.submission->student_id}].push_back(&work);
  for (const auto& [student, works] : by_student) {
    if (works.size() < 2) continue;
    notice(
        fmt::format("{}: {} submissions of that name: the gradebook has a row for each, and a "
                    "system that reads it may keep the last. Leave only one.",
                    plain_name(student.first), works.size()));
    for (GradedWork* work : works)
      work->remarks.push_back(fmt::format("one of {} submissions of this name", works.size()));
  }
}

void report_distrusted(const std::vector<GradedWork>& all, const Notice& notice) {
  constexpr std::size_t kNamed = 5;
  std::size_t count = 0;
  for (const GradedWork& work : all) {
    if (work.earlier.problem.empty() || work.is_left_out) continue;
    if (++count <= kNamed)
      notice(plain_name(work.submission->name) + ": the earlier result is not reused, because " +
             work.earlier.problem + "; graded again");
  }
  if (count > kNamed) notice(fmt::format("... and {} more", count - kNamed));
}

void refuse_key_in(const fs::path& out) {
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

void refuse_unknown_names(const std::vector<std::string>& only,
                          const std::vector<Submission>& submissions) {
  std::vector<std::string> known;
  for (const Submission& submission : submissions) known.push_back(submission.name);
  for (const std::string& name : only)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw UserError("--only " + plain_name(name),
                      "there is no submission of this name." + did_you_mean(name, known),
                      "The names are those of the folders of submissions.");
}

}  // namespace tumble::grading
