/// Are the tests any good? Known-wrong solutions must each be caught, and right ones must get every
/// point.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/course/slip.h"
#include "framework/grading/course/course.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// What is audited: a known-wrong solution, a slip (slip.h) or a whole file, whose first two lines
/// are
///   // mutant: NAME - what the slip is
///   // caught-by: words that the story of a test that catches it must hold
/// or a right one, which has no such lines.
struct Candidate {
  std::string name;
  std::filesystem::path file;
  bool is_right = false;
  std::string slip, keyword;
  // the right solution that a slip changes; empty for a whole file
  std::filesystem::path base = {};
};

/// The text that is judged.
struct JudgedSource {
  std::string text;
  std::optional<MadeSolution> made;  // of a slip and its base
};

struct AuditResult {
  Candidate candidate;
  std::string fault;                  // it does not compile, or the judge failed; empty: judged
  std::vector<TestResult> caught_by;  // tests that it did not pass, in the judge's order
  double score = 0.0, possible = 0.0;
  // the test to look at: one whose story holds the keyword, else the first
  std::string best;
  bool is_named = false;  // some story holds the keyword

  /// A wrong one that a test caught, or a right one with every point.
  bool is_as_it_should() const;
};

/// The right solution that the course calls its own.
std::filesystem::path reference_of(const Course& course, const std::string& id);

/// Known-wrong solutions of a folder (the assignment's own where empty), then the reference and the
/// other right ones.
/// @throws UserError for a folder without sources; and one that names every file that is not
///         written as above
std::vector<Candidate> find_candidates(const Course& course, const std::string& id,
                                       const std::filesystem::path& mutants = {});

/// @throws UserError that names every slip which does not fit its base
std::vector<JudgedSource> sources_of(const std::vector<Candidate>& candidates);

/// Compiles and judges all, `jobs` at a time. What has not changed since an earlier audit is not
/// run again (BUILD/audit, kept_file.h). The whole text of each slip is left for people to read and
/// to run, in BUILD/audit/ID/slips/.
/// @param told  called as each is finished: how many of how many; may be empty
/// @throws UserError as sources_of does, before anything is judged
/// @pre  this process runs no thread
std::vector<AuditResult> audit(
    const Course& course, const std::string& id, const std::vector<Candidate>& candidates, int jobs,
    const std::function<void(std::size_t done, std::size_t total)>& told = {});

/// What an earlier audit of the same tests found of the assignment's own known-wrong solutions.
/// Nothing is run: those that were not judged yet, or have changed since, are left out.
std::vector<AuditResult> kept_audit(const Course& course, const std::string& id);

/// The candidates of these names; all of them where there is none.
/// @throws UserError for a name that no candidate has, with the nearest
std::vector<Candidate> only(const std::vector<Candidate>& candidates,
                            const std::vector<std::string>& names);

/// What one test does among known-wrong solutions. Right solutions that it accuses are no catch.
struct Catches {
  std::size_t count = 0;
  std::vector<std::string> alone;  // slips that no other test catches
};

/// By test. A test that catches nothing is not in it.
std::map<std::string, Catches> catches_of(const std::vector<AuditResult>& results);

}  // namespace tumble::grading
