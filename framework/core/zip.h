/// Zip archives, without a file system: read from bytes that nobody vouches for, and written.
///
/// Source: PKWARE, APPNOTE.TXT 6.3.10 (section numbers in zip_reader.cpp). Read are plain files and
/// folders, stored or deflated; not encryption, parts on several disks, and archives that need the
/// 64-bit extension (more than 65,534 entries or 4 GB).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tumble {

/// Bytes packed as zlib packs them (RFC 1950), as small as it can.
std::string deflated(const std::string& bytes);

/// What an archive may cost. Declared sizes are checked before anything is unpacked, and unpacking
/// ends at the declared size.
struct ZipLimits {
  std::size_t entries = 5000;
  std::uint64_t bytes_each = 16u << 20;  // unpacked
  std::uint64_t bytes_all = 64u << 20;   // unpacked, of all entries together
  // Unpacked to packed bytes, of entries above `bytes_free`: source code packs 3 to 20 times, the
  // format's utmost is 1032.
  double ratio = 200.0;
  std::uint64_t bytes_free = 1u << 20;
};

/// Why an entry, or the whole archive, is refused. Names are as in the archive: any bytes.
struct ZipFault {
  std::string entry;  // empty: the archive itself
  std::string why;    // follows the name in a message: "is a symbolic link"
};

struct ZipReading {
  // the archive as a whole; then nothing was taken
  std::optional<ZipFault> archive;
  // single entries, which were not taken; the others were
  std::vector<ZipFault> entries;
};

/// Reads an archive and gives each plain file to `take`, in the archive's order: a relative path of
/// parts that are neither empty, "." nor "..", in UTF-8, and all of its bytes with the right CRC.
///
/// The archive as a whole is refused for: no or several ends, parts of it on other disks, sizes and
/// places that do not fit together, entries that overlap, a name that leads out of a folder, more
/// than the limits allow.
/// A single entry is refused for: a link, a device, encryption, an unknown method, a name that is
/// not UTF-8 or too long, a local header that differs from the directory, bytes that do not unpack
/// to their size and CRC, a name that another entry has, also in other (ASCII) capitals or as a
/// folder.
ZipReading read_zip(std::string_view archive, const ZipLimits& limits,
                    const std::function<void(const std::string& name, std::string&& bytes)>& take);

/// A file to be put into an archive.
struct ZipMember {
  std::string name;   // relative path with "/"
  std::string bytes;  // stored as they are
  bool is_program = false;
};

/// The same members give the same bytes: no times, stored without packing.
/// @pre  fewer than 65,535 members, together less than 4 GB
std::string zip_of(const std::vector<ZipMember>& members);

}  // namespace tumble
