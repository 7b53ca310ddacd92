// Source: classroom-resources/autograding-io-grader, src/main.js (version 1 of the result).
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/grading/platforms/formats.h"
#include "framework/report/channels.h"

namespace tumble::grading {
namespace {

const char* status_of(Verdict verdict) {
  if (verdict == Verdict::kRight) return "pass";
  return verdict == Verdict::kCrashed || verdict == Verdict::kOutOfResources ? "error" : "fail";
}

}  // namespace

std::string github_classroom_result(const StudentView& view) {
  require(view.hidden.empty(), "platforms: GitHub Classroom runs no hidden test");
  using Json = nlohmann::ordered_json;
  Json tests = Json::array();
  bool all = view.state == GradeState::kJudged;
  for (const ShownTest& test : view.tests) {
    all = all && test.verdict == Verdict::kRight;
    tests.push_back({{"name", test.title},
                     {"status", status_of(test.verdict)},
                     {"message", test.text},
                     {"test_code", "tumble check " + view.assignment + " '" + test.test + "'"},
                     {"filename", ""},
                     {"line_no", 0},
                     {"execution_time", ""},  // not measured: a load of the machine is no result
                     {"score", test.score}});
  }
  if (!view.said.empty())
    tests.push_back({{"name", "Your file"},
                     {"status", view.state == GradeState::kJudged ? "pass" : "error"},
                     {"message", view.said},
                     {"test_code", ""},
                     {"filename", ""},
                     {"line_no", 0},
                     {"execution_time", ""},
                     {"score", 0}});
  const Json result = {{"version", 1},
                       {"status", view.state != GradeState::kJudged ? "error"
                                  : all                             ? "pass"
                                                                    : "fail"},
                       {"max_score", view.possible},
                       {"tests", tests}};
  return report::base64(result.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace tumble::grading
