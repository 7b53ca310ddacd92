/// Files written whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace tumble {

/// Calls `make(draft)` to write a file beside the one wanted, then renames it: a reader sees the old file or the new one,
/// never half. The draft keeps the file's extension. Makes missing folders; leaves no draft behind when `make` throws.
/// @throws UserError when the file cannot be put in place, and whatever `make` throws
void make_whole(const std::filesystem::path& file, const std::function<void(const std::filesystem::path& draft)>& make);

/// The same, for bytes at hand.
/// @throws UserError when the file cannot be written
void write_whole(const std::filesystem::path& file, std::string_view bytes);

/// All bytes of a file; none where it cannot be read.
std::string text_of(const std::filesystem::path& file);

/// The bytes of a plain file: no link (it would show what the one who follows it may see), no device, no pipe that waits for a writer.
/// @param why  what stands in the way, after the file's name: "is a link; hand in the file itself"
/// @return nothing where `why` says why not
std::optional<std::string> read_plain_file(const std::filesystem::path& file, std::uint64_t most_bytes, std::string& why);

/// A folder that only this user can enter (mode 0700, a name nobody can foresee), gone with this object. For whatever passes
/// between two of our processes: in a shared /tmp, a file under a name that can be guessed is anybody's to write. What a killed process
/// left behind is removed when a later one makes its first.
class PrivateFolder {
 public:
  /// @throws UserError when it cannot be made
  PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  ~PrivateFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int alive_ = -1;   // a lock on the folder, which the kernel lets go of when the last process that shares it ends
};

/// Marks a folder of this process's, so that sweep_folders_of_the_dead leaves it alone. @return a descriptor to close when it may go
int hold_folder(const std::filesystem::path& folder);

/// Removes the folders NAME<process id>-... in `where` whose process is gone without having removed them: those of this user, which
/// nobody holds. A process id that somebody else has by now keeps a folder; a folder is never taken from a process that lives.
void sweep_folders_of_the_dead(const std::filesystem::path& where, const std::string& name);

}  // namespace tumble
