/// Files that are written whole or not at all, files that are read with limits, and private
/// temporary folders.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace tumble {

/// Calls `make(draft)` to write a draft in the same folder, then renames the draft to `file`: a
/// reader sees the old file or the new one, never half of one. The draft keeps the file's
/// extension. Creates missing folders; leaves no draft behind when `make` throws. Where `file` is a
/// link, the link is replaced.
/// @throws UserError when the file cannot be put in place, and whatever `make` throws
void make_whole(const std::filesystem::path& file,
                const std::function<void(const std::filesystem::path& draft)>& make);

/// The same, for bytes in memory.
/// @throws UserError when the file cannot be written
void write_whole(const std::filesystem::path& file, std::string_view bytes);

/// What a file is behind links, or the file itself. For a file that a person names, whose links
/// stay.
/// @throws UserError where the links make a loop
std::filesystem::path behind_links(const std::filesystem::path& file);

/// Refuses before the work what make_whole is known to refuse after it. Makes nothing.
/// @throws UserError when `file` is no plain file, or its folder cannot be made or written to
void expect_writable(const std::filesystem::path& file);

/// All bytes of a file; empty where it cannot be read.
std::string text_of(const std::filesystem::path& file);

/// The bytes of a regular file. Links are refused, because a link would show files that this user
/// may read and its author may not; so are devices, and pipes, which would wait for a writer.
/// @param why  [out] why the file is refused, to follow its name in a message: "is a link; hand in
///   the file itself"
/// @return nothing where `why` was set
std::optional<std::string> read_plain_file(const std::filesystem::path& file,
                                           std::uint64_t most_bytes, std::string& why);

/// A folder that only this user can enter (mode 0700, an unpredictable name), removed with this
/// object. It holds what two of our processes exchange: in a shared /tmp every user can write a
/// file whose name can be guessed. A folder that a killed process left behind is removed when a
/// later process creates its first one.
class PrivateFolder {
 public:
  /// @throws UserError when it cannot be created
  PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  ~PrivateFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  // holds a lock on the folder, which the kernel releases when the last process that shares the
  // descriptor ends
  int alive_ = -1;
};

/// Locks a folder of this process, so that sweep_folders_of_the_dead leaves it alone.
/// @return a descriptor; closing it releases the lock
int hold_folder(const std::filesystem::path& folder);

/// Removes the folders NAME<process id>-... in `where` that belong to this user, are not locked,
/// and whose process has ended without removing them. A folder stays while another process has the
/// same id; a folder of a living process is never removed.
void sweep_folders_of_the_dead(const std::filesystem::path& where, const std::string& name);

}  // namespace tumble
