// Reads in this order, and stops at the first thing that does not fit: the end record (4.3.16), the
// directory (4.3.12), the local headers (4.3.7) with the room of each entry, the entries' bytes.
// Only the directory is believed; a local header has to agree with it.
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <map>
#include <set>

#include "framework/core/text.h"
#include "framework/core/zip.h"

namespace tumble {
namespace {

constexpr std::uint32_t kLocal = 0x04034b50, kDirectory = 0x02014b50, kEnd = 0x06054b50,
                        kDescriptor = 0x08074b50;
constexpr std::uint64_t kLocalBytes = 30, kDirectoryBytes = 46, kEndBytes = 22;
constexpr std::uint32_t kMany32 = 0xffffffff, kMany16 = 0xffff;  // "see the 64-bit extension"
constexpr std::uint32_t kStored = 0, kDeflated = 8;
// 4.4.4: bits of the general purpose flag
constexpr std::uint32_t kEncrypted = 1 | 1u << 6 | 1u << 13, kPatch = 1u << 5, kStreamed = 1u << 3;

struct Entry {
  std::string name;
  std::uint32_t flags = 0, method = 0, crc = 0, mode = 0;
  std::uint64_t packed = 0, size = 0, at = 0;  // at: of the local header
  std::uint64_t begin = 0, end = 0;            // of the packed bytes; end of the descriptor
  std::string fault;                           // of this entry alone
  bool is_folder() const { return name.ends_with('/'); }
};

// Thrown inside read_zip only.
struct Refused {
  std::string entry, why;
};

class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t size() const { return bytes_.size(); }
  bool has(std::uint64_t at, std::uint64_t count) const {
    return at <= size() && count <= size() - at;
  }
  // @pre has(at, count)
  std::uint64_t number(std::uint64_t at, int count) const {
    std::uint64_t value = 0;
    for (int i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes_[at + i]);
    return value;
  }
  std::uint32_t u16(std::uint64_t at) const { return static_cast<std::uint32_t>(number(at, 2)); }
  std::uint32_t u32(std::uint64_t at) const { return static_cast<std::uint32_t>(number(at, 4)); }
  std::string_view part(std::uint64_t at, std::uint64_t count) const {
    return bytes_.substr(at, count);
  }

 private:
  std::string_view bytes_;
};

// Unicode 15, table 3-7: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned first = byte(i);
    const std::size_t more = first < 0x80 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    if ((first >= 0x80 && first < 0xc2) || first > 0xf4 || i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k)
      if ((byte(i + k) & 0xc0) != 0x80) return false;
    if ((first == 0xe0 && byte(i + 1) < 0xa0) || (first == 0xed && byte(i + 1) > 0x9f) ||
        (first == 0xf0 && byte(i + 1) < 0x90) || (first == 0xf4 && byte(i + 1) > 0x8f))
      return false;
    i += more + 1;
  }
  return true;
}

std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts(1);
  for (const char c : name) {
    if (c == '/')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  if (parts.back().empty()) parts.pop_back();  // a folder's last "/"
  return parts;
}

// Whether the name leads out of the folder that it is unpacked in, on any system.
bool leads_out(const std::string& name) {
  if (name.starts_with('/') || name.starts_with('\\')) return true;
  if (name.size() > 1 && name[1] == ':') return true;  // C:
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const auto parts = parts_of(slashes);
  return std::find(parts.begin(), parts.end(), "..") != parts.end();
}

std::string why_not_name(const std::string& name) {
  constexpr std::size_t kLongestPart = 255, kLongest = 2000;  // bytes: as file systems have it
  if (name.find('\0') != std::string::npos) return "has a name with a zero byte";
  if (name.find('\\') != std::string::npos) return "has a backslash in its name";
  if (!is_utf8(name)) return "has a name that is not UTF-8";
  if (name.size() > kLongest) return "has a name that is too long";
  const auto parts = parts_of(name);
  if (parts.empty()) return "has no name";
  for (const std::string& part : parts) {
    if (part.empty() || part == ".") return "has an empty part in its path";
    if (part.size() > kLongestPart) return "has a name that is too long";
  }
  return "";
}

std::string why_not_kind(const Entry& entry) {
  if (entry.flags & kEncrypted) return "is encrypted";
  if (entry.flags & kPatch) return "is a patch of another file";
  const std::uint32_t type = entry.mode & S_IFMT;
  if (type == S_IFLNK) return "is a symbolic link";
  if (type != 0 && type != S_IFREG && type != S_IFDIR) return "is a device, a pipe or a socket";
  if ((type == S_IFDIR && !entry.is_folder()) || (type == S_IFREG && entry.is_folder()))
    return "is named as a folder and is a file, or the other way round";
  if (entry.is_folder() && entry.size != 0) return "is a folder with bytes in it";
  if (entry.method != kStored && entry.method != kDeflated)
    return "is packed by method " + std::to_string(entry.method) + "; known are store and deflate";
  if (entry.method == kStored && entry.packed != entry.size) return "is stored, and has two sizes";
  return "";
}

// 4.3.16. The end record's comment reaches exactly to the end of the file.
std::uint64_t place_of_end(const Bytes& bytes) {
  std::optional<std::uint64_t> found;
  for (std::uint64_t comment = 0; comment <= kMany16; ++comment) {
    if (bytes.size() < kEndBytes + comment) break;
    const std::uint64_t at = bytes.size() - kEndBytes - comment;
    if (bytes.u32(at) != kEnd || bytes.u16(at + 20) != comment) continue;
    if (found) throw Refused{"", "has several ends"};
    found = at;
  }
  if (!found) throw Refused{"", "is not a whole zip archive: its end is missing"};
  return *found;
}

Entry entry_at(const Bytes& bytes, std::uint64_t& at, std::uint64_t end) {
  if (at > end || end - at < kDirectoryBytes || bytes.u32(at) != kDirectory)
    throw Refused{"", "has a directory that does not fit together"};
  const std::uint64_t name = bytes.u16(at + 28), extra = bytes.u16(at + 30),
                      comment = bytes.u16(at + 32);
  if (end - at < kDirectoryBytes + name + extra + comment)
    throw Refused{"", "has a directory that does not fit together"};
  Entry entry;
  entry.name = bytes.part(at + kDirectoryBytes, name);
  entry.flags = bytes.u16(at + 8);
  entry.method = bytes.u16(at + 10);
  entry.crc = bytes.u32(at + 16);
  entry.packed = bytes.u32(at + 20);
  entry.size = bytes.u32(at + 24);
  entry.mode = bytes.u32(at + 38) >> 16;
  entry.at = bytes.u32(at + 42);
  if (bytes.u16(at + 34) != 0) throw Refused{entry.name, "lies on another disk"};
  if (entry.packed == kMany32 || entry.size == kMany32 || entry.at == kMany32)
    throw Refused{entry.name, "needs the 64-bit extension of the format"};
  at += kDirectoryBytes + name + extra + comment;
  return entry;
}

std::vector<Entry> directory_of(const Bytes& bytes, const ZipLimits& limits,
                                std::uint64_t& begins) {
  const std::uint64_t end = place_of_end(bytes);
  const std::uint32_t count = bytes.u16(end + 10);
  const std::uint64_t size = bytes.u32(end + 12);
  begins = bytes.u32(end + 16);
  if (count == kMany16 || size == kMany32 || begins == kMany32)
    throw Refused{"", "needs the 64-bit extension of the format"};
  if (bytes.u32(end + 4) != 0 || bytes.u16(end + 8) != count)
    throw Refused{"", "is one of several parts"};
  if (begins > end || end - begins != size)
    throw Refused{"", "has a directory that does not fit together"};
  if (count > limits.entries)
    throw Refused{"", "has " + std::to_string(count) + " entries; at most " +
                          std::to_string(limits.entries) + " are unpacked"};
  std::vector<Entry> entries;
  std::uint64_t at = begins;
  for (std::uint32_t i = 0; i < count; ++i) entries.push_back(entry_at(bytes, at, end));
  if (at != end) throw Refused{"", "has a directory that does not fit together"};
  return entries;
}

void refuse_bombs(const std::vector<Entry>& entries, const ZipLimits& limits) {
  std::uint64_t all = 0;
  for (const Entry& entry : entries) {
    all += entry.size;
    if (entry.size > limits.bytes_each)
      throw Refused{entry.name, "would unpack to " + std::to_string(entry.size) +
                                    " bytes; at most " + std::to_string(limits.bytes_each) +
                                    " are unpacked"};
    if (entry.size > limits.bytes_free &&
        static_cast<double>(entry.size) > limits.ratio * static_cast<double>(entry.packed))
      throw Refused{entry.name, "would unpack to more than " +
                                    std::to_string(static_cast<long>(limits.ratio)) +
                                    " times its size"};
    if (all > limits.bytes_all)
      throw Refused{entry.name, "and the entries before it would unpack to more than " +
                                    std::to_string(limits.bytes_all) + " bytes"};
  }
}

// 4.5.3: the sizes of a local header in the extra field of the 64-bit extension, which writers of
// streams use for small files, too.
bool has_extended_sizes(const Bytes& bytes, std::uint64_t at, std::uint64_t end,
                        std::uint64_t& size, std::uint64_t& packed) {
  while (end - at >= 4) {
    const std::uint32_t id = bytes.u16(at);
    const std::uint64_t length = bytes.u16(at + 2);
    at += 4;
    if (length > end - at) return false;
    if (id == 1 && length >= 16) {
      size = bytes.number(at, 8);
      packed = bytes.number(at + 8, 8);
      return true;
    }
    at += length;
  }
  return false;
}

// 4.3.9: CRC and sizes behind the bytes of a streamed entry, with or without a signature, of 4 or 8
// bytes. @return its length; 0 where it does not agree with the directory
std::uint64_t descriptor_at(const Bytes& bytes, std::uint64_t at, const Entry& entry) {
  for (const std::uint64_t sign : {4, 0})
    for (const int wide : {4, 8}) {
      const std::uint64_t length = sign + 4 + 2 * static_cast<std::uint64_t>(wide);
      if (!bytes.has(at, length) || (sign != 0 && bytes.u32(at) != kDescriptor)) continue;
      if (bytes.u32(at + sign) == entry.crc && bytes.number(at + sign + 4, wide) == entry.packed &&
          bytes.number(at + sign + 4 + static_cast<std::uint64_t>(wide), wide) == entry.size)
        return length;
    }
  return 0;
}

// Finds the entry's bytes; says where its local header differs from the directory.
void read_local_header(const Bytes& bytes, std::uint64_t directory, Entry& entry) {
  const std::uint64_t at = entry.at;
  if (at > directory || directory - at < kLocalBytes || bytes.u32(at) != kLocal)
    throw Refused{entry.name, "has no local header where the directory says"};
  const std::uint64_t name = bytes.u16(at + 26), extra = bytes.u16(at + 28);
  if (directory - at < kLocalBytes + name + extra ||
      directory - at - kLocalBytes - name - extra < entry.packed)
    throw Refused{entry.name, "reaches into the directory"};
  const std::uint64_t extras = at + kLocalBytes + name;
  entry.begin = extras + extra;
  entry.end = entry.begin + entry.packed;

  constexpr std::uint32_t kTold = kEncrypted | kPatch | kStreamed;
  const bool is_streamed = entry.flags & kStreamed;
  std::uint64_t packed = bytes.u32(at + 18), size = bytes.u32(at + 22);
  if (packed == kMany32 && size == kMany32)
    has_extended_sizes(bytes, extras, extras + extra, size, packed);
  const auto agrees = [&](std::uint64_t local, std::uint64_t told) {
    return local == told || (is_streamed && local == 0);
  };
  const bool same = bytes.part(at + kLocalBytes, name) == entry.name &&
                    bytes.u16(at + 8) == entry.method &&
                    (bytes.u16(at + 6) & kTold) == (entry.flags & kTold) &&
                    agrees(bytes.u32(at + 14), entry.crc) && agrees(packed, entry.packed) &&
                    agrees(size, entry.size);
  if (!same) entry.fault = "has a local header that differs from the directory";
  if (!is_streamed) return;
  const std::uint64_t length = descriptor_at(bytes, entry.end, entry);
  if (length == 0) entry.fault = "has sizes behind its bytes that differ from the directory";
  entry.end += length;
  if (entry.end > directory) throw Refused{entry.name, "reaches into the directory"};
}

// Entries that share bytes unpack to more than the archive holds.
void refuse_overlaps(const std::vector<Entry>& entries) {
  std::vector<const Entry*> order;
  for (const Entry& entry : entries) order.push_back(&entry);
  std::sort(order.begin(), order.end(),
            [](const Entry* a, const Entry* b) { return a->at < b->at; });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (order[i]->at < order[i - 1]->end)
      throw Refused{order[i]->name, "overlaps " + order[i - 1]->name};
}

// Paths that would be one file, or a file and a folder, where capitals make no difference.
class Paths {
 public:
  std::string why_not(const Entry& entry) {
    std::string path;
    const auto parts = parts_of(entry.name);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      path += (i > 0 ? "/" : "") + parts[i];
      const bool is_folder = i + 1 < parts.size() || entry.is_folder();
      const auto [it, is_new] = seen_.insert({lowercase(path), {path, is_folder}});
      if (is_new) continue;
      const auto& [other, was_folder] = it->second;
      if (is_folder && was_folder && other == path) continue;
      if (other != path) return "differs from " + other + " in capitals only";
      return is_folder || was_folder ? "is a file and a folder" : "is there twice";
    }
    return "";
  }

 private:
  std::map<std::string, std::pair<std::string, bool>> seen_;
};

// @return nothing where the bytes do not unpack to exactly their size
std::optional<std::string> inflated(std::string_view packed, std::uint64_t size) {
  std::string bytes(size + 1, '\0');  // one more, so that a longer stream is seen
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return std::nullopt;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int status = inflate(&stream, Z_FINISH);
  const bool is_whole = status == Z_STREAM_END && stream.total_out == size && stream.avail_in == 0;
  inflateEnd(&stream);
  if (!is_whole) return std::nullopt;
  bytes.resize(size);
  return bytes;
}

std::optional<std::string> bytes_of(const Bytes& archive, const Entry& entry) {
  const std::string_view packed = archive.part(entry.begin, entry.packed);
  std::optional<std::string> bytes =
      entry.method == kStored ? std::string(packed) : inflated(packed, entry.size);
  if (!bytes) return std::nullopt;
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes->data()), bytes->size());
  return crc == entry.crc ? bytes : std::nullopt;
}

std::vector<Entry> checked_entries(const Bytes& bytes, const ZipLimits& limits) {
  std::uint64_t directory = 0;
  std::vector<Entry> entries = directory_of(bytes, limits, directory);
  for (const Entry& entry : entries)
    if (leads_out(entry.name)) throw Refused{entry.name, "would be unpacked outside of its folder"};
  refuse_bombs(entries, limits);
  for (Entry& entry : entries) read_local_header(bytes, directory, entry);
  refuse_overlaps(entries);
  Paths paths;
  for (Entry& entry : entries) {
    std::string why = why_not_name(entry.name);
    if (why.empty()) why = why_not_kind(entry);
    if (why.empty()) why = entry.fault;
    if (why.empty()) why = paths.why_not(entry);
    entry.fault = why;
  }
  return entries;
}

}  // namespace

ZipReading read_zip(std::string_view archive, const ZipLimits& limits,
                    const std::function<void(const std::string& name, std::string&& bytes)>& take) {
  ZipReading reading;
  const Bytes bytes(archive);
  std::vector<Entry> entries;
  try {
    entries = checked_entries(bytes, limits);
  } catch (const Refused& refused) {
    reading.archive = {refused.entry, refused.why};
    return reading;
  }
  for (const Entry& entry : entries) {
    if (!entry.fault.empty()) {
      reading.entries.push_back({entry.name, entry.fault});
      continue;
    }
    if (entry.is_folder()) continue;
    if (std::optional<std::string> unpacked = bytes_of(bytes, entry))
      take(entry.name, std::move(*unpacked));
    else
      reading.entries.push_back({entry.name, "does not unpack to the bytes that it was made of"});
  }
  return reading;
}

}  // namespace tumble
