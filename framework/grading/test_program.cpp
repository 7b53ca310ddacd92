#include "framework/grading/test_program.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include <gtest/gtest.h>

#include "framework/grading/test_words.h"
#include "framework/grading/verdict_table.h"

namespace tumble::grading {
namespace {

struct Words {
  std::string json, rubric;
  bool debug = false;
  TestLimits limits;
  std::string filter;   // GoogleTest's, patterns joined by ':'
};

Words read_words(int argc, char** argv) {
  Words words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= argc) throw UserError(word, "needs a value");
      return argv[++i];
    };
    if (word == "--json") words.json = value();
    else if (word == "--rubric") words.rubric = value();
    else if (word == "--wall-s") words.limits.wall_s = std::atof(value().c_str());
    else if (word == "--debug") words.debug = true;
    else if (word.starts_with("--gtest_")) continue;  // GoogleTest has read it
    else if (word.starts_with("-")) throw UserError(word, "is not known here", "Known: --json FILE, --rubric FILE, --wall-s S, --debug, and patterns of test names.");
    else words.filter += (words.filter.empty() ? "" : ":") + word;
  }
  return words;
}

int run(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const Words words = read_words(argc, argv);
  if (words.debug) {
    if (!words.filter.empty()) ::testing::GTEST_FLAG(filter) = words.filter;
    return RUN_ALL_TESTS();
  }
  std::vector<TestResult> results;
  for (const std::string& test : linked_tests())
    if (chosen(test, words.filter)) results.push_back(run_isolated(test, words.limits, Process::kStudents));
  if (results.empty()) throw UserError(words.filter, "no test has such a name", "--debug --gtest_list_tests lists them.");
  const Rubric rubric = words.rubric.empty() ? Rubric{} : read_rubric(words.rubric);
  if (!words.json.empty()) write_results(words.json, results);
  print_verdicts(std::cout, results, rubric, ::isatty(STDOUT_FILENO) == 1);
  return static_cast<int>(exit_code(results));
}

}  // namespace

int run_check_program(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(ExitCode::kUserError);
  }
}

}  // namespace tumble::grading
