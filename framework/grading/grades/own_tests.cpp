#include "framework/grading/grades/own_tests.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include <fmt/format.h>

#include "framework/core/digest.h"
#include "framework/core/files.h"
#include "framework/core/text.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/grading/course/build_submission.h"
#include "framework/core/run_program.h"
#include "framework/grading/grades/audit.h"
#include "framework/grading/grades/kept_file.h"
#include "framework/grading/grades/own_test_names.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr int kRuns = 2;            // of each module: one would not show a verdict by chance
constexpr double kRunWall = 600.0;  // s: the relay has limits of its own, far shorter
constexpr int kMostSlow = 4;        // runs that end out of time; then the rest is not run

struct Module {
  Candidate candidate;
  std::string text;
  fs::path kept;  // compiled (kept_file.h)
};

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

fs::path relay_of(const Course& course, const std::string& id) {
  return course.build / "bin" / ("own_tests_" + id);
}

// The slips of the rule, in an order that says nothing of their names; then the right solutions.
std::vector<Module> modules_of(const Course& course, const std::string& id) {
  const auto rule = rubric_of(course, id).own_tests;
  require(rule.has_value(), "own tests: the rubric has no rule for them");
  std::vector<Candidate> all = find_candidates(course, id), chosen;
  for (const std::string& slip : rule->slips) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Candidate& c) {
      return !c.is_right && c.file.stem() == slip;
    });
    if (found == all.end())
      throw UserError("rubric_hidden.json of " + id + " /own_tests/slips",
                      "no known-wrong solution is called '" + slip + "'");
    chosen.push_back(*found);
  }
  const auto order = [](const Candidate& c) { return digest("own tests " + c.name); };
  std::sort(chosen.begin(), chosen.end(),
            [&](const Candidate& a, const Candidate& b) { return order(a) < order(b); });
  for (const Candidate& candidate : all)
    if (candidate.is_right) chosen.push_back(candidate);
  const std::vector<JudgedSource> sources = sources_of(chosen);
  // what decides the bytes of an object beside its text
  const std::string made_by = digest_of_file("/usr/bin/g++") +
                              digest_of_file(module_header(course, id)) +
                              traits_of(chosen_sandbox()).name;
  const fs::path kept = (course.kept.empty() ? course.build : course.kept) / "own_tests" / id;
  std::vector<Module> modules;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    modules.push_back(
        {chosen[i], sources[i].text,
         kept / (digest(made_by + digest(sources[i].text)).substr(0, 32) + ".module")});
  return modules;
}

void build(const Course& course, const std::string& id, const Module& module) {
  const PrivateFolder folder;
  const fs::path file = folder.path() / (module.candidate.file.stem().string() + ".cpp"),
                 object = folder.path() / "module.so";
  write_whole(file, module.text);
  const BuiltSubmission built = build_submission(course, id, file, object);
  if (built.outcome != BuiltSubmission::Outcome::kBuilt)
    throw UserError(module.candidate.file.string(), "does not compile: " + built.said);
  keep_file(module.kept, text_of(object));
}

// What a student reads of a test, the better before the worse.
enum class SaidOfTest { kCatchesNothing, kCatches, kUnsteady, kAccuses };

const char* words_for_student(SaidOfTest said) {
  switch (said) {
    case SaidOfTest::kAccuses:
      return " accuses a right solution: it catches nothing, and takes one slip back";
    case SaidOfTest::kUnsteady:
      return " gave two verdicts for one module: it catches nothing, and takes one slip back";
    case SaidOfTest::kCatches: return " caught at least one slip";
    case SaidOfTest::kCatchesNothing: break;
  }
  return " caught no slip";
}

// One run of all tests on one module. @return nothing where the grader failed
std::optional<std::vector<TestResult>> run_once(const Course& course, const std::string& id,
                                                const fs::path& program, const fs::path& kept) {
  // whole when the grading began: the next one makes it again
  const std::optional<std::string> module = kept_file(kept);
  if (!module) return std::nullopt;
  const PrivateFolder folder;
  // A name that is the same for every module.
  const fs::path object = folder.path() / "module.so", record = folder.path() / "results.json";
  write_whole(object, *module);
  const ProgramOutcome outcome =
      run_program({relay_of(course, id).string(), "--tests", program.string(), "--submission",
                   object.string(), "--json", record.string(), "--quick"},
                  Output::kCaptured, kRunWall);
  // A relay that died without a result was killed by what the tests sent: no test has passed.
  if (!fs::exists(record)) {
    if (outcome.code >= 128) return std::vector<TestResult>{};
    return std::nullopt;
  }
  return read_results(record.string());
}

}  // namespace

bool wants_own_tests(const Course& course, const std::string& id) {
  const auto rule = rubric_of(course, id).own_tests;
  // a kind of sandbox in which no file is opened has no program that loads GoogleTest
  return rule && !rule->slips.empty() && !traits_of(chosen_sandbox()).links_worker;
}

void prepare_own_tests(const Course& course, const std::string& id) {
  for (const fs::path& file :
       {relay_of(course, id), fs::path(relay_of(course, id).string() + ".o")})
    if (!fs::exists(file))
      throw UserError(file.string(), "is not built", "Build it: ninja -C build own_tests_" + id);
  for (const Module& module : modules_of(course, id)) {
    if (!kept_file(module.kept)) build(course, id, module);
  }
}

std::string own_tests_digest(const Course& course, const std::string& id) {
  const auto rule = rubric_of(course, id).own_tests;
  std::string text = fmt::format("{} {} ", rule->points, rule->share) +
                     digest_of_file(relay_of(course, id)) +
                     digest_of_file(relay_of(course, id).string() + ".o");
  for (const Module& module : modules_of(course, id))
    text += module.candidate.name + digest(module.text);
  return digest(text);
}

OwnTestsGrade judge_own_tests(const Course& course, const std::string& id, const fs::path& tests) {
  const OwnTestsRule rule = *rubric_of(course, id).own_tests;
  OwnTestsGrade grade;
  grade.is_there = true;
  grade.possible = rule.points;
  const PrivateFolder folder;
  const fs::path program = folder.path() / "tests";
  const BuiltSubmission built = build_own_tests(course.root, course.build, id,
                                                course.registry->find(id).folder, tests, program);
  if (built.outcome != BuiltSubmission::Outcome::kBuilt) {
    grade.is_final = built.outcome == BuiltSubmission::Outcome::kRefused;
    grade.story =
        "does not compile: " + compiler_story(built.said, tests, module_header(course, id));
    return grade;
  }
  const std::vector<Module> modules = modules_of(course, id);
  std::vector<TriedModule> tried;
  std::size_t slips = 0, rights = 0;
  for (const Module& module : modules)
    tried.push_back({module.candidate.is_right ? fmt::format("right solution {}", ++rights)
                                               : fmt::format("slip {}", ++slips),
                     module.candidate.name,
                     module.candidate.is_right,
                     {}});
  std::vector<std::size_t> order;
  for (int run = 0; run < kRuns; ++run)
    for (std::size_t i = 0; i < modules.size(); ++i) order.push_back(i);
  // The result is the same in any order; a file of tests must not know it.
  std::shuffle(order.begin(), order.end(), std::mt19937_64(std::random_device{}()));
  std::set<std::string> names;
  std::vector<std::pair<std::size_t, std::vector<TestResult>>> runs;
  int slow = 0;
  for (const std::size_t i : order) {
    auto results = run_once(course, id, program, modules[i].kept);
    if (!results || std::any_of(results->begin(), results->end(),
                                [](const TestResult& r) { return !is_final_verdict(r.verdict); })) {
      grade.is_final = false;
      grade.story = "the grader could not run them; this costs no points, and is tried again";
      return grade;
    }
    slow += std::any_of(results->begin(), results->end(), [](const TestResult& r) {
      return r.verdict == Verdict::kOutOfResources && r.timed_out_s == 0.0 && r.calls == 0;
    });
    if (slow >= kMostSlow) {
      grade.story = fmt::format("out of time: the tests themselves did not end in {} runs", slow);
      return grade;
    }
    for (const TestResult& result : *results) names.insert(result.test);
    runs.emplace_back(i, std::move(*results));
  }
  // A test that did not run did not pass.
  for (const auto& [i, results] : runs) {
    std::vector<std::string> failed;
    for (const std::string& name : names)
      if (std::none_of(results.begin(), results.end(), [&](const TestResult& r) {
            return r.test == name && r.verdict == Verdict::kRight;
          }))
        failed.push_back(name);
    tried[i].failed.push_back(std::move(failed));
  }
  return graded_own_tests(rule, {names.begin(), names.end()}, tried,
                          names_of_tests(text_of(tests)));
}

OwnTestsGrade graded_own_tests(const OwnTestsRule& rule, const std::vector<std::string>& tests,
                               const std::vector<TriedModule>& modules,
                               const std::vector<std::string>& in_file) {
  std::map<std::string, std::set<std::string>> accuses;  // by test: right solutions
  std::set<std::string> unsteady;
  for (const TriedModule& module : modules) {
    for (const auto& run : module.failed) {
      for (const std::string& test : run)
        if (module.is_right) accuses[test].insert(module.shown);
      for (const std::string& test : tests) {
        const bool first = std::count(module.failed[0].begin(), module.failed[0].end(), test) > 0;
        if (first != (std::count(run.begin(), run.end(), test) > 0)) unsteady.insert(test);
      }
    }
  }
  std::set<std::string> bad = unsteady;
  for (const auto& [test, right] : accuses) bad.insert(test);
  // what is written anywhere; the points are those of the names that were reported
  std::map<std::string, std::string> shown;
  for (const std::string& test : tests) shown[test] = name_in_file(test, in_file);
  const auto names_of = [&](const auto& reported) {
    std::set<std::string> names;
    for (const std::string& test : reported) names.insert(shown.at(test));
    return std::vector<std::string>(names.begin(), names.end());
  };

  OwnTestsGrade grade;
  grade.is_there = true;
  grade.possible = rule.points;
  std::size_t slips = 0, caught = 0;
  std::set<std::string> catching;
  const auto name_for_grader = [&](const TriedModule& module, const std::string& how) {
    grade.names += (grade.names.empty() ? "" : "; ") + module.shown + " is " + module.name + how;
  };
  for (const TriedModule& module : modules) {
    if (module.is_right) continue;
    ++slips;
    std::vector<std::string> by;
    for (const std::string& test : module.failed[0])
      if (!bad.contains(test)) by.push_back(test);
    caught += !by.empty();
    catching.insert(by.begin(), by.end());
    name_for_grader(module,
                    by.empty() ? ", not caught" : ", caught by " + joined_names(names_of(by)));
  }
  for (const TriedModule& module : modules) {
    if (!module.is_right) continue;
    std::vector<std::string> by;
    for (const auto& [test, right] : accuses)
      if (right.contains(module.shown)) by.push_back(test);
    name_for_grader(module, by.empty() ? "" : ", accused by " + joined_names(names_of(by)));
  }
  // For the student one word a name of the file, the worst of its instances: which slips it catches
  // would tell what a test can compute of each of them, and so would how many instances do.
  std::map<std::string, SaidOfTest> said_of;
  for (const std::string& test : tests) {
    const SaidOfTest said = accuses.contains(test)    ? SaidOfTest::kAccuses
                            : unsteady.contains(test) ? SaidOfTest::kUnsteady
                            : catching.contains(test) ? SaidOfTest::kCatches
                                                      : SaidOfTest::kCatchesNothing;
    const auto [it, is_new] = said_of.emplace(shown.at(test), said);
    it->second = std::max(it->second, said);
  }
  std::string lines;
  std::size_t bad_names = 0;
  for (const auto& [name, said] : said_of) {
    lines += name + words_for_student(said) + '\n';
    bad_names += said >= SaidOfTest::kUnsteady;
  }
  // at least one, or a file without tests would have all points
  const std::size_t needed = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(rule.share * static_cast<double>(slips) - 1e-9)));
  const std::size_t counted_slips = std::min(caught, needed);
  const std::size_t taken_back = std::min(counted_slips, bad.size());
  const std::size_t left = counted_slips - taken_back;
  constexpr double kGrain = 100.0;  // hundredths of a point
  grade.score =
      std::floor(rule.points * static_cast<double>(left) / static_cast<double>(needed) * kGrain +
                 1e-9) /
      kGrain;
  grade.story = fmt::format(
      "{}: {} of {} slips caught, {} needed for all {} points; {} against right solutions or not "
      "repeatable{}\n",
      counted(said_of.size(), "test"), caught, slips, needed, points_text(rule.points),
      counted(bad_names, "test"),
      taken_back == 0 ? "" : fmt::format(" ({} taken back)", counted(taken_back, "slip")));
  grade.story += lines;
  return grade;
}

}  // namespace tumble::grading
