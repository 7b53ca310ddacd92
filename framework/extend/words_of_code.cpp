#include "framework/extend/words_of_code.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <sstream>

namespace tumble::extend {
namespace {

char upper(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }

}  // namespace

std::string pascal_case(const std::string& name) {
  std::string made;
  bool begins = true;
  for (const char c : name) {
    if (c == '_') {
      begins = true;
      continue;
    }
    made += begins ? upper(c) : c;
    begins = false;
  }
  return made;
}

std::string with_dashes(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string as_title(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  if (!name.empty()) name[0] = upper(name[0]);
  return name;
}

bool is_word_of_cpp(const std::string& word) {
  static const std::set<std::string> words = {
      "alignas",   "alignof",   "and",      "asm",      "auto",         "bool",     "break",
      "case",      "catch",     "char",     "class",    "concept",      "const",    "consteval",
      "constexpr", "constinit", "continue", "co_await", "co_return",    "co_yield", "decltype",
      "default",   "delete",    "do",       "double",   "dynamic_cast", "else",     "enum",
      "explicit",  "export",    "extern",   "false",    "float",        "for",      "friend",
      "goto",      "if",        "inline",   "int",      "long",         "mutable",  "namespace",
      "new",       "noexcept",  "not",      "nullptr",  "operator",     "or",       "private",
      "protected", "public",    "register", "requires", "return",       "short",    "signed",
      "sizeof",    "static",    "struct",   "switch",   "template",     "this",     "throw",
      "true",      "try",       "typedef",  "typeid",   "typename",     "union",    "unsigned",
      "using",     "virtual",   "void",     "volatile", "while",        "xor"};
  return words.contains(word);
}

bool is_plain_name(const std::string& name) {
  static const std::regex shape("[a-z][a-z0-9]*(_[a-z0-9]+)*");
  return std::regex_match(name, shape) && !is_word_of_cpp(name);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace tumble::extend
