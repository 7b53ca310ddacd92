/// The pages of a graded folder.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/mend_first.h"
#include "framework/report/html.h"

namespace tumble::grading {

/// The page of one submission, for OUT/NAME/index.html. Its media are in media/ beside it.
report::Page submission_page(const modules::ModuleKind& kind, const Grade& grade,
                             const std::string& record, const PageView& view = {});

/// The grade as its student may see it before grades are published: a hidden test keeps its points,
/// and neither its name nor its story.
Grade for_student(Grade grade);

/// The page over all submissions, for OUT/index.html.
/// @param has_class_pages  class_files.h writes its pages beside it
report::Page index_page(const modules::ModuleKind& kind, const std::vector<Grade>& grades,
                        bool has_class_pages = true);

/// Parts of a page, for other reports.
void add_stories(report::Page& page, const Grade& grade, const PageView& view = {});
/// @param folder      of the media, relative to the page
/// @param has_causes  the page names what to mend: that, and not a smaller step, is the remedy
void add_media(report::Page& page, const std::vector<SceneMedia>& media,
               const std::filesystem::path& folder, bool has_causes = false);

/// Adds nothing if nothing was measured.
void add_cost(report::Page& page, const CostSection& cost);

/// The result in one line: "12.5 of 100", "fault of the grader", ...
std::string summary_of(const Grade& grade);

}  // namespace tumble::grading
