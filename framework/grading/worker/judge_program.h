/// main() of a judge: public and hidden tests of an assignment against a submission that runs somewhere else.
///
/// The judge never loads a submission's code. A test counts only when the judge itself saw every answer.
#pragma once

#include <functional>

#include "framework/grading/worker/worker_connection.h"
#include "framework/modules/under_test.h"

namespace tumble::grading {

/// Words of a judge:
///   judge_a1 --submission FILE.so [--json FILE] [--rubric FILE]... [--budget-s S] [--plain] [--quick] [PATTERN...]
/// --budget-s bounds the time of all tests together (TimeBudget); those after it are not run.
///   judge_a1 --list [PATTERN...]
/// --list prints the names of the tests, one a line, and runs none.
/// --plain runs the submission without a sandbox: for our own code only.
/// --quick ends loops without end as soon as a student's own check does: a person waits.
/// @param attach  makes the connection's proxy the module under test
int run_judge_program(const char* id, const std::function<void(modules::Connection&)>& attach, int argc, char** argv);

template <class Module>
int run_judge(int argc, char** argv) {
  static Module module;
  return run_judge_program(Module::kId, [](modules::Connection& connection) {
    module = modules::make_proxy<Module>(connection);
    modules::UnderTest<Module>::table = &module;
  }, argc, argv);
}

}  // namespace tumble::grading
