#include <zlib.h>

#include "framework/core/error.h"
#include "framework/core/zip.h"

namespace tumble {
namespace {

void put(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
}

std::uint32_t crc_of(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// From "version needed" to "extra length": the same in the local header and in the directory.
void put_common(std::string& bytes, const ZipMember& member) {
  constexpr std::uint32_t kVersion = 20, kUtf8 = 1u << 11, kStored = 0;
  constexpr std::uint32_t kMidnight = 0, kFirstDay = 0x21;  // 1 January 1980
  put(bytes, kVersion, 2);
  put(bytes, kUtf8, 2);
  put(bytes, kStored, 2);
  put(bytes, kMidnight, 2);
  put(bytes, kFirstDay, 2);
  put(bytes, crc_of(member.bytes), 4);
  put(bytes, static_cast<std::uint32_t>(member.bytes.size()), 4);
  put(bytes, static_cast<std::uint32_t>(member.bytes.size()), 4);
  put(bytes, static_cast<std::uint32_t>(member.name.size()), 2);
  put(bytes, 0, 2);
}

}  // namespace

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_COMPRESSION);
  require(status == Z_OK, "core: zlib could not pack bytes");
  packed.resize(size);
  return packed;
}

std::string zip_of(const std::vector<ZipMember>& members) {
  std::uint64_t size = 0;
  for (const ZipMember& member : members) size += member.bytes.size() + 3 * member.name.size();
  require(members.size() < 0xffff && size < 0xf0000000u,
          "core: too much for an archive without the 64-bit extension");
  std::string archive, directory;
  for (const ZipMember& member : members) {
    const auto at = static_cast<std::uint32_t>(archive.size());
    archive += "PK\3\4";
    put_common(archive, member);
    archive += member.name + member.bytes;

    constexpr std::uint32_t kByUnix = 3 << 8 | 20;
    const std::uint32_t mode = member.is_program ? 0100755 : 0100644;
    directory += "PK\1\2";
    put(directory, kByUnix, 2);
    put_common(directory, member);
    put(directory, 0, 2);  // length of a comment
    put(directory, 0, 2);  // disk
    put(directory, 0, 2);  // internal attributes
    put(directory, mode << 16, 4);
    put(directory, at, 4);
    directory += member.name;
  }
  const auto at = static_cast<std::uint32_t>(archive.size()),
             count = static_cast<std::uint32_t>(members.size());
  archive += directory + "PK\5\6";
  put(archive, 0, 4);  // disks
  put(archive, count, 2);
  put(archive, count, 2);
  put(archive, static_cast<std::uint32_t>(directory.size()), 4);
  put(archive, at, 4);
  put(archive, 0, 2);  // length of a comment
  return archive;
}

}  // namespace tumble
