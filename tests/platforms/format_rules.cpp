#include "tests/platforms/format_rules.h"

#include <functional>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

namespace tumble::grading {
namespace {

using Json = nlohmann::json;

const std::set<std::string> kVisibilities = {"hidden", "after_due_date", "after_published",
                                             "visible"},
                            kTextFormats = {"text", "html", "simple_format", "md", "ansi"};

struct Rule {
  bool needed = false;
  std::function<bool(const Json&)> holds;
};

bool is_number(const Json& json) { return json.is_number(); }
bool is_text(const Json& json) { return json.is_string(); }
bool is_object(const Json& json) { return json.is_object(); }
bool is_array(const Json& json) { return json.is_array(); }
bool are_texts(const Json& json) {
  if (!json.is_array()) return false;
  for (const Json& each : json)
    if (!each.is_string()) return false;
  return true;
}
std::function<bool(const Json&)> one_of(const std::set<std::string>& words) {
  return [words](const Json& json) {
    return json.is_string() && words.contains(json.get<std::string>());
  };
}

void check(const Json& json, const std::map<std::string, Rule>& rules, const std::string& where,
           Faults& faults) {
  if (!json.is_object()) return faults.push_back(where + " is no object");
  for (const auto& [key, rule] : rules)
    if (rule.needed && !json.contains(key)) faults.push_back(where + " has no " + key);
  for (const auto& [key, value] : json.items())
    if (const auto rule = rules.find(key); rule == rules.end())
      faults.push_back(where + " has an unknown " + key);
    else if (!rule->second.holds(value))
      faults.push_back(where + " has a wrong " + key + ": " + value.dump());
}

// ---- XML ----

// A reader of the part of XML 1.0 that JUnit's files use: elements, attributes, text, the five named
// entities and character references. Whatever it does not know is a fault.
class XmlReader {
 public:
  struct Element {
    std::string name, text;
    std::map<std::string, std::string> attributes;
    std::vector<Element> inner;
  };

  explicit XmlReader(const std::string& text) : text_(text) {}

  Element read() {
    if (at("<?xml version=\"1.0\" encoding=\"UTF-8\"?>")) skip_to("?>");
    skip_blanks();
    Element root = element();
    skip_blanks();
    if (here_ != text_.size()) fail("something behind the root");
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw std::runtime_error(why + " at byte " + std::to_string(here_));
  }
  bool at(const std::string& word) const { return text_.compare(here_, word.size(), word) == 0; }
  void skip_to(const std::string& word) {
    const std::size_t found = text_.find(word, here_);
    if (found == std::string::npos) fail("no " + word);
    here_ = found + word.size();
  }
  void skip_blanks() {
    while (here_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[here_]))) ++here_;
  }
  char next() {
    if (here_ == text_.size()) fail("the end comes too early");
    return text_[here_++];
  }
  std::string name() {
    std::string word;
    while (here_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[here_])) || text_[here_] == '-'))
      word += text_[here_++];
    if (word.empty()) fail("no name");
    return word;
  }
  std::string reference() {  // behind "&"
    std::string word;
    for (char c = next(); c != ';'; c = next()) {
      word += c;
      if (word.size() > 8) fail("an ampersand that begins nothing");
    }
    static const std::map<std::string, std::string> known = {
        {"amp", "&"},  {"lt", "<"},   {"gt", ">"},  {"quot", "\""},
        {"apos", "'"}, {"#10", "\n"}, {"#9", "\t"}, {"#13", "\r"}};
    const auto it = known.find(word);
    if (it == known.end()) fail("an unknown reference " + word);
    return it->second;
  }
  // XML 1.0, section 2.2: no control characters, no U+FFFE and U+FFFF.
  std::string character(char c) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 && c != '\n' && c != '\t' && c != '\r') fail("a control character");
    if (text_.compare(here_ - 1, 3, "\xef\xbf\xbe") == 0 ||
        text_.compare(here_ - 1, 3, "\xef\xbf\xbf") == 0)
      fail("no character of XML");
    return std::string(1, c);
  }
  std::string value() {
    if (next() != '"') fail("an attribute without quotes");
    std::string text;
    for (char c = next(); c != '"'; c = next()) {
      if (c == '<') fail("markup in an attribute");
      text += c == '&' ? reference() : character(c);
    }
    return text;
  }
  Element element() {
    if (next() != '<') fail("no element");
    Element element;
    element.name = name();
    for (skip_blanks(); !at(">") && !at("/>"); skip_blanks()) {
      const std::string key = name();
      if (next() != '=') fail("an attribute without a value");
      if (!element.attributes.insert({key, value()}).second) fail("an attribute twice");
    }
    if (at("/>")) return here_ += 2, element;
    ++here_;
    while (!at("</")) {
      if (at("<"))
        element.inner.push_back(this->element());
      else if (const char c = next(); true)
        element.text += c == '&' ? reference() : character(c);
    }
    here_ += 2;
    if (name() != element.name) fail("ends another element than " + element.name);
    if (next() != '>') fail("no end of an element");
    return element;
  }

  const std::string& text_;
  std::size_t here_ = 0;
};

using Element = XmlReader::Element;

struct Counts {
  std::map<std::string, int> of = {{"tests", 0}, {"failures", 0}, {"errors", 0}, {"skipped", 0}};
  std::set<std::string> names;
};

void check_known(const Element& element, const std::map<std::string, std::set<std::string>>& known,
                 Faults& faults) {
  const auto it = known.find(element.name);
  if (it == known.end()) return faults.push_back("an unknown element " + element.name);
  for (const auto& [key, value] : element.attributes)
    if (!it->second.contains(key))
      faults.push_back(element.name + " has an unknown attribute " + key);
  for (const Element& inner : element.inner) check_known(inner, known, faults);
}

void check_case(const Element& test, Counts& counts, Faults& faults) {
  const auto name = test.attributes.find("name");
  if (name == test.attributes.end() || name->second.empty())
    faults.push_back("a test case without a name");
  else if (!counts.names.insert(name->second).second)
    faults.push_back("two test cases are named " + name->second);
  ++counts.of["tests"];
  int outcomes = 0;
  for (const Element& inner : test.inner) {
    const std::string& kind = inner.name;
    if (kind == "failure") ++counts.of["failures"], ++outcomes;
    if (kind == "error") ++counts.of["errors"], ++outcomes;
    if (kind == "skipped") ++counts.of["skipped"], ++outcomes;
    if ((kind == "failure" || kind == "error") && !inner.attributes.contains("message"))
      faults.push_back(kind + " without a message");
    if (kind == "testcase" || kind == "testsuite") faults.push_back(kind + " in a test case");
  }
  if (outcomes > 1) faults.push_back("a test case with two outcomes");
}

void check_counts(const Element& element, const Counts& counts, Faults& faults) {
  for (const auto& [key, count] : counts.of)
    if (const auto it = element.attributes.find(key);
        it != element.attributes.end() && it->second != std::to_string(count))
      faults.push_back(element.name + " says " + key + "=" + it->second + " of " +
                       std::to_string(count));
}

}  // namespace

Faults faults_of_gradescope(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return {"is no JSON"};
  Faults faults;
  const std::map<std::string, Rule> top = {{"score", {false, is_number}},
                                           {"execution_time", {false, is_number}},
                                           {"output", {false, is_text}},
                                           {"output_format", {false, one_of(kTextFormats)}},
                                           {"test_output_format", {false, one_of(kTextFormats)}},
                                           {"test_name_format", {false, one_of(kTextFormats)}},
                                           {"visibility", {false, one_of(kVisibilities)}},
                                           {"stdout_visibility", {false, one_of(kVisibilities)}},
                                           {"extra_data", {false, is_object}},
                                           {"tests", {false, is_array}},
                                           {"leaderboard", {false, is_array}}};
  const std::map<std::string, Rule> of_test = {{"score", {false, is_number}},
                                               {"max_score", {false, is_number}},
                                               {"status", {false, one_of({"passed", "failed"})}},
                                               {"name", {false, is_text}},
                                               {"name_format", {false, one_of(kTextFormats)}},
                                               {"number", {false, is_text}},
                                               {"output", {false, is_text}},
                                               {"output_format", {false, one_of(kTextFormats)}},
                                               {"tags", {false, are_texts}},
                                               {"visibility", {false, one_of(kVisibilities)}},
                                               {"extra_data", {false, is_object}}};
  check(json, top, "the file", faults);
  if (!faults.empty()) return faults;
  const Json tests = json.value("tests", Json::array());
  if (!json.contains("score") && tests.empty()) faults.push_back("has neither a score nor tests");
  double sum = 0.0;
  for (const Json& test : tests) {
    check(test, of_test, "a test", faults);
    if (!json.contains("score") && !test.contains("score"))
      faults.push_back("has no score, and a test without one");
    if (test.contains("score") && test["score"].is_number()) sum += test["score"].get<double>();
  }
  // Ours: the total is the sum of what the student sees.
  constexpr double kGrain = 1e-6;
  if (json.contains("score") && std::abs(sum - json["score"].get<double>()) > kGrain)
    faults.push_back("has a total that is not the sum of its tests");
  if (json.value("stdout_visibility", "hidden") != "hidden")
    faults.push_back("shows stdout, which has the stories of hidden tests");
  return faults;
}

bool student_sees_total(const std::string& text) {
  const Json json = Json::parse(text);
  for (const Json& test : json.at("tests"))
    if (test.value("visibility", json.value("visibility", "visible")) != "visible") return false;
  return true;
}

Faults faults_of_junit(const std::string& text) {
  Faults faults;
  Element root;
  try {
    root = XmlReader(text).read();
  } catch (const std::runtime_error& error) {
    return {std::string("is no XML: ") + error.what()};
  }
  const std::set<std::string> of_suite = {"name",       "tests",   "failures",  "errors",
                                          "skipped",    "time",    "timestamp", "file",
                                          "assertions", "package", "hostname",  "id"};
  check_known(root,
              {{"testsuites", of_suite},
               {"testsuite", of_suite},
               {"testcase", {"name", "classname", "assertions", "time", "file", "line"}},
               {"failure", {"message", "type"}},
               {"error", {"message", "type"}},
               {"skipped", {"message"}},
               {"properties", {}},
               {"property", {"name", "value"}},
               {"system-out", {}},
               {"system-err", {}}},
              faults);
  if (root.name != "testsuites") faults.push_back("the root is " + root.name);
  Counts all;
  for (const Element& suite : root.inner) {
    if (suite.name != "testsuite") faults.push_back(suite.name + " at the root");
    Counts counts;
    for (const Element& test : suite.inner)
      if (test.name == "testcase") {
        check_case(test, counts, faults);
        check_case(test, all, faults);
      } else if (test.name != "properties") {
        faults.push_back(test.name + " in a suite");
      }
    check_counts(suite, counts, faults);
  }
  check_counts(root, all, faults);
  return faults;
}

Faults faults_of_custom_feedback(const std::map<std::string, std::string>& files) {
  Faults faults;
  std::set<std::string> names;
  for (const auto& [file, text] : files) {
    if (!file.starts_with("customFeedbacks/")) continue;
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) {
      faults.push_back(file + " is no JSON");
      continue;
    }
    check(json,
          {{"name", {true, is_text}},
           {"successful", {false, [](const Json& j) { return j.is_boolean(); }}},
           {"message", {false, is_text}}},
          file, faults);
    const std::string name = json.value("name", "");
    if (name.empty() || !names.insert(name).second)
      faults.push_back(file + " has no name of its own");
    if (!json.value("successful", false) && json.value("message", "").empty())
      faults.push_back(file + " has no message");
  }
  return faults;
}

Faults faults_of_github_classroom(const std::string& text) {
  Faults faults;
  if (text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=") !=
          std::string::npos ||
      text.size() % 4 != 0)
    return {"is not base64 in one line"};
  const Json json = Json::parse(decoded(text), nullptr, false);
  if (json.is_discarded()) return {"holds no JSON"};
  const auto status = one_of({"pass", "fail", "error"});
  check(json,
        {{"version", {true, [](const Json& j) { return j == 1; }}},
         {"status", {true, status}},
         {"max_score", {true, is_number}},
         {"tests", {true, is_array}}},
        "the result", faults);
  double sum = 0.0;
  bool all = true;
  for (const Json& test : json.value("tests", Json::array())) {
    check(test,
          {{"name", {true, is_text}},
           {"status", {true, status}},
           {"message", {true, is_text}},
           {"test_code", {true, is_text}},
           {"filename", {true, is_text}},
           {"line_no", {true, [](const Json& j) { return j.is_number_integer(); }}},
           {"execution_time", {true, [](const Json& j) { return j.is_number() || j.is_string(); }}},
           {"score", {true, is_number}}},
          "a test", faults);
    sum += test.value("score", 0.0);
    all = all && test.value("status", "") == "pass";
  }
  if (sum > json.value("max_score", 0.0) + 1e-6) faults.push_back("has more than all points");
  if (all != (json.value("status", "") == "pass")) faults.push_back("has a status that is wrong");
  return faults;
}

Faults faults_of_autolab(const std::string& text) {
  Faults faults;
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  if (lines.size() < 2) return {"has no two lines"};
  const Json scores = Json::parse(lines.back(), nullptr, false);
  if (scores.is_discarded() || !scores.is_object() || !scores.contains("scores"))
    return {"its last line has no scores"};
  check(scores, {{"scores", {true, is_object}}, {"scoreboard", {false, is_array}}}, "the last line",
        faults);
  for (const auto& [problem, score] : scores["scores"].items())
    if (!score.is_number()) faults.push_back("a score that is no number: " + problem);
  for (std::size_t i = 0; i + 2 < lines.size(); ++i)
    if (lines[i].starts_with("{")) faults.push_back("another line looks like one of ours");
  const Json stages = Json::parse(lines[lines.size() - 2], nullptr, false);
  if (stages.is_discarded() || stages.value("_presentation", "") != "semantic" ||
      !are_texts(stages.value("stages", Json())))
    return {"the line before has no stages"};
  for (const std::string stage : stages["stages"]) {
    const Json entries = stages.value(stage, Json::object());
    for (const auto& [name, entry] : entries.items())
      check(entry,
            {{"passed", {true, [](const Json& j) { return j.is_boolean(); }}},
             {"hint", {false, is_text}}},
            stage + ": " + name, faults);
  }
  return faults;
}

std::string decoded(const std::string& base64) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  static const std::string letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (const char c : base64) {
    const std::size_t value = letters.find(c);
    if (value == std::string::npos) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const std::size_t begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

}  // namespace tumble::grading
