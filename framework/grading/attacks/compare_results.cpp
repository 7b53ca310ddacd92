#include "framework/grading/attacks/compare_results.h"

#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {
namespace {

using Json = nlohmann::json;

struct Test {
  std::string verdict;
  double score = 0.0;
};

std::map<std::string, Test> tests_of(const Json& results) {
  std::map<std::string, Test> all;
  for (const Json& test : results.at("tests"))
    if (test.at("extra_data").contains("test"))  // own tests have none
      all[test.at("extra_data").at("test")] = {test.at("extra_data").at("verdict"),
                                               test.value("score", 0.0)};
  return all;
}

// Whether any text in it holds these words.
bool holds(const Json& json, const std::string& words) {
  if (json.is_string()) return json.get<std::string>().find(words) != std::string::npos;
  for (const Json& part : json)
    if ((part.is_string() || part.is_structured()) && holds(part, words)) return true;
  return false;
}

void compare_tests(const Attack& attack, const Json& results, const Json& harmless,
                   AttackResult& result) {
  const auto ours = tests_of(results), theirs = tests_of(harmless);
  std::map<std::string, int> differing;
  if (ours.size() != theirs.size()) result.faults.push_back("tests are missing or too many");
  for (const auto& [name, test] : ours) {
    const auto other = theirs.find(name);
    if (other == theirs.end()) continue;
    const bool may_be_right = test.verdict == "right" && attack.verdicts.contains("right");
    if (test.score > other->second.score && !may_be_right)
      result.faults.push_back(fmt::format("it gains in {}: {} points, without the attack {}", name,
                                          test.score, other->second.score));
    const auto known = verdict_from_words(test.verdict);
    const bool is_final = known && is_final_verdict(*known);
    if (test.verdict == other->second.verdict && is_final) continue;
    if (differing[test.verdict]++ == 0 && (!attack.verdicts.contains(test.verdict) || !is_final))
      result.faults.push_back(fmt::format("{} is '{}', which is not expected", name, test.verdict));
  }
  if (differing.empty() && !attack.verdicts.contains("same"))
    result.faults.push_back("no test differs from the harmless submission's: nothing was attacked");
  for (const auto& [verdict, count] : differing)
    result.found += fmt::format("{}{} {}", result.found.empty() ? "" : ", ", count, verdict);
  if (differing.empty()) result.found = "same as " + attack.harmless();
}

}  // namespace

void compare_results(const Attack& attack, const std::string& results, const std::string& record,
                     const std::string& harmless, AttackResult& result) {
  const Json ours = Json::parse(results, nullptr, false),
             theirs = Json::parse(harmless, nullptr, false),
             about = Json::parse(record, nullptr, false);
  if (ours.is_discarded() || theirs.is_discarded() || about.is_discarded()) {
    result.faults.push_back("there is no results.json, or it is no JSON");
    return;
  }
  const std::string state = ours.at("extra_data").at("state");
  result.score = ours.value("score", 0.0);
  if (!attack.states.contains(state))
    result.faults.push_back("it is '" + state + "', which is not expected");
  if (state == "judged")
    compare_tests(attack, ours, theirs, result);
  else
    result.found = state;
  if (state != "judged" && result.score > 0.0) result.faults.push_back("it has points");
  if (attack.own_points) {
    const Json own = about.value("own_tests", Json::object());
    const double points = own.value("score", -1.0);
    if (points != *attack.own_points)
      result.faults.push_back(fmt::format("its own tests have {} points, and {} are expected",
                                          points, *attack.own_points));
    result.found += fmt::format(", own tests {} points", points);
  }
  for (const std::string& words : attack.stories)
    if (!holds(ours, words) && !holds(about, words))
      result.faults.push_back("no story holds '" + words + "'");
}

}  // namespace tumble::grading
