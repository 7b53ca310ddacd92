#include "framework/grading/grades/class_overview.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "framework/grading/course/handout_page.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

void make_page(const GradeOptions& options, const std::string& what,
               const std::function<void()>& make) {
  try {
    make();
  } catch (const std::exception& error) {
    if (!options.failed) throw;
    options.failed(what, error.what());
  }
}

void report_left_out(const GradeOptions& options, const std::vector<GradedWork>& all) {
  std::size_t left_out = 0, distrusted = 0;
  for (const GradedWork& work : all)
    (work.earlier.problem.empty() ? left_out : distrusted) += work.is_left_out;
  if (!options.notice) return;
  if (left_out > 0)
    options.notice(
        fmt::format("{} submissions were never graded and are not in the overview: grade all of "
                    "them with tumble grade",
                    left_out));
  if (distrusted > 0)
    options.notice(
        fmt::format("the earlier results of {} submissions do not count, and they are not in the "
                    "overview: grade all of them with tumble grade",
                    distrusted));
}

}  // namespace

std::vector<Grade> write_overview(const GradingTerms& terms, std::vector<GradedWork>& all) {
  const GradeOptions& options = terms.options;
  const fs::path& out = terms.out;
  report_left_out(options, all);
  std::vector<Grade> grades;
  nlohmann::ordered_json times = {{"command", terms.course.command},
                                  {"seconds", nlohmann::ordered_json::object()}};
  std::vector<fs::path> with_handout;
  for (GradedWork& work : all) {
    if (work.is_left_out) continue;
    if (work.record.grade.has_handout && !work.is_untouched)
      with_handout.push_back(out / work.folder);
    work.record.grade.remarks = work.remarks;
    work.record.grade.student_id = work.submission->student_id;
    grades.push_back(std::move(work.record.grade));
    if (work.seconds > 0.0) times["seconds"][work.folder] = work.seconds;
  }
  // with a policy it is the overview's: without late days it must not even lie there meanwhile
  if (options.policy.empty())
    write_whole(out / "gradebook.csv", gradebook_csv(terms.kind.title, grades));
  make_page(options, "index.html", [&] {
    index_page(terms.kind, grades, static_cast<bool>(options.overview)).write(out / "index.html");
  });
  make_page(options, kHandoutPage, [&] {
    write_handout(terms.course, terms.id, out / kHandoutPage);
    for (const fs::path& place : with_handout) add_handout(out / kHandoutPage, place);
  });
  write_whole(out / "times.json",
              times.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
  if (options.overview) options.overview(out, grades);
  return grades;
}

}  // namespace tumble::grading
