/// A test's story as a page shows it: named values, the terms of its equation as a table, and where
/// the equation has arms, a drawing of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/report/bench.h"
#include "framework/report/html.h"

namespace tumble::grading {

/// Where a page's links lead, and who reads it.
struct PageView {
  // page of the handout, relative to this page, and its name in stories ("a1_impulse"); empty:
  // stories name it without a link
  std::string handout = {}, handout_name = {};
  bool is_alone = false;          // there is no page of all submissions to go to
  report::Bench bench = {};       // its code, in the page; without a module: none
  std::string no_right_law = {};  // why the right law is not beside it, where it was to be
};

/// A line of an x-ray (framework/grading/verdicts/xray.h): "r_a   (1, 0, -1) m   <- mark".
struct StoryTerm {
  std::string name, value, mark;
};

/// What a story says, taken apart.
struct StoryParts {
  std::string before;                 // lines before the first named value
  std::vector<report::Field> fields;  // in their order, without the x-ray
  std::string equation;               // of the x-ray; empty: there is none
  std::vector<StoryTerm> terms;
};

/// @param story  as a terminal shows it: "  found:    2 m", "            r_a     (1, 0, 0) m"
StoryParts parts_of_story(const std::string& story);

/// The arms and directions among the terms: r, r_a, r_b; n, J, F. Nothing where none can be drawn.
std::optional<report::Arms> arms_of(const std::vector<StoryTerm>& terms);

/// "read", with places of the handout as links.
report::Field reading(const std::string& places, const PageView& view);

/// Adds the story, each of its scenes by itself. Its handout is a link.
void add_story(report::Page& page, const std::string& story, const PageView& view);

}  // namespace tumble::grading
