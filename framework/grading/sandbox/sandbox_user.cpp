// Uids and folders for sandboxes.
#include <fcntl.h>
#include <linux/capability.h>
#include <pwd.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/sandbox/sandbox_user.h"

namespace tumble::grading {
namespace {

// High in the range of ordinary users, where ids are usually free; an id in use is skipped.
constexpr uid_t kFirstUid = 58100;
constexpr uid_t kUids = 64;  // concurrent jobs
constexpr uid_t kFirstRun = kFirstUid + kUids;
// concurrent runs: while one of a job ends, its next one begins
constexpr uid_t kRuns = 128;
constexpr const char* kLockFolder = "/run/tumble";

// A stage's name contains its maker's process id, so that stages of killed processes can be found
// and removed.
constexpr const char* kStageFolder = "/tmp";
constexpr const char* kStageName = "tumble-stage-";

// Locks do not show a grader in a container with another /run; its processes do show where they are
// shared, and then ending all of a uid would end that grader's too.
bool has_process(uid_t uid) {
  std::error_code failed;
  for (std::filesystem::directory_iterator it("/proc", failed), end; !failed && it != end;
       it.increment(failed)) {
    const std::string name = it->path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    struct stat about {};
    if (::stat(it->path().c_str(), &about) == 0 && about.st_uid == uid) return true;
  }
  return false;
}

}  // namespace

void sweep_stages_of_the_dead() { sweep_folders_of_the_dead(kStageFolder, kStageName); }

bool can_change_user() {
  if (::geteuid() != 0) return false;
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[2] = {};
  if (::syscall(SYS_capget, &head, sets) != 0) return false;
  for (const int needed :
       {CAP_CHOWN, CAP_DAC_OVERRIDE, CAP_FOWNER, CAP_KILL, CAP_SETGID, CAP_SETUID})
    if ((sets[0].effective & (1u << needed)) == 0) return false;
  return true;
}

SandboxUser SandboxUser::lease() { return lease_between(kFirstUid, kFirstUid + kUids); }
SandboxUser SandboxUser::lease_for_run() { return lease_between(kFirstRun, kFirstRun + kRuns); }

SandboxUser SandboxUser::lease_between(uid_t first, uid_t end) {
  SandboxUser user;
  if (!can_change_user()) return user;
  ::mkdir(kLockFolder, 0700);
  for (uid_t uid = first; uid < end; ++uid) {
    if (::getpwuid(uid) != nullptr) continue;
    const std::string file = fmt::format("{}/uid-{}", kLockFolder, uid);
    const int lock = ::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (lock < 0)
      throw UserError(
          file, "cannot be opened",
          "It records which sandbox uses which user id; root must be able to write it.");
    if (::flock(lock, LOCK_EX | LOCK_NB) == 0 && !has_process(uid)) {
      user.lock_ = lock;
      user.uid_ = uid;
      return user;
    }
    ::close(lock);
  }
  throw UserError(kLockFolder, "all user ids for sandboxes are in use", "Use fewer --jobs.");
}

SandboxUser::SandboxUser(SandboxUser&& other) noexcept : uid_(other.uid_), lock_(other.lock_) {
  other.lock_ = -1;
}

SandboxUser::~SandboxUser() {
  if (lock_ >= 0) ::close(lock_);
}

Stage::Stage(const SandboxUser* user) {
  static const bool swept = (sweep_stages_of_the_dead(), true);
  (void)swept;
  // Not the user's TMPDIR, which may be in a folder that another uid cannot enter.
  std::string name = fmt::format("{}/{}{}-XXXXXX", kStageFolder, kStageName, ::getpid());
  if (::mkdtemp(name.data()) == nullptr)
    throw UserError(kStageFolder, "no folder can be created in it");
  path_ = name;
  alive_ = hold_folder(path_);
  if (user != nullptr) owner_ = user->uid();
  hand_over(path_, owner_ ? 0750 : user != nullptr ? 0700 : 0755);
}

Stage::~Stage() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (alive_ >= 0) ::close(alive_);
}

void Stage::hand_over(const std::filesystem::path& file, unsigned mode) const {
  if (::chmod(file.c_str(), mode) != 0)
    throw UserError(file.string(), "its permissions cannot be set");
  if (owner_ && ::lchown(file.c_str(), *owner_, *owner_) != 0)
    throw UserError(file.string(), "its owner cannot be set");
}

std::filesystem::path Stage::add_file(const std::filesystem::path& from, const std::string& name,
                                      bool executable) {
  const auto to = path_ / name;
  for (auto folder = std::filesystem::path(name).parent_path(); !folder.empty();
       folder = folder.parent_path()) {
    std::filesystem::create_directories(path_ / folder);
    hand_over(path_ / folder, owner_ ? 0750 : 0755);
  }
  std::error_code error;
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
  if (error) throw UserError(from.string(), "cannot be copied: " + error.message());
  hand_over(to, executable ? 0555 : 0444);
  return to;
}

bool Stage::link_file(const std::filesystem::path& from, const std::string& name) {
  struct stat about {};
  const bool all_may_read = ::stat(from.c_str(), &about) == 0 && (about.st_mode & 0444) == 0444;
  return all_may_read && ::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, (path_ / name).c_str(), 0) == 0;
}

bool Stage::can_be_shown(const std::filesystem::path& file) const {
  if (!owner_) return ::access(file.c_str(), R_OK) == 0;
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(file, error);
  struct stat about {};
  if (error || ::stat(real.c_str(), &about) != 0 || (about.st_mode & S_IROTH) == 0) return false;
  for (std::filesystem::path folder = real.parent_path();; folder = folder.parent_path()) {
    if (::stat(folder.c_str(), &about) != 0 || (about.st_mode & S_IXOTH) == 0) return false;
    if (folder == folder.root_path()) return true;
  }
}

std::filesystem::path Stage::add_text(const std::string& text, const std::string& name) {
  const auto to = path_ / name;
  std::ofstream out(to, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw UserError(to.string(), "cannot be written", "Is the disk full?");
  hand_over(to, 0444);
  return to;
}

}  // namespace tumble::grading
