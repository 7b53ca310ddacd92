#include "framework/extend/mutations.h"

#include <algorithm>
#include <regex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/extend/new_assignment.h"
#include "framework/extend/words_of_code.h"

namespace tumble::extend {
namespace {

namespace fs = std::filesystem;

struct Rule {
  const char* what;
  const char* found;  // regular expression
  const char* put;
};

// Operators stand between blanks in this house, so that a sign, a pointer and a template's bracket
// are none.
constexpr Rule kRules[] = {{"plus_to_minus", R"( \+ )", " - "},
                           {"minus_to_plus", " - ", " + "},
                           {"times_to_divided", R"( \* )", " / "},
                           {"divided_to_times", " / ", " * "},
                           {"adding_to_subtracting", R"( \+= )", " -= "},
                           {"subtracting_to_adding", " -= ", " += "},
                           {"below_to_at_most", " < ", " <= "},
                           {"at_most_to_below", " <= ", " < "},
                           {"above_to_at_least", " > ", " >= "},
                           {"at_least_to_above", " >= ", " > "},
                           {"equal_to_different", " == ", " != "},
                           {"different_to_equal", " != ", " == "},
                           {"and_to_or", " && ", " || "},
                           {"or_to_and", R"( \|\| )", " && "},
                           {"half_to_one", R"(\b0\.5\b)", "1.0"},
                           {"two_to_one", R"(\b2\.0\b)", "1.0"},
                           {"one_to_two", R"(\b1\.0\b)", "2.0"},
                           {"least_to_largest", R"(std::min\()", "std::max("},
                           {"largest_to_least", R"(std::max\()", "std::min("},
                           {"first_to_second", R"(\[0\])", "[1]"},
                           {"second_to_first", R"(\[1\])", "[0]"},
                           {"x_to_y", R"(\.x\(\))", ".y()"},
                           {"y_to_z", R"(\.y\(\))", ".z()"},
                           {"z_to_x", R"(\.z\(\))", ".x()"},
                           {"not_transposed", R"(\.transpose\(\))", ""},
                           {"not_conjugated", R"(\.conjugate\(\))", ""},
                           {"cross_product_reversed", R"(\b(\w+)\.cross\()", "(-$1).cross("},
                           {"body_frame_for_world", R"(\bomega_world\b)", "omega_body"},
                           {"world_frame_for_body", R"(\bomega_body\b)", "omega_world"}};

// Where the code of a line ends: at a comment.
std::size_t end_of_code(const std::string& line) { return std::min(line.find("//"), line.size()); }

bool is_in_quotes(const std::string& line, std::size_t at) {
  return std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(at), '"') % 2 == 1;
}

// Only inside a function: an indented line that is no declaration of its parameters.
bool may_change(const std::string& line) {
  return line.starts_with("  ") && line.find("static_assert") == std::string::npos;
}

// A mark for each line: how many lines above it must be kept so that the text stands once.
int context_of(const std::vector<std::string>& lines, std::size_t at) {
  for (std::size_t kept = 0; kept <= at; ++kept) {
    int found = 0;
    for (std::size_t i = kept; i < lines.size(); ++i)
      found += std::equal(lines.begin() + static_cast<std::ptrdiff_t>(at - kept),
                          lines.begin() + static_cast<std::ptrdiff_t>(at + 1),
                          lines.begin() + static_cast<std::ptrdiff_t>(i - kept))
                   ? 1
                   : 0;
    if (found == 1) return static_cast<int>(kept);
  }
  return 0;
}

}  // namespace

std::vector<Mutation> mutations_of(const std::string& text) {
  std::vector<Mutation> found;
  int number = 0;
  const auto is_named = [&](const std::string& name) {
    return std::regex_search(text, std::regex("\\b" + name + "\\b"));
  };
  for (const std::string& line : lines_of(text)) {
    ++number;
    if (!may_change(line)) continue;
    const std::string code = line.substr(0, end_of_code(line));
    for (const Rule& rule : kRules) {
      // another frame only where the text has it, or nothing would compile
      const std::string put = rule.put;
      if (put.starts_with("omega_") && !is_named(put)) continue;
      const std::regex pattern(rule.found);
      for (std::sregex_iterator it(code.begin(), code.end(), pattern), end; it != end; ++it) {
        const auto at = static_cast<std::size_t>(it->position());
        if (is_in_quotes(code, at)) continue;
        found.push_back({number, line,
                         line.substr(0, at) + it->format(put) +
                             line.substr(at + static_cast<std::size_t>(it->length())),
                         rule.what});
      }
    }
  }
  return found;
}

std::vector<NewFile> new_mutations(const fs::path& root, const std::string& id,
                                   const fs::path& folder) {
  const std::string name = folder_of_assignment(root, id);
  const fs::path reference = root / "solutions_private" / name / (name + ".cpp");
  const std::string text = text_of(reference);
  const std::vector<std::string> lines = lines_of(text);
  std::vector<NewFile> files;
  std::set<std::string> taken;
  for (const Mutation& mutation : mutations_of(text)) {
    // Several of a kind in a line are numbered.
    const std::string plain = "line_" + std::to_string(mutation.line) + "_" + mutation.what;
    std::string own = plain;
    for (int i = 2; !taken.insert(own).second; ++i) own = plain + "_" + std::to_string(i);
    const auto at = static_cast<std::size_t>(mutation.line - 1);
    const auto kept = static_cast<std::size_t>(context_of(lines, at));
    std::string slip = "// mutant: " + own + " - " + mutation.what + " in line " +
                       std::to_string(mutation.line) +
                       " of the reference\n// caught-by: likely\n// base: reference\n@@\n";
    for (std::size_t i = at - kept; i < at; ++i) slip += " " + lines[i] + "\n";
    slip += "-" + mutation.before + "\n+" + mutation.after + "\n";
    files.push_back({own + ".slip", slip});
  }
  if (files.empty())
    throw UserError(reference.string(), "has nothing that could be changed",
                    "Write the reference first.");
  put_in_place(fs::absolute(folder), files);
  return files;
}

}  // namespace tumble::extend
