#include "framework/core/save_watch.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "framework/core/error.h"

namespace tumble {

namespace fs = std::filesystem;

SaveWatch::SaveWatch(const std::vector<fs::path>& files)
    : fd_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
  for (const fs::path& file : files) {
    const fs::path whole = fs::absolute(file).lexically_normal(), folder = whole.parent_path();
    files_.insert(whole);
    const int number =
        fd_ < 0 ? -1 : ::inotify_add_watch(fd_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO);
    if (number < 0) {
      const std::string why = std::strerror(errno);
      ::close(fd_);
      throw UserError(folder.string(), "cannot be watched: " + why,
                      "Use ./tumble check after each change.");
    }
    folders_[number] = folder;
  }
}

SaveWatch::~SaveWatch() { ::close(fd_); }

std::set<fs::path> SaveWatch::wait(int timeout_ms) {
  constexpr int kForever = -1, kQuietMs = 60;
  std::set<fs::path> saved;
  do {
    if (!look(timeout_ms, saved) && timeout_ms != kForever) break;
  } while (saved.empty() && timeout_ms == kForever);
  while (!saved.empty() && look(kQuietMs, saved)) {
  }
  return saved;
}

// @return whether one of the files was saved
bool SaveWatch::look(int timeout_ms, std::set<fs::path>& saved) {
  pollfd waiting{fd_, POLLIN, 0};
  if (::poll(&waiting, 1, timeout_ms) <= 0) return false;
  alignas(inotify_event) char buffer[4096];
  const ssize_t size = ::read(fd_, buffer, sizeof buffer);
  bool is_ours = false;
  for (ssize_t at = 0; at < size;) {
    const auto* event = reinterpret_cast<const inotify_event*>(buffer + at);
    at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
    if (event->len == 0 || !folders_.contains(event->wd)) continue;
    const fs::path file = folders_.at(event->wd) / event->name;
    if (!files_.contains(file)) continue;
    saved.insert(file);
    is_ours = true;
  }
  return is_ours;
}

}  // namespace tumble
