/// Records from the process that simulates to the one that serves the page: a kind, a length,
/// bytes. Frames and events are doubles as they are, so that nothing is rounded on the way.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "framework/trajectory/trajectory.h"

namespace tumble::live {

enum class RecordKind : char {
  kHead = 'H',     // JSON: what the page needs of scene and run; the first record of a run
  kFrame = 'F',    // pack(Frame)
  kEvent = 'E',    // pack(Event)
  kAimed = 'A',    // JSON: what a ray has hit
  kHand = 'P',     // JSON: a point force that was put on a body by hand, as a scene says it
  kTimes = 'V',    // JSON: local virtual times of a timewarp
  kAsked = 'C',    // JSON: what the run has asked of the modules so far (simulate.h)
  kEnd = 'X',      // JSON: how the run ended
  kRefused = 'U',  // JSON: a UserError
};

struct Record {
  RecordKind kind;
  std::string bytes;
};

/// @return false where nobody reads any more
bool write_record(int fd, RecordKind kind, std::string_view bytes);

/// Puts records together from what a pipe gives, piece by piece.
class RecordReader {
 public:
  void feed(std::string_view bytes) { waiting_.append(bytes); }
  /// @throws std::runtime_error where the bytes are no record
  std::optional<Record> next();

 private:
  std::string waiting_;
  std::size_t at_ = 0;  // of waiting_, read so far
};

std::string pack(const Frame& frame);
std::string pack(const Event& event);
/// @throws std::runtime_error where the bytes are none
Frame unpack_frame(std::string_view bytes);
Event unpack_event(std::string_view bytes);

}  // namespace tumble::live
