#include "framework/trajectory/run_progress.h"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "framework/core/terminal.h"

namespace tumble {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

RunProgress::RunProgress(TrajectorySink& sink, double duration_s, Pace pace)
    : PassingSink(sink),
      duration_(duration_s),
      pace_(pace),
      reporter_([this] { report_until_done(); }) {}

RunProgress::Pace RunProgress::usual_pace() {
  return ::isatty(STDERR_FILENO) == 1 ? Pace{2.0, 1.0, true} : Pace{};
}

RunProgress::~RunProgress() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  ended_.notify_all();
  reporter_.join();
  if (pace_.rewrites && reported_time_ >= 0.0) fmt::print(stderr, "\r\033[K");
}

void RunProgress::frame(const Frame& frame) {
  note(frame.time, false);
  sink_.frame(frame);
}

void RunProgress::beat(double time_s) {
  note(time_s, true);
  sink_.beat(time_s);
}

void RunProgress::note(double time_s, bool is_of_a_beat) {
  const std::lock_guard lock(mutex_);
  time_ = time_s;
  came_s_ = seconds_since(begun_);
  is_of_a_beat_ = is_of_a_beat;
}

void RunProgress::report_until_done() {
  std::unique_lock lock(mutex_);
  for (double next = pace_.first_s;; next += pace_.every_s) {
    if (ended_.wait_until(lock,
                          begun_ + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double>(next)),
                          [this] { return is_over_; }))
      return;
    report(next);
  }
}

void RunProgress::report(double now_s) {
  const std::string so_far = fmt::format("{:.4g} of {:.4g} s", time_, duration_);
  std::string line = is_of_a_beat_
                         ? "tumble: the ordered reference, which runs first, is at " + so_far
                         : "tumble: " + so_far + " simulated";
  // A line that is written every second says only after a while that no frame comes.
  constexpr double kPatience = 5.0;  // s
  if (time_ == reported_time_ && (!pace_.rewrites || now_s - came_s_ >= kPatience)) {
    const double waited = now_s - came_s_;
    line += is_of_a_beat_ ? fmt::format(", for {:.0f} s now. Ctrl-C ends the run", waited)
                          : fmt::format(
                                ", for {:.0f} s no frame has come: steps are very short there, or "
                                "each takes long. "
                                "Ctrl-C ends the run",
                                waited);
    if (time_ > 0 && !is_of_a_beat_)
      line += fmt::format("; --duration-s {:.4g} shows what came before", time_);
  } else if (time_ > 0 && !is_of_a_beat_) {
    line += fmt::format(", about {:.0f} s left", came_s_ / time_ * (duration_ - time_));
  }
  reported_time_ = time_;
  if (!pace_.rewrites) {
    fmt::print(stderr, "{}\n", line);
    return;
  }
  // A line wider than the terminal cannot be written over.
  const std::size_t columns = terminal_columns(STDERR_FILENO) - 1;
  fmt::print(stderr, "\r\033[K{}", line.size() <= columns ? line : line.substr(0, columns));
  std::fflush(stderr);
}

}  // namespace tumble
