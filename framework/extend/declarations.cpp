#include "framework/extend/declarations.h"

#include <algorithm>
#include <regex>

#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/extend/words_of_code.h"

namespace tumble::extend {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// One blank between words; none inside brackets' edges, so that a type prints as people write it.
std::string in_one_line(const std::string& text) {
  static const std::regex blanks("\\s+"), inside("([(<]) | ([),>])"), before(" ([&*])");
  const std::string line = std::regex_replace(trimmed(text), blanks, " ");
  return std::regex_replace(std::regex_replace(line, inside, "$1$2"), before, "$1");
}

class Reader {
 public:
  Reader(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  Declarations read() {
    while (at_ < text_.size()) take_next();
    if (!comment_.empty())
      fail(line_, "ends with a comment that belongs to no declaration",
           "Put it above a declaration, or take it out.");
    if (read_.functions.empty())
      fail(1, "declares no function", "Write one a line:  // What it gives.  double f(double x);");
    return std::move(read_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& problem, const std::string& remedy) const {
    throw UserError(file_ + ":" + std::to_string(line), problem, remedy);
  }

  std::string take_line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return line;
  }

  // A line of comment, an #include, a blank line, or a declaration up to its semicolon.
  void take_next() {
    const std::size_t begin = at_;
    const int line = line_ + 1;
    const std::string first = trimmed(take_line());
    if (first.empty() || first == "#pragma once") return;
    if (first.starts_with("//")) {
      comment_.push_back(trimmed(first.substr(first.find_first_not_of('/'))));
      return;
    }
    if (first.starts_with("#include")) {
      read_.includes.push_back(first);
      return;
    }
    if (first.starts_with("#") || first.starts_with("namespace") || first.starts_with("using"))
      fail(line, "'" + first + "' cannot stand in a list of declarations",
           "It holds #include, struct, enum and functions, outside any namespace.");
    const std::string whole = up_to_semicolon(begin, line);
    if (first.starts_with("struct ") || first.starts_with("enum "))
      take_type(whole);
    else
      take_function(whole, line);
    comment_.clear();
  }

  // Semicolons inside braces do not end it.
  std::string up_to_semicolon(std::size_t begin, int line) {
    int depth = 0;
    for (std::size_t i = begin; i < text_.size(); ++i) {
      if (text_[i] == '{') ++depth;
      if (text_[i] == '}') --depth;
      if (text_[i] != ';' || depth > 0) continue;
      while (at_ <= i) take_line();
      const std::size_t end = std::min(text_.find('\n', i), text_.size());
      if (!trimmed(text_.substr(i + 1, end - i - 1)).empty())
        fail(line, "has more on the line after its ';'",
             "Put each declaration on lines of its own, its comment above it.");
      return text_.substr(begin, i - begin);
    }
    fail(line, "does not end with ';'", "End the declaration with a semicolon.");
  }

  void take_type(const std::string& whole) {
    for (const std::string& words : comment_) read_.types += "/// " + words + "\n";
    read_.types += whole + ";\n\n";
  }

  void take_function(const std::string& whole, int line) {
    const std::string text = in_one_line(whole);
    std::smatch match;
    if (text.find_first_of("{}=") != std::string::npos)
      fail(line, "'" + text + "' is more than a declaration",
           "Give the declaration alone: no body, no default value.");
    const std::size_t open = opening_of_parameters(text);
    const std::string head = text.substr(0, open);
    static const std::regex named(R"(^(.+?[\s&*>])(\w+)$)");
    const std::string plain_head = trimmed(head);
    if (open == std::string::npos || !text.ends_with(")") ||
        !std::regex_match(plain_head, match, named))
      fail(line, "'" + text + "' is no declaration of a function",
           "It is written  double mean_of(double a, double b);");
    Function function;
    function.line = line;
    function.returns = trimmed(match[1]);
    function.name = match[2];
    check_name(function, line);
    const std::string inside = trimmed(text.substr(open + 1, text.size() - open - 2));
    if (!inside.empty())
      for (const std::string& part : at_commas(inside))
        function.parameters.push_back(parameter_of(trimmed(part), line));
    take_comment(function, line);
    read_.functions.push_back(std::move(function));
  }

  // The bracket that the last one closes.
  static std::size_t opening_of_parameters(const std::string& text) {
    int depth = 0;
    for (std::size_t i = text.size(); i-- > 0;) {
      if (text[i] == ')') ++depth;
      if (text[i] == '(' && --depth == 0) return i;
    }
    return std::string::npos;
  }

  void check_name(const Function& function, int line) const {
    if (function.returns == "void")
      fail(line, function.name + " returns nothing",
           "A module's function answers with a value: its calls cross to another process.");
    if (function.returns.ends_with("&") || function.returns.ends_with("*"))
      fail(line, function.name + " returns a reference or a pointer",
           "Return the value: calls cross to another process.");
    if (!std::regex_match(function.name, std::regex("[a-z][a-z0-9]*(_[a-z0-9]+)*")))
      fail(line, "'" + function.name + "' is not named like a function",
           "Names of functions are lower case words: mean_of.");
    if (is_word_of_cpp(function.name))
      fail(line, "'" + function.name + "' is a word of C++", "Name it otherwise.");
    for (const Function& other : read_.functions)
      if (other.name == function.name)
        fail(line, function.name + " is declared in line " + std::to_string(other.line) + " too",
             "A module is a table by name: give the second one another name.");
  }

  Parameter parameter_of(const std::string& text, int line) const {
    static const std::regex shape(R"(^(.+[\s&*>])(\w+)$)");
    std::smatch match;
    if (!std::regex_match(text, match, shape) || is_word_of_cpp(match[2]))
      fail(line, "the parameter '" + text + "' has no name",
           "Name each parameter: the header explains it to students.");
    const std::string type = trimmed(match[1]);
    if (type == "const")
      fail(line, "the parameter '" + text + "' has no name",
           "Name each parameter: the header explains it to students.");
    if (type.ends_with("*") || (type.ends_with("&") && !type.starts_with("const ")))
      fail(line, "the parameter '" + text + "' is changed by the function",
           "Take a value or const&, and return what comes out.");
    return {type, match[2]};
  }

  void take_comment(Function& function, int line) {
    for (const std::string& words : comment_)
      if (words.starts_with("eq:"))
        function.equation = trimmed(words.substr(3));
      else if (!words.empty())
        function.about.push_back(words);
    if (function.about.empty())
      fail(line, function.name + " has no comment",
           "Say above it in one line what the caller gets:  // The mean of two numbers.");
  }

  const std::string& text_;
  std::string file_;
  std::size_t at_ = 0;
  int line_ = 0;  // the last one taken
  std::vector<std::string> comment_;
  Declarations read_;
};

}  // namespace

Declarations read_declarations(const std::string& text, const std::string& file) {
  return Reader(text, file).read();
}

Function read_function(const std::string& header, const std::string& name,
                       const std::string& file) {
  const std::regex declaration("\n([A-Za-z][\\w:<>, ]* +" + name + "\\([^;]*;)");
  std::smatch declared;
  if (!std::regex_search(header, declared, declaration))
    throw UserError(file, "declares no function " + name,
                    "TUMBLE_MODULE lists what the header declares.");
  return read_declarations("// Read from the header.\n" + declared[1].str() + "\n", file)
      .functions.front();
}

}  // namespace tumble::extend
