#include "framework/grading/verdicts/verdict.h"

#include <array>
#include <fstream>

#include <nlohmann/json.hpp>

namespace tumble::grading {
namespace {

constexpr std::array kWords = {"right",
                               "wrong",
                               "not attempted",
                               "crashed",
                               "out of time or memory",
                               "fault of the grader",
                               "machine too busy"};

}  // namespace

const char* words(Verdict verdict) { return kWords.at(static_cast<std::size_t>(verdict)); }

std::optional<Verdict> verdict_from_words(const std::string& text) {
  for (std::size_t i = 0; i < kWords.size(); ++i)
    if (text == kWords[i]) return static_cast<Verdict>(i);
  return std::nullopt;
}

ExitCode exit_code(const std::vector<TestResult>& results) {
  bool wrong = false, missing = false;
  for (const TestResult& result : results) {
    if (!is_final_verdict(result.verdict)) return ExitCode::kOurBug;
    if (result.verdict == Verdict::kNotAttempted)
      missing = true;
    else if (result.verdict != Verdict::kRight)
      wrong = true;
  }
  return wrong ? ExitCode::kCheckFailed : missing ? ExitCode::kNotAttempted : ExitCode::kFine;
}

void write_results(const std::string& file, const std::vector<TestResult>& results) {
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  for (const TestResult& r : results)
    tests.push_back({{"test", r.test},
                     {"verdict", words(r.verdict)},
                     {"story", r.story},
                     {"last_call", r.last_call},
                     {"calls", r.calls},
                     {"printed", r.printed},
                     {"timed_out_s", r.timed_out_s},
                     {"not_run", r.not_run},
                     {"charged_s", r.charged_s},
                     {"wall_s", r.wall_s}});
  std::ofstream out(file);
  // Students' code may print any bytes: invalid UTF-8 is replaced, not refused.
  out << nlohmann::ordered_json{{"tests", tests}}.dump(
             1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
      << '\n';
  if (!out.flush()) throw UserError(file, "cannot be written");
}

std::vector<TestResult> read_results(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw UserError(file, "cannot be read");
  try {
    std::vector<TestResult> results;
    // named: a range over a part of a temporary would outlive it
    const auto record = nlohmann::json::parse(in);
    for (const auto& item : record.at("tests")) {
      TestResult r;
      r.test = item.at("test");
      const auto verdict = verdict_from_words(item.at("verdict"));
      if (!verdict) throw UserError(file, "has an unknown verdict");
      r.verdict = *verdict;
      r.story = item.at("story");
      r.last_call = item.at("last_call");
      r.calls = item.at("calls");
      r.printed = item.at("printed");
      r.timed_out_s = item.at("timed_out_s");
      r.not_run = item.at("not_run");
      r.charged_s = item.at("charged_s");
      r.wall_s = item.at("wall_s");
      results.push_back(std::move(r));
    }
    return results;
  } catch (const nlohmann::json::exception& error) {
    throw UserError(file, std::string("is not a record of a test program: ") + error.what());
  }
}

}  // namespace tumble::grading
