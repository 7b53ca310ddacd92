/// The head of a graded page: what to mend first, by what it costs.
#pragma once

#include <string>

#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/story_section.h"
#include "framework/report/html.h"

namespace tumble::grading {

/// Adds the box of causes, each with its points, its place, one story and one picture. Nothing
/// where all is right.
void add_mend_first(report::Page& page, const Grade& grade, const PageView& view);

/// The anchor of a test's story in the page, without the #.
std::string anchor_of_story(const std::string& test);

}  // namespace tumble::grading
