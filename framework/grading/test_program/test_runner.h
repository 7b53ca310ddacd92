/// Runs one GoogleTest test of this program in a separate process: a crash, a hang or excessive
/// memory use costs only that test.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

struct TestLimits {
  // own time (own_time.h): a test of a module takes milliseconds
  double own_s = 5.0;
  std::uint64_t memory_bytes = 2ull << 30;  // of address space; a module's test needs a few MB
  // [s], shorter limits of one call, by function (see TimeBudget)
  std::map<std::string, double> call_own_s = {};
  // the user's file, where its code is linked in: a crash is told with its line; may be empty
  std::string source = "";
};

/// Whose code runs in the test's process, and so whose fault a crash of that process is.
enum class Process {
  kStudents,  // the module is linked in
  kGraders,   // the module runs in another process
};

/// Names of all tests linked into this program, "Suite.Name", in the order of registration.
/// @pre InitGoogleTest was called
std::vector<std::string> linked_tests();

/// @param test  one of linked_tests()
TestResult run_isolated(const std::string& test, const TestLimits& limits, Process owner);

}  // namespace tumble::grading
