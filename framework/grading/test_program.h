/// Runs GoogleTest's tests one by one, each with a verdict of its own: the student's loop and the judge share it.
#pragma once

#include "framework/modules/under_test.h"

namespace tumble::grading {

/// Runs every test linked into this program against the functions linked into this program. Returns an exit code.
int run_tests(int argc, char** argv);

/// main() of a student's check program.
template <class Module>
int run_linked_tests(int argc, char** argv) {
  static const Module module = Module::linked();
  modules::UnderTest<Module>::table = &module;
  return run_tests(argc, argv);
}

}  // namespace tumble::grading
