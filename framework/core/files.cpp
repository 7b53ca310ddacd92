#include "framework/core/files.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "framework/core/error.h"

namespace tumble {
namespace {

UserError cannot_write(
    const std::filesystem::path& file, const std::string& reason,
    const std::string& remedy = "Is there room on the disk, and may you write to this folder?") {
  return {file.string(), "cannot be written" + (reason.empty() ? "" : " (" + reason + ")"), remedy};
}

namespace fs = std::filesystem;

constexpr const char* kNameAnother = "Name another file.";

// A link is replaced, as a file is: what it points to may belong to others. Nothing takes the place
// of a folder, a pipe or a device, nor of a link to these.
void refuse_other_than_files(const fs::path& file) {
  std::error_code failed;
  const fs::file_type type = fs::status(file, failed).type();
  if (type == fs::file_type::directory && !fs::is_symlink(fs::symlink_status(file, failed)))
    throw cannot_write(file, "it is a folder", kNameAnother);
  if (type == fs::file_type::fifo || type == fs::file_type::character ||
      type == fs::file_type::block || type == fs::file_type::socket)
    throw cannot_write(file, "it is no plain file", kNameAnother);
}

// Removes the draft when it goes out of scope; after the rename there is nothing left to remove.
struct Draft {
  std::filesystem::path path;
  ~Draft() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

}  // namespace

fs::path behind_links(const fs::path& file) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code failed;
  fs::path target = file;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, failed)); ++links) {
    if (links == kMostLinks) throw cannot_write(file, "it is a loop of links", kNameAnother);
    const fs::path next = fs::read_symlink(target, failed);
    if (failed) throw cannot_write(file, failed.message());
    target = target.parent_path() / next;  // next alone where it is absolute
  }
  return target;
}

void expect_writable(const fs::path& file) {
  refuse_other_than_files(file);
  fs::path there = file;  // what has to let us write
  std::error_code failed;
  do there = there.parent_path();
  while (!there.empty() && there.has_relative_path() && !fs::exists(there, failed));
  if (there.empty()) there = ".";
  if (!fs::is_directory(there, failed)) throw cannot_write(file, there.string() + " is no folder");
  if (::access(there.c_str(), W_OK | X_OK) != 0) throw cannot_write(file, std::strerror(errno));
}

void make_whole(const fs::path& file, const std::function<void(const fs::path&)>& make) {
  refuse_other_than_files(file);
  std::error_code failed;
  const fs::path folder = file.parent_path();
  if (!folder.empty()) fs::create_directories(folder, failed);
  if (failed) throw cannot_write(file, failed.message());
  const std::string name = '.' + file.stem().string() + ".draft" + std::to_string(::getpid()) +
                           file.extension().string();
  const Draft draft{folder / name};
  make(draft.path);
  fs::rename(draft.path, file, failed);
  if (failed) throw cannot_write(file, failed.message());
}

void write_whole(const std::filesystem::path& file, std::string_view bytes) {
  make_whole(file, [&](const std::filesystem::path& draft) {
    std::ofstream out(draft, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) throw cannot_write(file, "");
  });
}

int hold_folder(const std::filesystem::path& folder) {
  const int alive = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (alive >= 0) ::flock(alive, LOCK_SH | LOCK_NB);
  return alive;
}

void sweep_folders_of_the_dead(const std::filesystem::path& where, const std::string& name) {
  std::error_code failed;
  for (fs::directory_iterator it(where, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string folder = it->path().filename().string();
    if (!folder.starts_with(name)) continue;
    char* rest = nullptr;
    const long maker = std::strtol(folder.c_str() + name.size(), &rest, 10);
    if (maker <= 0 || *rest != '-' || ::kill(static_cast<pid_t>(maker), 0) == 0 || errno != ESRCH)
      continue;
    // Neither a link nor locked: a maker in another container has a process id that does not exist
    // here, but it holds the lock.
    const int fd = ::open(it->path().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0) continue;
    std::error_code ignored;  // a folder of another user cannot be removed, and stays
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) fs::remove_all(it->path(), ignored);
    ::close(fd);
  }
}

PrivateFolder::PrivateFolder() {
  constexpr const char* kName = "tumble-own-";
  const std::filesystem::path where = std::filesystem::temp_directory_path();
  static const bool swept = (sweep_folders_of_the_dead(where, kName), true);
  (void)swept;
  std::string name = (where / (kName + std::to_string(::getpid()) + "-XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr)
    throw UserError(where.string(), "no folder can be made there",
                    "Free some space, or name another place in TMPDIR.");
  path_ = name;
  alive_ = hold_folder(path_);
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (alive_ >= 0) ::close(alive_);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::optional<std::string> read_plain_file(const std::filesystem::path& file,
                                           std::uint64_t most_bytes, std::string& why) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  struct stat about {};
  const bool opened = fd >= 0;
  if (!opened)
    why = errno == ELOOP ? "is a link; hand in the file itself" : "cannot be read";
  else if (::fstat(fd, &about) != 0 || !S_ISREG(about.st_mode))
    why = "is not a file";
  else if (static_cast<std::uint64_t>(about.st_size) > most_bytes)
    why = "is larger than " + std::to_string(most_bytes >> 10) + " KiB";
  std::string text(why.empty() ? static_cast<std::size_t>(about.st_size) : 0, '\0');
  std::size_t got = 0;
  while (got < text.size()) {
    const ssize_t n = ::read(fd, text.data() + got, text.size() - got);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) why = std::string("cannot be read to its end: ") + std::strerror(errno);
    if (n <= 0) break;
    got += static_cast<std::size_t>(n);
  }
  if (opened) ::close(fd);
  if (!why.empty()) return std::nullopt;
  text.resize(got);
  return text;
}

}  // namespace tumble
