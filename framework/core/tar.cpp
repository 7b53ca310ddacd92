#include "framework/core/tar.h"

#include <cstdio>

#include "framework/core/error.h"

namespace tumble {
namespace {

constexpr std::size_t kBlock = 512;

// A number as octal digits and a zero byte, in `width` bytes.
void put_octal(std::string& header, std::size_t at, std::size_t width, std::size_t value) {
  char digits[24];
  std::snprintf(digits, sizeof digits, "%0*zo", static_cast<int>(width - 1), value);
  header.replace(at, width - 1, digits);
}

std::string header_of(const ZipMember& member) {
  require(member.name.size() <= 100, "core: a name in a tar archive has at most 100 bytes");
  std::string header(kBlock, '\0');
  header.replace(0, member.name.size(), member.name);
  put_octal(header, 100, 8, member.is_program ? 0755 : 0644);
  put_octal(header, 108, 8, 0);  // owner
  put_octal(header, 116, 8, 0);  // group
  put_octal(header, 124, 12, member.bytes.size());
  put_octal(header, 136, 12, 0);       // time
  header.replace(148, 8, "        ");  // the sum is made with spaces in its place
  header[156] = '0';                   // a plain file
  header.replace(257, 5, "ustar");
  header.replace(263, 2, "00");
  std::size_t sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  put_octal(header, 148, 7, sum);
  header[154] = '\0';
  return header;
}

}  // namespace

std::string tar_of(const std::vector<ZipMember>& members) {
  std::string archive;
  for (const ZipMember& member : members) {
    archive += header_of(member) + member.bytes;
    archive.append((kBlock - archive.size() % kBlock) % kBlock, '\0');
  }
  return archive.append(2 * kBlock, '\0');
}

}  // namespace tumble
