/// What waits to be sent to one open page.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tumble::live {

/// An event of the stream to a page: a name, and text of one line.
std::string event_of(const std::string& name, const std::string& line);

class Mailbox {
 public:
  /// Of a page that does not read, what waits is thrown away and the mailbox closed: the page comes
  /// again and gets all anew.
  void put(const std::shared_ptr<const std::string>& text);
  /// An event that other pages do not get.
  void put(const std::string& name, const std::string& line) {
    put(std::make_shared<const std::string>(event_of(name, line)));
  }
  void close();
  bool is_closed() const;

  /// Waits for at most so long. @return all that waits, in order; empty where nothing does
  std::string take(double seconds);

 private:
  mutable std::mutex mutex_;
  std::condition_variable something_;
  std::vector<std::shared_ptr<const std::string>> waiting_;
  std::size_t bytes_ = 0;
  bool is_closed_ = false;
};

}  // namespace tumble::live
