/// What the results of a class say together: slips, tests, changes. Pure functions of grades.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/grade_pages.h"

namespace tumble::grading {

/// A slip with the tests that fail for it, as an audit found them.
struct KnownSlip {
  std::string slip;             // what is wrong
  std::string keyword;          // in the story of one of the tests
  std::set<std::string> tests;  // that do not pass it
};

/// The slips of one submission. Known slips come first: one is recognised where all tests fail that
/// fail for it, and one of their stories holds its keyword; the one that explains the most failing
/// tests is taken, then the one that explains the most of the rest, and so on. Where none is
/// recognised, the slips that stories name after "likely:".
std::set<std::string> slips_of(const Grade& grade, const std::vector<KnownSlip>& known);

/// A slip, with the submissions that made it.
struct SlipCount {
  std::string slip;
  std::vector<std::string> names;
};

/// Counts slips, one submission after the other.
class SlipTally {
 public:
  explicit SlipTally(std::vector<KnownSlip> known) : known_(std::move(known)) {}
  bool has_known() const { return !known_.empty(); }
  void add(const Grade& grade);
  /// The slips that the most submissions made, most frequent first; equal ones by their text.
  std::vector<SlipCount> made_most(std::size_t most = 10) const;

 private:
  std::vector<KnownSlip> known_;
  std::map<std::string, std::set<std::string>> names_;  // of submissions, by slip
};

/// How a class did in one test.
struct TestCount {
  RubricItem item;
  std::size_t right = 0, judged = 0;  // submissions
};

/// Every test in the rubric's order; submissions that did not compile count as not right.
std::vector<TestCount> test_counts(const std::vector<Grade>& grades);

/// Submissions of the same text, byte for byte: each group has at least two names.
std::vector<std::vector<std::string>> equal_submissions(const std::vector<GradeRecord>& records);

/// All trusted results of a folder of results, by name of their folder. One that is older than the
/// ledger's last score of the same file is not trusted: it was put back.
/// @param notice  called with a sentence for each that is left out, and why
std::vector<GradeRecord> records_of(const std::filesystem::path& out, const std::string& assignment,
                                    const std::string& machine_key,
                                    const std::function<void(const std::string&)>& notice);

}  // namespace tumble::grading
