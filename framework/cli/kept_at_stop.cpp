#include "framework/cli/kept_at_stop.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace tumble::cli {
namespace {

// What the handler says. It may run at any time, in any thread, and must not allocate: the text
// that is not shown is written, then it becomes the one that is.
using Text = std::array<char, 1024>;
Text texts[2];
std::atomic<const Text*> shown{&texts[0]};
std::atomic<bool> is_writing{false}, is_asked{false};
static_assert(std::atomic<const Text*>::is_always_lock_free);

[[noreturn]] void end_now() {
  const char* const text = shown.load()->data();
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) {
  }  // nobody reads it
  ::_exit(kStoppedByHand);
}

void on_stop(int) {
  is_asked = true;
  if (!is_writing) end_now();
}

void say_at_stop(const std::string& words) {
  Text& next = texts[shown.load() == &texts[0] ? 1 : 0];
  std::snprintf(next.data(), next.size(), "\ntumble: stopped by Ctrl-C: %s\n", words.c_str());
  shown = &next;
}

}  // namespace

KeptAtStop::KeptAtStop(std::string pieces) : pieces_(std::move(pieces)) {
  is_asked = false;
  say_at_stop("nothing was finished yet, and nothing is kept");
  struct sigaction action {};
  action.sa_handler = on_stop;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, &before_);
}

KeptAtStop::~KeptAtStop() { ::sigaction(SIGINT, &before_, nullptr); }

void KeptAtStop::keep(std::size_t done, std::size_t all, const std::string& place,
                      const std::function<void()>& write) {
  struct Writing {
    Writing() { is_writing = true; }
    ~Writing() {
      is_writing = false;
      if (is_asked) end_now();
    }
  };
  std::fflush(stdout);  // what stands there is kept, too
  const Writing writing;
  write();
  say_at_stop(fmt::format("kept in {}: {} of {} {}", place, done, all, pieces_));
}

}  // namespace tumble::cli
