/// main() of a student's check program: the tests linked into it, one by one, each with a verdict and a story of its own.
#pragma once

#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/test_program/test_runner.h"
#include "framework/modules/under_test.h"

namespace tumble::grading {

/// Words of a check program:
///   check_a1 [--json FILE] [--rubric FILE] [--wall-s S] [--budget-s S] [--debug] [PATTERN...]
/// --wall-s bounds each test's own time (own_time.h), --budget-s all of them together (TimeBudget): an endless loop must not bore its author.
/// PATTERNs are GoogleTest filters ("CollisionImpulse.*"). --debug runs GoogleTest plainly in this one process, for gdb.
/// @return an exit code: 0 all right, 1 something is wrong, 2 wrong words, 4 the rest is right but not all is attempted
int run_check_program(int argc, char** argv);

/// The tests against the functions linked into this program.
template <class Module>
int run_linked_tests(int argc, char** argv) {
  static const Module module = observed(Module::linked());
  modules::UnderTest<Module>::table = &module;
  return run_check_program(argc, argv);
}

}  // namespace tumble::grading
