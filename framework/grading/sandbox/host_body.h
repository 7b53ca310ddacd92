/// The sandbox where namespaces are refused: the program is a process of the host, with a user id
/// of its own where the grader is root, limits, a system call filter, and Landlock where the kernel
/// has it.
///
/// Without Landlock (SandboxKind::kBare) a submission is a program that needs no file: its filter
/// refuses open, clone and all other calls but a list, and lets it be started exactly once.
#pragma once

#include <unistd.h>

#include <optional>

#include "framework/grading/sandbox/body.h"
#include "framework/grading/sandbox/sandbox_user.h"

namespace tumble::grading {

class HostBody : public SandboxBody {
 public:
  /// Leases a user id and makes the temporary folder.
  explicit HostBody(const SandboxJob& job);
  ~HostBody() override;

  [[noreturn]] void become() override;
  int descriptor() const override { return start_[1]; }
  void attend() override;
  void kill_rest() override;
  std::optional<std::uint64_t> bytes_on_disk() const override;
  std::string as_inside(std::string printed) const override;

 private:
  bool has_landlock() const { return job_.kind == SandboxKind::kLandlock; }
  bool starts_once() const { return job_.is_alone && !has_landlock(); }
  std::string named(const std::string& word) const;
  void change_user() const;

  const SandboxJob& job_;
  const pid_t keeper_ = ::getpid();
  const SandboxUser user_;  // of this run alone
  std::optional<Stage> tmp_;
  int start_[2] = {-1, -1};  // the child sends the descriptor that lets it start once
};

}  // namespace tumble::grading
