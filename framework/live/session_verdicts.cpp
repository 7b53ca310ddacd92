// What is said of a run: verdicts, differences from the run before, and whether a saved scene runs
// again byte for byte.
#include "framework/live/session_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace tumble::live {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kComparesEvery = 0.4;  // s

}  // namespace

void Session::judge(const std::string& id) {
  if (!sitting_.judge || id.empty()) return;
  judge_ = std::make_unique<Child>(sitting_.judge(id));
  judge_->close_input();
  judging_ = id;
  judge_text_.clear();
  judge_talk_.clear();
  to_judge_.erase(id);
  tell({{"kind", "judging"}, {"id", id}});
}

// One after the other: two builds at once would be in each other's way.
void Session::judge_next() {
  if (!judge_ && !to_judge_.empty()) judge(std::string(*to_judge_.begin()));
}

void Session::listen_to_judge() {
  const bool is_open = Child::read_some(judge_->output(), judge_text_);
  judge_->read_talk(judge_talk_);
  if (is_open) return;
  judge_->wait();
  judge_.reset();
  Json verdicts = Json::parse(judge_text_, nullptr, false);
  if (verdicts.is_discarded())
    verdicts = {{"id", judging_}, {"said", judge_talk_}, {"tests", Json::array()}};
  verdicts["kind"] = "verdicts";
  send(event_of("say", verdicts_[judging_] = dumped(verdicts)));
  if (!starting_ || starting_->has_ended) judge_next();
}

// The run against the one before it, as far as both have come since the last look.
void Session::compare() {
  const auto now = Clock::now();
  if (has_difference_ || former_.frames().empty() ||
      now - compared_at_ < std::chrono::duration<double>(kComparesEvery))
    return;
  compared_at_ = now;
  const double end = std::min(former_.end_s(), current_.end_s());
  // The last common instant is compared, too, when nothing more can come at it.
  const bool is_whole =
      (former_has_ended_ || former_.end_s() > end) && (!end_.empty() || current_.end_s() > end);
  const double until =
      is_whole ? std::nextafter(end, std::numeric_limits<double>::infinity()) : end;
  if (!(until > compared_until_) || former_.radii_m().size() != current_.radii_m().size()) return;
  const Trajectory a = former_.part(compared_until_, until),
                   b = current_.part(compared_until_, until);
  if (a.frames.empty() || b.frames.empty()) return;
  const auto found =
      report::compare(current_.outline(), current_.radii_m(), a, "the run before", b, "this run");
  compared_until_ = until;
  Json words{{"kind", "difference"}, {"same_until_s", end}};
  if (found.first) {
    has_difference_ = true;
    words["time_s"] = found.first->time_s;
    words["what"] = found.first->what;
    words["body"] = found.first->body;
  }
  difference_ = dumped(words);
  send(event_of("say", difference_));
}

void Session::save() {
  if (scene_.recipe.document.empty())
    throw UserError(scene_.name, "is made by code and has no scene file to add pushes to",
                    "Begin with a scene file.");
  if (current_.frames().empty()) throw UserError(scene_.name, "has not moved yet", "");
  fs::path file;
  for (int number = 1; file.empty() || fs::exists(file); ++number)
    file = sitting_.saves / fmt::format("{}_{}.json", scene_.name, number);
  const Json head = Json::parse(current_.head());
  const std::string again =
      scene_.again ? scene_.again(file, recipe_.changes, head.value("modules", "")) : "";
  write_whole(file, saved_document(recipe_, current_.end_s(), again));
  scenes_.push_back(file);
  saved_recipe_ = as_text(recipe_);
  look_for_unsaved();
  // The same code runs what stands in the file.
  Recipe written;
  written.document = tumble::text_of(file);
  written.file = scene_.recipe.file;
  written.changes.method = recipe_.changes.method;
  checking_ = std::make_unique<Simulator>(scene_.simulator, 0.0, "check", written);
  checking_->child.say(
      dumped({{"recipe", as_text(written)}, {"from_s", 0.0}, {"speed", 1e30}, {"paused", false}}));
  frames_checked_ = 0;
  expected_ = current_.frames();
  first_wrong_.clear();
  checked_file_ = file.string();
  saved_ = dumped({{"kind", "saved"}, {"file", checked_file_}, {"again", again}});
  send(event_of("say", saved_));
}

void Session::check_saved() {
  std::string bytes;
  const bool is_open = Child::read_some(checking_->child.output(), bytes);
  checking_->talk.clear();  // only read, so that the process goes on
  checking_->child.read_talk(checking_->talk);
  checking_->records.feed(bytes);
  while (auto record = checking_->records.next()) {
    if (record->kind == RecordKind::kRefused && first_wrong_.empty())
      first_wrong_ = Json::parse(record->bytes).value("problem", "refused");
    if (record->kind != RecordKind::kFrame || frames_checked_ == expected_.size()) continue;
    if (first_wrong_.empty() && record->bytes != expected_[frames_checked_])
      first_wrong_ = fmt::format("the frame at {:.6g} s differs", History::time_of(record->bytes));
    ++frames_checked_;
  }
  if (is_open) return;
  if (frames_checked_ < expected_.size() && first_wrong_.empty())
    first_wrong_ = "it ended before its last frame";
  Json words = Json::parse(saved_);
  words["checked"] = true;
  words["frames"] = frames_checked_;
  words["wrong"] = first_wrong_;
  saved_ = dumped(words);
  send(event_of("say", saved_));
  checking_.reset();
  expected_ = {};
}

void Session::code_saved(const std::set<fs::path>& files) {
  bool is_any = false;
  for (const Watched& one : sitting_.watched)
    if (files.contains(fs::absolute(one.file).lexically_normal())) {
      if (judge_) to_judge_.insert(judging_);  // of the code before
      judge_.reset();
      to_judge_.insert(one.id);
      is_any = true;
      tell({{"kind", "code_saved"}, {"file", one.file.filename().string()}, {"id", one.id}});
    }
  if (is_any) begin("code", 0.0, wanted());
}

}  // namespace tumble::live
