#include "framework/grading/handins/layouts.h"

#include <cstdint>
#include <regex>
#include <sstream>

namespace tumble::grading {
namespace {

constexpr std::size_t kLongest = 255;  // bytes of a name; std::regex recurses by its length

std::optional<PlatformName> taken_apart(const std::string& name, const std::regex& pattern) {
  std::smatch parts;
  if (name.size() > kLongest || !std::regex_match(name, parts, pattern)) return std::nullopt;
  return PlatformName{parts[1], parts[2], parts[3]};
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string trimmed(std::string text) {
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  return text.substr(begin);
}

void append_utf8(std::uint32_t code, std::string& text) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xc0 | code >> 6);
  } else if (code < 0x10000) {
    put(0xe0 | code >> 12);
    put(0x80 | (code >> 6 & 63));
  } else {
    put(0xf0 | code >> 18);
    put(0x80 | (code >> 12 & 63));
    put(0x80 | (code >> 6 & 63));
  }
  put(0x80 | (code & 63));
}

// In double quotes YAML has escapes: \xHH, \uHHHH, \UHHHHHHHH, and letters, of which two occur in
// names: \" and \\.
std::string without_escapes(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      plain += text[i];
      continue;
    }
    const char kind = text[++i];
    const std::size_t digits = kind == 'x' ? 2 : kind == 'u' ? 4 : kind == 'U' ? 8 : 0;
    const std::string number = text.substr(i + 1, digits);
    const bool is_code = digits > 0 && number.size() == digits &&
                         number.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
    if (!is_code) {
      plain += kind;
      continue;
    }
    append_utf8(static_cast<std::uint32_t>(std::stoul(number, nullptr, 16)) & 0x1fffff, plain);
    i += digits;
  }
  return plain;
}

// A scalar on one line: plain, in single quotes ('' is a quote), or in double quotes.
std::string scalar(const std::string& raw) {
  const std::string text = trimmed(raw);
  if (text == "~" || text == "null") return "";
  if (text.size() < 2 || text.front() != text.back()) return text;
  const std::string inside = text.substr(1, text.size() - 2);
  if (text.front() == '"') return without_escapes(inside);
  if (text.front() != '\'') return text;
  return std::regex_replace(inside, std::regex("''"), "'");
}

// ":name: Ada" or "name: Ada"; @return false for another line
bool key_and_value(std::string line, std::string& key, std::string& value) {
  if (line.starts_with(':')) line.erase(0, 1);
  const std::size_t colon = line.find(':');
  if (colon == std::string::npos) return false;
  key = line.substr(0, colon);
  value = scalar(line.substr(colon + 1));
  return true;
}

}  // namespace

std::optional<PlatformName> canvas_name(const std::string& name) {
  // A text or an address typed on the page has no number of its own; of an anonymous assignment the
  // student is anon_ and letters.
  static const std::regex file(R"(^([^_]+)_(?:LATE_)?(\d+)_\d+_(.+)$)");
  static const std::regex typed(R"(^([^_]+)_(?:LATE_)?(\d+)_((?:text|link)\.html)$)");
  static const std::regex anonymous(
      R"(^(?:LATE_)?(anon)_([A-Za-z0-9]+)_(?:\d+_)?((?:text|link)\.html|.+\.[^.]+)$)");
  auto canvas = taken_apart(name, file);
  if (!canvas) canvas = taken_apart(name, typed);
  if (!canvas) canvas = taken_apart(name, anonymous);
  if (canvas) canvas->file = without_copy_number(canvas->file);
  return canvas;
}

std::optional<PlatformName> moodle_name(const std::string& name) {
  // the first number, which the platform writes: the student chooses the rest
  static const std::regex pattern(
      R"(^(.+?)_(\d+)_assignsubmission_(?:file|onlinetext)(?:_(.*))?$)");
  return taken_apart(name, pattern);
}

std::string without_copy_number(const std::string& file) {
  static const std::regex numbered(R"(^(.+?)(?:-\d+| \(\d+\))(\.[^.]*)$)");
  std::smatch parts;
  if (file.size() > kLongest || !std::regex_match(file, parts, numbered)) return file;
  return parts[1].str() + parts[2].str();
}

std::map<std::string, std::vector<Submitter>> read_gradescope_metadata(const std::string& text) {
  std::map<std::string, std::vector<Submitter>> all;
  std::vector<Submitter>* submitters = nullptr;  // of the submission that is being read
  bool in_list = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    if (indent == std::string::npos || line[indent] == '#') continue;
    const std::string rest = line.substr(indent);
    std::string key, value;
    if (indent == 0) {
      in_list = false;
      submitters = nullptr;
      if (key_and_value(scalar(rest), key, value) && key.starts_with("submission_"))
        submitters = &all[key];
    } else if (submitters == nullptr) {
      continue;
    } else if (in_list && indent <= 4 && rest.starts_with("- ")) {
      submitters->emplace_back();
      if (key_and_value(trimmed(rest.substr(2)), key, value) && key == "name")
        submitters->back().name = value;
      else if (key == "sid")
        submitters->back().id = value;
    } else if (indent == 2 && !rest.starts_with("-")) {
      in_list = key_and_value(rest, key, value) && key == "submitters" && value.empty();
    } else if (in_list && !submitters->empty() && indent <= 6 && key_and_value(rest, key, value)) {
      if (key == "name") submitters->back().name = value;
      if (key == "sid") submitters->back().id = value;
    }
  }
  std::erase_if(all, [](const auto& entry) { return entry.second.empty(); });
  return all;
}

}  // namespace tumble::grading
