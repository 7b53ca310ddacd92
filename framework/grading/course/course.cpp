#include "framework/grading/course/course.h"

#include <algorithm>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/run_program.h"
#include "framework/grading/sandbox/protection.h"

namespace tumble::grading {

namespace fs = std::filesystem;

namespace {

// s: a list takes milliseconds; the machine may be loaded
constexpr double kListWall = 600.0;
constexpr const char* kSdk = "submission_sdk";  // precompiled header of compile.cpp

}  // namespace

fs::path judge_of(const Course& course, const std::string& id) {
  const fs::path judge =
      course.build / "bin" / (course.public_only ? "check_" + id + "_sandboxed" : "judge_" + id);
  if (!fs::exists(judge) && course.public_only)
    throw UserError(judge.string(), "is not built",
                    "Build it: ninja -C build check_" + id + "_sandboxed");
  if (!fs::exists(judge))
    throw UserError(judge.string(), "is not built",
                    "Grading needs the hidden tests, which students do not have. ./tumble check " +
                        id + " runs the public ones.");
  return judge;
}

fs::path built_module(const Course& course, const std::string& id, const std::string& word) {
  return course.build / "modules" / (id + '_' + word + ".so");
}

Rubric rubric_of(const Course& course, const std::string& id) {
  const std::string folder = course.registry->find(id).folder;
  Rubric rubric = read_rubric(course.root / "assignments" / folder / "rubric.json");
  if (!course.public_only)
    rubric = joined(
        rubric,
        read_rubric(course.root / "solutions_private" / folder / "rubric_hidden.json", true));
  if (rubric.title.empty()) rubric.title = course.registry->find(id).title;
  return rubric;
}

std::vector<fs::path> scenes_of(const Course& course, const std::string& id) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(
           course.root / "assignments" / course.registry->find(id).folder / "scenes", ignored))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> tests_of_judge(const Course& course, const std::string& id) {
  const ProgramOutcome outcome =
      run_program({judge_of(course, id).string(), "--list"}, Output::kCaptured, kListWall);
  std::vector<std::string> tests;
  std::istringstream lines(outcome.printed);
  for (std::string line; std::getline(lines, line);) tests.push_back(line);
  if (outcome.code != 0 || tests.empty())
    throw UserError(judge_of(course, id).filename().string(),
                    "does not list its tests: " + outcome.printed,
                    "Build it again (ninja judge_" + id + "), and grade when the build has ended.");
  return tests;
}

void require_rubric_of_judge(const Course& course, const std::string& id) {
  const std::string folder = course.registry->find(id).folder;
  const fs::path open = course.root / "assignments" / folder / "rubric.json",
                 hidden = course.root / "solutions_private" / folder / "rubric_hidden.json";
  const Rubric rubric = rubric_of(course, id);
  const std::vector<std::string> tests = tests_of_judge(course, id);
  std::vector<std::string> named;
  for (const RubricItem& item : rubric.items) {
    named.push_back(item.test);
    if (std::find(tests.begin(), tests.end(), item.test) != tests.end()) continue;
    throw UserError((item.hidden ? hidden : open).string(),
                    "names test '" + item.test + "', which judge_" + id + " does not have",
                    "Correct the name, or build judge_" + id + " with the test." +
                        did_you_mean(item.test, tests));
  }
  for (const std::string& test : tests)
    if (rubric.find(test) == nullptr)
      throw UserError(open.string(),
                      "has no entry for test '" + test + "' of judge_" + id + ", and neither has " +
                          hidden.string() + ": it would be worth nothing",
                      "Give the test an entry (with 0 points if it should earn none)." +
                          did_you_mean(test, named));
}

CourseSnapshot::CourseSnapshot(const Course& course, const std::string& id) : course_(course) {
  course_.kept = course.build;
  course_.build = folder_.path();
  const auto copy = [&](const fs::path& file) {
    std::error_code failed;
    fs::create_directories((course_.build / file).parent_path());
    fs::copy_file(course.build / file, course_.build / file, failed);
    if (failed)
      throw UserError(
          (course.build / file).string(), "cannot be copied: " + failed.message(),
          "Build it (ninja " + file.stem().string() + "), and grade when the build has ended.");
  };
  const std::string judge = judge_of(course, id).filename().string();
  for (const std::string& program : {judge, "worker_" + id, std::string("sandbox_init")})
    copy(fs::path("bin") / program);
  if (traits_of(chosen_sandbox()).links_worker) copy(fs::path("bin") / ("worker_" + id + ".o"));
  // of a course whose rubric has a rule for own tests: prepare_own_tests says where one is missing
  for (const std::string& file : {"own_tests_" + id, "own_tests_" + id + ".o"})
    if (fs::exists(course.build / "bin" / file)) copy(fs::path("bin") / file);
  for (const modules::ModuleKind* kind : course.registry->all())
    if (const fs::path file = built_module(course, kind->id, "reference"); fs::exists(file))
      copy(file.lexically_relative(course.build));
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(course.build / kSdk, ignored))
    copy(fs::path(kSdk) / entry.path().filename());
}

}  // namespace tumble::grading
