/// Points for a student's own tests: they catch slips without accusing right solutions.
///
/// The rubric has the rule: "own_tests": {"points": 5, "share": 0.75} in rubric.json, and
/// "own_tests": {"slips": ["NAME", ...]} in rubric_hidden.json. The points come on top of 100. A
/// file aN_name_tests.cpp beside the module is judged by them.
///
/// Each test runs on every slip and every right solution (the reference and the others), twice, in
/// an order drawn by lot, each time in new processes (own_tests/relay.h). A test counts where
///   - it gave the same verdict both times for every module, and
///   - it passed for every right solution.
/// It catches the slips for which it failed. A test that accuses a right solution, or whose
/// verdicts change, catches nothing and takes one caught slip back:
///   score = points * max(0, min(caught, needed) - bad tests) / needed,   needed = share * slips
///
/// What a file of tests could use to tell modules apart without testing them, and why it cannot:
///   name, source, bytes, addresses   the module is in another sandbox, behind the relay
///   order of the runs, a clock       the order is drawn, no state outlives a run, and a verdict
///                                    that is not repeated counts against its test
///   failing always, or by chance     accuses right solutions, or is not repeated
/// What it does learn is what a test is for: the answers. They are those of right solutions, too,
/// so nothing that it makes of them is shown: not what it prints, not the names that it reports
/// (own_test_names.h), not how many it reports, not which slips each test catches. A student's page
/// has the names that stand in the file, each with the worst that its instances did, how many slips
/// were caught in all, and how many of them were taken back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/course/course.h"
#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/grades/own_tests_grade.h"

namespace tumble::grading {

/// Whether the course has a rule for own tests and the modules to try them on.
bool wants_own_tests(const Course& course, const std::string& id);

/// Compiles every slip and right solution of the rule, where BUILD/own_tests has it not yet, or not
/// whole (kept_file.h).
/// @throws UserError when one is missing, does not compile, or a program is not built
void prepare_own_tests(const Course& course, const std::string& id);

/// Digest of all that decides the points of a file of tests.
std::string own_tests_digest(const Course& course, const std::string& id);

/// Judges a file of tests. @pre prepare_own_tests
OwnTestsGrade judge_own_tests(const Course& course, const std::string& id,
                              const std::filesystem::path& tests);

/// One module that tests were run on, with the verdicts of both runs.
struct TriedModule {
  std::string shown;  // "slip 3", "right solution 1"
  std::string name;   // of the slip
  bool is_right = false;
  std::vector<std::vector<std::string>> failed;  // tests that did not pass, as reported, by run
};

/// The rule above, on runs that have been made.
/// @param tests    all that ran, by the names that the program reported: each instance of a TEST_P
///   counts by itself
/// @param in_file  names that stand in the file, which alone are written (names_of_tests)
OwnTestsGrade graded_own_tests(const OwnTestsRule& rule, const std::vector<std::string>& tests,
                               const std::vector<TriedModule>& modules,
                               const std::vector<std::string>& in_file);

}  // namespace tumble::grading
