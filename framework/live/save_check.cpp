#include "framework/live/save_check.h"

#include <fmt/format.h>

namespace tumble::live {

void SaveCheck::begin(const std::vector<std::string>& simulator, const SavedScene& saved,
                      const std::vector<std::string>& expected) {
  simulator_ = std::make_unique<Simulator>(simulator, 0.0, "check", saved.recipe);
  simulator_->start(1e30, false);
  frames_checked_ = 0;
  expected_ = expected;
  first_wrong_.clear();
  told_ = pages_.tell({{"kind", "saved"}, {"file", saved.file.string()}, {"again", saved.again}});
}

void SaveCheck::listen() {
  if (!simulator_) return;
  const bool is_open = simulator_->read();
  while (auto record = simulator_->records.next()) {
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
  Json words = Json::parse(told_);
  words["checked"] = true;
  words["frames"] = frames_checked_;
  words["wrong"] = first_wrong_;
  told_ = pages_.tell(words);
  simulator_.reset();
  expected_ = {};
}

}  // namespace tumble::live
