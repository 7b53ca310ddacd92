/// The files that platforms read, as text: pure functions of what a student may see. They hold no
/// time and no path, so that the same submission and the same grader give the same bytes.
#pragma once

#include <map>
#include <string>

#include "framework/grading/platforms/student_view.h"

namespace tumble::grading {

/// results.json of Gradescope (autograder specification of May 2023).
///
/// All hidden tests are one visible entry with their points and their count. Gradescope would also
/// take an entry for each with the visibility "hidden" or "after_published"; but as soon as a test
/// is hidden the student sees no total, and what is published later is in the file already.
std::string gradescope_results(const StudentView& view);

/// Files of Artemis, by path in its working folder: results/tumble.xml in the format of JUnit, and
/// customFeedbacks/*.json.
///
/// Artemis gives points by the names of test cases: public tests have their own, hidden ones are
/// Hidden.Test01 and so on, in the rubric's order. Partial points are in properties, which Artemis
/// ignores.
std::map<std::string, std::string> artemis_files(const StudentView& view);

/// The result of one runner of GitHub Classroom: base64 of its JSON, one line.
/// @pre  view.hidden is empty: whoever may push to the repository reads what runs there
std::string github_classroom_result(const StudentView& view);

/// What an autograder of Autolab prints: stories, then stages for its "semantic" presentation, and
/// in the last line the scores. Lines with words of a submission begin with "| ".
std::string autolab_output(const StudentView& view);

/// Names of the problems that Autolab has to know.
inline constexpr const char* kAutolabPublic = "public";
inline constexpr const char* kAutolabHidden = "hidden";

}  // namespace tumble::grading
