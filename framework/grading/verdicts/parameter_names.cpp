#include "framework/grading/verdicts/parameter_names.h"

#include <cctype>
#include <exception>
#include <filesystem>
#include <set>
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
