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

/// Anchors in the page, without the #: of a test's story, of its row in the tables, of a scene.
std::string anchor_of_story(const std::string& test);
std::string anchor_of_row(const std::string& test);
std::string anchor_of_scene(const std::string& scene);

/// Whether the page has a story with a heading for this test.
bool has_story_in_page(const ScoredTest& test);

}  // namespace tumble::grading
