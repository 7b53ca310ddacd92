/// Names of a student's own tests, as they stand in the file that was handed in.
///
/// A program of tests names its tests while it runs, and what it runs against answers it: a name
/// that is made then can hold an answer of a slip or of the reference. So every name that a page
/// shows is read from the file before anything runs, and what the program reports only chooses one
/// of these.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

/// In place of every reported name that does not stand in the file.
inline constexpr const char* kUnnamedTest = "a test whose name does not stand in the file";

/// "Suite.Name" of each TEST(Suite, Name), TEST_F, TEST_P and TYPED_TEST in the text, in its order.
std::vector<std::string> names_of_tests(const std::string& text);

/// The name in the file that a reported one belongs to: "Some/Suite.Name/3" is an instance of
/// "Suite.Name".
/// @return kUnnamedTest where none is
std::string name_in_file(const std::string& reported, const std::vector<std::string>& in_file);

}  // namespace tumble::grading
