/// Messages over a pair of file descriptors, with a deadline and a size limit.
///
/// The judge's end numbers each of its messages by lot, and takes only answers that carry the
/// number of its latest one. So what a worker sends unasked is refused, however the two are timed
/// against each other: an answer before its question, or a second one to the same.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>

#include "framework/modules/wire.h"

namespace tumble::modules {

enum class MessageKind : std::uint8_t {
  kCall = 1,        // judge to worker: function number, arguments
  kReturn,          // worker to judge: the value
  kCallback,        // worker to judge: callback number, arguments
  kCallbackReturn,  // judge to worker: the value
  kNotImplemented,  // worker to judge: function, handout
  kException,       // worker to judge: what()
};

struct Message {
  MessageKind kind;
  Bytes payload;
};

/// The other process exited, crashed or closed its descriptor.
class ChannelClosed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// No complete message arrived before the deadline.
class ChannelTimeout : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Channel {
 public:
  using Clock = std::chrono::steady_clock;
  // bytes: a state of 10^5 bodies is 10 MB; more is an attack
  static constexpr std::uint32_t kMaxPayload = 16u << 20;

  enum class End { kAsks, kAnswers };  // of the judge, of the worker

  /// Does not own the descriptors. Either may be a socket or a pipe.
  Channel(End end, int read_fd, int write_fd)
      : read_fd_(read_fd), write_fd_(write_fd), side_(end) {}

  /// Called when a deadline has passed: returns a later one, or the same one to end the wait.
  using Extension = std::function<Clock::time_point(Clock::time_point passed)>;
  void extend_by(Extension extension) { extension_ = std::move(extension); }

  /// @throws ChannelClosed, ChannelTimeout, WireError (payload above kMaxPayload: nothing is sent)
  void send(MessageKind kind, const Bytes& payload,
            Clock::time_point deadline = Clock::time_point::max());
  /// @throws ChannelClosed, ChannelTimeout, WireError (size above kMaxPayload, or no answer to the
  ///   latest question)
  Message receive(Clock::time_point deadline = Clock::time_point::max());

 private:
  void wait(int fd, short events, Clock::time_point deadline);
  ssize_t poll_briefly();
  void fill(Clock::time_point deadline);

  std::uint64_t draw();

  int read_fd_, write_fd_;
  std::uint64_t question_ = 0;  // number of the judge's latest message
  End side_;
  std::array<std::uint64_t, 32> lots_{};  // drawn ahead: one system call for many questions
  std::size_t lots_left_ = 0;
  Extension extension_;
  std::array<std::uint8_t, 1 << 14> ahead_;  // received but not consumed: from at_ to end_
  std::size_t at_ = 0, end_ = 0;
  int reads_to_sleep_ = 0, pause_ = 0;  // on a busy machine: how many reads do without polling
};

}  // namespace tumble::modules
