#include "framework/grading/test_program/test_program.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/test_program/test_words.h"
#include "framework/grading/test_program/time_budget.h"
#include "framework/grading/verdicts/verdict_table.h"

namespace tumble::grading {
namespace {

// An endless loop ends within seconds, because the user waits; a test of a module takes
// milliseconds.
constexpr double kTestOwn = 2.0;     // s of own time (own_time.h), like the others
constexpr double kSuspectOwn = 0.2;  // s, for a call to a function that has timed out
constexpr double kBudget = 4.0;      // s, of all tests together

struct Words {
  std::string json, rubric, source;
  bool debug = false;
  TestLimits limits{.own_s = kTestOwn};
  TimeRules time{.budget_s = kBudget, .full_timeouts = 1, .suspect_own_s = kSuspectOwn};
  std::vector<std::string> chosen;  // test_words.h
  bool all = false;                 // a line for each test
};

Words read_words(int argc, char** argv) {
  Words words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return value_after(argc, argv, i); };
    if (word == "--json")
      words.json = value();
    else if (word == "--rubric")
      words.rubric = value();
    else if (word == "--source")
      words.source = value();
    else if (word == "--wall-s")
      words.limits.own_s = number_word(word, value());
    else if (word == "--budget-s")
      words.time.budget_s = number_word(word, value());
    else if (word == "--debug")
      words.debug = true;
    else if (word == "--all")
      words.all = true;
    else if (word.starts_with("--gtest_"))
      continue;  // already read by GoogleTest
    else if (word.starts_with("-"))
      throw UserError(word, "is not known here",
                      "Known: --json FILE, --rubric FILE, --source FILE, --wall-s S, --budget-s S, "
                      "--all, --debug, and patterns of test names, parts of titles, functions.");
    else
      words.chosen.push_back(word);
  }
  return words;
}

int run(const std::vector<std::string>& functions, int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const Words words = read_words(argc, argv);
  if (words.debug) {
    std::string filter;
    for (const std::string& word : words.chosen) filter += (filter.empty() ? "" : ":") + word;
    if (!filter.empty()) ::testing::GTEST_FLAG(filter) = filter;
    return RUN_ALL_TESTS();
  }
  TestLimits limits = words.limits;
  limits.source = words.source;
  TimeBudget budget(words.time);
  const Rubric rubric = words.rubric.empty() ? Rubric{} : read_rubric(words.rubric);
  const TestChoice choice(words.chosen, linked_tests(), rubric, functions);
  std::vector<TestResult> results;
  for (const std::string& test : choice.to_run()) {
    limits.call_own_s = budget.suspects();
    results.push_back(budget.is_used_up() ? budget.not_run(test)
                                          : run_isolated(test, limits, Process::kStudents));
    if (!results.back().not_run) budget.charge(results.back());
  }
  std::erase_if(results, [&](const TestResult& result) { return !choice.has(result); });
  if (!words.json.empty()) write_results(words.json, results);
  TableWords table = table_words_for(STDOUT_FILENO);
  if (!words.source.empty()) table.source = text_of(words.source);
  table.all = words.all;
  print_verdicts(std::cout, results, rubric, table);
  return static_cast<int>(exit_code(results));
}

}  // namespace

int run_check_program(const std::vector<std::string>& functions, int argc, char** argv) {
  try {
    return run(functions, argc, argv);
  } catch (const UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(ExitCode::kUserError);
  }
}

const void* load_first_word(const modules::ModuleName& name, int argc, char** argv) {
  try {
    if (argc < 2) throw UserError(argv[0], "needs a shared object", "Run tumble check.");
    return modules::load_functions(name, argv[1]);
  } catch (const UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return nullptr;
  }
}

}  // namespace tumble::grading
