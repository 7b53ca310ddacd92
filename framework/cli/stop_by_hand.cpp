#include "framework/cli/stop_by_hand.h"

namespace tumble::cli {
namespace {

volatile sig_atomic_t is_stop_asked = 0;

void ask_to_stop(int) { is_stop_asked = 1; }

}  // namespace

StopByHand::StopByHand(TrajectorySink& sink) : PassingSink(sink) {
  is_stop_asked = 0;
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  ::sigaction(SIGINT, &action, &before_);
}

StopByHand::~StopByHand() { ::sigaction(SIGINT, &before_, nullptr); }

bool StopByHand::is_asked() { return is_stop_asked != 0; }

void StopByHand::frame(const Frame& frame) {
  sink_.frame(frame);
  if (is_asked()) throw StoppedByHand{};
}

void StopByHand::beat(double time_s) {
  sink_.beat(time_s);
  if (is_asked()) throw StoppedByHand{};
}

}  // namespace tumble::cli
