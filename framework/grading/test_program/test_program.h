/// main() of a student's check program: runs its tests one by one, each with a verdict and a story.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/test_program/test_runner.h"
#include "framework/modules/load.h"
#include "framework/modules/under_test.h"

namespace tumble::grading {

/// Command line of a check program:
///   check_a1 [--json FILE] [--rubric FILE] [--source FILE] [--wall-s S] [--budget-s S]
///   [--all] [--debug] [WORD...]
/// --wall-s limits each test's own time (own_time.h), --budget-s all tests together (TimeBudget),
/// so that an endless loop ends soon. WORDs choose tests (test_words.h):
/// "CollisionImpulse.*", "Two walls", "collision_impulse". --all has a line for each test.
/// --debug runs plain GoogleTest in this process, for gdb.
/// @param functions  of the module
/// @return an exit code: 0 all right, 1 something is wrong, 2 wrong arguments, 4 some tests not
///   attempted and the others right
int run_check_program(const std::vector<std::string>& functions, int argc, char** argv);

/// Their names, in header order.
template <class Module>
std::vector<std::string> names_of_functions(const Module& module) {
  std::vector<std::string> names;
  Module::visit(module, [&](const char* name, const auto&) { names.emplace_back(name); });
  return names;
}

/// The functions of the shared object that the first word names.
/// @return null where it cannot be loaded, after a message
const void* load_first_word(const modules::ModuleName& name, int argc, char** argv);

/// The tests against the functions linked into this program.
template <class Module>
int run_linked_tests(int argc, char** argv) {
  static const Module module = observed(Module::of(Module::linked()));
  modules::UnderTest<Module>::table = &module;
  return run_check_program(names_of_functions(module), argc, argv);
}

/// The tests against a shared object built from a student's file: the first word. For an installed
/// course, where nothing is linked.
template <class Module>
int run_loaded_tests(int argc, char** argv) {
  const void* loaded =
      load_first_word(modules::find_name(assignment_names(), Module::kId), argc, argv);
  if (loaded == nullptr) return static_cast<int>(ExitCode::kUserError);
  static const Module module =
      observed(Module::of(*static_cast<const typename Module::Addresses*>(loaded)));
  modules::UnderTest<Module>::table = &module;
  return run_check_program(names_of_functions(module), argc - 1, argv + 1);
}

}  // namespace tumble::grading
