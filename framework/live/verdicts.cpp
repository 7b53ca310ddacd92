#include "framework/live/verdicts.h"

namespace tumble::live {

void Verdicts::judge(const std::string& id) {
  if (!judge_of_ || id.empty()) return;
  judgement_.ask(judge_of_(id));
  judging_ = id;
  waiting_.erase(id);
  pages_.tell({{"kind", "judging"}, {"id", id}});
}

void Verdicts::judge_anew(const std::string& id) {
  if (child() != nullptr) wait(judging_);
  judgement_.drop();
  wait(id);
}

void Verdicts::go_on() {
  if (child() == nullptr && !waiting_.empty()) judge(std::string(*waiting_.begin()));
}

bool Verdicts::listen() {
  const auto answer = judgement_.listen();
  if (!answer) return false;
  Json verdicts = Json::parse(answer->text, nullptr, false);
  if (verdicts.is_discarded())
    verdicts = {{"id", judging_}, {"said", answer->talk}, {"tests", Json::array()}};
  verdicts["kind"] = "verdicts";
  told_[judging_] = pages_.tell(verdicts);
  return true;
}

std::vector<std::string> Verdicts::told() const {
  std::vector<std::string> told;
  for (const auto& [id, text] : told_) told.push_back(text);
  if (child() != nullptr) told.push_back(dumped({{"kind", "judging"}, {"id", judging_}}));
  return told;
}

}  // namespace tumble::live
