#include "framework/grading/grades/equal_mutations.h"

#include <sstream>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace tumble::grading {
namespace {

std::string without_blanks(const std::string& line) {
  const auto first = line.find_first_not_of(" \t"), last = line.find_last_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first, last - first + 1);
}

}  // namespace

EqualMutations read_equal_mutations(const Course& course, const std::string& id) {
  const auto file = reference_of(course, id).parent_path() / "equal_mutations.json";
  if (!std::filesystem::exists(file)) return {};
  EqualMutations known;
  try {
    for (const nlohmann::json& entry : nlohmann::json::parse(text_of(file)))
      known.push_back({without_blanks(entry.at("before")), without_blanks(entry.at("after")),
                       entry.at("because")});
  } catch (const nlohmann::json::exception& error) {
    throw UserError(file.string(), error.what(),
                    "It is a list of objects with before, after and because.");
  }
  for (const EqualMutation& one : known)
    if (one.because.empty())
      throw UserError(file.string(), "gives no reason for '" + one.after + "'");
  return known;
}

std::string why_equal(const Candidate& candidate, const EqualMutations& known) {
  if (candidate.file.extension() != kSlipExtension) return "";
  std::string before, after;
  std::istringstream lines(text_of(candidate.file));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("-")) before += without_blanks(line.substr(1));
    if (line.starts_with("+")) after += without_blanks(line.substr(1));
  }
  for (const EqualMutation& one : known)
    if (one.before == before && one.after == after) return one.because;
  return "";
}

}  // namespace tumble::grading
