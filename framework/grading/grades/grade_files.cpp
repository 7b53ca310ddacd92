#include "framework/grading/grades/grade_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "framework/core/version.h"
#include "framework/grading/course/handout_page.h"
#include "framework/grading/grades/cost_json.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/grades/scoring.h"
#include "framework/trajectory/record.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kRecord = "record.json";

constexpr std::array kStates = {"judged", "nothing to compile", "does not compile",
                                "fault of the grader"};

// Names and stories may contain any bytes: invalid UTF-8 is replaced, not refused.
std::string dumped(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string output_of(const ScoredTest& test) {
  std::string text = words(test.result.verdict);
  if (!test.result.story.empty()) text += "\n" + plain_text(test.result.story);
  return text;
}

// Whether a spreadsheet could read the text as a formula: it starts with a sign, or with a
// full-width form of one.
bool starts_a_formula(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return false;
  for (const std::string_view sign :
       {"=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20", "\u2212"})
    if (std::string_view(text).substr(first).starts_with(sign)) return true;
  return false;
}

Json media_json(const SceneMedia& media) {
  Json checks = Json::array();
  for (const auto& c : media.checks)
    checks.push_back({{"kind", c.kind},
                      {"subject", c.subject},
                      {"value", c.value},
                      {"threshold", c.threshold},
                      {"unit", c.unit},
                      {"passed", c.passed},
                      {"why", c.why},
                      {"at_least", c.at_least},
                      {"detail", c.detail}});
  return {{"scene", media.scene},          {"title", media.title},
          {"about", media.about},          {"picture", media.picture.string()},
          {"video", media.video.string()}, {"story", media.story},
          {"attempted", media.attempted},  {"checks", checks},
          {"page", media.page.string()},   {"functions", media.functions}};
}

// JSON has no infinity, so it is stored as null.
double number_or_infinity(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

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
  media.functions = json.value("functions", std::vector<std::string>());
  for (const Json& c : json.at("checks"))
    media.checks.push_back({c.at("kind"), c.at("subject"), number_or_infinity(c.at("value")),
                            number_or_infinity(c.at("threshold")), c.at("unit"), c.at("passed"),
                            c.at("why"), c.at("at_least"), c.at("detail")});
  return media;
}

Json test_json(const ScoredTest& test) {
  return {{"test", test.item.test},
          {"title", test.item.title},
          {"level", test.item.level},
          {"hidden", test.item.hidden},
          {"points", test.item.points},
          {"score", test.score},
          {"verdict", words(test.result.verdict)},
          {"story", test.result.story},
          {"last_call", test.result.last_call},
          {"calls", test.result.calls},
          {"not_run", test.result.not_run}};
}

ScoredTest test_of(const Json& json) {
  ScoredTest test;
  test.item = {json.at("test"), json.at("points"), json.at("level"), json.at("title"),
               json.at("hidden")};
  test.score = json.at("score");
  test.result.test = test.item.test;
  test.result.verdict = verdict_from_words(json.at("verdict")).value_or(Verdict::kGraderFault);
  test.result.story = json.at("story");
  test.result.last_call = json.at("last_call");
  test.result.calls = json.at("calls");
  test.result.not_run = json.at("not_run");
  return test;
}

constexpr std::array kCauseKinds = {"slip", "crash", "out of time or memory", "not written",
                                    "unknown"};

Json json_of_causes(const std::vector<Cause>& causes) {
  Json list = Json::array();
  for (const Cause& c : causes) {
    list.push_back({{"kind", kCauseKinds.at(static_cast<std::size_t>(c.kind))},
                    {"says", c.says},
                    {"or_else", c.or_else},
                    {"functions", c.functions},
                    {"places", c.places},
                    {"code", c.code},
                    {"tests", c.tests},
                    {"same_numbers", c.same_numbers},
                    {"following", c.following},
                    {"not_run", c.not_run}});
    if (!c.and_also.empty()) {
      list.back()["and_also"] = c.and_also;
      list.back()["by_both"] = c.by_both;
      list.back()["alone"] = c.alone;
    }
  }
  return list;
}

std::vector<Cause> causes_in(const Json& json) {
  std::vector<Cause> causes;
  for (const Json& c : json) {
    Cause cause{Cause::Kind::kUnknown,
                c.at("says"),
                c.at("or_else"),
                c.at("functions"),
                c.at("places"),
                c.value("code", std::vector<std::string>()),
                c.at("tests"),
                c.at("same_numbers"),
                c.value("following", std::vector<std::string>()),
                c.value("not_run", std::vector<std::string>()),
                c.value("and_also", ""),
                c.value("by_both", std::size_t{0}),
                {}};
    if (c.contains("alone"))
      for (const std::size_t k : {0, 1}) cause.alone[k] = c.at("alone").at(k);
    for (std::size_t i = 0; i < kCauseKinds.size(); ++i)
      if (c.at("kind") == kCauseKinds[i]) cause.kind = static_cast<Cause::Kind>(i);
    causes.push_back(std::move(cause));
  }
  return causes;
}

Json changes_json(const std::vector<TestChange>& changes) {
  Json list = Json::array();
  for (const TestChange& c : changes)
    list.push_back({{"test", c.test},
                    {"title", c.title},
                    {"before", c.before},
                    {"after", c.after},
                    {"reason", c.reason}});
  return list;
}

std::string code_of(const Json& json, const std::string& machine_key) {
  return authentication_code(machine_key, "tumble record 1\n" + dumped(json));
}

GradeRecord record_of(const Json& json) {
  GradeRecord record;
  record.assignment = json.at("assignment");
  record.key = {json.at("submission"), json.at("judging"), json.at("rubric"), json.at("pictures")};
  record.files = json.at("files").get<std::map<std::string, std::string>>();
  Grade& grade = record.grade;
  grade.name = json.at("name");
  grade.folder = json.at("folder");
  const std::string state = json.at("state");
  for (std::size_t i = 0; i < kStates.size(); ++i)
    if (state == kStates[i]) grade.state = static_cast<GradeState>(i);
  grade.score = json.at("score");
  grade.possible = json.at("possible");
  grade.change = json.at("change");
  for (const Json& c : json.at("changes"))
    grade.changes.push_back(
        {c.at("test"), c.at("title"), c.at("before"), c.at("after"), c.at("reason")});
  grade.story = json.at("story");
  grade.notes = json.at("notes").get<std::vector<std::string>>();
  grade.sandbox = json.at("sandbox");
  grade.is_official = json.at("official");
  grade.is_held = json.value("held", false);
  grade.has_handout = json.value("handout", false);
  grade.no_page_code = json.value("no_page_code", std::string());
  grade.faults = json.value("faults", std::vector<std::string>());
  for (const Json& test : json.at("tests")) grade.tests.push_back(test_of(test));
  for (const Json& media : json.at("media")) grade.media.push_back(media_of(media));
  if (json.contains("own_tests")) {
    const Json& own = json.at("own_tests");
    grade.own_tests = {
        true,           own.at("final"), own.at("score"), own.at("possible"), own.at("story"),
        own.at("names")};
  }
  if (json.contains("causes")) grade.causes = causes_in(json.at("causes"));
  grade.cost = cost_of(json.at("cost"));
  return record;
}

// The last line of a page: the first digits of each digest, which identify the entry in the ledger.
std::string graded_from(const Grade& grade, const GradeKey& key) {
  constexpr std::size_t kShown = 16;
  const auto head = [](const std::string& digits) { return digits.substr(0, kShown); };
  std::string text = "Submission " + head(key.submission) + " · judge " + head(key.judging) +
                     " · rubric " + head(key.rubric);
  if (!key.pictures.empty()) text += " · pictures " + head(key.pictures);
  return text + " · sandbox " + grade.sandbox + " · " + version_in_words(kProgramVersion);
}

}  // namespace

std::string gradescope_json(const Grade& grade) {
  Json page;
  // Without a score Gradescope keeps the old one: a submission that was not judged does not get 0
  // points.
  if (grade.has_score()) page["score"] = grade.score;
  std::string said = grade.story;
  for (const std::string& note : grade.notes)
    said += (said.empty() ? "" : "\n") + ("note: " + note);
  page["output"] = plain_text(said);
  page["output_format"] = "text";
  page["test_output_format"] = "text";
  page["test_name_format"] = "text";
  page["visibility"] = "visible";
  page["stdout_visibility"] = "hidden";
  page["extra_data"] = {{"version", kProgramVersion},
                        {"state", kStates.at(static_cast<std::size_t>(grade.state))},
                        {"final", grade.is_final()},
                        {"sandbox", grade.sandbox},
                        {"official", grade.is_official}};
  page["tests"] = Json::array();
  for (const ScoredTest& test : grade.tests) {
    Json entry;
    entry["name"] = test.item.title;
    if (grade.has_score()) entry["score"] = test.score;
    entry["max_score"] = test.item.points;
    entry["status"] = test.result.verdict == Verdict::kRight ? "passed" : "failed";
    entry["output"] = output_of(test);
    entry["tags"] = test.item.level.empty() ? Json::array() : Json::array({test.item.level});
    entry["visibility"] = test.item.hidden ? "hidden" : "visible";
    entry["extra_data"] = {{"test", test.item.test}, {"verdict", words(test.result.verdict)}};
    page["tests"].push_back(std::move(entry));
  }
  if (const OwnTestsGrade& own = grade.own_tests; own.is_there) {
    // extra points: they are not among those that can be reached
    Json entry = {{"name", kOwnTestsTitle}};
    if (grade.has_score()) entry["score"] = own.score;
    entry["max_score"] = 0;
    entry["status"] = own.score == own.possible ? "passed" : "failed";
    entry["output"] = plain_text(own.story);
    entry["tags"] = Json::array();
    entry["visibility"] = "visible";
    entry["extra_data"] = {{"extra_points", own.possible}};
    page["tests"].push_back(std::move(entry));
  }
  return dumped(page);
}

namespace {

bool is_points_row(std::string name) {
  const auto first = name.find_first_not_of(" \t"), last = name.find_last_not_of(" \t");
  if (first == std::string::npos) return false;
  name = name.substr(first, last - first + 1);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name == "points possible";
}

}  // namespace

std::string csv_cell(const std::string& raw) {
  std::string text = plain_name(raw);
  if (starts_a_formula(text)) text.insert(0, "'");
  const bool is_plain = text.find_first_of(",;\"") == std::string::npos && !text.starts_with(' ') &&
                        !text.ends_with(' ');
  if (is_plain) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string csv_name(const std::string& name) {
  return csv_cell(is_points_row(name) ? "folder " + name : name);
}

std::string gradebook_csv(const std::string& assignment_title, const std::vector<Grade>& grades) {
  // Another column than that of the official grades: Canvas would enter these there.
  const bool is_official = std::all_of(grades.begin(), grades.end(),
                                       [](const Grade& grade) { return grade.is_official; });
  std::string text =
      "Student,ID,SIS Login ID,Section," +
      csv_cell(assignment_title + (is_official ? "" : " - not official; see the notes")) + "\n";
  double possible = 0.0;
  for (const Grade& grade : grades) possible = std::max(possible, grade.possible);
  text += "    Points Possible,,,," + points_text(possible) + "\n";
  for (const Grade& grade : grades) {
    const std::string name = csv_name(grade.name);
    text += name + "," + grade.student_id + "," + name + ",," +
            (grade.has_score() ? points_text(grade.score) : "") + "\n";
  }
  return text;
}

std::map<std::string, std::string> digests_below(const fs::path& folder) {
  std::map<std::string, std::string> digests;
  std::error_code failed;
  for (fs::recursive_directory_iterator it(folder, failed), end; !failed && it != end;
       it.increment(failed)) {
    const std::string name = it->path().lexically_relative(folder).string();
    if (fs::is_directory(it->symlink_status()) || name == kRecord || name == kHandoutPage) continue;
    digests[name] =
        fs::is_regular_file(it->symlink_status()) ? digest_of_file(it->path()) : "not a file";
  }
  return digests;
}

std::string record_json(const GradeRecord& record, const std::string& machine_key) {
  const Grade& grade = record.grade;
  Json json;
  json["assignment"] = record.assignment;
  json["folder"] = grade.folder;
  json["submission"] = record.key.submission;
  json["judging"] = record.key.judging;
  json["rubric"] = record.key.rubric;
  json["pictures"] = record.key.pictures;
  json["name"] = grade.name;
  json["state"] = kStates.at(static_cast<std::size_t>(grade.state));
  json["score"] = grade.score;
  json["possible"] = grade.possible;
  json["change"] = grade.change;
  json["changes"] = changes_json(grade.changes);
  json["story"] = grade.story;
  json["notes"] = grade.notes;
  json["sandbox"] = grade.sandbox;
  json["official"] = grade.is_official;
  if (grade.is_held) json["held"] = true;
  json["handout"] = grade.has_handout;
  if (grade.own_tests.is_there)
    json["own_tests"] = {{"final", grade.own_tests.is_final},
                         {"score", grade.own_tests.score},
                         {"possible", grade.own_tests.possible},
                         {"story", grade.own_tests.story},
                         {"names", grade.own_tests.names}};
  json["tests"] = Json::array();
  for (const ScoredTest& test : grade.tests) json["tests"].push_back(test_json(test));
  json["causes"] = json_of_causes(grade.causes);
  json["media"] = Json::array();
  for (const SceneMedia& media : grade.media) json["media"].push_back(media_json(media));
  json["no_page_code"] = grade.no_page_code;
  if (!grade.faults.empty()) json["faults"] = grade.faults;
  json["cost"] = cost_json(grade.cost);
  json["files"] = record.files;
  // Converted to text and back, so that the signature is of the data as read later, after invalid
  // UTF-8 has been replaced.
  json = Json::parse(dumped(json));
  json["mac"] = code_of(json, machine_key);
  return dumped(json);
}

EarlierRun read_earlier_run(const fs::path& folder, const std::string& assignment,
                            const std::string& machine_key) {
  std::error_code failed;
  if (!fs::exists(fs::symlink_status(folder, failed))) return {};
  std::ifstream in(folder / kRecord);
  if (!in) return {{}, "it has no record"};
  GradeRecord record;
  try {
    Json json = Json::parse(in);
    const std::string code = json.at("mac");
    json.erase("mac");
    if (!is_same_code(code, code_of(json, machine_key)))
      return {{}, "its record is not signed by this machine's key"};
    record = record_of(json);
  } catch (const Json::exception&) {
    return {{}, "its record cannot be read"};
  }
  if (record.assignment != assignment || record.grade.folder != folder.filename().string())
    return {{}, "its record belongs to another folder"};
  if (record.files != digests_below(folder)) return {{}, "its files have changed"};
  return {std::move(record), ""};
}

void write_grade(const modules::ModuleKind& kind, const Grade& grade, const GradeKey& key,
                 const fs::path& folder, const std::string& machine_key, const PageLaws& laws) {
  write_whole(folder / "results.json", gradescope_json(grade));
  const std::string record = graded_from(grade, key);
  Grade written = grade;
  // A page that cannot be made takes nothing from the results beside it.
  const auto write_page = [&](const char* file, const std::function<report::Page()>& make) {
    try {
      make().write(folder / file);
    } catch (const std::exception& error) {
      report::Page page(plain_name(grade.name),
                        fmt::format("{} ({}): {}", kind.title, kind.id, summary_of(grade)));
      page.paragraph(
          "The grader failed at this page. Verdicts and points stand, in results.json beside it.",
          report::Look::kWarning);
      page.write(folder / file);
      written.faults.push_back(std::string(file) + ": " + error.what());
    }
  };
  PageView view;
  if (grade.has_handout) view = {kHandoutPage, kind.folder};
  write_page("index.html", [&] {
    view.bench = bench_of(folder, laws.script, laws.right);
    view.no_right_law = laws.why_no_right;
    return submission_page(kind, grade, record, view);
  });
  view.is_alone = true;
  write_page("student.html", [&] {
    view.bench = bench_of(folder, laws.script);
    view.no_right_law = laws.is_for_students && !laws.why_no_right.empty()
                            ? "it could not be compiled for a page on the grader's machine"
                            : "";
    return submission_page(kind, for_student(grade), record, view);
  });
  write_whole(folder / kRecord,
              record_json({written, key, kind.id, digests_below(folder)}, machine_key));
}

}  // namespace tumble::grading
