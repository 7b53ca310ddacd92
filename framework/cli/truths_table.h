/// How the cases of `tumble truths` are shown: a case a line within 100 columns, or JSON.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/engines/truths/comparison.h"

namespace tumble::cli {

/// All comparisons of one case.
struct CaseResult {
  std::string id;
  std::string family;
  std::vector<truths::Line> lines;
};

void print_truths_head();
/// One line; below it what failed, what was measured about convergence, or what is not attempted.
/// @param each  every output, with its note
/// @param said  hints that stand above already, not to be repeated; grows
void print_truths_case(const CaseResult& result, bool each, std::set<std::string>& said);
/// @param skipped  how many cases of each family are not known here
void print_truths_count(const std::vector<CaseResult>& results, const std::map<std::string, int>& skipped);

nlohmann::ordered_json truths_to_json(const std::vector<CaseResult>& results, const std::map<std::string, int>& skipped);

/// Cases of one verdict.
int count_cases(const std::vector<CaseResult>& results, truths::Verdict verdict);

}  // namespace tumble::cli
