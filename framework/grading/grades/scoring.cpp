#include "framework/grading/grades/scoring.h"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// s, for one judge: its own limits end every test much earlier, so beyond this the judge hangs.
constexpr double kJudgeWall = 3600.0;

}  // namespace

Judgement judge_module(const Course& course, const std::string& id, const fs::path& module,
                       bool plain, double budget_s) {
  Judgement judgement;
  const PrivateFolder folder;
  const fs::path record = folder.path() / "results.json";
  std::vector<std::string> words = {judge_of(course, id).string(),
                                    "--submission",
                                    module.string(),
                                    "--json",
                                    record.string(),
                                    "--budget-s",
                                    fmt::format("{:g}", budget_s)};
  if (plain) words.push_back("--plain");
  const ProgramOutcome outcome = run_program(words, Output::kCaptured, kJudgeWall);
  if (!fs::exists(record) || outcome.code == static_cast<int>(ExitCode::kUserError)) {
    judgement.fault = outcome.in_time
                          ? fmt::format("the judge ended with code {} and no results: {}",
                                        outcome.code, outcome.printed)
                          : fmt::format("the judge did not end in {} s", kJudgeWall);
    return judgement;
  }
  try {
    judgement.results = read_results(record.string());
  } catch (const UserError& error) {
    judgement.fault = std::string("the judge's results cannot be read: ") + error.what();
  }
  return judgement;
}

std::vector<ScoredTest> score_tests(const Rubric& rubric, const Judgement& judgement) {
  std::map<std::string, const TestResult*> by_name;
  for (const TestResult& result : judgement.results) by_name[result.test] = &result;
  std::vector<ScoredTest> scored;
  for (const RubricItem& item : rubric.items) {
    ScoredTest test{item, {}, 0.0};
    test.result.test = item.test;
    if (const auto it = by_name.find(item.test); it != by_name.end()) {
      test.result = *it->second;
      if (test.result.verdict == Verdict::kRight) test.score = item.points;
    } else {
      test.result.verdict = Verdict::kGraderFault;
      test.result.story =
          judgement.fault.empty() ? "the judge has no test of this name" : judgement.fault;
    }
    scored.push_back(std::move(test));
  }
  for (const TestResult& result : judgement.results)
    if (rubric.find(result.test) == nullptr)
      scored.push_back({{result.test, 0.0, "", result.test, true}, result, 0.0});
  return scored;
}

std::vector<ScoredTest> score_nothing(const Rubric& rubric, Verdict verdict,
                                      const std::string& story) {
  std::vector<ScoredTest> scored;
  for (const RubricItem& item : rubric.items) {
    ScoredTest test{item, {}, 0.0};
    test.result.test = item.test;
    test.result.verdict = verdict;
    test.result.story = story;
    scored.push_back(std::move(test));
  }
  return scored;
}

void add_up(Grade& grade) {
  grade.score = grade.possible = 0.0;
  for (const ScoredTest& test : grade.tests) {
    grade.score += test.score;
    grade.possible += test.item.points;
  }
  grade.score += grade.own_tests.score;  // extra points
  // Points have few decimals: rounding removes the round-off of their sum.
  constexpr double kGrain = 1e6;
  grade.score = std::round(grade.score * kGrain) / kGrain;
  grade.possible = std::round(grade.possible * kGrain) / kGrain;
}

std::string points_text(double points) { return fmt::format("{:.6g}", points); }

}  // namespace tumble::grading
