// The loop of a sitting, and what ends it.
#include "framework/live/session.h"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "framework/live/session_parts.h"
#include "framework/report/player_parts.h"

namespace tumble::live {

void Session::run(int stop) {
  if (!sitting_.first_judged.empty()) to_judge_.insert(sitting_.first_judged);
  begin("begin", 0.0, recipe_);
  for (;;) {
    std::vector<pollfd> waiting = {
        {stop, POLLIN, 0}, {wake_, POLLIN, 0}, {saves_.descriptor(), POLLIN, 0}};
    // What a process says is read, too: one that says much would stand still when its pipe is full.
    const auto wait_for = [&](const Child& child) {
      waiting.push_back({child.output(), POLLIN, 0});
      if (child.talk_is_open()) waiting.push_back({child.talk(), POLLIN, 0});
    };
    for (const Simulator* simulator : {running_.get(), starting_.get(), checking_.get()})
      if (simulator != nullptr) wait_for(simulator->child);
    for (const Child* child : {judge_.get(), locator_.get()})
      if (child != nullptr) wait_for(*child);
    constexpr int kTickMs = 500;
    if (::poll(waiting.data(), waiting.size(), kTickMs) < 0 && errno != EINTR) return;
    if (waiting[0].revents != 0) return;
    if (waiting[1].revents != 0) take_posts();
    if (waiting[2].revents != 0) code_saved(saves_.wait(0));
    if (running_) listen_to(running_);
    if (starting_) listen_to(starting_);
    if (checking_) check_saved();
    if (judge_) listen_to_judge();
    if (locator_) listen_to_locator();
    compare();
    // A page that is closed lets the run stand.
    const bool had = !pages_.empty();
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(pages_, [](const auto& page) { return page->is_closed(); });
    }
    if (had && pages_.empty()) set_pace();
  }
}

namespace {

/// Signals that end the program, as a descriptor; blocked for all threads that are started later.
class StopSignals {
 public:
  StopSignals() {
    ::sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&signals_, signal);
    ::pthread_sigmask(SIG_BLOCK, &signals_, &before_);
    ::signal(SIGPIPE, SIG_IGN);
    fd_ = ::signalfd(-1, &signals_, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  ~StopSignals() {
    // What has come is taken, so that it ends nobody when it is let through again.
    signalfd_siginfo one;
    while (::read(fd_, &one, sizeof one) == sizeof one) {
    }
    ::close(fd_);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  int descriptor() const { return fd_; }

 private:
  sigset_t signals_, before_;
  int fd_;
};

}  // namespace

Left serve(const Sitting& sitting, const std::function<void(const std::string& address)>& ready) {
  report::three_js();  // missing: said before anything is started
  const StopSignals stop;
  std::vector<std::filesystem::path> files;
  for (const Watched& one : sitting.watched) files.push_back(one.file);
  SaveWatch saves(files);
  Session session(sitting, saves);
  const Server server(session.hooks(), sitting.port);
  ready(server.address());
  session.run(stop.descriptor());
  session.close_pages();
  return session.left();
}

}  // namespace tumble::live
