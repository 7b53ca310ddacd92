/// The user id of a sandboxed program, and the folders that it can read.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

namespace tumble::grading {

/// Whether this process can give a program another user id: as root, unless its container has taken
/// the capabilities for it.
bool can_change_user();

/// The user id of a sandboxed program outside its sandbox. Where the user can be changed: a
/// separate uid for each concurrent job, leased until destruction. Else: this process's own user.
class SandboxUser {
 public:
  /// Of a job, whose files it may read.
  /// @throws UserError when all uids are in use
  static SandboxUser lease();
  /// Of one run on the host, which shares it with no other process: so all processes of the run can
  /// be counted and killed by their user.
  static SandboxUser lease_for_run();
  SandboxUser(SandboxUser&& other) noexcept;
  SandboxUser& operator=(SandboxUser&&) = delete;
  ~SandboxUser();

  /// Empty where the user is kept.
  std::optional<uid_t> uid() const { return uid_; }

 private:
  SandboxUser() = default;
  static SandboxUser lease_between(uid_t first, uid_t end);
  std::optional<uid_t> uid_;
  int lock_ = -1;
};

/// A folder that the sandbox's user can read, wherever the checkout is; removed at destruction.
class Stage {
 public:
  /// @param user  the only user that can write to it, and the only group that can read it; null:
  ///   all users can read it, for files that are not secret
  explicit Stage(const SandboxUser* user);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  ~Stage();

  const std::filesystem::path& path() const { return path_; }
  /// @return path of the copy
  std::filesystem::path add_file(const std::filesystem::path& from, const std::string& name,
                                 bool executable = false);
  /// The file itself under one more name, which takes neither time nor room. Not for secrets.
  /// @pre what runs inside cannot change the file: another user's, or bound for reading only
  /// @return false, with nothing done: it lies on another file system, or the kernel does not
  ///   permit it for a file of another user
  bool link_file(const std::filesystem::path& from, const std::string& name);
  /// Whether the sandbox's user can read a file where it lies, so that it can be a Bind there: as
  /// its mode and its folders' modes say.
  bool can_be_shown(const std::filesystem::path& file) const;
  std::filesystem::path add_text(const std::string& text, const std::string& name);

 private:
  void hand_over(const std::filesystem::path& file, unsigned mode) const;

  std::filesystem::path path_;
  int alive_ = -1;  // hold_folder
  std::optional<uid_t> owner_;
};

/// Removes the stages of killed processes.
void sweep_stages_of_the_dead();

}  // namespace tumble::grading
