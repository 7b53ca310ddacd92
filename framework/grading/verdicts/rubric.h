/// The points of each test of an assignment: assignments/aN_name/rubric.json for public tests,
/// solutions_private/aN_name/rubric_hidden.json for hidden ones.
///
///   {"assignment": "a1", "title": "Impulse",
///    "tests": [{"test": "Suite.Name", "points": 5, "level": "basic", "title": "short human
///    title"}],
///    "own_tests": {"points": 5, "share": 0.75}}     may be left out; the hidden one has "slips"
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tumble::grading {

struct RubricItem {
  std::string test;  // "Suite.Name"
  double points = 0.0;
  std::string level;  // basic, intermediate, advanced
  std::string title;  // shown to the user
  bool hidden = false;

  bool operator==(const RubricItem&) const = default;
};

/// Extra points for a student's own tests (grades/own_tests.h).
struct OwnTestsRule {
  double points = 0.0;             // on top of those of the tests
  double share = 1.0;              // of the slips, to be caught for all of them
  std::vector<std::string> slips;  // names of known-wrong solutions; of the hidden rubric

  bool operator==(const OwnTestsRule&) const = default;
};

struct Rubric {
  std::string assignment;  // "a1"
  std::string title;
  std::vector<RubricItem> items;
  std::optional<OwnTestsRule> own_tests = {};

  /// @return null when no item names the test
  const RubricItem* find(const std::string& test) const;
  double total() const;
};

/// @throws UserError with file and entry: unreadable, a field missing or of a wrong type, a test
///   named twice, points below 0, an unknown level
Rubric read_rubric(const std::filesystem::path& file, bool hidden = false);

/// Public and hidden items together.
/// @throws UserError when a test is in both or the points do not sum to 100
Rubric joined(const Rubric& open, const Rubric& hidden);

}  // namespace tumble::grading
