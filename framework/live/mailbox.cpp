#include "framework/live/mailbox.h"

#include <chrono>

namespace tumble::live {
namespace {

// bytes: more than a page gets that is new (shown_run.cpp)
constexpr std::size_t kMostWaiting = 128u << 20;

}  // namespace

std::string event_of(const std::string& name, const std::string& line) {
  return "event: " + name + "\ndata: " + line + "\n\n";
}

void Mailbox::put(const std::shared_ptr<const std::string>& text) {
  const std::lock_guard lock(mutex_);
  if (is_closed_) return;
  waiting_.push_back(text);
  bytes_ += text->size();
  if (bytes_ > kMostWaiting) {
    waiting_.clear();
    is_closed_ = true;
  }
  something_.notify_one();
}

void Mailbox::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  something_.notify_all();
}

bool Mailbox::is_closed() const {
  const std::lock_guard lock(mutex_);
  return is_closed_;
}

std::string Mailbox::take(double seconds) {
  std::unique_lock lock(mutex_);
  something_.wait_for(lock, std::chrono::duration<double>(seconds),
                      [&] { return is_closed_ || !waiting_.empty(); });
  std::string all;
  all.reserve(bytes_);
  for (const auto& text : waiting_) all += *text;
  waiting_.clear();
  bytes_ = 0;
  return all;
}

}  // namespace tumble::live
