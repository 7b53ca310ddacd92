#include "framework/grading/grade_files.h"

#include <array>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/grading/plain_text.h"
#include "framework/grading/scoring.h"

namespace tumble::grading {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kStates = {"judged", "nothing to compile", "does not compile", "fault of the grader"};

// Names and stories that are kept for ourselves hold any bytes: what is not UTF-8 is replaced, not refused.
std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n'; }

std::string output_of(const ScoredTest& test) {
  std::string text = words(test.result.verdict);
  if (!test.result.story.empty()) text += "\n" + plain_text(test.result.story);
  return text;
}

// What spreadsheets take for the start of a formula: the signs, and the full-width forms that some of them read alike.
bool starts_a_formula(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return false;
  for (const std::string_view sign : {"=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20", "\u2212"})
    if (std::string_view(text).substr(first).starts_with(sign)) return true;
  return false;
}

// A cell of a table for spreadsheets: one line, quoted where it must be, and never a formula.
std::string csv_cell(const std::string& raw) {
  std::string text = plain_name(raw);
  if (starts_a_formula(text)) text.insert(0, "'");
  const bool is_plain = text.find_first_of(",;\"") == std::string::npos && !text.starts_with(' ') && !text.ends_with(' ');
  if (is_plain) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

Json media_json(const SceneMedia& media) {
  Json checks = Json::array();
  for (const auto& c : media.checks)
    checks.push_back({{"kind", c.kind}, {"subject", c.subject}, {"value", c.value}, {"threshold", c.threshold}, {"unit", c.unit}, {"passed", c.passed},
                      {"why", c.why}, {"at_least", c.at_least}, {"detail", c.detail}});
  return {{"scene", media.scene}, {"title", media.title}, {"about", media.about}, {"picture", media.picture.string()}, {"video", media.video.string()},
          {"story", media.story}, {"attempted", media.attempted}, {"checks", checks}, {"page", media.page.string()}};
}

// JSON has no infinities: they became null.
double number_of(const Json& json) { return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>(); }

SceneMedia media_of(const Json& json) {
  SceneMedia media;
  media.scene = json.at("scene");
  media.title = json.at("title");
  media.about = json.at("about");
  media.picture = json.at("picture").get<std::string>();
  media.video = json.at("video").get<std::string>();
  media.story = json.at("story");
  media.attempted = json.at("attempted");
  media.page = json.value("page", std::string());
  for (const Json& c : json.at("checks"))
    media.checks.push_back({c.at("kind"), c.at("subject"), number_of(c.at("value")), number_of(c.at("threshold")), c.at("unit"), c.at("passed"), c.at("why"),
                            c.at("at_least"), c.at("detail")});
  return media;
}

Json test_json(const ScoredTest& test) {
  return {{"test", test.item.test}, {"title", test.item.title}, {"level", test.item.level}, {"hidden", test.item.hidden}, {"points", test.item.points},
          {"score", test.score}, {"verdict", words(test.result.verdict)}, {"story", test.result.story}, {"last_call", test.result.last_call},
          {"calls", test.result.calls}, {"not_run", test.result.not_run}};
}

ScoredTest test_of(const Json& json) {
  ScoredTest test;
  test.item = {json.at("test"), json.at("points"), json.at("level"), json.at("title"), json.at("hidden")};
  test.score = json.at("score");
  test.result.test = test.item.test;
  test.result.verdict = verdict_from_words(json.at("verdict")).value_or(Verdict::kGraderFault);
  test.result.story = json.at("story");
  test.result.last_call = json.at("last_call");
  test.result.calls = json.at("calls");
  test.result.not_run = json.at("not_run");
  return test;
}

}  // namespace

std::string gradescope_json(const Grade& grade) {
  Json page;
  page["score"] = grade.score;
  std::string said = grade.story;
  for (const std::string& note : grade.notes) said += (said.empty() ? "" : "\n") + ("note: " + note);
  page["output"] = plain_text(said);
  page["output_format"] = "text";
  page["test_output_format"] = "text";
  page["test_name_format"] = "text";
  page["visibility"] = "visible";
  page["stdout_visibility"] = "hidden";
  page["extra_data"] = {{"state", kStates.at(static_cast<std::size_t>(grade.state))}, {"final", grade.is_final()}};
  page["tests"] = Json::array();
  for (const ScoredTest& test : grade.tests) {
    Json entry;
    entry["name"] = test.item.title;
    entry["score"] = test.score;
    entry["max_score"] = test.item.points;
    entry["status"] = test.result.verdict == Verdict::kRight ? "passed" : "failed";
    entry["output"] = output_of(test);
    entry["tags"] = test.item.level.empty() ? Json::array() : Json::array({test.item.level});
    entry["visibility"] = test.item.hidden ? "after_published" : "visible";
    entry["extra_data"] = {{"test", test.item.test}, {"verdict", words(test.result.verdict)}};
    page["tests"].push_back(std::move(entry));
  }
  return dumped(page);
}

std::string gradebook_csv(const std::string& assignment_title, const std::vector<Grade>& grades) {
  std::string text = "Student,ID,SIS Login ID,Section," + csv_cell(assignment_title) + "\n";
  double possible = 0.0;
  for (const Grade& grade : grades) possible = std::max(possible, grade.possible);
  text += "    Points Possible,,,," + points_text(possible) + "\n";
  for (const Grade& grade : grades) {
    const std::string name = csv_cell(grade.name);
    text += name + ",," + name + ",," + (grade.is_final() ? points_text(grade.score) : "") + "\n";
  }
  return text;
}

std::string record_json(const Grade& grade, const GradeKey& key, const std::string& results_digest) {
  Json record;
  record["submission"] = key.submission;
  record["grader"] = key.grader;
  record["pictures"] = key.pictures;
  record["results"] = results_digest;
  record["name"] = grade.name;
  record["state"] = kStates.at(static_cast<std::size_t>(grade.state));
  record["score"] = grade.score;
  record["possible"] = grade.possible;
  record["change"] = grade.change;
  record["story"] = grade.story;
  record["notes"] = grade.notes;
  record["tests"] = Json::array();
  for (const ScoredTest& test : grade.tests) record["tests"].push_back(test_json(test));
  record["media"] = Json::array();
  for (const SceneMedia& media : grade.media) record["media"].push_back(media_json(media));
  return dumped(record);
}

std::optional<GradeRecord> read_record(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) return std::nullopt;
  try {
    const Json json = Json::parse(in);
    GradeRecord record;
    record.key = {json.at("submission"), json.at("grader"), json.at("pictures")};
    record.results_digest = json.at("results");
    Grade& grade = record.grade;
    grade.name = json.at("name");
    grade.folder = file.parent_path().filename().string();
    const std::string state = json.at("state");
    for (std::size_t i = 0; i < kStates.size(); ++i)
      if (state == kStates[i]) grade.state = static_cast<GradeState>(i);
    grade.score = json.at("score");
    grade.possible = json.at("possible");
    grade.change = json.at("change");
    grade.story = json.at("story");
    grade.notes = json.at("notes").get<std::vector<std::string>>();
    for (const Json& test : json.at("tests")) grade.tests.push_back(test_of(test));
    for (const Json& media : json.at("media")) grade.media.push_back(media_of(media));
    return record;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string ledger_json(const std::string& id, const std::vector<GradeRecord>& records) {
  Json ledger;
  ledger["assignment"] = id;
  ledger["submissions"] = Json::array();
  for (const GradeRecord& record : records)
    ledger["submissions"].push_back({{"name", plain_name(record.grade.name)}, {"folder", record.grade.folder}, {"submission", record.key.submission}, {"grader", record.key.grader},
                                     {"results", record.results_digest}, {"score", record.grade.score}, {"final", record.grade.is_final()},
                                     {"change", record.grade.change}});
  return dumped(ledger);
}

}  // namespace tumble::grading
