#include "framework/grading/grades/batch_work.h"

#include <map>
#include <set>

#include <fmt/format.h>

#include "framework/core/digest.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/grades/grade_key.h"

namespace tumble::grading {

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

void remark_equal_files(std::vector<GradedWork>& all) {
  std::map<std::string, std::vector<GradedWork*>> by_digest;
  for (GradedWork& work : all)
    if (!work.submission->source.empty())
      by_digest[digest_of_file(work.submission->source)].push_back(&work);
  for (const auto& [bytes, equal] : by_digest)
    for (GradedWork* work : equal)
      for (const GradedWork* other : equal)
        if (other != work)
          work->remarks.push_back("the same file, byte for byte, as that of " +
                                  plain_name(other->submission->name));
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
    if (work.earlier.problem.empty()) continue;
    if (++count <= kNamed)
      notice(plain_name(work.submission->name) + ": the earlier result is not reused, because " +
             work.earlier.problem + "; graded again");
  }
  if (count > kNamed) notice(fmt::format("... and {} more", count - kNamed));
}

}  // namespace tumble::grading
