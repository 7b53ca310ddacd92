/// The open pages of a sitting: what all of them are told, and what they ask for.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/live/mailbox.h"

namespace tumble::live {

using Json = nlohmann::ordered_json;

/// In one line; bytes that are no UTF-8 are replaced.
std::string dumped(const Json& json);

/// What has come from pages since it was taken last.
struct PagesNews {
  std::vector<std::string> posts;                // JSON, in order
  std::vector<std::shared_ptr<Mailbox>> opened;  // are told nothing before they are greeted
  bool was_left = false;                         // all pages before these have been closed
};

class Pages {
 public:
  Pages();
  ~Pages();
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;

  // From threads of the server.
  /// @return null: too many are open
  std::shared_ptr<Mailbox> open();
  void post(const std::string& json);

  // From the thread of the session.
  /// A descriptor that is readable when there is news.
  int news() const { return wake_; }
  PagesNews take_news();
  /// @return whether the last one was closed
  bool forget_closed();
  /// Whether any is open.
  bool are_watched() const;
  /// To all. @return its text, for pages that are opened later
  std::string tell(const Json& what);
  /// An event of the stream to all.
  void send(const std::string& name, const std::string& line);
  void close();

 private:
  int wake_;
  std::mutex mutex_;  // guards the three below; pages_ changes in the thread of the session alone
  std::vector<std::string> posts_;
  std::vector<std::shared_ptr<Mailbox>> new_pages_, pages_;
};

}  // namespace tumble::live
