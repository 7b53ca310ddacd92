#include "framework/grading/handins/unpack.h"

#include <fstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// Names were checked by read_zip, and nothing but this writes below the folder.
ZipReading unpack(const std::string& bytes, const ZipLimits& limits, const fs::path& folder) {
  return read_zip(bytes, limits, [&](const std::string& name, std::string&& content) {
    const fs::path file = folder / name;
    fs::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary);
    out << content;
    if (!out.flush())
      throw UserError(plain_name(file.string()), "cannot be written", "Is the disk full?");
  });
}

}  // namespace

std::string in_words(const ZipFault& fault) {
  return (fault.entry.empty() ? "it" : plain_name(fault.entry)) + " " + plain_name(fault.why);
}

std::vector<ZipFault> unpack_class(const fs::path& archive, const fs::path& folder) {
  std::string why;
  const auto bytes = read_plain_file(archive, kClassZipBytes, why);
  const char* const kRemedy = "Unpack it yourself, and give the folder.";
  if (!bytes) throw UserError(plain_name(archive.string()), why, kRemedy);
  const ZipReading reading = unpack(*bytes, kClassZip, folder);
  if (reading.archive)
    throw UserError(plain_name(archive.string()), "is not unpacked: " + in_words(*reading.archive),
                    kRemedy);
  return reading.entries;
}

std::string unpack_submission(const fs::path& archive, const fs::path& folder) {
  const std::string name = plain_name(archive.filename().string());
  std::string why;
  const auto bytes = read_plain_file(archive, kStudentZipBytes, why);
  if (!bytes) return name + ' ' + why + '.';
  const ZipReading reading = unpack(*bytes, kStudentZip, folder);
  const ZipFault* fault = reading.archive            ? &*reading.archive
                          : !reading.entries.empty() ? &reading.entries.front()
                                                     : nullptr;
  if (fault == nullptr) return "";
  return name + " is not unpacked: " + in_words(*fault) + ". Hand in the source file itself.";
}

}  // namespace tumble::grading
