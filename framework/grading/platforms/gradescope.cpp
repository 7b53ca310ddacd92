// Source: github.com/gradescope/autograder_samples, docs/specs.md.
#include <nlohmann/json.hpp>

#include "framework/core/version.h"
#include "framework/grading/platforms/formats.h"

namespace tumble::grading {

std::string gradescope_results(const StudentView& view) {
  using Json = nlohmann::ordered_json;
  const auto status = [](bool passed) { return passed ? "passed" : "failed"; };
  Json tests = Json::array();
  for (const ShownTest& test : view.tests)
    tests.push_back({{"name", test.title},
                     {"score", test.score},
                     {"max_score", test.possible},
                     {"status", status(test.verdict == Verdict::kRight)},
                     {"output", test.text},
                     {"tags", test.level.empty() ? Json::array() : Json::array({test.level})},
                     {"visibility", "visible"},
                     {"extra_data", {{"test", test.test}, {"verdict", words(test.verdict)}}}});
  if (const HiddenSum hidden = sum_of_hidden(view); hidden.count > 0)
    tests.push_back({{"name", "Hidden tests"},
                     {"score", hidden.score},
                     {"max_score", hidden.possible},
                     {"status", status(hidden.passed == hidden.count)},
                     {"output", hidden.text},
                     {"visibility", "visible"}});
  const Json page = {
      {"score", view.score},
      {"output", view.said},
      {"output_format", "text"},
      {"test_output_format", "text"},
      {"test_name_format", "text"},
      {"visibility", "visible"},
      // where the instructor reads the stories of hidden tests
      {"stdout_visibility", "hidden"},
      {"extra_data",
       {{"version", kProgramVersion}, {"sandbox", view.sandbox}, {"official", view.is_official}}},
      {"tests", tests}};
  return page.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace tumble::grading
