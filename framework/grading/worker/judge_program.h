/// main() of a judge: public and hidden tests of an assignment against a submission in another
/// process.
///
/// The judge never loads a submission's code. A test counts only when the judge itself has received
/// every answer.
#pragma once

#include <functional>

#include "framework/grading/test_program/test_program.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/modules/under_test.h"

namespace tumble::grading {

/// Command line of a judge:
///   judge_a1 --submission FILE.so [--json FILE] [--rubric FILE]... [--budget-s S] [--plain]
///   [--quick] [--all] [WORD...]
/// --budget-s limits the time of all tests together (TimeBudget); later tests are not run.
///   judge_a1 --list [WORD...]
/// --list prints the names of the tests, one per line, and runs none.
/// --plain runs the submission without a sandbox: for trusted code only.
/// WORDs choose tests (test_program/test_words.h); --all has a line for each in the table.
/// --quick has the short limits of a student's own check, because the user waits, and runs every
/// second test in a second process.
/// @param functions  of the module
/// @param attach     sets the connection's proxy as the module under test
int run_judge_program(const char* id, const std::vector<std::string>& functions,
                      const std::function<void(modules::Connection&)>& attach, int argc,
                      char** argv);

template <class Module>
int run_judge(int argc, char** argv) {
  static Module module;
  return run_judge_program(
      Module::kId, names_of_functions(module),
      [](modules::Connection& connection) {
        module = modules::make_proxy<Module>(connection);
        modules::UnderTest<Module>::table = &module;
      },
      argc, argv);
}

}  // namespace tumble::grading
