/// A folder for the time of a scope.
#pragma once

#include <filesystem>
#include <string>

#include <stdlib.h>

#include "framework/core/error.h"

namespace tumble {

/// A new folder in the place for temporary files, gone with all that is in it at the end of the scope.
class TemporaryFolder {
 public:
  /// @param name  how its name begins. @throws UserError when it cannot be made
  explicit TemporaryFolder(const std::string& name) {
    std::string path = (std::filesystem::temp_directory_path() / (name + "-XXXXXX")).string();
    if (::mkdtemp(path.data()) == nullptr) throw UserError(path, "this folder cannot be made", "Free some space, or set TMPDIR.");
    path_ = path;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tumble
