/// Detects when files were saved, whether an editor writes them in place or renames a new file over
/// them. It watches their folders, not the files, because the second way gives the old name to a
/// new file.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <vector>

namespace tumble {

class SaveWatch {
 public:
  /// @throws UserError where a folder cannot be watched
  explicit SaveWatch(const std::vector<std::filesystem::path>& files);
  ~SaveWatch();
  SaveWatch(const SaveWatch&) = delete;
  SaveWatch& operator=(const SaveWatch&) = delete;

  /// Waits for a save, then until nothing has changed for a moment: some editors write twice.
  /// @return the files that were saved
  std::set<std::filesystem::path> wait() { return wait(-1); }
  /// The same for at most so long. @return nothing where none was saved
  std::set<std::filesystem::path> wait(int timeout_ms);
  /// To wait for together with others: readable where something may have been saved.
  int descriptor() const { return fd_; }

 private:
  bool look(int timeout_ms, std::set<std::filesystem::path>& saved);

  int fd_;
  std::map<int, std::filesystem::path> folders_;  // by the number of the watch
  std::set<std::filesystem::path> files_;
};

}  // namespace tumble
