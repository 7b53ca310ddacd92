/// The user id of a sandboxed program, and the folders that it can read.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

namespace tumble::grading {

/// The user id of a sandboxed program outside its sandbox. As root: a separate uid for each
/// concurrent job, leased until destruction. As an ordinary user: that user.
class SandboxUser {
 public:
  /// @throws UserError when all uids are in use
  static SandboxUser lease();
  SandboxUser(SandboxUser&& other) noexcept;
  SandboxUser& operator=(SandboxUser&&) = delete;
  ~SandboxUser();

  /// Empty for an ordinary user, whose uid is kept.
  std::optional<uid_t> uid() const { return uid_; }

 private:
  SandboxUser() = default;
  std::optional<uid_t> uid_;
  int lock_ = -1;
};

/// A folder that the sandbox's user can read, wherever the checkout is; removed at destruction.
class Stage {
 public:
  /// @param user  the only user that can read it; null: all users, for files that are not secret
  explicit Stage(const SandboxUser* user);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  ~Stage();

  const std::filesystem::path& path() const { return path_; }
  /// @return path of the copy
  std::filesystem::path add_file(const std::filesystem::path& from, const std::string& name, bool executable = false);
  std::filesystem::path add_text(const std::string& text, const std::string& name);

 private:
  void hand_over(const std::filesystem::path& file, unsigned mode) const;

  std::filesystem::path path_;
  int alive_ = -1;   // hold_folder
  std::optional<uid_t> owner_;
};

/// Removes the stages of killed processes.
void sweep_stages_of_the_dead();

}  // namespace tumble::grading
