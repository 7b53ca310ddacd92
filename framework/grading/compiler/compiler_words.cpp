#include "framework/grading/compiler/compiler_words.h"

#include <algorithm>
#include <charconv>
#include <cctype>
#include <iterator>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "framework/core/files.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownErrors = 8;  // the first ones matter most
constexpr std::size_t kShownWarnings = 10;
constexpr std::size_t kShownExcerpt = 4;   // lines of code and markers below a message
constexpr std::size_t kShownWhole = 4000;  // bytes, of output without a known error
// Bytes of a line that are read: a hostile file has lines of a megabyte, and std::regex recurses
// once per letter.
constexpr std::size_t kReadOfLine = 600;

/// A place in a file as the compiler writes it: "FILE:LINE:COLUMN".
struct Place {
  std::string file;
  int line = 0, column = 0;
  std::string text() const { return fmt::format("{}:{}:{}", file, line, column); }
};

struct Diagnostic {
  enum class Kind { kError, kWarning, kNote } kind = Kind::kNote;
  Place place;
  std::string message;
  std::vector<std::string> excerpt;
  // the student's line, where the message is for a line of a library
  std::optional<Place> required_from;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line.substr(0, kReadOfLine));
  return lines;
}

bool is_excerpt(const std::string& line) {
  static const std::regex excerpt(R"(^\s*\d* \|.*)");
  return std::regex_match(line, excerpt);
}

/// Splits a compiler's output into messages.
class Reader {
 public:
  explicit Reader(const fs::path& source) : name_(source.filename().string()) {}

  std::vector<Diagnostic> read(const std::string& said) {
    for (const std::string& line : lines_of(said)) take(line);
    return std::move(found_);
  }

 private:
  // The student's file by its bare name, without a folder of this machine.
  std::string shortened(const std::string& file) const {
    if (fs::path(file).filename() == name_) return name_;
    const auto eigen = file.rfind("/Eigen/");
    return eigen == std::string::npos ? file : file.substr(eigen + 1);
  }

  // Nothing where a number is larger than any line's.
  std::optional<Place> place_of(const std::string& file, const std::string& line,
                                const std::string& column) const {
    Place place{shortened(file), 0, 0};
    const auto reads = [](const std::string& digits, int& number) {
      const char* end = digits.data() + digits.size();
      return std::from_chars(digits.data(), end, number) == std::from_chars_result{end, {}};
    };
    if (!reads(line, place.line) || !reads(column, place.column)) return std::nullopt;
    return place;
  }

  void take(const std::string& line) {
    static const std::regex head(
        R"(^(.+?):(\d+):(?:(\d+):)? (fatal error|error|warning|note): (.*)$)");
    static const std::regex required(
        R"(^(.+?):(\d+):(\d+):   (?:recursively )?required (?:from|by) .*$)");
    static const std::regex inlined(R"(^\s+inlined from .* at (.+?):(\d+):(\d+)[,:]?$)");
    std::smatch m;
    if (std::regex_match(line, m, required) || std::regex_match(line, m, inlined)) {
      const auto place = place_of(m[1], m[2], m[3]);
      // the last one is the nearest to the student's code
      if (place && place->file == name_) context_ = place;
    } else if (std::regex_match(line, m, head)) {
      const auto place = place_of(m[1], m[2], m[3].matched ? m[3].str() : "1");
      if (!place) return;  // a text of the student's that only looks like it
      Diagnostic d;
      d.kind = m[4] == "warning" ? Diagnostic::Kind::kWarning
               : m[4] == "note"  ? Diagnostic::Kind::kNote
                                 : Diagnostic::Kind::kError;
      d.place = *place;
      d.message = m[5];
      if (d.place.file != name_) d.required_from = context_;
      found_.push_back(d);
      if (d.kind != Diagnostic::Kind::kNote) context_.reset();
    } else if (is_excerpt(line)) {
      if (!found_.empty() && found_.back().excerpt.size() < kShownExcerpt)
        found_.back().excerpt.push_back(line);
    }
  }

  std::string name_;
  std::optional<Place> context_;
  std::vector<Diagnostic> found_;
};

/// "   12 | the line" with a mark below its column; empty where the file has no such line.
std::string source_line(const std::vector<std::string>& source, const Place& place) {
  if (place.line < 1 || static_cast<std::size_t>(place.line) > source.size()) return "";
  const std::string& text = source[static_cast<std::size_t>(place.line) - 1];
  std::string mark(static_cast<std::size_t>(std::max(0, place.column - 1)), ' ');
  for (std::size_t i = 0; i < mark.size() && i < text.size(); ++i)
    if (text[i] == '\t') mark[i] = '\t';
  return fmt::format("{:>5} | {}\n      | {}^\n", place.line, text, mark);
}

std::string own_text(const Diagnostic& d, const char* kind) {
  std::string text = fmt::format("{}: {}: {}\n", d.place.text(), kind, d.message);
  for (const std::string& line : d.excerpt) text += line + "\n";
  return text;
}

std::string errors_text(const std::vector<Diagnostic>& all, const fs::path& source) {
  const std::string name = source.filename().string();
  const std::vector<std::string> code = lines_of(text_of(source));
  std::string story;
  std::set<std::string> shown;  // places: one line may break several checks of a library
  for (const Diagnostic& d : all) {
    if (d.kind != Diagnostic::Kind::kError || shown.size() >= kShownErrors) continue;
    const std::string place = d.required_from ? d.required_from->text() : d.place.text();
    if (!shown.insert(place).second) continue;
    if (!d.required_from) {
      story += own_text(d, "error");
    } else {
      story += fmt::format("{}: error: required from here\n{}", place,
                           source_line(code, *d.required_from));
      story += fmt::format("      {}: {}\n", d.place.text(), d.message);
    }
  }
  return story;
}

/// A function's declaration or definition, on one line, and its place.
struct Declaration {
  std::string text;
  int line = 0;
};

std::string one_line(const std::string& text) {
  static const std::regex spaces(R"(\s+)");
  const std::string joined = std::regex_replace(text, spaces, " ");
  const std::size_t first = joined.find_first_not_of(' '), last = joined.find_last_not_of(' ');
  return first == std::string::npos ? "" : joined.substr(first, last - first + 1);
}

/// The first line that begins with a type and then `name(`: a declaration or a definition.
std::optional<Declaration> declared(const std::string& text, const std::string& name) {
  const std::regex begins(R"(^[A-Za-z_][\w:<>, &*]*[\s&*:])" + name + R"(\s*\(.*)");
  std::size_t begin = 0;
  for (int number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, std::min(end - begin, kReadOfLine));
    if (line.find(name) != std::string::npos && !line.starts_with("return ") &&
        std::regex_match(line, begins))
      return Declaration{
          one_line(
              text.substr(begin, std::min(text.find_first_of(";{", begin) - begin, kReadOfLine))),
          number};
    begin = end + 1;
  }
  return std::nullopt;
}

/// Functions of the project that the linker did not find.
std::vector<std::string> undefined_functions(const std::string& said) {
  static const std::regex undefined(
      R"((?:undefined symbol: |undefined reference to [`'‘])(?:tumble::\w+::)(\w+)\()");
  std::vector<std::string> names;
  for (const std::string& line : lines_of(said)) {
    std::smatch m;
    if (std::regex_search(line, m, undefined) &&
        std::find(names.begin(), names.end(), m[1]) == names.end())
      names.push_back(m[1]);
  }
  return names;
}

std::string missing_text(const std::string& said, const fs::path& source, const fs::path& header) {
  const std::string own = text_of(source), wanted = text_of(header),
                    name = source.filename().string();
  std::string story;
  for (const std::string& function : undefined_functions(said)) {
    const auto expected = declared(wanted, function), found = declared(own, function);
    if (found)
      story += fmt::format(
          "{}:{}: error: {} is written here, but not as the header declares it\n  here:     {}\n",
          name, found->line, function, found->text);
    else
      story +=
          fmt::format("{}: error: {} is missing: the file does not define it\n", name, function);
    if (expected)
      story += fmt::format("  expected: {}\n  declared in {}:{}\n", expected->text,
                           header.filename().string(), expected->line);
    if (found && expected && one_line(found->text) == expected->text)
      story += "  The text is the same: is it inside the header's namespace, and not static?\n";
  }
  return story;
}

// Advice on errors that the line itself does not explain.
std::string advice_on(const std::string& said) {
  const auto has = [&](const char* words) { return said.find(words) != std::string::npos; };
  if (has("internal compiler error"))
    return "The compiler itself failed at that line: your code may be right. Write the line in "
           "another way (shorter expressions, a variable for a part); "
           "if that does not help, show it to your instructor.\n";
  if (has("No such file or directory"))
    return "Only this one file is compiled, with the course's own headers. Include those as the "
           "starter does (\"assignments/...\"), and put into the file what you have in headers of "
           "your own.\n";
  return "";
}

}  // namespace

std::string compiler_story(const std::string& said, const fs::path& source,
                           const fs::path& header) {
  std::string story = errors_text(Reader(source).read(said), source);
  if (story.empty()) story = missing_text(said, source, header);
  return (story.empty() ? said.substr(0, kShownWhole) : story) + advice_on(said);
}

std::string included_in_quotes(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  if (first == std::string::npos || line[first] != '#') return "";
  const auto open = line.find('"'), close = line.rfind('"');
  if (line.find("include") == std::string::npos || open == std::string::npos || close <= open)
    return "";
  return line.substr(open + 1, close - open - 1);
}

std::string why_nothing(const std::string& name, const std::string& text, const fs::path& header) {
  if (text.find(header.filename().string()) != std::string::npos) return "";
  std::string question = "Is it empty, or another file?";
  for (const std::string& line : lines_of(text)) {
    const std::string file = included_in_quotes(line);
    if (file.starts_with("assignments/"))
      question =
          fmt::format("Is it the file of {}?", fs::path(file).parent_path().filename().string());
    else if (!file.empty() && !file.starts_with("framework/"))
      return "";  // a file of the student's own, which may include the header
  }
  return fmt::format(
      "{}:1:1: error: the file does not include \"{}\" and defines nothing of it. {}", name,
      header.string(), question);
}

std::string compiler_warnings(const std::string& said, const fs::path& source) {
  // An argument that is not used yet is fine.
  constexpr const char* kUnusedParameter = "[-Wunused-parameter]";
  std::string story;
  std::set<std::string> shown;
  for (const Diagnostic& d : Reader(source).read(said)) {
    const bool own = d.place.file == source.filename().string();
    if (d.kind != Diagnostic::Kind::kWarning || (!own && !d.required_from) ||
        d.message.ends_with(kUnusedParameter))
      continue;
    Diagnostic at_home = d;
    if (!own) {
      at_home.place = *d.required_from;
      at_home.excerpt.clear();
    }
    if (shown.size() < kShownWarnings && shown.insert(at_home.place.text()).second)
      story += own_text(at_home, "warning");
  }
  return story;
}

}  // namespace tumble::grading
