/// The points of an assignment against its tests, its functions and its handout, read off the
/// sources: said with file and line, before anything is built.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::extend {

struct TestPlace {
  std::string name;   // "Suite.Name"
  std::string place;  // "tests/a5_plausible/mean_test.cpp:12"
  bool hidden;
};

/// Every TEST and TEST_F of an assignment's sources, public and hidden.
/// @param folder  "a5_plausible"
std::vector<TestPlace> tests_of_sources(const std::filesystem::path& root,
                                        const std::string& folder);

/// The functions that the header's TUMBLE_MODULE lists, in its order.
std::vector<std::string> functions_of_header(const std::filesystem::path& root,
                                             const std::string& folder);

/// What does not fit, a sentence each, beginning with "file:line: ": a test without points, points
/// for no test, a test in both rubrics or in the other one, a sum other than 100, a function that
/// no test calls, a row of the handout's table that is not the rubrics'. Empty: all fits.
std::vector<std::string> check_points(const std::filesystem::path& root, const std::string& folder);

/// The handout with the numbers of its table as the rubrics have them; else as it is.
/// @return its text
/// @throws UserError where the table or a row of it is missing, and as read_rubric
std::string with_points_of_rubrics(const std::filesystem::path& root, const std::string& folder);

}  // namespace tumble::extend
