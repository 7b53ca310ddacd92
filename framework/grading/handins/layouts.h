/// How platforms name what they give to download.
///
///   Canvas      STUDENT_[LATE_]USER_SUBMISSION_FILE, all in one folder; what was typed on the page
///               is STUDENT_[LATE_]USER_text.html or _link.html; of an anonymous assignment the
///               first three are [LATE_]anon_LETTERS
///   Moodle      STUDENT_PARTICIPANT_assignsubmission_file_/FILE, older without the last "_";
///               without folders STUDENT_PARTICIPANT_assignsubmission_file_FILE
///   Gradescope  assignment_N_export/submission_M/FILE, and submission_metadata.yml beside it
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tumble::grading {

/// A name of Canvas or Moodle, taken apart.
struct PlatformName {
  std::string student, id;
  std::string file;  // as handed in; empty: the name is that of a folder
};
std::optional<PlatformName> canvas_name(const std::string& name);
std::optional<PlatformName> moodle_name(const std::string& name);

/// The name of a file without the number that Canvas and browsers give to a copy:
/// "a1_impulse-1.cpp", "a1_impulse (1).cpp".
std::string without_copy_number(const std::string& file);

/// One who handed in, as Gradescope knows it.
struct Submitter {
  std::string name, id;  // id: the student's number in the course; may be empty
};

inline constexpr const char* kGradescopeMetadata = "submission_metadata.yml";

/// Who handed in what, by folder ("submission_123"), from submission_metadata.yml.
///
/// Not a reader of YAML: it takes the keys that it wants at the indentation that Gradescope writes
/// (0 for a submission, 2 for its :submitters:, "- " for each), and passes over the rest, in which
/// output of a submission may stand. A folder that it does not understand is missing.
std::map<std::string, std::vector<Submitter>> read_gradescope_metadata(const std::string& text);

}  // namespace tumble::grading
