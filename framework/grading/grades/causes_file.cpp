#include "framework/grading/grades/causes_file.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "framework/core/files.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The module's function whose text a slip changes: the words behind its first @@.
std::string function_of(const AuditResult& result, const std::vector<std::string>& functions) {
  if (result.candidate.file.extension() != kSlipExtension) return "";
  std::string function;
  std::istringstream lines(text_of(result.candidate.file));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("@@ ")) continue;
    const std::string name = line.substr(3);
    if (std::find(functions.begin(), functions.end(), name) == functions.end()) return "";
    if (!function.empty() && function != name) return "";  // in more than one
    function = name;
  }
  return function;
}

}  // namespace

fs::path causes_file(const Course& course, const std::string& id) {
  return course.root / "solutions_private" / course.registry->find(id).folder / "causes.json";
}

std::vector<AuditedSlip> audited_slips(const std::vector<AuditResult>& results,
                                       const std::vector<std::string>& functions) {
  std::vector<AuditedSlip> slips;
  for (const AuditResult& result : results) {
    if (result.candidate.is_right || result.candidate.base.empty()) continue;
    AuditedSlip slip{
        result.candidate.name, result.candidate.slip, function_of(result, functions), {}};
    for (const TestResult& test : result.caught_by) slip.fails.push_back(failure_of(test));
    slips.push_back(std::move(slip));
  }
  return slips;
}

std::string causes_json(const std::string& id, const std::vector<AuditedSlip>& slips) {
  Json page = {{"assignment", id}, {"written_by", "tumble audit " + id}, {"slips", Json::array()}};
  for (const AuditedSlip& slip : slips) {
    Json fails = Json::array();
    for (const Failure& failure : slip.fails)
      fails.push_back({failure.test, words(failure.verdict), failure.found, failure.function});
    page["slips"].push_back({{"name", slip.name},
                             {"says", slip.says},
                             {"function", slip.function},
                             {"fails", std::move(fails)}});
  }
  return page.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::vector<AuditedSlip> read_causes(const fs::path& file) {
  try {
    std::vector<AuditedSlip> slips;
    const Json page = Json::parse(text_of(file));
    for (const Json& entry : page.at("slips")) {
      AuditedSlip slip{entry.at("name"), entry.at("says"), entry.at("function"), {}};
      for (const Json& fails : entry.at("fails"))
        slip.fails.push_back(
            {fails.at(0), verdict_from_words(fails.at(1)).value(), fails.at(2), fails.at(3)});
      slips.push_back(std::move(slip));
    }
    return slips;
  } catch (const std::exception& error) {
    throw UserError(file.string(), std::string("cannot be read: ") + error.what(),
                    "Run tumble audit for this assignment: it writes the file anew.");
  }
}

std::vector<AuditedSlip> audited_slips_of(const Course& course, const std::string& id) {
  const fs::path file = causes_file(course, id);
  return fs::exists(file) ? read_causes(file) : std::vector<AuditedSlip>{};
}

}  // namespace tumble::grading
