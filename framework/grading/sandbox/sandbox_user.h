/// Whom a sandboxed program is, and the folders that it can read.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

namespace tumble::grading {

/// Whom the sandboxed program is to the rest of the machine. As root: a uid of its own, one a concurrent job, leased until
/// destruction. As an ordinary user: that user.
class SandboxUser {
 public:
  /// @throws UserError when all uids are in use
  static SandboxUser lease();
  SandboxUser(SandboxUser&& other) noexcept;
  SandboxUser& operator=(SandboxUser&&) = delete;
  ~SandboxUser();

  /// Empty where we are an ordinary user: nothing is dropped then.
  std::optional<uid_t> uid() const { return uid_; }

 private:
  SandboxUser() = default;
  std::optional<uid_t> uid_;
  int lock_ = -1;
};

/// A folder that the sandbox's user can read wherever the checkout lies; removed at destruction.
class Stage {
 public:
  /// @param user  who may read it; null: anybody, for what is no secret
  explicit Stage(const SandboxUser* user);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  ~Stage();

  const std::filesystem::path& path() const { return path_; }
  /// @return where the copy lies
  std::filesystem::path add_file(const std::filesystem::path& from, const std::string& name, bool executable = false);
  std::filesystem::path add_text(const std::string& text, const std::string& name);

 private:
  void hand_over(const std::filesystem::path& file, unsigned mode) const;

  std::filesystem::path path_;
  int alive_ = -1;   // hold_folder
  std::optional<uid_t> owner_;
};

/// Removes the stages of processes that are gone without having removed them: killed ones.
void sweep_stages_of_the_dead();

}  // namespace tumble::grading
