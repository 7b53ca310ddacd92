#include "framework/core/files.h"

#include <cstdlib>
#include <fstream>

#include <unistd.h>

#include "framework/core/error.h"

namespace tumble {
namespace {

UserError cannot_write(const std::filesystem::path& file, const std::string& reason) {
  return {file.string(), "cannot be written" + (reason.empty() ? "" : " (" + reason + ")"),
          "Is there room on the disk, and may you write to this folder?"};
}

// Goes away with the draft that it names, unless that was renamed.
struct Draft {
  std::filesystem::path path;
  ~Draft() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

}  // namespace

void make_whole(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& make) {
  std::error_code failed;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failed);
  if (failed) throw cannot_write(file, failed.message());
  const std::string name = '.' + file.stem().string() + ".draft" + std::to_string(::getpid()) + file.extension().string();
  const Draft draft{file.parent_path() / name};
  make(draft.path);
  std::filesystem::rename(draft.path, file, failed);
  if (failed) throw cannot_write(file, failed.message());
}

void write_whole(const std::filesystem::path& file, std::string_view bytes) {
  make_whole(file, [&](const std::filesystem::path& draft) {
    std::ofstream out(draft, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) throw cannot_write(file, "");
  });
}

PrivateFolder::PrivateFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "tumble-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw UserError(std::filesystem::temp_directory_path().string(), "no folder can be made there", "Free some space, or name another place in TMPDIR.");
  path_ = name;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace tumble
