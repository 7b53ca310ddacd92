#include "framework/grading/grades/grade_submission.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "framework/grading/course/build_submission.h"
#include "framework/grading/course/handout_page.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/grading/grades/causes.h"
#include "framework/grading/grades/causes_file.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/grades/measure_cost.h"
#include "framework/grading/grades/own_tests.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/grades/stages.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// The shared object, removed at the end of the scope.
struct ObjectFile {
  fs::path path;
  ~ObjectFile() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

std::ptrdiff_t not_run(const Grade& grade) {
  return std::count_if(grade.tests.begin(), grade.tests.end(), [](const ScoredTest& t) {
    return t.result.not_run && t.result.verdict == Verdict::kOutOfResources;
  });
}

void judge(const Course& course, const std::string& id, const Submission& submission,
           const Rubric& rubric, const ObjectFile& object, double budget_s, Grade& grade) {
  if (!submission.problem.empty()) {
    grade.state = GradeState::kNothingToCompile;
    grade.story = submission.problem;
    grade.tests = score_nothing(rubric, Verdict::kNotAttempted, "nothing to compile");
    return;
  }
  const BuiltSubmission built = build_submission(course, id, submission.source, object.path);
  if (built.outcome == BuiltSubmission::Outcome::kGraderFault) {
    grade.story = "The compiler could not run: " + built.said;
    grade.tests = score_nothing(rubric, Verdict::kGraderFault, grade.story);
  } else if (built.outcome == BuiltSubmission::Outcome::kRefused) {
    grade.state = GradeState::kDoesNotCompile;
    grade.story = compiler_story(built.said, submission.source, module_header(course, id));
    grade.tests =
        score_nothing(rubric, Verdict::kWrong, "the file does not compile, so no test ran");
  } else {
    grade.tests = score_tests(rubric, judge_module(course, id, object.path, false, budget_s));
    if (const auto n = not_run(grade); n > 0)
      grade.notes.push_back(
          fmt::format("the time budget of {:g} s was used up by tests that ran out of time; {} of "
                      "{} tests were not run",
                      budget_s, n, grade.tests.size()));
    grade.state = GradeState::kJudged;
  }
}

void judge_own(const Course& course, const std::string& id, const fs::path& tests, Grade& grade) {
  if (!wants_own_tests(course, id)) {
    grade.notes.push_back("own tests earn no points here, and were not run");
    return;
  }
  try {
    grade.own_tests = judge_own_tests(course, id, tests);
  } catch (const std::exception& error) {  // not the verdicts' fault, which are shown
    grade.own_tests = {};
    grade.own_tests.is_there = true;
    grade.own_tests.is_final = false;
    grade.own_tests.story =
        "the grader could not run them; this costs no points, and is tried again";
    grade.faults.push_back(std::string("own tests: ") + error.what());
  }
}

}  // namespace

Grade grade_submission(const Course& course, const std::string& id, const Submission& submission,
                       const fs::path& folder, const GradeOptions& options,
                       const std::function<void(const Grade&)>& judged) {
  const Rubric rubric = rubric_of(course, id);
  fs::create_directories(folder);

  Grade grade;
  grade.name = submission.name;
  grade.folder = folder.filename().string();
  grade.notes = submission.notes;
  grade.has_handout = has_handout(course, id);
  const ObjectFile object{folder / ("." + id + ".so")};
  judge(course, id, submission, rubric, object, options.budget_s, grade);
  if (!submission.own_tests.empty()) judge_own(course, id, submission.own_tests, grade);
  add_up(grade);
  if (judged) judged(grade);
  if (grade.state != GradeState::kJudged) return grade;
  run_stage(grade, "what to mend first", [&] {
    grade.causes = causes_of(grade.tests, audited_slips_of(course, id),
                             submission.source.filename().string(), text_of(submission.source));
    for (Cause& cause : grade.causes)
      for (const std::string& function : cause.functions)
        cause.told.push_back(told_of_function(id, function));
  });
  if (options.draws(submission.name)) {
    const fs::path media = folder / "media";
    const bool is_drawn = run_stage(grade, "the pictures", [&] {
      grade.media =
          make_media(course, id, options.scenes.empty() ? scenes_of(course, id) : options.scenes,
                     object.path, media, options.media_options);
    });
    if (!is_drawn) fs::remove_all(media);
  }
  if (options.cost)
    run_stage(grade, "what accuracy costs",
              [&] { grade.cost = measure_cost(course, id, object.path); });
  return grade;
}

std::optional<Grade> graded_by(const Rubric& rubric, Grade earlier) {
  if (earlier.state == GradeState::kJudged) {
    Judgement judgement;
    for (const ScoredTest& test : earlier.tests) judgement.results.push_back(test.result);
    for (const RubricItem& item : rubric.items)
      if (std::none_of(judgement.results.begin(), judgement.results.end(),
                       [&](const TestResult& r) { return r.test == item.test; }))
        return std::nullopt;
    earlier.tests = score_tests(rubric, judgement);
  } else {
    if (earlier.tests.empty()) return std::nullopt;
    const TestResult all = earlier.tests.front().result;  // all have the same reason
    earlier.tests = score_nothing(rubric, all.verdict, all.story);
  }
  add_up(earlier);
  return earlier;
}

}  // namespace tumble::grading
