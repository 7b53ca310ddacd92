/// The head of a graded page: what to mend first, by what it costs.
#pragma once

#include <string>

#include "framework/grading/grades/grade.h"
#include "framework/report/html.h"

namespace tumble::grading {

/// Where a page's links lead, and who reads it.
struct PageView {
  // page of the handout, relative to this page, and its name in stories ("a1_impulse"); empty:
  // stories name it without a link
  std::string handout = {}, handout_name = {};
  bool is_alone = false;  // there is no page of all submissions to go to
};

/// Adds the box of causes, each with its points, its place, one story and one picture. Nothing
/// where all is right.
void add_mend_first(report::Page& page, const Grade& grade, const PageView& view);

/// The anchor of a test's story in the page, without the #.
std::string anchor_of_story(const std::string& test);

/// A story as a page shows it: flush left, its handout as a link.
void add_story(report::Page& page, const std::string& story, const PageView& view);

}  // namespace tumble::grading
