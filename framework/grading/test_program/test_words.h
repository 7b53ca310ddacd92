/// Words on the command line of a program that runs tests.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// GoogleTest's pattern language: '*' and '?', patterns separated by ':'. An empty filter selects
/// all.
bool chosen(const std::string& test, const std::string& filter);

/// What the words on a command line choose. A word is a pattern of test names; else the name of a
/// function of the module: all tests that end in it, which only their run says; else a part of a
/// title or of a name, in upper or lower case. All words together may be one part of a title.
class TestChoice {
 public:
  /// @param tests      all of the program
  /// @param rubric     gives titles; may be empty
  /// @param functions  of the module
  /// @throws UserError with the nearest titles and names where a word chooses nothing
  TestChoice(const std::vector<std::string>& words, const std::vector<std::string>& tests,
             const Rubric& rubric, const std::vector<std::string>& functions);

  /// Those to be run, in their order: all of them where a function was named.
  const std::vector<std::string>& to_run() const { return to_run_; }
  /// Whether a result belongs to what was chosen. A test that was not run may.
  bool has(const TestResult& result) const;

 private:
  std::vector<std::string> to_run_;
  std::set<std::string> tests_, functions_;  // chosen by their own names
};

/// The word after argv[i], which is the value of that option; `i` becomes its index.
/// @throws UserError where there is none
std::string value_after(int argc, char** argv, int& i);

/// The number of seconds after a flag.
/// @throws UserError when it is not a number above 0
double number_word(const std::string& flag, const std::string& word);

}  // namespace tumble::grading
