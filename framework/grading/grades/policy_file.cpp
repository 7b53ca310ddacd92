#include "framework/grading/grades/policy_file.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/scene/json_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kExample = "For example \"2026-10-12T23:59:00+02:00\".";

std::string text_to_read(const fs::path& file) {
  std::string why;
  const auto text = read_plain_file(file, 16u << 20, why);
  if (!text && !fs::exists(fs::symlink_status(file)))
    throw UserError(file.string(), "does not exist");
  if (!text) throw UserError(file.string(), why);
  return text->starts_with("\xef\xbb\xbf") ? text->substr(3) : *text;
}

// A table whose first row names its columns.
class Table {
 public:
  Table(const fs::path& file, const std::vector<std::string>& needed,
        const std::vector<std::string>& allowed)
      : file_(file), rows_(csv_rows(text_to_read(file))) {
    for (std::size_t i = 0; !rows_.empty() && i < rows_[0].size(); ++i) {
      const std::string& name = rows_[0][i];
      if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
        throw UserError(
            file.string(),
            "has the unknown column '" + plain_name(name) + "'." + did_you_mean(name, allowed),
            fmt::format("Its columns are {}.", fmt::join(allowed, ", ")));
      columns_[name] = i;
    }
    for (const std::string& name : needed)
      if (!columns_.contains(name))
        throw UserError(file.string(), "has no column '" + name + "'",
                        fmt::format("Its first line names them: {}.", fmt::join(allowed, ",")));
  }

  std::size_t size() const { return rows_.size() - 1; }
  std::string cell(std::size_t row, const std::string& column) const {
    const auto it = columns_.find(column);
    const auto& cells = rows_[row + 1];
    return it == columns_.end() || it->second >= cells.size() ? "" : cells[it->second];
  }
  std::string where(std::size_t row) const {
    return fmt::format("{}, entry {}", file_.string(), row + 1);
  }

 private:
  fs::path file_;
  std::vector<std::vector<std::string>> rows_;
  std::map<std::string, std::size_t> columns_;
};

std::vector<Person> read_roster(const fs::path& file) {
  const Table table(file, {"name", "id"}, {"name", "id", "group", "late_days"});
  std::vector<Person> roster;
  std::set<std::string> known;
  for (std::size_t row = 0; row < table.size(); ++row) {
    Person person{table.cell(row, "name"), table.cell(row, "id"), table.cell(row, "group"), {}};
    if (person.name.empty()) throw UserError(table.where(row), "has no name");
    std::set<std::string> words = {person.name};
    if (!person.id.empty()) words.insert(person.id);
    for (const std::string& word : words)
      if (!known.insert(word).second)
        throw UserError(table.where(row),
                        "'" + plain_name(word) + "' stands for another person already",
                        "Names and ids have to be different from each other.");
    if (const std::string days = table.cell(row, "late_days"); !days.empty()) {
      int number = 0;
      const auto read = std::from_chars(days.data(), days.data() + days.size(), number);
      if (read.ec != std::errc() || read.ptr != days.data() + days.size() || number < 0)
        throw UserError(table.where(row),
                        "late_days is '" + plain_name(days) + "', and is a whole number from 0");
      person.free_late_days = number;
    }
    roster.push_back(std::move(person));
  }
  if (roster.empty()) throw UserError(file.string(), "has no person in it");
  return roster;
}

std::vector<HandIn> read_hand_ins(const fs::path& file) {
  const Table table(file, {"submission", "time"}, {"submission", "student", "time"});
  std::vector<HandIn> all;
  std::set<std::string> known;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const auto time = time_of(table.cell(row, "time"));
    if (!time)
      throw UserError(table.where(row),
                      "'" + plain_name(table.cell(row, "time")) + "' is no time with its offset",
                      kExample);
    all.push_back({table.cell(row, "submission"), table.cell(row, "student"), *time});
    if (!known.insert(all.back().submission).second)
      throw UserError(table.where(row),
                      "'" + plain_name(all.back().submission) + "' stands there twice");
  }
  return all;
}

void refuse_unknown_fields(const fs::path& file, const Json& json) {
  static const std::vector<std::string> kFields = {
      "due",           "roster",         "handed_in",
      "grace_minutes", "free_late_days", "penalty_percent_a_day",
      "attempt",       "groups",         "penalty_cap_percent",
      "extensions",    "by_hand"};
  for (const auto& [name, value] : json.items())
    if (std::find(kFields.begin(), kFields.end(), name) == kFields.end())
      throw UserError(
          file.string(),
          "has the unknown field '" + plain_name(name) + "'." + did_you_mean(name, kFields),
          fmt::format("Its fields are {}.", fmt::join(kFields, ", ")));
}

double number_in(const fs::path& file, const Json& json, const char* name, double otherwise,
                 double most) {
  if (!json.contains(name)) return otherwise;
  const Json& value = json[name];
  if (!value.is_number() || !(value.get<double>() >= 0.0 && value.get<double>() <= most))
    throw UserError(file.string(), fmt::format("{} is {}, and is a number from 0 to {}", name,
                                               value.dump(), most));
  return value.get<double>();
}

std::int64_t due_of(const fs::path& file, const Json& json, const std::string& assignment) {
  const Json due = json.value("due", Json::object());
  if (!due.is_object() || !due.contains(assignment))
    throw UserError(file.string(), "does not say when " + assignment + " is due",
                    "\"due\": {\"" + assignment + "\": \"2026-10-12T23:59:00+02:00\"}");
  const auto time = due[assignment].is_string() ? time_of(due[assignment].get<std::string>())
                                                : std::optional<std::int64_t>();
  if (!time)
    throw UserError(file.string(), "due: " + due[assignment].dump() + " is no time with its offset",
                    kExample);
  return *time;
}

Policy policy_in(const fs::path& file, const Json& json, const std::string& assignment) {
  constexpr double kManyDays = 365.0;
  Policy policy;
  policy.due_s = due_of(file, json, assignment);
  policy.grace_s = static_cast<std::int64_t>(
      60.0 * number_in(file, json, "grace_minutes", 0.0, kManyDays * 24.0 * 60.0));
  const double free = number_in(file, json, "free_late_days", 0.0, kManyDays);
  policy.free_late_days = static_cast<int>(free);
  if (policy.free_late_days != free)
    throw UserError(file.string(), "free_late_days is no whole number");
  policy.percent_a_day =
      number_in(file, json, "penalty_percent_a_day", policy.percent_a_day, 100.0);
  policy.cap_percent = number_in(file, json, "penalty_cap_percent", policy.cap_percent, 100.0);
  const Json attempt = json.value("attempt", Json("best"));
  if (attempt != "best" && attempt != "last")
    throw UserError(file.string(),
                    "attempt is " + attempt.dump() + ", and is \"best\" or \"last\"");
  policy.attempt = attempt == "best" ? AttemptThatCounts::kBest : AttemptThatCounts::kLast;
  const Json groups = json.value("groups", Json(false));
  if (!groups.is_boolean())
    throw UserError(file.string(), "groups is " + groups.dump() + ", and is true or false");
  policy.groups = groups.get<bool>();
  return policy;
}

// The entries of this assignment under a field, by the person that each is for.
std::vector<std::pair<Person*, Json>> for_persons(const fs::path& file, const Json& json,
                                                  const std::string& field,
                                                  const std::string& assignment,
                                                  std::vector<Person>& roster) {
  std::vector<std::pair<Person*, Json>> found;
  const Json all = json.value(field, Json::object());
  const std::string form = "\"" + field + "\": {\"" + assignment + "\": {\"name or id\": ...}}";
  if (!all.is_object() || (all.contains(assignment) && !all[assignment].is_object()))
    throw UserError(file.string(), field + " does not name assignments, and students in these",
                    form);
  if (!all.contains(assignment)) return found;
  std::vector<std::string> words;
  for (const Person& person : roster) words.insert(words.end(), {person.name, person.id});
  for (const auto& [word, value] : all[assignment].items()) {
    const auto person = std::find_if(roster.begin(), roster.end(), [&](const Person& one) {
      return !word.empty() && (one.name == word || one.id == word);
    });
    if (person == roster.end())
      throw UserError(
          file.string(),
          field + ": '" + plain_name(word) + "' is not in the roster." + did_you_mean(word, words),
          form);
    for (const auto& [other, entry] : found)
      if (other == &*person)
        throw UserError(file.string(),
                        field + ": '" + plain_name(word) + "' stands there twice, by name and id");
    found.emplace_back(&*person, value);
  }
  return found;
}

void read_extensions(const fs::path& file, const Json& json, const std::string& assignment,
                     std::int64_t due_s, std::vector<Person>& roster) {
  for (const auto& [person, value] : for_persons(file, json, "extensions", assignment, roster)) {
    person->due_s =
        value.is_string() ? time_of(value.get<std::string>()) : std::optional<std::int64_t>();
    if (!person->due_s)
      throw UserError(file.string(), "extensions: " + value.dump() + " is no time with its offset",
                      kExample);
    if (*person->due_s < due_s)
      throw UserError(file.string(), "extensions: " + value.dump() + " of '" +
                                         plain_name(person->name) + "' is before " + assignment +
                                         " is due");
  }
}

void read_points_by_hand(const fs::path& file, const Json& json, const std::string& assignment,
                         std::vector<Person>& roster) {
  constexpr double kMost = 1000.0;
  for (const auto& [person, value] : for_persons(file, json, "by_hand", assignment, roster)) {
    const bool is_whole = value.is_object() && value.size() == 2 && value.contains("points") &&
                          value.contains("why") && value["why"].is_string() &&
                          !value["why"].get<std::string>().empty();
    if (!is_whole)
      throw UserError(file.string(),
                      "by_hand: " + value.dump() + " of '" + plain_name(person->name) +
                          "' has no points, or no reason, or more than these",
                      "{\"points\": 80, \"why\": \"explained it at the blackboard\"}");
    person->by_hand =
        PointsByHand{number_in(file, value, "points", 0.0, kMost), value["why"].get<std::string>()};
  }
}

fs::path path_in(const fs::path& file, const Json& json, const char* name) {
  if (!json.contains(name)) return {};
  if (!json[name].is_string())
    throw UserError(file.string(),
                    std::string(name) + " is " + json[name].dump() + ", and is the name of a file");
  return file.parent_path() / json[name].get<std::string>();
}

}  // namespace

std::optional<std::int64_t> time_of(const std::string& text) {
  std::tm date = {};
  char sign = 'Z';
  int hours = 0, minutes = 0, seen = 0;
  const int fields =
      std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d%n", &date.tm_year, &date.tm_mon,
                  &date.tm_mday, &date.tm_hour, &date.tm_min, &date.tm_sec, &seen);
  if (fields != 6 || seen != 19) return std::nullopt;
  const std::string offset = text.substr(19);
  if (offset != "Z") {
    int used = 0;
    if (std::sscanf(offset.c_str(), "%c%2d:%2d%n", &sign, &hours, &minutes, &used) != 3 ||
        used != 6 || offset.size() != 6 || (sign != '+' && sign != '-') || hours > 14 ||
        minutes > 59 || hours < 0 || minutes < 0)
      return std::nullopt;
  }
  date.tm_year -= 1900;
  date.tm_mon -= 1;
  const std::tm said = date;
  const std::int64_t utc_s = ::timegm(&date);
  // timegm turns the 31st of June into the 1st of July.
  if (said.tm_mon != date.tm_mon || said.tm_mday != date.tm_mday || said.tm_hour != date.tm_hour ||
      said.tm_min != date.tm_min || said.tm_sec != date.tm_sec)
    return std::nullopt;
  const std::int64_t offset_s = 3600 * hours + 60 * minutes;
  return utc_s + (sign == '-' ? offset_s : -offset_s);
}

std::vector<std::vector<std::string>> csv_rows(const std::string& text) {
  const std::string head = text.substr(0, text.find('\n'));
  const char between = head.find(',') == head.npos && head.find(';') != head.npos ? ';' : ',';
  std::vector<std::vector<std::string>> rows(1, {""});
  bool quoted = false;
  const auto end_row = [&] {
    if (rows.back().size() == 1 && rows.back()[0].empty()) rows.pop_back();
    rows.push_back({""});
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& cell = rows.back().back();
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      cell += text[++i];
    else if (c == '"' && (quoted || cell.empty()))
      quoted = !quoted;
    else if (quoted)
      cell += c;
    else if (c == between)
      rows.back().push_back("");
    else if (c == '\n')
      end_row();
    else if (c != '\r')
      cell += c;
  }
  end_row();
  rows.pop_back();
  return rows;
}

PolicyFile read_policy(const fs::path& file, const std::string& assignment) {
  const std::string text = text_to_read(file);
  // Refuses what is no JSON, by line and column, and a key that stands twice: of two lists of
  // extensions the first would be lost.
  scene::require_json(text, file);
  const Json json = Json::parse(text);
  if (!json.is_object()) throw UserError(file.string(), "is no JSON object");
  refuse_unknown_fields(file, json);
  PolicyFile read;
  read.policy = policy_in(file, json, assignment);
  const fs::path roster = path_in(file, json, "roster"), times = path_in(file, json, "handed_in");
  if (roster.empty())
    throw UserError(file.string(), "names no roster", "\"roster\": \"roster.csv\"");
  read.roster = read_roster(roster);
  read_extensions(file, json, assignment, read.policy.due_s, read.roster);
  read_points_by_hand(file, json, assignment, read.roster);
  if (!times.empty()) read.hand_ins = read_hand_ins(times);
  return read;
}

}  // namespace tumble::grading
