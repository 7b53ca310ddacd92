#include "framework/scene/document.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "framework/core/utf8.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

/// Iterator over the text that makes the parser's position visible in its callback.
struct WatchedIterator {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at;
  const char** seen;
  const char& operator*() const { return *at; }
  WatchedIterator& operator++() {
    *seen = ++at;
    return *this;
  }
  bool operator==(const WatchedIterator& other) const { return at == other.at; }
  bool operator!=(const WatchedIterator& other) const { return at != other.at; }
};

std::string escaped(const std::string& key) {
  std::string text;
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

// lists and objects within each other; the deepest scene needs ten
constexpr std::size_t kDeepest = 100;
struct TooDeep {
  int line;
};

/// Follows the parser's events and notes the line of every value.
class LineNotes {
 public:
  LineNotes(const std::string& text, const char* const* seen) : text_(text), seen_(seen) {}

  bool operator()(json::parse_event_t event, const json& parsed) {
    using Event = json::parse_event_t;
    switch (event) {
      case Event::object_start:
      case Event::array_start:
        note_value();
        levels_.push_back({pointer(), event == Event::array_start ? 0 : -1, ""});
        if (levels_.size() > kDeepest) throw TooDeep{line()};
        break;
      case Event::object_end:
      case Event::array_end:
        levels_.pop_back();
        advance();
        break;
      case Event::key:
        levels_.back().key = parsed.get<std::string>();
        if (!lines.emplace(pointer(), line()).second && !twice) twice = pointer();
        break;
      case Event::value:
        note_value();
        advance();
        break;
    }
    return true;
  }

  std::map<std::string, int> lines;
  std::optional<std::string> twice;  // first duplicate key of one object

 private:
  struct Level {
    std::string prefix;
    int index;  // of the next element; -1 in an object
    std::string key;
  };

  std::string pointer() const {
    if (levels_.empty()) return "";
    const Level& level = levels_.back();
    return level.prefix + '/' +
           (level.index >= 0 ? std::to_string(level.index) : escaped(level.key));
  }
  // keeps the key's line where there is one
  void note_value() { lines.emplace(pointer(), line()); }
  void advance() {
    if (!levels_.empty() && levels_.back().index >= 0) ++levels_.back().index;
  }
  int line() {
    // The parser may have read one character past the token: its line feed must not be counted.
    const char* end = std::max(counted_ == nullptr ? text_.data() : counted_, *seen_ - 1);
    const char* begin = counted_ == nullptr ? text_.data() : counted_;
    line_ += static_cast<int>(std::count(begin, end, '\n'));
    counted_ = end;
    return line_;
  }

  const std::string& text_;
  const char* const* seen_;
  const char* counted_ = nullptr;
  int line_ = 1;
  std::vector<Level> levels_;
};

std::string line_and_column(const std::string& text, std::size_t byte) {
  const std::size_t end = std::min(byte > 0 ? byte - 1 : 0, text.size());
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  const std::size_t start = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  return std::to_string(line) + ':' +
         std::to_string(end - (start == std::string::npos ? 0 : start + 1) + 1);
}

/// The problem in a message of nlohmann::json, without its prefix and position.
std::string essence(const std::string& what) {
  const std::size_t dash = what.find(" - ");
  if (dash != std::string::npos) return what.substr(dash + 3);
  const std::size_t bracket = what.find("] ");
  return bracket == std::string::npos ? what : what.substr(bracket + 2);
}

const json& resolve(const json& schema, const json& node) {
  const auto ref = node.find("$ref");
  return ref == node.end() ? node
                           : schema.at(json::json_pointer(ref->get<std::string>().substr(1)));
}

std::string description(const json& schema, const json& node) {
  if (node.contains("description")) return node.at("description");
  const json& target = resolve(schema, node);
  return target.contains("description") ? target.at("description").get<std::string>()
                                        : "something else";
}

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& item : object.items()) names.push_back(item.key());
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool has_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  return value.is_number();
}

/// Appends the objects of a scene that know a key, by what they are called: "body" for "friction".
void note_owners(const json& node, const std::string& name, const std::string& key,
                 std::vector<std::string>& owners) {
  if (!node.is_object()) return;
  if (node.contains("properties") && node.at("properties").contains(key)) owners.push_back(name);
  for (const char* kind : {"properties", "definitions"})
    if (node.contains(kind))
      for (const auto& [inner, rule] : node.at(kind).items()) note_owners(rule, inner, key, owners);
}

/// Where a key that is not known here belongs, as a sentence; "" where nowhere.
std::string known_elsewhere(const json& schema, const std::string& key) {
  std::vector<std::string> owners;
  note_owners(schema, "the scene itself", key, owners);
  return owners.empty() ? "" : " It is a key of: " + joined(owners) + ".";
}

std::string hint_for(const json& schema, const std::string& key,
                     const std::vector<std::string>& known) {
  const std::string nearest = did_you_mean(key, known);
  return nearest.empty() ? known_elsewhere(schema, key) : nearest;
}

/// What is expected, with the keys of an object and the two values of a switch where the schema's
/// words do not say them.
std::string expectation_of(const json& rule, const json& value, const std::string& words) {
  const std::string type = rule.value("type", "");
  if (type == "boolean") return "true or false; " + words;
  if (type != "object" || value.is_object() || !rule.contains("properties")) return words;
  const std::vector<std::string> names = keys(rule.at("properties"));
  const bool are_said = std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return words.find(name) != std::string::npos;
  });
  return are_said || names.empty() ? words : words + "; its keys: " + joined(names);
}

/// " (an immovable half-space, ...)": what an object is, of a description that says it shortly.
std::string kind_of(const std::string& words) {
  constexpr std::string_view kBegin = "an object: ";
  constexpr std::size_t kShort = 150;  // characters: a sentence beside the keys
  if (!words.starts_with(kBegin) || words.size() > kShort) return "";
  return " (" + words.substr(kBegin.size()) + ")";
}

/// Reports the problem of one value, whose children are all valid.
[[noreturn]] void explain(const Document& document, const std::string& pointer, const json& schema,
                          const json& node) {
  const json& value = document.json.at(json::json_pointer(pointer));
  const json& rule = resolve(schema, node);
  const std::string expected = expectation_of(rule, value, description(schema, node));
  if (rule.contains("type") && has_type(value, rule.at("type")) && value.is_object()) {
    const auto known =
        rule.contains("properties") ? keys(rule.at("properties")) : std::vector<std::string>{};
    for (const auto& key : keys(value))
      if (std::find(known.begin(), known.end(), key) == known.end())
        document.refuse(
            pointer + '/' + escaped(key),
            "unknown key '" + key + "'." + hint_for(schema, key, known),
            "Known here" + kind_of(description(schema, node)) + ": " + joined(known) + ".");
    for (const auto& key : rule.value("required", std::vector<std::string>{}))
      if (!value.contains(key))
        document.refuse(
            pointer,
            "key '" + key + "' is missing: " + description(schema, rule.at("properties").at(key)),
            "Add it.");
    document.refuse(pointer, "found the keys " + (value.empty() ? "(none)" : joined(keys(value))) +
                                 ", expected " + expected);
  }
  if (rule.contains("enum")) {
    const auto words = rule.at("enum").get<std::vector<std::string>>();
    const std::string hint = value.is_string() ? did_you_mean(value.get<std::string>(), words) : "";
    document.refuse(pointer,
                    "found " + show(value) + ", expected one of " + joined(words) + "." + hint);
  }
  if (value.is_array() && rule.value("type", "") == "array" &&
      value.size() != rule.value("minItems", value.size()))
    document.refuse(pointer,
                    "found a list of " + std::to_string(value.size()) + ", expected " + expected);
  document.refuse(pointer,
                  "found " + show(value) + ", expected " +
                      (pointer.empty() ? "an object, { ... }: what a scene says" : expected));
}

// Squares and cubes of a scene's numbers must stay within doubles, and so must products of three of
// them (2^-1074 to 2^1023).
constexpr double kLargest = 1e60, kSmallest = 1e-60;

void refuse_extreme_numbers(const Document& document, const json& value,
                            const std::string& pointer) {
  if (value.is_object())
    for (const auto& [key, member] : value.items())
      refuse_extreme_numbers(document, member, pointer + '/' + escaped(key));
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i)
      refuse_extreme_numbers(document, value[i], pointer + '/' + std::to_string(i));
  if (!value.is_number()) return;
  const double size = std::abs(value.get<double>());
  if (size > kLargest)
    document.refuse(pointer, "found " + show(value) + ", too large to compute with",
                    "Numbers may be up to 1e60: check its digits and its unit.");
  if (size > 0.0 && size < kSmallest)
    document.refuse(pointer, "found " + show(value) + ", too small to compute with",
                    "Numbers are 0 or at least 1e-60 in size: write 0, or check its unit.");
}

}  // namespace

void Document::refuse(const std::string& pointer, const std::string& problem,
                      const std::string& remedy) const {
  std::string at = pointer;
  while (!lines.contains(at) && !at.empty()) at.erase(at.rfind('/'));
  const int line = lines.contains(at) ? lines.at(at) : 1;
  throw UserError(
      file.string() + ':' + std::to_string(line) + (pointer.empty() ? "" : ": " + pointer), problem,
      remedy);
}

namespace {

/// JSON is UTF-8. Said before a parser prints bytes that no terminal shows.
void refuse_what_is_no_utf8(const std::string& text, const std::filesystem::path& file) {
  if (const auto no_text = why_no_text(text))
    throw UserError(file.string(), "the file " + no_text->problem, no_text->remedy);
  const auto at = first_that_is_no_utf8(text);
  if (!at) return;
  throw UserError(
      file.string() + ':' + line_and_column(text, *at + 1),
      fmt::format("found the byte {:#04x}, which is not UTF-8", character_at(text, *at).code),
      "Save the file as UTF-8: letters with accents are two bytes there.");
}

/// What is wrong at the place where the parser stopped.
std::string what_is_no_json(const std::string& text, const json::parse_error& error) {
  const std::size_t at = std::max<std::size_t>(error.byte, 1) - 1;
  const bool is_ascii = at >= text.size() || character_at(text, at).code < 0x80;
  if (is_ascii) return "this is not JSON: " + essence(error.what());
  return "this is not JSON: found " + text.substr(at, character_at(text, at).length) +
         " outside of a text in double quotes";
}

}  // namespace

Document parse_document(const std::string& text, const std::filesystem::path& file) {
  refuse_what_is_no_utf8(text, file);
  Document document;
  document.file = file;
  const char* seen = text.data();
  LineNotes notes(text, &seen);
  try {
    document.json = json::parse(
        WatchedIterator{text.data(), &seen}, WatchedIterator{text.data() + text.size(), &seen},
        [&](int, json::parse_event_t event, json& parsed) { return notes(event, parsed); });
  } catch (const TooDeep& deep) {  // the notes of a level are as long as it is deep
    throw UserError(file.string() + ':' + std::to_string(deep.line),
                    fmt::format("found more than {} lists and objects within each other, deeper "
                                "than any scene",
                                kDeepest),
                    "Check its brackets.");
  } catch (const json::parse_error& error) {
    throw UserError(file.string() + ':' + line_and_column(text, error.byte),
                    what_is_no_json(text, error),
                    "JSON wants double quotes, a comma between entries and none after the last, "
                    "true and false in small letters, no NaN or infinity, and no comments.");
  } catch (const json::exception& error) {  // a number beyond a double
    throw UserError(
        file.string() + ':' + line_and_column(text, static_cast<std::size_t>(seen - text.data())),
        essence(error.what()), "Write a number that a double can hold: check its digits.");
  }
  document.lines = std::move(notes.lines);
  if (notes.twice)
    document.refuse(*notes.twice, "this key occurs twice in the same object",
                    "Delete one of the two.");
  refuse_extreme_numbers(document, document.json, "");
  return document;
}

void check_against_schema(const Document& document, const json& schema) {
  valijson::Schema rules;
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), rules);
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  valijson::ValidationResults results;
  if (validator.validate(rules, valijson::adapters::NlohmannJsonAdapter(document.json), &results))
    return;

  // The innermost problem, the first of several, is the cause; those around it are its
  // consequences.
  std::vector<std::string> deepest;
  for (const auto& error : results)
    if (error.context.size() > deepest.size()) deepest = error.context;
  std::string pointer;
  const json* node = &schema;
  for (std::size_t i = 1; i < deepest.size(); ++i) {
    const std::string token = deepest[i].substr(1, deepest[i].size() - 2);  // "[name]"
    const json& rule = resolve(schema, *node);
    if (rule.contains("properties") && rule.at("properties").contains(token)) {
      node = &rule.at("properties").at(token);
    } else if (rule.contains("items")) {
      node = &rule.at("items");
    } else {
      break;  // an unknown key, or inside a choice that is explained as a whole
    }
    pointer += '/' + escaped(token);
  }
  explain(document, pointer, schema, *node);
}

std::string show(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return (value.is_string()   ? "the text "
          : value.is_object() ? "the object "
          : value.is_array()  ? "the list "
                              : "") +
         text;
}

}  // namespace tumble::scene
