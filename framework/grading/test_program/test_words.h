/// Words on the command line of a program that runs tests.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

/// GoogleTest's pattern language: '*' and '?', patterns separated by ':'. An empty filter selects
/// all.
bool chosen(const std::string& test, const std::string& filter);

/// The tests that the filter selects, in their order.
/// @throws UserError with the nearest names when it selects none
std::vector<std::string> chosen_tests(const std::vector<std::string>& tests,
                                      const std::string& filter);

/// The word after argv[i], which is the value of that option; `i` becomes its index.
/// @throws UserError where there is none
std::string value_after(int argc, char** argv, int& i);

/// The number of seconds after a flag.
/// @throws UserError when it is not a number above 0
double number_word(const std::string& flag, const std::string& word);

}  // namespace tumble::grading
