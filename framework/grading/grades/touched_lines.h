/// Which lines of the reference do slips touch? A line that none touches may break without any
/// test's noticing.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "framework/grading/grades/audit.h"

namespace tumble::grading {

struct LineRange {
  int first, last;   // from 1
  int code_lines;    // among them
  std::string text;  // of the first
};

/// A line of code holds a word that is no comment; #include, namespace, access labels and braces
/// alone are none. It is touched where a slip takes it out or writes it anew; a line put in between
/// touches none.
struct TouchedLines {
  std::filesystem::path file;
  int code_lines = 0, touched = 0;
  std::vector<LineRange> untouched;  // lines of code with none between them that is touched
};

/// @param taken_out  lines of `text` that some slip takes out, from 1
TouchedLines touched_lines(const std::filesystem::path& file, const std::string& text,
                           const std::set<int>& taken_out);

/// What the slips among the candidates that change the reference touch of it.
/// @throws UserError as sources_of does
TouchedLines touched_lines_of_reference(const Course& course, const std::string& id,
                                        const std::vector<Candidate>& candidates);

}  // namespace tumble::grading
