#include "framework/modules/channel.h"

#include <poll.h>
#include <sched.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tumble::modules {
namespace {

struct Header {
  std::uint32_t size;
  std::uint8_t kind;
  std::uint8_t padding[3];
  std::uint64_t question;
};

}  // namespace

void Channel::wait(int fd, short events, Clock::time_point deadline) {
  for (;;) {
    int timeout_ms = -1;
    if (deadline != Clock::time_point::max()) {
      if (extension_ && deadline <= Clock::now()) deadline = extension_(deadline);
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (left <= 0 && deadline <= Clock::now())
        throw ChannelTimeout("no answer before the deadline");
      timeout_ms = static_cast<int>(std::min<long long>(left + 1, 1 << 30));
    }
    pollfd waiting{fd, events, 0};
    const int ready = ::poll(&waiting, 1, timeout_ms);
    if (ready > 0) return;
    if (ready < 0 && errno != EINTR) throw ChannelClosed("poll failed");
  }
}

// No number can be known before its message is sent.
std::uint64_t Channel::draw() {
  if (lots_left_ == 0) {
    if (::getrandom(lots_.data(), sizeof lots_, 0) != static_cast<ssize_t>(sizeof lots_))
      throw ChannelClosed("the system gives no random numbers");
    lots_left_ = lots_.size();
  }
  return lots_[--lots_left_];
}

void Channel::send(MessageKind kind, const Bytes& payload, Clock::time_point deadline) {
  if (payload.size() > kMaxPayload)
    throw WireError("an argument or answer of " + std::to_string(payload.size()) +
                    " bytes, above the limit of " + std::to_string(kMaxPayload) +
                    " (a size that was never set?)");
  Bytes frame(sizeof(Header) + payload.size());
  if (side_ == End::kAsks) question_ = draw();
  const Header header{static_cast<std::uint32_t>(payload.size()),
                      static_cast<std::uint8_t>(kind),
                      {0, 0, 0},
                      question_};
  std::memcpy(frame.data(), &header, sizeof header);
  if (!payload.empty()) std::memcpy(frame.data() + sizeof header, payload.data(), payload.size());
  for (std::size_t sent = 0; sent < frame.size();) {
    // MSG_NOSIGNAL: a dead reader gives an error code instead of SIGPIPE. MSG_DONTWAIT: a reader
    // that never reads cannot block this process.
    ssize_t n =
        ::send(write_fd_, frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && errno == ENOTSOCK)
      n = ::write(write_fd_, frame.data() + sent, frame.size() - sent);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      wait(write_fd_, POLLOUT, deadline);
      continue;
    }
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw ChannelClosed("the other end closed the channel");
    sent += static_cast<std::size_t>(n);
  }
}

// Waking a sleeping process takes some 30 us, longer than most functions of a module run: so poll
// for a while before sleeping. sched_yield: where both ends share a core, the other one needs it.
// Where other programs wait for the core, too, a yield hands it to them for milliseconds, and a
// call costs 50 times what it costs asleep. One such yield, and the next reads sleep at once; twice
// as many after each further one.
ssize_t Channel::poll_briefly() {
  constexpr auto kPolling = std::chrono::microseconds(60), kStrangers = kPolling * 4;
  constexpr int kFirstPause = 64, kLongestPause = 4096;  // reads: tens of ms at most between tries
  if (reads_to_sleep_ > 0) {
    --reads_to_sleep_;
    errno = EAGAIN;
    return -1;
  }
  const auto began = Clock::now();
  for (auto now = began;;) {
    const ssize_t n = ::recv(read_fd_, ahead_.data(), ahead_.size(), MSG_DONTWAIT);
    const bool has_answer = n >= 0 || errno != EAGAIN;
    if (now - began > kStrangers) {
      reads_to_sleep_ = pause_ = std::clamp(2 * pause_, kFirstPause, kLongestPause);
      return n;
    }
    if (has_answer) pause_ = 0;
    if (has_answer || now - began >= kPolling) return n;
    ::sched_yield();
    now = Clock::now();
  }
}

// Reads as much as has arrived in one system call: system calls are the main cost of a call across
// the boundary.
void Channel::fill(Clock::time_point deadline) {
  if (const ssize_t n = poll_briefly(); n > 0) {
    at_ = 0;
    end_ = static_cast<std::size_t>(n);
    return;
  }
  for (;;) {
    if (deadline != Clock::time_point::max()) wait(read_fd_, POLLIN, deadline);
    const ssize_t n = ::read(read_fd_, ahead_.data(), ahead_.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) {
      wait(read_fd_, POLLIN, deadline);
      continue;
    }
    if (n <= 0) throw ChannelClosed("the other end closed the channel");
    at_ = 0;
    end_ = static_cast<std::size_t>(n);
    return;
  }
}

Message Channel::receive(Clock::time_point deadline) {
  const auto read_exactly = [&](void* data, std::size_t size) {
    auto* to = static_cast<std::uint8_t*>(data);
    while (size > 0) {
      if (at_ == end_) fill(deadline);
      const std::size_t n = std::min(size, end_ - at_);
      std::memcpy(to, ahead_.data() + at_, n);
      at_ += n;
      to += n;
      size -= n;
    }
  };
  Header header{};
  read_exactly(&header, sizeof header);
  if (header.size > kMaxPayload) throw WireError("a message larger than the limit");
  if (side_ == End::kAnswers)
    question_ = header.question;
  else if (header.question != question_)
    throw WireError("an answer to a question that was not asked");
  Message message{static_cast<MessageKind>(header.kind), Bytes(header.size)};
  read_exactly(message.payload.data(), header.size);
  return message;
}

}  // namespace tumble::modules
