#include "framework/live/pages.h"

#include <unistd.h>
#include <sys/eventfd.h>

#include <algorithm>

namespace tumble::live {
namespace {

constexpr std::size_t kMostPages = 8;

std::size_t count_open(const std::vector<std::shared_ptr<Mailbox>>& pages) {
  return static_cast<std::size_t>(std::count_if(
      pages.begin(), pages.end(), [](const auto& page) { return !page->is_closed(); }));
}

}  // namespace

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Pages::Pages() : wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
Pages::~Pages() { ::close(wake_); }

std::shared_ptr<Mailbox> Pages::open() {
  const std::lock_guard lock(mutex_);
  if (count_open(pages_) + count_open(new_pages_) >= kMostPages) return nullptr;
  new_pages_.push_back(std::make_shared<Mailbox>());
  ::eventfd_write(wake_, 1);
  return new_pages_.back();
}

void Pages::post(const std::string& json) {
  const std::lock_guard lock(mutex_);
  posts_.push_back(json);
  ::eventfd_write(wake_, 1);
}

PagesNews Pages::take_news() {
  eventfd_t unused = 0;
  ::eventfd_read(wake_, &unused);
  PagesNews news;
  news.was_left = forget_closed();
  const std::lock_guard lock(mutex_);
  news.posts.swap(posts_);
  news.opened.swap(new_pages_);
  pages_.insert(pages_.end(), news.opened.begin(), news.opened.end());
  return news;
}

bool Pages::forget_closed() {
  const std::lock_guard lock(mutex_);
  const bool had = !pages_.empty();
  std::erase_if(pages_, [](const auto& page) { return page->is_closed(); });
  return had && pages_.empty();
}

bool Pages::are_watched() const { return count_open(pages_) > 0; }

std::string Pages::tell(const Json& what) {
  const std::string text = dumped(what);
  send("say", text);
  return text;
}

void Pages::send(const std::string& name, const std::string& line) {
  const auto shared = std::make_shared<const std::string>(event_of(name, line));
  const std::lock_guard lock(mutex_);
  for (const auto& page : pages_) page->put(shared);
}

void Pages::close() {
  const std::lock_guard lock(mutex_);
  for (const auto* list : {&pages_, &new_pages_})
    for (const auto& page : *list) page->close();
}

}  // namespace tumble::live
