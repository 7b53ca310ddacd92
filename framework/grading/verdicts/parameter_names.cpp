#include "framework/grading/verdicts/parameter_names.h"

#include <cctype>
#include <exception>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>

#include "framework/core/code_text.h"
#include "framework/core/files.h"
#include "framework/core/program_trees.h"
#include "framework/core/text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

bool is_in_a_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// "const VectorXd& y" -> "y"; empty where there is a type alone, such as "const Vector3d&".
std::string name_in(const std::string& parameter) {
  static const std::set<std::string> types = {"bool", "char", "const", "double", "float",
                                              "int",  "long", "short", "signed", "unsigned"};
  const std::string text = parameter.substr(0, parameter.find('='));
  const std::size_t last = text.find_last_not_of(" \t\n");
  if (last == text.npos || !is_in_a_word(text[last])) return "";
  std::size_t begin = last;
  while (begin > 0 && is_in_a_word(text[begin - 1])) --begin;
  const std::size_t before = begin == 0 ? text.npos : text.find_last_not_of(" \t\n", begin - 1);
  const std::string name = text.substr(begin, last + 1 - begin);
  return before == text.npos || text[before] == ':' || types.contains(name) ? "" : name;
}

// Whether a name with its brackets is a declaration: a type stands before it, a semicolon behind.
bool is_declaration(const std::string& text, std::size_t name, std::size_t behind_brackets) {
  if (name == 0 || behind_brackets == text.npos) return false;
  const std::size_t before = text.find_last_not_of(" \t\n", name - 1),
                    behind = text.find_first_not_of(" \t\n", behind_brackets);
  if (before == text.npos || behind == text.npos || text[behind] != ';') return false;
  const bool is_call = before >= 5 && text.compare(before - 5, 6, "return") == 0;
  return !is_call && (is_in_a_word(text[before]) ? before + 1 < name : text[before] == '>');
}

fs::path header_of(const std::string& id) {
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(find_trees().root / "assignments", missing))
    if (const fs::path& folder = entry.path(); folder.filename().string().starts_with(id + "_"))
      return folder / (folder.filename().string() + ".h");
  return {};
}

// Where a function is declared in the code of a header: its name, its brackets.
struct Declaration {
  std::size_t name = std::string::npos, open = 0, end = 0;
};

Declaration declaration_of(const std::string& code, const std::string& function) {
  for (std::size_t at = code.find(function); at != code.npos && !function.empty();
       at = code.find(function, at + 1)) {
    const std::size_t open = code.find_first_not_of(" \t\n", at + function.size());
    if (open == code.npos || code[open] != '(') continue;
    const std::size_t end = behind_bracket(code, open);
    if (is_declaration(code, at, end)) return {at, open, end};
  }
  return {};
}

// The lines of the comment `///` that stands before a declaration, without their slashes.
std::vector<std::string> comment_before(const std::string& header, std::size_t declaration) {
  std::vector<std::string> lines;
  std::istringstream in(header.substr(0, header.rfind('\n', declaration) + 1));
  bool is_open = false;
  for (std::string line; std::getline(in, line);) {
    const bool is_comment = line.starts_with("///");
    if (is_comment && !is_open) lines.clear();
    if (is_comment) lines.push_back(line.substr(3));
    if (!is_comment && (line.find(';') != line.npos || line.empty())) lines.clear();
    is_open = is_comment;
  }
  return lines;
}

std::string without_ends(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \n"), end = text.find_last_not_of(" \n");
  return begin == text.npos ? "" : text.substr(begin, end + 1 - begin);
}

// "(A1.7c)" at the end of a line becomes "eq-a1-7", and has three blanks before it.
std::string equation_at_end(std::string& line) {
  const std::size_t open = line.rfind("  (A");
  if (open == line.npos || line.back() != ')') return "";
  std::string number = line.substr(open + 3, line.size() - open - 4);  // "A1.7c"
  line = without_ends(line.substr(0, open)) + "   (" + number + ")";
  while (!number.empty() && std::isdigit(static_cast<unsigned char>(number.back())) == 0)
    number.pop_back();
  for (char& c : number)
    c = c == '.' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return number.empty() ? "" : "eq-" + number;
}

}  // namespace

std::vector<std::string> names_in_declaration(const std::string& header,
                                              const std::string& function) {
  const std::string text = code_of(header);
  const Declaration found = declaration_of(text, function);
  if (found.name == text.npos) return {};
  std::vector<std::string> names;
  for (const std::string& parameter :
       at_commas(text.substr(found.open + 1, found.end - found.open - 2))) {
    names.push_back(name_in(parameter));
    if (names.back().empty()) return {};
  }
  return names;
}

std::string hints_in_declaration(const std::string& header, const std::string& function) {
  const std::string code = code_of(header);  // comments are blanked: places are the same
  const Declaration found = declaration_of(code, function);
  if (found.name == code.npos) return "";
  const std::size_t before = code.find_last_of(";}", found.name),
                    begin = before == code.npos ? 0 : before;
  constexpr std::string_view kMark = "Hints: ";
  const std::string comment = header.substr(begin, found.name - begin);
  const std::size_t at = comment.rfind(kMark);
  if (at == comment.npos) return "";
  const std::size_t from = at + kMark.size();
  return comment.substr(from, comment.find_first_of(" \n", from) - from);
}

FunctionInHeader told_in_declaration(const std::string& header, const std::string& function) {
  const Declaration found = declaration_of(code_of(header), function);
  if (found.name == std::string::npos) return {};
  FunctionInHeader told;
  told.hints = hints_in_declaration(header, function);
  const std::string file = told.hints.substr(0, told.hints.find('#'));
  enum class In { kPurpose, kReturns, kOther } in = In::kPurpose;
  for (std::string line : comment_before(header, found.name)) {
    const std::string bare = without_ends(line);
    if (bare.starts_with("@return"))
      in = In::kReturns;
    else if (bare.starts_with('@') || bare.starts_with("Source:") || bare.starts_with("Tests:") ||
             bare.starts_with("Hints:"))
      in = In::kOther;
    const bool is_formula = line.starts_with("   ");
    if (in == In::kPurpose) {
      const std::string equation = equation_at_end(line);
      if (!equation.empty() && !file.empty()) told.equations.push_back(file + '#' + equation);
      told.purpose += (told.purpose.empty() ? "" : "\n") + without_ends(line);
      if (is_formula) told.formula += (told.formula.empty() ? "" : "\n") + without_ends(line);
    } else if (in == In::kReturns) {
      const std::string words = bare.starts_with("@return") ? without_ends(bare.substr(7)) : bare;
      told.returns += (told.returns.empty() ? "" : " ") + words;
    }
  }
  return told;
}

FunctionInHeader told_of_function(const std::string& id, const std::string& function) {
  try {
    return told_in_declaration(text_of(header_of(id)), function);
  } catch (const std::exception&) {  // a tree that cannot be found, or read
    return {};
  }
}

std::string hints_to_read(const std::string& id, const std::string& function) {
  try {
    const std::string place = hints_in_declaration(text_of(header_of(id)), function);
    return place.empty() ? "" : "\n  read:     " + place;
  } catch (const std::exception&) {  // a tree that cannot be found, or read
    return "";
  }
}

std::vector<std::string> parameter_names(const std::string& id, const std::string& function) {
  try {
    return names_in_declaration(text_of(header_of(id)), function);
  } catch (const std::exception&) {  // a tree that cannot be found, or read
    return {};
  }
}

std::string with_names(const std::vector<std::string>& values,
                       const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ", ";
    if (names.size() == values.size()) text += names[i] + " = ";
    text += values[i];
  }
  return text;
}

}  // namespace tumble::grading
