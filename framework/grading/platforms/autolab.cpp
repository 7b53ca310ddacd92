// Source: autolab/Autolab, docs/lab.md: the last line of what an autograder prints has the scores.
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/grading/grades/scoring.h"
#include "framework/grading/platforms/formats.h"

namespace tumble::grading {
namespace {

using Json = nlohmann::ordered_json;

// No line of a submission's words is one of ours.
std::string quoted_lines(const std::string& text) {
  std::string all;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) all += "| " + line + '\n';
  return all;
}

std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

std::string autolab_output(const StudentView& view) {
  std::string text = view.said.empty() ? "" : quoted_lines(view.said) + '\n';
  Json open = Json::object();
  double score = 0.0;
  for (const ShownTest& test : view.tests) {
    score += test.score;
    text += fmt::format("{}: {} of {}\n", test.title, points_text(test.score),
                        points_text(test.possible));
    if (test.verdict != Verdict::kRight) text += quoted_lines(test.text) + '\n';
    Json stage = {{"passed", test.verdict == Verdict::kRight}};
    if (test.verdict != Verdict::kRight) stage["hint"] = words(test.verdict);
    open[test.title] = stage;
  }
  const HiddenSum hidden = sum_of_hidden(view);
  Json stages = {{"_presentation", "semantic"}, {"stages", Json::array({"Public tests"})}};
  stages["Public tests"] = open;
  Json scores = {{kAutolabPublic, score}};
  if (hidden.count > 0) {
    text += fmt::format("Hidden tests: {} of {}. {}\n", points_text(hidden.score),
                        points_text(hidden.possible), hidden.text);
    stages["stages"].push_back("Hidden tests");
    stages["Hidden tests"] = {
        {"All together",
         {{"passed", hidden.passed == hidden.count},
          {"hint", fmt::format("{} of {} passed", hidden.passed, hidden.count)}}}};
    scores[kAutolabHidden] = hidden.score;
  }
  if (!view.is_official) text += "Not an official grade; sandbox: " + view.sandbox + "\n";
  return text + one_line(stages) + one_line({{"scores", scores}});
}

}  // namespace tumble::grading
