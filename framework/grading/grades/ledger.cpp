#include "framework/grading/grades/ledger.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::string kNoDigest(64, '0');
constexpr std::string_view kDigestField = ",\"digest\":\"", kEndOfLine = "\"}";
constexpr std::size_t kDigits = 64;

std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Everything but the number, the chain and what a change was: whether two entries say the same.
Json facts_of(const LedgerEntry& entry) {
  return {{"assignment", entry.assignment},
          {"name", entry.name},
          {"folder", entry.folder},
          {"submission", entry.submission},
          {"judging", entry.judging},
          {"rubric", entry.rubric},
          {"version", entry.version},
          {"compiler", entry.compiler},
          {"sandbox", entry.sandbox},
          {"official", entry.is_official},
          {"final", entry.is_final},
          {"results", entry.results},
          {"score", entry.score ? Json(*entry.score) : Json(nullptr)}};
}

LedgerEntry entry_of(const Json& json) {
  LedgerEntry entry;
  entry.assignment = json.at("assignment");
  entry.name = json.at("name");
  entry.folder = json.at("folder");
  entry.submission = json.at("submission");
  entry.judging = json.at("judging");
  entry.rubric = json.at("rubric");
  entry.version = json.at("version");
  entry.compiler = json.at("compiler");
  entry.sandbox = json.at("sandbox");
  entry.is_official = json.at("official");
  entry.is_final = json.at("final");
  entry.results = json.at("results");
  if (!json.at("score").is_null()) entry.score = json.at("score").get<double>();
  entry.change = json.at("change");
  for (const Json& c : json.at("changes"))
    entry.changes.push_back(
        {c.at("test"), c.at("title"), c.at("before"), c.at("after"), c.at("reason")});
  return entry;
}

// The digest that a line should end with; empty where the line has no such end.
std::string digest_in(const std::string& line, std::string& head_of_line) {
  const std::size_t tail = kDigestField.size() + kDigits + kEndOfLine.size();
  if (line.size() < tail) return "";
  const std::size_t at = line.size() - tail;
  if (line.compare(at, kDigestField.size(), kDigestField) != 0 || !line.ends_with(kEndOfLine))
    return "";
  head_of_line = line.substr(0, at) + "}";
  return line.substr(at + kDigestField.size(), kDigits);
}

// Reads one line into `ledger`. @return why it does not fit; empty: it does
std::string read_line(const std::string& line, LedgerContent& ledger) {
  std::string body;
  const std::string said = digest_in(line, body);
  if (said.empty()) return "it does not end with its digest";
  if (said != digest(body)) return "its text was changed: its digest is of another text";
  try {
    const Json json = Json::parse(body);
    if (json.at("entry").get<std::size_t>() != ledger.entries.size() + 1)
      return fmt::format("it has the number {}: an entry was removed, added or moved",
                         json.at("entry").get<std::size_t>());
    if (json.at("previous").get<std::string>() != ledger.head)
      return "it does not continue the entry before it: that one was replaced";
    ledger.entries.push_back(entry_of(json));
    ledger.entries.back().digest = said;
  } catch (const Json::exception&) {
    return "it has not the fields of an entry";
  }
  ledger.head = said;
  return "";
}

// The name in a line that does not fit, for people.
std::string name_in(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("name") || !json["name"].is_string()) return "";
  return ", " + plain_name(json["name"].get<std::string>());
}

UserError cannot_append(const fs::path& file) {
  return {file.string(), std::string("cannot be written (") + std::strerror(errno) + ")",
          "Is there room on the disk, and may you write to this folder?"};
}

}  // namespace

std::string compiler_in_words() {
  const std::string said =
      run_program({"/usr/bin/g++", "--version"}, Output::kCaptured, 60.0).printed;
  return plain_name(said.substr(0, said.find('\n')));
}

std::string ledger_line(const LedgerEntry& entry, std::size_t number, const std::string& previous) {
  Json json = {{"entry", number}};
  json.update(facts_of(entry));
  json["change"] = entry.change;
  json["changes"] = Json::array();
  for (const TestChange& c : entry.changes)
    json["changes"].push_back({{"test", c.test},
                               {"title", c.title},
                               {"before", c.before},
                               {"after", c.after},
                               {"reason", c.reason}});
  json["previous"] = previous;
  const std::string body = one_line(json);
  return body.substr(0, body.size() - 1) + std::string(kDigestField) + digest(body) +
         std::string(kEndOfLine);
}

LedgerContent read_ledger(const fs::path& file) {
  LedgerContent ledger;
  ledger.head = kNoDigest;
  std::error_code failed;
  if (!fs::exists(fs::symlink_status(file, failed))) return ledger;
  std::ifstream in(file, std::ios::binary);
  if (!in || !fs::is_regular_file(fs::symlink_status(file)))
    throw UserError(file.string(), "cannot be read as a ledger", "Name a ledger.jsonl.");
  for (std::string line; std::getline(in, line);) {
    if (in.eof()) {  // no line break: a run was killed while it wrote this
      ledger.unfinished = line;
      break;
    }
    ledger.whole_bytes += line.size() + 1;
    const std::size_t number = ledger.entries.size() + 1;
    if (const std::string why = read_line(line, ledger); !why.empty()) {
      ledger.fault = fmt::format("entry {}{}: {}", number, name_in(line), why);
      break;
    }
  }
  return ledger;
}

std::map<std::string, LedgerEntry> latest_entries(const LedgerContent& ledger) {
  std::map<std::string, LedgerEntry> latest;
  for (const LedgerEntry& entry : ledger.entries) latest[entry.folder] = entry;
  return latest;
}

std::map<std::string, LedgerScore> last_scores(const LedgerContent& ledger) {
  std::map<std::string, LedgerScore> scores;
  for (const LedgerEntry& entry : ledger.entries)
    if (entry.score) scores[entry.folder] = {entry.submission, *entry.score};
  return scores;
}

std::vector<std::string> differences_from_results(const LedgerContent& ledger,
                                                  const fs::path& out) {
  std::vector<std::string> differences;
  const auto latest = latest_entries(ledger);
  for (const auto& [folder, entry] : latest) {
    const std::string found = digest_of_file(out / folder / "results.json");
    if (found == "missing")
      differences.push_back(entry.name + ": the ledger has an entry, and " +
                            (fs::path(folder) / "results.json").string() + " is missing");
    else if (found != entry.results)
      differences.push_back(entry.name + ": " + (fs::path(folder) / "results.json").string() +
                            " is not the result that its last entry names");
  }
  std::error_code failed;
  for (fs::directory_iterator it(out, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string folder = it->path().filename().string();
    if (fs::exists(it->path() / "results.json") && !latest.contains(folder) &&
        !folder.starts_with('.'))
      differences.push_back(plain_name(folder) + ": has results, and no entry in the ledger");
  }
  return differences;
}

Ledger::Ledger(const fs::path& file) : file_(file) {
  const LedgerContent ledger = read_ledger(file);
  if (!ledger.fault.empty())
    throw UserError(file.string(), "does not fit together: " + ledger.fault,
                    "Nothing was graded. Keep this folder as it is, find out who changed it, and "
                    "give --out another one.");
  latest_ = latest_entries(ledger);
  scores_ = last_scores(ledger);
  count_ = ledger.entries.size();
  head_ = ledger.head;
  was_mended_ = !ledger.unfinished.empty();
  if (was_mended_ && ::truncate(file.c_str(), static_cast<off_t>(ledger.whole_bytes)) != 0)
    throw cannot_append(file);
}

const LedgerScore* Ledger::last_score(const std::string& folder) const {
  const auto found = scores_.find(folder);
  return found == scores_.end() ? nullptr : &found->second;
}

void Ledger::append(const LedgerEntry& entry) {
  const auto last = latest_.find(entry.folder);
  if (last != latest_.end() && one_line(facts_of(last->second)) == one_line(facts_of(entry)))
    return;
  const std::string line = ledger_line(entry, count_ + 1, head_) + '\n';
  const int out =
      ::open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (out < 0) throw cannot_append(file_);
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t n = ::write(out, line.data() + written, line.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      ::close(out);
      throw cannot_append(file_);
    }
    written += static_cast<std::size_t>(n);
  }
  ::close(out);
  std::string body;
  head_ = digest_in(line.substr(0, line.size() - 1), body);
  latest_[entry.folder] = entry;
  if (entry.score) scores_[entry.folder] = {entry.submission, *entry.score};
  ++count_;
}

}  // namespace tumble::grading
