/// The words on a test program's command line that choose tests.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

/// GoogleTest's own pattern language: '*' and '?', patterns joined by ':'. An empty filter chooses all.
bool chosen(const std::string& test, const std::string& filter);

/// The tests that the filter chooses, in their order.
/// @throws UserError with the nearest names when it chooses none
std::vector<std::string> chosen_tests(const std::vector<std::string>& tests, const std::string& filter);

/// A number of seconds after a flag. @throws UserError when it is none, or not above 0
double number_word(const std::string& flag, const std::string& word);

}  // namespace tumble::grading
