/// Output of `tumble truths`: one line of at most 100 columns per case, or JSON.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/truths/comparison.h"

namespace tumble::cli {

/// All comparisons of one case.
struct CaseResult {
  std::string id;
  std::string family;
  std::vector<truths::Line> lines;
};

void print_truths_head();
/// One line; below it failures, measured orders, or what is not attempted.
/// @param each  every output, with its note
/// @param said  hints that were printed already, not to be repeated; grows
void print_truths_case(const CaseResult& result, bool each, std::set<std::string>& said);
/// @param skipped  number of cases of each unknown family
void print_truths_count(const std::vector<CaseResult>& results,
                        const std::map<std::string, int>& skipped);

nlohmann::ordered_json truths_to_json(const std::vector<CaseResult>& results,
                                      const std::map<std::string, int>& skipped);

/// Cases of one verdict.
int count_cases(const std::vector<CaseResult>& results, truths::Verdict verdict);

}  // namespace tumble::cli
