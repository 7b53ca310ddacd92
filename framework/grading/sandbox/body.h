/// How a job becomes a confined process: one body for each kind of sandbox.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "framework/grading/sandbox/sandbox_job.h"

namespace tumble::grading {

/// Lives in the keeper, for one run. Destruction removes what the run left on disk.
class SandboxBody {
 public:
  virtual ~SandboxBody() = default;
  /// Becomes the program, or the process that starts it. Called in the keeper's child, whose
  /// descriptors are those of sandbox_wire.h. Before the program starts, InitReport::kStarted is
  /// sent, by this process or by SandboxJob::init.
  /// @throws std::runtime_error when the program must not be started
  [[noreturn]] virtual void become() = 0;
  /// A descriptor that the child gets as kBodyFd; -1: none.
  virtual int descriptor() const { return -1; }
  /// Called in the keeper once its child exists.
  virtual void attend() {}
  /// Kills every process of the run that the keeper cannot find among its descendants.
  virtual void kill_rest() {}
  /// Bytes that the run has written to a disk; nothing where the kernel limits its folder.
  virtual std::optional<std::uint64_t> bytes_on_disk() const { return std::nullopt; }
  /// What the run printed, with the names inside instead of those outside.
  virtual std::string as_inside(std::string printed) const { return printed; }
};

}  // namespace tumble::grading
