/// Builds and runs the test program of a student's file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/cli/command.h"
#include "framework/cli/words.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::cli {

struct CheckWords {
  std::string id;
  std::optional<std::filesystem::path> file;  // instead of the stub
  std::vector<std::string> patterns;          // choose tests (test_program/test_words.h)
  bool all = false;                           // a line for each test in the table
  bool first = false;                         // without the tests of whole scenes
  std::string own_tests;                      // the student's own tests in place of the public ones
  std::filesystem::path results;              // where verdicts are written as well; may be empty
  // of check_quietly(): a shared object of the user's own file, for which the file is not compiled
  // again as long as it is not newer; may be empty
  std::filesystem::path object = {};
};

/// The words "a1 [FILE] [TEST...] [--all]" as they are given.
struct GivenWords {
  std::string id;
  std::vector<std::string> rest;
  bool all = false;
};
/// Declares them on a verb.
void add_check_words(Verb& verb, GivenWords& given);
/// @throws UserError for an unknown assignment or a missing file
CheckWords read_check_words(const GivenWords& given);

/// The public rubric of the assignment.
std::filesystem::path public_rubric(const Command& command, const CheckWords& words);

/// The checked file.
std::filesystem::path checked_file(const Command& command, const CheckWords& words);

/// The public tests of a file, as data.
struct CheckedTests {
  std::string said;  // of the compiler, or why no test ran; empty where tests ran
  std::vector<grading::TestResult> results;
};
/// Builds, then runs the public tests. @throws UserError where the file is missing
CheckedTests check_quietly(const Command& command, const CheckWords& words);

/// Builds, then runs the public tests, which print their table. A compiler error is a verdict with
/// its position.
ExitCode check_once(const Command& command, const CheckWords& words);

}  // namespace tumble::cli
