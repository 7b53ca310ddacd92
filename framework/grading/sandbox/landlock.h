/// Landlock (landlock(7)): a process gives up the rights on all files but those named.
///
/// By raw system calls and with constants of its own, because Debian 12's headers end at ABI 2.
/// The kernel is asked at run time which rights it knows.
#pragma once

#include <cstdint>
#include <filesystem>

namespace tumble::grading {

/// Version of the kernel's interface; 0: none, or switched off. 1: files. 2: renaming into other
/// folders. 3: truncation. 4: TCP. 5: ioctl of devices. 6: signals and abstract sockets.
int landlock_abi();

/// The rights that a program keeps.
class LandlockRules {
 public:
  /// @throws std::runtime_error where there is no Landlock
  LandlockRules();
  LandlockRules(const LandlockRules&) = delete;
  LandlockRules& operator=(const LandlockRules&) = delete;
  ~LandlockRules();

  /// Each on a file, or a folder and everything below it. A path that does not exist is skipped.
  void allow_reading_and_running(const std::filesystem::path& path) {
    allow(path, kRead | kExecute);
  }
  void allow_reading(const std::filesystem::path& path) { allow(path, kRead); }
  void allow_device(const std::filesystem::path& path) { allow(path, kRead | kWriteFile); }
  /// Files and folders can be made, written, renamed and removed there; none of them can be run.
  void allow_writing(const std::filesystem::path& folder);

  /// Gives up all other rights, for this process and its descendants.
  /// @pre  no_new_privs is set
  /// @throws std::runtime_error when the kernel refuses
  void restrict_self() const;

 private:
  using Rights = std::uint64_t;
  // of files and of folders
  static constexpr Rights kExecute = 1ull << 0, kWriteFile = 1ull << 1,
                          kRead = 1ull << 2 | 1ull << 3;
  void allow(const std::filesystem::path& path, Rights rights);

  int rules_ = -1;
  Rights handled_ = 0;
};

}  // namespace tumble::grading
