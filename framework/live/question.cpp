#include "framework/live/question.h"

#include <utility>

namespace tumble::live {

void Question::ask(const std::vector<std::string>& words, const std::string& about) {
  child_ = std::make_unique<Child>(words);
  if (!about.empty()) child_->say(about);
  child_->close_input();
  answer_ = {};
}

std::optional<Question::Answer> Question::listen() {
  if (!child_) return std::nullopt;
  const bool is_open = Child::read_some(child_->output(), answer_.text);
  child_->read_talk(answer_.talk);
  if (is_open) return std::nullopt;
  child_->wait();
  child_.reset();
  return std::move(answer_);
}

}  // namespace tumble::live
