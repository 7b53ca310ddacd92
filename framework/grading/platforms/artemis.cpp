// Sources: ls1intum/Artemis, docs/user/exercises/programming.rst; the elements of JUnit's XML as
// testmoapp/junitxml lists them.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/grading/grades/scoring.h"
#include "framework/grading/platforms/formats.h"

namespace tumble::grading {
namespace {

// Of plain text, which has no control characters but line ends and tabs. U+FFFE and U+FFFF, which
// are valid UTF-8, are no characters of XML 1.0 (section 2.2).
std::string xml_text(const std::string& text) {
  std::string escaped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = std::string_view(text).substr(i);
    if (rest.starts_with("\xef\xbf\xbe") || rest.starts_with("\xef\xbf\xbf")) {
      escaped += '?';
      i += 2;
      continue;
    }
    switch (text[i]) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\'': escaped += "&apos;"; break;
      case '\n': escaped += "&#10;"; break;  // a line end in an attribute would become a space
      case '\t': escaped += "&#9;"; break;
      default: escaped += text[i];
    }
  }
  return escaped;
}

// failure: a wrong answer, or none; error: the code ended in another way.
bool is_error(Verdict verdict) {
  return verdict == Verdict::kCrashed || verdict == Verdict::kOutOfResources;
}

std::string properties_of(double score, double possible) {
  return fmt::format(
      "   <properties>\n    <property name=\"score\" value=\"{}\"/>\n"
      "    <property name=\"max_score\" value=\"{}\"/>\n   </properties>\n",
      points_text(score), points_text(possible));
}

std::string case_of(const std::string& suite, const std::string& name,
                    const std::string& properties, const std::string& outcome) {
  return fmt::format("  <testcase name=\"{}\" classname=\"{}\">\n{}{}  </testcase>\n",
                     xml_text(name), xml_text(suite), properties, outcome);
}

std::string case_of(const ShownTest& test) {
  const std::string suite = test.test.substr(0, test.test.find('.'));
  std::string outcome;
  if (test.verdict != Verdict::kRight) {
    const char* element = is_error(test.verdict) ? "error" : "failure";
    outcome = fmt::format("   <{0} message=\"{1}\" type=\"{2}\">{1}</{0}>\n", element,
                          xml_text(test.text), words(test.verdict));
  }
  return case_of(suite, test.test, properties_of(test.score, test.possible), outcome);
}

std::string case_of(const HiddenTest& test, std::size_t number) {
  const bool passed = test.score == test.possible;
  constexpr const char* kFailure =
      "   <failure message=\"A hidden test. Its details are not shown.\" type=\"hidden\"/>\n";
  return case_of("Hidden", fmt::format("Hidden.Test{:02}", number),
                 properties_of(test.score, test.possible), passed ? "" : kFailure);
}

std::string junit_xml(const StudentView& view) {
  std::string cases;
  std::size_t failures = 0, errors = 0;
  for (const ShownTest& test : view.tests) {
    cases += case_of(test);
    if (test.verdict != Verdict::kRight) ++(is_error(test.verdict) ? errors : failures);
  }
  for (std::size_t i = 0; i < view.hidden.size(); ++i) {
    cases += case_of(view.hidden[i], i + 1);
    failures += view.hidden[i].score != view.hidden[i].possible;
  }
  const std::string counts = fmt::format(
      "name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"0\"",
      xml_text(view.assignment), view.tests.size() + view.hidden.size(), failures, errors);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {0}>\n <testsuite {0}>\n{1}"
      " </testsuite>\n</testsuites>\n",
      counts, cases);
}

std::string feedback(const std::string& name, bool successful, const std::string& message) {
  using Json = nlohmann::ordered_json;
  const Json json = {{"name", name}, {"successful", successful}, {"message", message}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

std::map<std::string, std::string> artemis_files(const StudentView& view) {
  std::map<std::string, std::string> files;
  files["results/tumble.xml"] = junit_xml(view);
  const HiddenSum hidden = sum_of_hidden(view);
  std::string points =
      fmt::format("{} of {} points", points_text(view.score), points_text(view.possible));
  if (hidden.count > 0) points += "; hidden tests: " + hidden.text;
  if (!view.is_official) points += "\nNot an official grade; sandbox: " + view.sandbox;
  files["customFeedbacks/1_points.json"] =
      feedback("Tumble: points", view.score >= view.possible, points);
  if (!view.said.empty())
    files["customFeedbacks/2_file.json"] =
        feedback("Tumble: your file", view.state == GradeState::kJudged, view.said);
  return files;
}

}  // namespace tumble::grading
