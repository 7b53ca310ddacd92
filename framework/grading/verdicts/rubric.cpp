#include "framework/grading/verdicts/rubric.h"

#include <cmath>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"

namespace tumble::grading {
namespace {

RubricItem read_item(const nlohmann::json& entry, const std::string& where) {
  RubricItem item;
  try {
    item.test = entry.at("test");
    item.points = entry.at("points");
    item.level = entry.at("level");
    item.title = entry.at("title");
  } catch (const nlohmann::json::exception& error) {
    throw UserError(where, std::string("is not an entry of a rubric: ") + error.what(),
                    "It needs test, points, level and title.");
  }
  if (item.test.find('.') == std::string::npos)
    throw UserError(where, "test '" + item.test + "' is not of the form Suite.Name");
  if (!(item.points >= 0.0)) throw UserError(where, "test '" + item.test + "' has points below 0");
  static const std::set<std::string> levels = {"basic", "intermediate", "advanced"};
  if (!levels.contains(item.level))
    throw UserError(where, "unknown level '" + item.level + "'",
                    "Levels are basic, intermediate, advanced.");
  return item;
}

// "own_tests" of either rubric; nothing where it has none.
std::optional<OwnTestsRule> read_own_tests(const nlohmann::json& document,
                                           const std::string& file) {
  if (!document.contains("own_tests")) return std::nullopt;
  const std::string where = file + " /own_tests";
  OwnTestsRule rule;
  try {
    const nlohmann::json& own = document["own_tests"];
    rule.points = own.value("points", 0.0);
    rule.share = own.value("share", 1.0);
    rule.slips = own.value("slips", std::vector<std::string>());
  } catch (const nlohmann::json::exception& error) {
    throw UserError(where, std::string("is no rule for own tests: ") + error.what(),
                    "It has points and share; of the hidden rubric slips.");
  }
  if (!(rule.points >= 0.0)) throw UserError(where, "has points below 0");
  if (!(rule.share > 0.0 && rule.share <= 1.0))
    throw UserError(where, "its share is not in (0, 1]", "It is the part of the slips to catch.");
  return rule;
}

}  // namespace

const RubricItem* Rubric::find(const std::string& test) const {
  for (const RubricItem& item : items)
    if (item.test == test) return &item;
  return nullptr;
}

double Rubric::total() const {
  double sum = 0.0;
  for (const RubricItem& item : items) sum += item.points;
  return sum;
}

Rubric read_rubric(const std::filesystem::path& file, bool hidden) {
  std::ifstream in(file);
  if (!in) throw UserError(file.string(), "cannot be read", "Every assignment has a rubric.");
  nlohmann::json document;
  try {
    document = nlohmann::json::parse(in);
  } catch (const nlohmann::json::exception& error) {
    throw UserError(file.string(), error.what());
  }
  Rubric rubric;
  rubric.assignment = document.value("assignment", "");
  rubric.title = document.value("title", "");
  rubric.own_tests = read_own_tests(document, file.string());
  if (!document.contains("tests") || !document["tests"].is_array())
    throw UserError(file.string(), "has no array \"tests\"");
  std::set<std::string> seen;
  for (std::size_t i = 0; i < document["tests"].size(); ++i) {
    const std::string where = file.string() + " /tests/" + std::to_string(i);
    RubricItem item = read_item(document["tests"][i], where);
    item.hidden = hidden;
    if (!seen.insert(item.test).second)
      throw UserError(where, "names test '" + item.test + "' a second time");
    rubric.items.push_back(std::move(item));
  }
  return rubric;
}

Rubric joined(const Rubric& open, const Rubric& hidden) {
  Rubric all = open;
  for (const RubricItem& item : hidden.items) {
    if (open.find(item.test) != nullptr)
      throw UserError("rubric of " + open.assignment,
                      "test '" + item.test + "' is both public and hidden");
    all.items.push_back(item);
  }
  if (all.own_tests && hidden.own_tests) all.own_tests->slips = hidden.own_tests->slips;
  // points: they have few decimals, so the sum is exact up to round-off
  constexpr double kFull = 100.0, kSlack = 1e-9;
  if (std::abs(all.total() - kFull) > kSlack)
    throw UserError("rubric of " + open.assignment,
                    "public and hidden points sum to " + std::to_string(all.total()),
                    "They must sum to 100.");
  return all;
}

}  // namespace tumble::grading
