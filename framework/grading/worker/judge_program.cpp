#include "framework/grading/worker/judge_program.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <iostream>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/test_program/test_runner.h"
#include "framework/grading/test_program/test_words.h"
#include "framework/grading/test_program/time_budget.h"
#include "framework/grading/verdicts/verdict_table.h"

namespace tumble::grading {
namespace {

// s of the judge's own CPU time per test. Tests take at most a few seconds, so beyond this the
// submission's answers cause too much work. The wall-clock limit is kPatience times as long, longer
// than that of the worker.
constexpr double kJudgesOwn = 60.0;
// tests ended by a busy machine; then the rest is not run, because it would not count either
constexpr int kMostBusy = 2;

TestResult not_run_for_busy(const std::string& test) {
  TestResult result;
  result.test = test;
  result.verdict = Verdict::kMachineBusy;
  result.not_run = true;
  result.story =
      "not run: the machine was too busy in " + std::to_string(kMostBusy) + " tests before it";
  return result;
}

struct Words {
  WorkerOptions worker;
  std::string json, source;
  std::vector<std::string> chosen;  // test_words.h
  bool list = false, quick = false, all = false;
  Rubric rubric;
  TimeRules time;
};

// The limits of a student's own check (test_program.cpp), because the user waits.
void be_quick(Words& words) {
  words.quick = true;
  words.worker.call_own_s = 2.0;
  words.time = {.budget_s = 4.0, .full_timeouts = 1, .suspect_own_s = 0.2};
}

Words read_words(const char* id, int argc, char** argv) {
  Words words;
  words.worker.id = id;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return value_after(argc, argv, i); };
    if (word == "--submission")
      words.worker.module = value();
    else if (word == "--json")
      words.json = value();
    else if (word == "--budget-s")
      words.time.budget_s = number_word(word, value());
    else if (word == "--source")
      words.source = value();
    else if (word == "--list")
      words.list = true;
    else if (word == "--all")
      words.all = true;
    else if (word == "--plain")
      words.worker.sandboxed = false;
    else if (word == "--quick")
      be_quick(words);
    else if (word == "--rubric") {
      const Rubric more = read_rubric(value());
      words.rubric.items.insert(words.rubric.items.end(), more.items.begin(), more.items.end());
    } else if (word.starts_with("-")) {
      throw UserError(
          word, "is not known here",
          "Known: --submission FILE.so, --json FILE, --rubric FILE, --source FILE, --budget-s S, "
          "--plain, --quick, --all, --list, and patterns of test names, parts of titles, "
          "functions.");
    } else {
      words.chosen.push_back(word);
    }
  }
  if (words.worker.module.empty() && !words.list)
    throw UserError("--submission", "is missing",
                    "Give the shared object of a compiled submission.");
  return words;
}

using Attach = std::function<void(modules::Connection&)>;

/// Every `stride`-th test from `first` on, against a worker and with a time budget of their own.
std::vector<TestResult> run_share(const Words& words, const Attach& attach,
                                  const std::vector<std::string>& tests, std::size_t first,
                                  std::size_t stride) {
  // Adopts the keepers of sandboxes whose test has ended, and waits for them at the end.
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  WorkerConnection connection(words.worker);
  attach(connection);
  TestLimits limits;
  limits.own_s = kJudgesOwn;
  limits.memory_bytes = 4ull << 30;
  TimeBudget budget(words.time);
  std::vector<TestResult> results;
  int busy = 0;
  for (std::size_t i = first; i < tests.size(); i += stride) {
    connection.suspect(budget.suspects());
    if (busy >= kMostBusy) {
      results.push_back(not_run_for_busy(tests[i]));
      continue;
    }
    results.push_back(budget.is_used_up() ? budget.not_run(tests[i])
                                          : run_isolated(tests[i], limits, Process::kGraders));
    if (results.back().verdict == Verdict::kMachineBusy) ++busy;
    if (!results.back().not_run) budget.charge(results.back());
  }
  return results;
}

/// Waits for all children, and returns the status of one of them.
int wait_for_all(::pid_t wanted) {
  int wanted_status = -1, status = 0;
  for (::pid_t pid = 0; (pid = ::waitpid(-1, &status, 0)) > 0 || errno == EINTR;)
    if (pid == wanted) wanted_status = status;
  return wanted_status;
}

/// All tests by two processes, so that whoever waits waits half as long. Who runs which test does
/// not depend on time: the same endless loops leave the same tests out on every machine.
std::vector<TestResult> run_in_halves(const Words& words, const Attach& attach,
                                      const std::vector<std::string>& tests) {
  const PrivateFolder folder;
  const std::string file = (folder.path() / "results").string();
  const ::pid_t second = ::fork();
  if (second < 0) throw std::runtime_error("no second process could be started");
  if (second == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    try {
      write_results(file, run_share(words, attach, tests, 1, 2));
      wait_for_all(0);
      ::_exit(0);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      ::_exit(1);
    }
  }
  const std::vector<TestResult> even = run_share(words, attach, tests, 0, 2);
  if (wait_for_all(second) != 0) throw std::runtime_error("every second test was lost");
  const std::vector<TestResult> odd = read_results(file);
  std::vector<TestResult> results;
  for (std::size_t i = 0; i < tests.size(); ++i)
    results.push_back(i % 2 == 0 ? even[i / 2] : odd.at(i / 2));
  return results;
}

int run(const char* id, const std::vector<std::string>& functions, const Attach& attach, int argc,
        char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const Words words = read_words(id, argc, argv);
  const TestChoice choice(words.chosen, linked_tests(), words.rubric, functions);
  const std::vector<std::string>& tests = choice.to_run();
  if (words.list) {
    for (const std::string& test : tests) std::cout << test << '\n';
    return static_cast<int>(ExitCode::kFine);
  }
  std::vector<TestResult> results;
  if (words.quick && tests.size() > 1) {
    results = run_in_halves(words, attach, tests);
  } else {
    results = run_share(words, attach, tests, 0, 1);
    wait_for_all(0);
  }
  std::erase_if(results, [&](const TestResult& result) { return !choice.has(result); });
  if (!words.json.empty()) write_results(words.json, results);
  TableWords table = table_words_for(STDOUT_FILENO);
  if (!words.source.empty()) table.source = text_of(words.source);
  table.all = words.all;
  print_verdicts(std::cout, results, words.rubric, table);
  return static_cast<int>(exit_code(results));
}

}  // namespace

int run_judge_program(const char* id, const std::vector<std::string>& functions,
                      const std::function<void(modules::Connection&)>& attach, int argc,
                      char** argv) {
  try {
    return run(id, functions, attach, argc, argv);
  } catch (const UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(ExitCode::kUserError);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "the judge failed: %s\n", error.what());
    return static_cast<int>(ExitCode::kOurBug);
  }
}

}  // namespace tumble::grading
