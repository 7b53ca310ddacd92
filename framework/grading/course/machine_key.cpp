#include "framework/grading/course/machine_key.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/digest.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// the size of a SHA-256 digest: more adds no security (RFC 2104, section 3)
constexpr std::size_t kKeyBytes = 32;

// The content of the file, or its problem.
struct FoundKey {
  std::string bytes;    // empty: not a usable key
  std::string problem;  // empty where there is no file
};

FoundKey read_key(const fs::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0)
    return {"", errno == ENOENT  ? ""
                : errno == ELOOP ? "is a symbolic link"
                                 : std::string("cannot be read (") + std::strerror(errno) + ")"};
  struct stat about {};
  FoundKey found;
  if (::fstat(fd, &about) != 0 || !S_ISREG(about.st_mode))
    found.problem = "is not a file";
  else if (about.st_uid != ::geteuid())
    found.problem = "belongs to another user";
  else if ((about.st_mode & 077) != 0)
    found.problem = "can be read or written by others";
  else if (about.st_size != static_cast<off_t>(kKeyBytes))
    found.problem = "is not a key";
  std::string bytes(kKeyBytes, '\0');
  if (found.problem.empty() &&
      ::read(fd, bytes.data(), kKeyBytes) == static_cast<ssize_t>(kKeyBytes))
    found.bytes = bytes;
  ::close(fd);
  return found;
}

// Written under another name, then linked: two concurrent first users get the same key.
bool keep(const fs::path& file, const std::string& bytes) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  std::string draft = file.string() + ".XXXXXX";
  const int fd = ::mkstemp(draft.data());  // mode 0600
  if (fd < 0) return false;
  const bool written =
      ::write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()) &&
      ::fsync(fd) == 0;
  ::close(fd);
  const bool linked = written && (::link(draft.c_str(), file.c_str()) == 0 || errno == EEXIST);
  ::unlink(draft.c_str());
  return linked;
}

}  // namespace

fs::path machine_key_file() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  if (const std::string own = variable("TUMBLE_GRADER_KEY"); !own.empty()) return fs::absolute(own);
  if (const std::string state = variable("XDG_STATE_HOME"); state.starts_with('/'))
    return fs::path(state) / "tumble/grader.key";
  std::string home = variable("HOME");
  if (home.empty())
    if (const passwd* user = ::getpwuid(::geteuid()); user != nullptr && user->pw_dir != nullptr)
      home = user->pw_dir;
  return home.empty() ? fs::path() : fs::path(home) / ".local/state/tumble/grader.key";
}

MachineKey machine_key() {
  MachineKey key;
  key.file = machine_key_file();
  FoundKey found = key.file.empty() ? FoundKey{} : read_key(key.file);
  if (!found.bytes.empty()) return key.bytes = found.bytes, key;
  // A file that is not a key may belong to the user: it is never changed.
  if (!found.problem.empty())
    throw UserError(key.file.string(),
                    "should hold the key that signs results of this machine, but " + found.problem,
                    "Set TUMBLE_GRADER_KEY to a file that does not exist yet, or move this one "
                    "away: a new key is made, and earlier results are graded again.");
  const std::string fresh = random_bytes(kKeyBytes);
  if (!key.file.empty() && keep(key.file, fresh)) found = read_key(key.file);
  if (!found.bytes.empty()) {
    key.bytes = found.bytes;
    key.notice = "a new key of this machine was made in " + key.file.string() +
                 " (there was none): results of earlier runs are graded again";
  } else {
    key.notice = "the key of this machine cannot be stored" +
                 (key.file.empty() ? std::string() : " in " + key.file.string()) +
                 ", so the next run grades everything again. Set TUMBLE_GRADER_KEY to a file that "
                 "you may write.";
    key.bytes = fresh;
    key.file.clear();
  }
  return key;
}

}  // namespace tumble::grading
