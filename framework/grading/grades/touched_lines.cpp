#include "framework/grading/grades/touched_lines.h"

#include <regex>
#include <sstream>

#include "framework/core/code_text.h"
#include "framework/core/files.h"
#include "framework/grading/course/slip.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

bool is_line_of_code(const std::string& line_without_comments) {
  static const std::regex no_code(
      R"(^[^\w]*$|^\s*(inline )?namespace\b.*|^\s*(public|protected|private):\s*$)");
  return !std::regex_match(line_without_comments, no_code);
}

}  // namespace

TouchedLines touched_lines(const fs::path& file, const std::string& text,
                           const std::set<int>& taken_out) {
  TouchedLines all{file, 0, 0, {}};
  std::istringstream code(code_of(text)), written(text);
  bool goes_on = false;  // the last line of code is untouched, too
  std::string line, as_written;
  for (int number = 1; std::getline(code, line) && std::getline(written, as_written); ++number) {
    if (!is_line_of_code(line)) continue;
    ++all.code_lines;
    const bool is_touched = taken_out.contains(number);
    if (is_touched)
      ++all.touched;
    else if (goes_on)
      all.untouched.back().last = number, ++all.untouched.back().code_lines;
    else
      all.untouched.push_back({number, number, 1, as_written});
    goes_on = !is_touched;
  }
  return all;
}

TouchedLines touched_lines_of_reference(const Course& course, const std::string& id,
                                        const std::vector<Candidate>& candidates) {
  const fs::path reference = reference_of(course, id);
  std::set<int> taken_out;
  for (const JudgedSource& source : sources_of(candidates))
    if (source.made && source.made->base == reference)
      taken_out.insert(source.made->taken_out.begin(), source.made->taken_out.end());
  return touched_lines(reference, text_of(reference), taken_out);
}

}  // namespace tumble::grading
