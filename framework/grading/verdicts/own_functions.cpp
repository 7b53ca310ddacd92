#include "framework/grading/verdicts/own_functions.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "framework/core/code_text.h"

namespace tumble::grading {
namespace {

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// By place of "{": the place of the bracket that closes it.
std::map<std::size_t, std::size_t> closing_brackets(const std::string& code) {
  std::map<std::size_t, std::size_t> closing;
  std::vector<std::size_t> open;
  for (std::size_t at = 0; at < code.size(); ++at) {
    if (code[at] == '{') open.push_back(at);
    if (code[at] == '}' && !open.empty()) {
      closing[open.back()] = at;
      open.pop_back();
    }
  }
  return closing;
}

// The place of the "{" of a definition whose name ends at `behind`; npos: it is none.
std::size_t body_of(const std::string& code, std::size_t behind) {
  std::size_t next = code.find_first_not_of(" \t\n", behind);
  if (next == std::string::npos || code[next] != '(') return std::string::npos;
  next = behind_bracket(code, next);
  if (next == std::string::npos) return next;
  next = code.find_first_not_of(" \t\n", next);
  for (const std::string& word : {std::string("const"), std::string("noexcept")})
    if (next != std::string::npos && code.compare(next, word.size(), word) == 0)
      next = code.find_first_not_of(" \t\n", next + word.size());
  return next != std::string::npos && code[next] == '{' ? next : std::string::npos;
}

// Names in the body of each function, those of its own lambdas and local classes with them.
std::map<std::string, std::set<std::string>> names_in_functions(const std::string& code) {
  static const std::set<std::string> no_functions = {"if", "for", "while", "switch", "catch"};
  const auto closing = closing_brackets(code);
  std::map<std::string, std::set<std::string>> names;
  std::string current;
  std::size_t end = 0;  // of the body of the current function
  for (std::size_t at = 0; at < code.size(); ++at) {
    if (!is_name(code[at])) continue;
    const std::size_t begin = at;
    while (at < code.size() && is_name(code[at])) ++at;
    const std::string name = code.substr(begin, at - begin);
    if (begin < end) {
      names[current].insert(name);
    } else if (!no_functions.contains(name)) {
      const auto body = closing.find(body_of(code, at));
      if (body == closing.end()) continue;
      current = name;
      end = body->second;
      names[current];
      at = body->first;
    }
  }
  return names;
}

}  // namespace

int line_of_definition(const std::string& source, const std::string& function) {
  const std::string code = code_of(source);
  for (std::size_t at = code.find(function); at != std::string::npos && !function.empty();
       at = code.find(function, at + 1)) {
    std::size_t next = at + function.size();
    if ((at > 0 && is_name(code[at - 1])) || (next < code.size() && is_name(code[next]))) continue;
    next = code.find_first_not_of(" \t\n", next);
    if (next == std::string::npos || code[next] != '(') continue;
    next = behind_bracket(code, next);
    if (next == std::string::npos) continue;
    next = code.find_first_not_of(" \t\n", next);
    if (next != std::string::npos && code.compare(next, 8, "noexcept") == 0)
      next = code.find_first_not_of(" \t\n", next + 8);
    if (next == std::string::npos || code[next] != '{') continue;  // a call or a declaration
    return 1 +
           static_cast<int>(std::count(code.begin(), code.begin() + static_cast<long>(at), '\n'));
  }
  return 0;
}

std::string with_its_line(const std::string& source, const std::string& function) {
  const int line = line_of_definition(source, function);
  return line == 0 ? function : function + " (which begins in line " + std::to_string(line) + ")";
}

std::map<std::string, std::set<std::string>> functions_asked(
    const std::string& source, const std::set<std::string>& functions) {
  const auto names = names_in_functions(code_of(source));
  std::map<std::string, std::set<std::string>> asked;
  for (const std::string& function : functions) {
    if (!names.contains(function)) continue;
    std::set<std::string>& all = asked[function];
    std::vector<std::string> open = {function};
    while (!open.empty()) {
      const auto& mentioned = names.at(open.back());
      open.pop_back();
      for (const std::string& name : mentioned)
        if (names.contains(name) && name != function && all.insert(name).second)
          open.push_back(name);
    }
  }
  return asked;
}

}  // namespace tumble::grading
