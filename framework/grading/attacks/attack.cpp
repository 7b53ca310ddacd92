#include "framework/grading/attacks/attack.h"

#include <algorithm>
#include <functional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/grading/verdicts/verdict.h"
#include "framework/modules/names.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

using Kind = AttackPart::Kind;
const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> all = {
      {"before", Kind::kBefore},      {"after", Kind::kAfter}, {"body", Kind::kBody},
      {"whole", Kind::kWhole},        {"file", Kind::kFile},   {"link", Kind::kLink},
      {"hard link", Kind::kHardLink}, {"fifo", Kind::kFifo},   {"folder", Kind::kFolder},
      {"device", Kind::kDevice},      {"fill", Kind::kFill}};
  return all;
}
bool has_name(Kind kind) {
  return kind != Kind::kBefore && kind != Kind::kAfter && kind != Kind::kWhole;
}

std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t at; (at = text.find(separator, from)) != std::string::npos;
       from = at + separator.size())
    parts.push_back(text.substr(from, at - from));
  parts.push_back(text.substr(from));
  return parts;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Reads one file line by line.
class AttackReader {
 public:
  explicit AttackReader(const fs::path& file) { attack_.file = file; }

  Attack read() {
    std::istringstream in(text_of(attack_.file));
    for (std::string line; std::getline(in, line);) {
      ++line_;
      if (line.starts_with("@@"))
        begin_part(line);
      else if (!attack_.parts.empty())
        attack_.parts.back().text += line + "\n";
      else
        take_head(line);
    }
    check();
    return std::move(attack_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const {
    throw UserError(attack_.file.string() + ":" + std::to_string(line_), problem, remedy);
  }

  void take_head(const std::string& line) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("// ") || colon == std::string::npos)
      fail("is no word of a head", "It is written  // word: value ; a part begins with @@.");
    const std::string word = line.substr(3, colon - 3), value = line.substr(colon + 2);
    if (word == "story") return attack_.stories.push_back(value);
    if (word == "never") return attack_.never.push_back(value);
    if (!seen_.insert(word).second) fail("'" + word + "' stands here twice", "");
    take(word, value);
  }

  void take(const std::string& word, const std::string& value) {
    const std::map<std::string, std::function<void()>> words = {
        {"attack", [&] { take_title(value); }},
        {"kind", [&] { attack_.kind = value; }},
        {"verdict", [&] { take_verdicts(value); }},
        {"state",
         [&] {
           for (const std::string& state : split(value, ", "))
             attack_.states.insert(
                 one_of({"judged", "does not compile", "nothing to compile"}, state));
         }},
        {"module",
         [&] {
           std::vector<std::string> ids;
           for (const modules::ModuleName& name : assignment_names()) ids.push_back(name.id);
           attack_.module = one_of(ids, value);
         }},
        {"base",
         [&] {
           attack_.base = one_of({"stub", "reference"}, value);
         }},
        {"own points", [&] { take_own_points(value); }},
        {"folder", [&] { take_folder(value); }},
        {"not in", [&] { take_not_in(value); }},
        {"needs", [&] { attack_.needs_root = one_of({"root"}, value) == "root"; }},
        {"media", [&] { attack_.media = one_of({"yes"}, value) == "yes"; }},
        {"run", [&] { attack_.is_sample = one_of({"sample"}, value) == "sample"; }}};
    const auto found = words.find(word);
    std::vector<std::string> known = {"story", "never"};
    for (const auto& entry : words) known.push_back(entry.first);
    if (found == words.end())
      fail("'" + word + "' is no word of a head",
           "Its words stand in framework/grading/attacks/attack.h." + did_you_mean(word, known));
    found->second();
  }

  std::string one_of(const std::vector<std::string>& known, const std::string& value) const {
    if (std::find(known.begin(), known.end(), value) == known.end())
      fail("'" + value + "' is not known here", "Known: " + joined(known));
    return value;
  }

  void take_title(const std::string& value) {
    const std::size_t dash = value.find(" - ");
    attack_.name = value.substr(0, dash);
    if (dash == std::string::npos || attack_.name != attack_.file.stem().string())
      fail("does not begin with the file's name",
           "The title is written  NAME - what it does ; NAME is " + attack_.file.stem().string());
    attack_.about = value.substr(dash + 3);
  }

  void take_verdicts(const std::string& value) {
    for (const std::string& word : split(value, ", ")) {
      if (word != "same" && (!verdict_from_words(word) || word == words(Verdict::kGraderFault)))
        fail("'" + word + "' is no verdict that a submission may get",
             "They are: right, wrong, not attempted, crashed, out of time or memory, same.");
      attack_.verdicts.insert(word);
    }
  }

  void take_own_points(const std::string& value) {
    const auto json = nlohmann::json::parse(value, nullptr, false);
    if (!json.is_number()) fail("the points of own tests are no number", "");
    attack_.own_points = json.get<double>();
  }

  void take_folder(const std::string& value) {
    const auto json = nlohmann::json::parse(value, nullptr, false);
    if (!json.is_string()) fail("the name of the folder is no JSON string", "");
    attack_.folder = json.get<std::string>();
  }

  void take_not_in(const std::string& value) {
    for (const std::string& kind : split(value, " "))
      attack_.not_in.insert(one_of({"namespaces", "landlock", "bare"}, kind));
  }

  void begin_part(const std::string& line) {
    const std::string words = line.size() > 3 ? line.substr(3) : "";
    for (const auto& [word, kind] : kinds()) {
      const bool is_it = has_name(kind) ? words.starts_with(word + " ") : words == word;
      if (!is_it) continue;
      attack_.parts.push_back(
          {kind, has_name(kind) ? words.substr(word.size() + 1) : "", "", line_});
      return;
    }
    fail("'" + words + "' begins no part",
         "They are: before, after, whole, body FUNCTION, and file, link, hard link, fifo, folder, "
         "device, fill with a NAME.");
  }

  void check() {
    line_ = 1;
    if (attack_.name.empty() || attack_.kind.empty() || attack_.verdicts.empty())
      fail("a head needs attack, kind and verdict", "");
    if (attack_.states.empty()) attack_.states = {"judged"};
    if (!attack_.states.contains("judged") && attack_.verdicts != std::set<std::string>{"same"})
      fail("a submission that is not judged has no verdicts", "Write  // verdict: same");
    if (attack_.folder.empty()) attack_.folder = attack_.name;
  }

  Attack attack_;
  int line_ = 0;
  std::set<std::string> seen_;
};

}  // namespace

std::vector<std::string> Attack::functions() const {
  std::vector<std::string> names;
  for (const AttackPart& part : parts)
    if (part.kind == Kind::kBody) names.push_back(part.name);
  std::sort(names.begin(), names.end());
  return names;
}

std::string Attack::harmless() const {
  if (base == "stub") return "stub";
  if (verdicts.contains("same") || functions().empty()) return "reference";
  std::string name = "without";  // also a folder's
  for (const std::string& function : functions()) name += "-" + function;
  return name;
}

Attack read_attack(const fs::path& file) { return AttackReader(file).read(); }

std::vector<Attack> read_attacks(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    if (it->path().extension() == kAttackExtension) files.push_back(it->path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw UserError(folder.string(), "holds no attack",
                    "One is a file NAME.attack; framework/grading/attacks/attack.h says how it is "
                    "written. A tree that students get has none.");
  std::vector<Attack> attacks;
  for (const fs::path& file : files) attacks.push_back(read_attack(file));
  return attacks;
}

}  // namespace tumble::grading
