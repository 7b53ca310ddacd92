// Zip archives as programs write them, and as an attacker does: what is refused, and that nothing
// else happens. Archives are built field by field, so that each field can lie.
#include "framework/core/zip.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/core/tar.h"

namespace tumble::zip_test {
namespace {

using Files = std::map<std::string, std::string>;

struct Read {
  ZipReading reading;
  Files files;
  std::size_t taken = 0;
};

Read read(const std::string& archive, const ZipLimits& limits = {}) {
  Read result;
  result.reading = read_zip(archive, limits, [&](const std::string& name, std::string&& bytes) {
    ++result.taken;
    result.files[name] = std::move(bytes);
  });
  return result;
}

std::string number(std::uint32_t value, int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
  return bytes;
}

// CRC-32 of zip (polynomial 0xedb88320), bit by bit: a second implementation.
std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int i = 0; i < 8; ++i) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

// The raw stream in what zlib packs: without its 2 bytes before and 4 behind.
std::string packed(const std::string& bytes) {
  const std::string whole = deflated(bytes);
  return whole.substr(2, whole.size() - 6);
}

// One entry; fields of the local header are those of the directory unless they are set.
struct Lying {
  std::string name = "a.cpp", bytes = "int a;\n";
  bool is_packed = false;
  std::uint32_t flags = 0, mode = 0100644, made_by = 3 << 8;
  std::optional<std::string> local_name, content;
  std::optional<std::uint32_t> crc, size, local_crc, local_size, local_packed, local_method, at,
      method;
  std::string local_extra, behind;  // behind: a descriptor
};

std::string archive_of(const std::vector<Lying>& entries) {
  std::string archive, directory;
  for (const Lying& e : entries) {
    const std::string content = e.content ? *e.content : e.is_packed ? packed(e.bytes) : e.bytes;
    const std::uint32_t method = e.method.value_or(e.is_packed ? 8 : 0),
                        crc = e.crc.value_or(crc_of(e.bytes)),
                        size = e.size.value_or(static_cast<std::uint32_t>(e.bytes.size())),
                        in = static_cast<std::uint32_t>(content.size()),
                        at = e.at.value_or(static_cast<std::uint32_t>(archive.size()));
    const std::string local = e.local_name.value_or(e.name);
    archive += "PK\3\4" + number(20, 2) + number(e.flags, 2) +
               number(e.local_method.value_or(method), 2) + number(0, 4) +
               number(e.local_crc.value_or(crc), 4) + number(e.local_packed.value_or(in), 4) +
               number(e.local_size.value_or(size), 4) +
               number(static_cast<std::uint32_t>(local.size()), 2) +
               number(static_cast<std::uint32_t>(e.local_extra.size()), 2) + local + e.local_extra +
               content + e.behind;
    directory += "PK\1\2" + number(e.made_by | 20, 2) + number(20, 2) + number(e.flags, 2) +
                 number(method, 2) + number(0, 4) + number(crc, 4) + number(in, 4) +
                 number(size, 4) + number(static_cast<std::uint32_t>(e.name.size()), 2) +
                 number(0, 2) + number(0, 2) + number(0, 2) + number(0, 2) +
                 number(e.mode << 16, 4) + number(at, 4) + e.name;
  }
  const auto count = static_cast<std::uint32_t>(entries.size());
  return archive + directory + "PK\5\6" + number(0, 4) + number(count, 2) + number(count, 2) +
         number(static_cast<std::uint32_t>(directory.size()), 4) +
         number(static_cast<std::uint32_t>(archive.size()), 4) + number(0, 2);
}

Lying named(const std::string& name) {
  Lying entry;
  entry.name = name;
  return entry;
}

// The archive as a whole is refused, for this reason and with this entry's name; nothing is taken.
void expect_archive_refused(const std::string& archive, const std::string& entry,
                            const std::string& why, const ZipLimits& limits = {}) {
  const Read result = read(archive, limits);
  ASSERT_TRUE(result.reading.archive) << why;
  EXPECT_EQ(result.reading.archive->entry, entry);
  EXPECT_NE(result.reading.archive->why.find(why), std::string::npos)
      << result.reading.archive->why;
  EXPECT_EQ(result.taken, 0u);
}

// This entry alone is refused; an honest one behind it is taken.
void expect_entry_refused(Lying entry, const std::string& why) {
  const std::string name = entry.name;
  const Read result = read(archive_of({std::move(entry), named("honest.cpp")}));
  ASSERT_FALSE(result.reading.archive) << result.reading.archive->why;
  ASSERT_EQ(result.reading.entries.size(), 1u) << why;
  EXPECT_EQ(result.reading.entries[0].entry, name);
  EXPECT_NE(result.reading.entries[0].why.find(why), std::string::npos)
      << result.reading.entries[0].why;
  EXPECT_EQ(result.files, (Files{{"honest.cpp", "int a;\n"}}));
}

TEST(ZipReader, PlainFilesComeOutStoredAndDeflated) {
  Lying deflate = named("dir/b.cpp");
  deflate.bytes = std::string(5000, 'b');
  deflate.is_packed = true;
  Lying folder = named("dir/");
  folder.bytes = "";
  folder.mode = 040755;
  Lying empty = named("empty");
  empty.bytes = "";
  const Read result = read(archive_of({named("a.cpp"), folder, deflate, empty}));
  EXPECT_FALSE(result.reading.archive);
  EXPECT_TRUE(result.reading.entries.empty());
  EXPECT_EQ(result.files,
            (Files{{"a.cpp", "int a;\n"}, {"dir/b.cpp", std::string(5000, 'b')}, {"empty", ""}}));
}

TEST(ZipReader, WhatTheWriterWritesComesBack) {
  const std::string all_bytes = [] {
    std::string bytes;
    for (int i = 0; i < 1024; ++i) bytes += static_cast<char>(i);
    return bytes;
  }();
  const std::string archive = zip_of({{"run", all_bytes, true}, {"a/\xc3\xa4.txt", "", false}});
  EXPECT_EQ(read(archive).files, (Files{{"run", all_bytes}, {"a/\xc3\xa4.txt", ""}}));
  EXPECT_EQ(archive, zip_of({{"run", all_bytes, true}, {"a/\xc3\xa4.txt", "", false}}));
}

// Writers of streams do not know the sizes when they write the local header.
TEST(ZipReader, SizesMayStandBehindTheBytes) {
  for (const bool has_signature : {true, false}) {
    Lying streamed;
    streamed.flags = 1 << 3;
    streamed.local_crc = streamed.local_size = streamed.local_packed = 0;
    const auto size = static_cast<std::uint32_t>(streamed.bytes.size());
    streamed.behind = (has_signature ? "PK\7\10" : "") + number(crc_of(streamed.bytes), 4) +
                      number(size, 4) + number(size, 4);
    EXPECT_EQ(read(archive_of({streamed, named("b")})).files.size(), 2u);
    streamed.behind[has_signature ? 4 : 0] ^= 1;
    expect_entry_refused(streamed, "behind its bytes");
  }
}

TEST(ZipReader, StreamsMayHaveWideSizesInTheirLocalHeader) {
  Lying streamed;
  streamed.flags = 1 << 3;
  streamed.local_crc = 0;
  streamed.local_size = streamed.local_packed = 0xffffffff;
  streamed.local_extra = number(1, 2) + number(16, 2) + std::string(16, '\0');
  const auto size = static_cast<std::uint32_t>(streamed.bytes.size());
  streamed.behind = "PK\7\10" + number(crc_of(streamed.bytes), 4) + number(size, 4) + number(0, 4) +
                    number(size, 4) + number(0, 4);
  EXPECT_EQ(read(archive_of({streamed})).files.size(), 1u);
}

TEST(ZipReader, NamesThatLeadOutRefuseTheArchive) {
  for (const char* const name :
       {"../a.cpp", "x/../../a.cpp", "x/..", "/etc/passwd", "\\\\host\\a", "C:/a.cpp", "..\\a.cpp"})
    expect_archive_refused(archive_of({named("ok"), named(name)}), name, "outside of its folder");
}

TEST(ZipReader, NamesThatNoFileHasRefuseTheEntry) {
  expect_entry_refused(named("x//a.cpp"), "empty part");
  expect_entry_refused(named("./a.cpp"), "empty part");
  expect_entry_refused(named("a\\b.cpp"), "backslash");
  expect_entry_refused(named(std::string("a\0b", 3)), "zero byte");
  expect_entry_refused(named(std::string(300, 'a')), "too long");
  for (const char* const name : {"\xff.cpp", "\xc0\xaf.cpp", "\xed\xa0\x80.cpp", "\xc3"})
    expect_entry_refused(named(name), "not UTF-8");
}

TEST(ZipReader, LinksAndDevicesRefuseTheEntry) {
  for (const std::uint32_t made_by : {3u << 8, 0u}) {  // also where the system says DOS
    Lying entry = named("link.cpp");
    entry.made_by = made_by;
    entry.mode = 0120777;
    expect_entry_refused(entry, "symbolic link");
    for (const std::uint32_t mode : {0010644u, 0020644u, 0060644u, 0140644u}) {
      entry.mode = mode;
      expect_entry_refused(entry, "device");
    }
  }
}

TEST(ZipReader, EncryptionAndUnknownMethodsRefuseTheEntry) {
  for (const std::uint32_t flags : {1u, 1u | 1u << 6, 1u << 13}) {
    Lying entry;
    entry.flags = flags;
    expect_entry_refused(entry, "encrypted");
  }
  Lying other;
  other.method = 12;  // bzip2
  expect_entry_refused(other, "method 12");
}

TEST(ZipReader, DoublesAndCapitalsRefuseTheLaterEntry) {
  for (const auto& [first, second, why] :
       std::vector<std::array<std::string, 3>>{{"a.cpp", "a.cpp", "there twice"},
                                               {"a.cpp", "A.cpp", "in capitals only"},
                                               {"x/a.cpp", "X/b.cpp", "in capitals only"},
                                               {"a", "a/b", "a file and a folder"},
                                               {"a/b", "a", "a file and a folder"}}) {
    const Read result = read(archive_of({named(first), named(second)}));
    ASSERT_EQ(result.reading.entries.size(), 1u) << first << ' ' << second;
    EXPECT_EQ(result.reading.entries[0].entry, second);
    EXPECT_NE(result.reading.entries[0].why.find(why), std::string::npos);
    EXPECT_EQ(result.taken, 1u);
  }
}

TEST(ZipReader, BytesThatDoNotFitTheirCrcOrSizeRefuseTheEntry) {
  Lying wrong;
  wrong.crc = 1;
  expect_entry_refused(wrong, "does not unpack");
  Lying longer;
  longer.is_packed = true;
  longer.size = 3;  // the stream goes on
  expect_entry_refused(longer, "does not unpack");
  Lying shorter;
  shorter.is_packed = true;
  shorter.size = 100;
  expect_entry_refused(shorter, "does not unpack");
  Lying broken;
  broken.is_packed = true;
  broken.content = "\xff\xff\xff\xff";
  expect_entry_refused(broken, "does not unpack");
  Lying trailing;
  trailing.is_packed = true;
  trailing.content = packed(trailing.bytes) + "more";
  expect_entry_refused(trailing, "does not unpack");
  Lying stored;
  stored.size = 3;
  expect_entry_refused(stored, "two sizes");
}

TEST(ZipReader, ALocalHeaderThatDiffersFromTheDirectoryRefusesTheEntry) {
  std::vector<Lying> all(4);
  all[0].local_name = "b.cpp";
  all[1].local_crc = 1;
  all[2].local_size = 8;
  all[3].local_method = 8;
  for (const Lying& entry : all) expect_entry_refused(entry, "differs from the directory");
}

TEST(ZipReader, OverlapsRefuseTheArchive) {
  Lying second = named("b.cpp");
  second.at = 0;
  second.local_name = "b.cpp";
  expect_archive_refused(archive_of({named("a.cpp"), second}), "b.cpp", "overlaps");
  Lying beyond = named("a.cpp");
  beyond.at = 40;  // no header there
  expect_archive_refused(archive_of({beyond}), "a.cpp", "no local header");
}

TEST(ZipReader, BombsAreRefusedByWhatTheyDeclare) {
  Lying zeros = named("zeros");
  zeros.bytes = std::string(3 << 20, '\0');  // packs a thousand times
  zeros.is_packed = true;
  expect_archive_refused(archive_of({zeros}), "zeros", "times its size");
  ZipLimits limits;
  limits.bytes_each = 10;
  Lying large = named("large");
  large.bytes = std::string(11, 'x');
  expect_archive_refused(archive_of({large}), "large", "at most 10", limits);
  limits = {};
  limits.bytes_all = 20;
  expect_archive_refused(archive_of({named("a"), named("b"), named("c")}), "c", "more than 20",
                         limits);
  limits = {};
  limits.entries = 2;
  expect_archive_refused(archive_of({named("a"), named("b"), named("c")}), "", "3 entries", limits);
}

TEST(ZipReader, WhatIsNoWholeArchiveIsRefused) {
  const std::string archive = archive_of({named("a")});
  expect_archive_refused("", "", "its end is missing");
  expect_archive_refused("PK", "", "its end is missing");
  expect_archive_refused(archive.substr(0, archive.size() - 1), "", "its end is missing");
  expect_archive_refused(archive + "x", "", "its end is missing");
  expect_archive_refused("x" + archive, "", "does not fit together");
  std::string parts = archive;
  parts[parts.size() - 18] = 1;  // number of this disk
  expect_archive_refused(parts, "", "one of several parts");
  std::string wide = archive;
  wide.replace(wide.size() - 6, 4, "\xff\xff\xff\xff");
  expect_archive_refused(wide, "", "64-bit extension");
}

// What holds for any bytes: no crash (under the sanitizers of the preset asan, too), every name safe
// and none twice, no more than the limits allow, and the bytes of a taken file have the CRC of the
// directory, which only an honest entry or one in 2^32 has.
class Mutations : public ::testing::Test {
 protected:
  std::string valid() {
    std::vector<Lying> entries;
    const std::vector<std::string> names = {"a.cpp", "d/b.cpp", "d/e/c.h", "../x", "\xc3\xa4"};
    for (const std::string& name : names) {
      Lying entry = named(name == "../x" ? "e.txt" : name);
      entry.bytes = std::string(pick(200), static_cast<char>('a' + pick(26)));
      entry.is_packed = pick(2) == 1;
      if (pick(4) == 0) {
        entry.flags = 1 << 3;
        const auto in = static_cast<std::uint32_t>(entry.is_packed ? packed(entry.bytes).size()
                                                                   : entry.bytes.size());
        entry.behind = "PK\7\10" + number(crc_of(entry.bytes), 4) + number(in, 4) +
                       number(static_cast<std::uint32_t>(entry.bytes.size()), 4);
      }
      entries.push_back(entry);
    }
    return archive_of(entries);
  }
  std::string mutated(std::string bytes) {
    static const std::vector<std::string> words = {
        "PK\1\2", "PK\3\4", "PK\5\6",          "PK\7\10",          "../",
        "/",      "\\",     std::string(2, 0), "\xff\xff\xff\xff", "a.cpp"};
    for (std::size_t n = 1 + pick(4); n > 0 && !bytes.empty(); --n) {
      const std::size_t at = pick(bytes.size());
      switch (pick(6)) {
        case 0: bytes[at] = static_cast<char>(pick(256)); break;
        case 1: bytes[at] = static_cast<char>(bytes[at] ^ 1 << pick(8)); break;
        case 2: bytes.erase(at, 1 + pick(30)); break;
        case 3: bytes.insert(at, bytes.substr(pick(bytes.size()), pick(80))); break;
        case 4:
          bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at), words[pick(10)]);
          break;
        default: bytes.resize(at);
      }
    }
    return bytes;
  }
  std::size_t pick(std::size_t below) { return random_() % below; }
  std::mt19937 random_{20261124};
};

TEST_F(Mutations, NeverLeadOutsideNorBeyondTheLimits) {
  ZipLimits limits;
  limits.entries = 8;
  limits.bytes_each = 4096;
  limits.bytes_all = 8192;
  int untouched = 0, in_part = 0, refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Read result = read(mutated(valid()), limits);
    std::uint64_t all = 0;
    for (const auto& [name, bytes] : result.files) {
      EXPECT_FALSE(name.empty() || name.front() == '/' || name.find("..") == 0 ||
                   name.find("/..") != std::string::npos || name.find('\0') != std::string::npos)
          << i;
      EXPECT_LE(bytes.size(), limits.bytes_each) << i;
      all += bytes.size();
    }
    EXPECT_LE(all, limits.bytes_all) << i;
    EXPECT_EQ(result.files.size(), result.taken) << i << ": a name twice";
    if (result.reading.archive) {
      EXPECT_EQ(result.taken, 0u) << i;
      ++refused;
    } else {
      ++(result.reading.entries.empty() ? untouched : in_part);
    }
  }
  // The generator reaches every outcome.
  EXPECT_GT(untouched, 100);
  EXPECT_GT(in_part, 1000);
  EXPECT_GT(refused, 1000);
}

// tar itself reads it back.
TEST(TarWriter, TarReadsIt) {
  if (std::system("command -v tar >/dev/null") != 0) GTEST_SKIP() << "no tar here";
  const PrivateFolder folder;
  write_whole(folder.path() / "a.tar", tar_of({{"bin/run", "#!/bin/sh\necho ran\n", true},
                                               {"text", std::string(513, 't'), false}}));
  const std::string at = "cd '" + folder.path().string() + "' && ";
  ASSERT_EQ(std::system((at + "tar xf a.tar && ./bin/run >said").c_str()), 0);
  EXPECT_EQ(text_of(folder.path() / "said"), "ran\n");
  EXPECT_EQ(text_of(folder.path() / "text"), std::string(513, 't'));
}

}  // namespace
}  // namespace tumble::zip_test
