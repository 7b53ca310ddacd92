/// What the results of a class say together: slips, tests, changes. Pure functions of grades.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_pages.h"

namespace tumble::grading {

/// A slip, as the stories of failing tests name it after "likely:", with the submissions that made
/// it.
struct SlipCount {
  std::string slip;
  std::vector<std::string> names;
};

/// @return the slips that the most submissions made, most frequent first; equal ones by their text
std::vector<SlipCount> slips_made_most(const std::vector<Grade>& grades, std::size_t most = 10);

/// How a class did in one test.
struct TestCount {
  RubricItem item;
  std::size_t right = 0, judged = 0;  // submissions
};

/// Every test in the rubric's order; submissions that did not compile count as not right.
std::vector<TestCount> test_counts(const std::vector<Grade>& grades);

/// Submissions of the same text, byte for byte: each group has at least two names.
std::vector<std::vector<std::string>> equal_submissions(const std::vector<GradeRecord>& records);

/// All trusted results of a folder of results, by name of their folder.
/// @param notice  called with a sentence for each that is not trusted
std::vector<GradeRecord> records_of(const std::filesystem::path& out, const std::string& assignment,
                                    const std::string& machine_key,
                                    const std::function<void(const std::string&)>& notice);

}  // namespace tumble::grading
