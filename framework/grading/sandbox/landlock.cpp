#include "framework/grading/sandbox/landlock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace tumble::grading {
namespace {

// include/uapi/linux/landlock.h of Linux 6.12 (ABI 6). The numbers of the calls are equal on all
// architectures.
constexpr long kCreateRuleset = 444, kAddRule = 445, kRestrictSelf = 446;
constexpr unsigned kVersion = 1;      // flag of kCreateRuleset: only tells the ABI
constexpr unsigned kPathBeneath = 1;  // type of a rule

struct RulesetAttributes {
  std::uint64_t files, network, scopes;
};
struct __attribute__((packed)) PathBeneath {
  std::uint64_t rights;
  std::int32_t parent;
};

// Rights by the ABI that brought them: all up to this bit.
constexpr std::uint64_t below(int bit) { return (1ull << bit) - 1; }
std::uint64_t file_rights(int abi) {
  return abi >= 5 ? below(16) : abi >= 3 ? below(15) : abi >= 2 ? below(14) : below(13);
}
constexpr std::uint64_t kTcp = 3;     // bind and connect: ABI 4
constexpr std::uint64_t kScopes = 3;  // abstract sockets and signals: ABI 6
// execute, write, read, truncate, ioctl: the rights of a rule on a file
constexpr std::uint64_t kOfFiles = 1ull << 0 | 1ull << 1 | 1ull << 2 | 1ull << 14 | 1ull << 15;
// In a folder to write to: write, read, list, remove, make folders and files, rename, truncate.
constexpr std::uint64_t kOfTemporary = 1ull << 1 | 1ull << 2 | 1ull << 3 | 1ull << 4 | 1ull << 5 |
                                       1ull << 7 | 1ull << 8 | 1ull << 13 | 1ull << 14;

std::runtime_error failure(const std::string& what) {
  return std::runtime_error("Landlock: " + what + ": " + std::strerror(errno));
}

}  // namespace

int landlock_abi() {
  const long abi = ::syscall(kCreateRuleset, nullptr, 0, kVersion);
  return abi < 0 ? 0 : static_cast<int>(abi);
}

LandlockRules::LandlockRules() {
  const int abi = landlock_abi();
  if (abi < 1) throw failure("this kernel does not offer it, or a filter refuses it");
  handled_ = file_rights(abi);
  const RulesetAttributes attributes{handled_, abi >= 4 ? kTcp : 0, abi >= 6 ? kScopes : 0};
  // Older kernels refuse a larger structure unless the rest of it is zero, which it is.
  rules_ = static_cast<int>(::syscall(kCreateRuleset, &attributes, sizeof attributes, 0));
  if (rules_ < 0) throw failure("no rules can be made");
  ::fcntl(rules_, F_SETFD, FD_CLOEXEC);
}

LandlockRules::~LandlockRules() {
  if (rules_ >= 0) ::close(rules_);
}

void LandlockRules::allow(const std::filesystem::path& path, Rights rights) {
  const int place = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (place < 0 && errno == ENOENT) return;
  if (place < 0) throw failure(path.string());
  struct stat about {};
  ::fstat(place, &about);
  const PathBeneath rule{rights & handled_ & (S_ISDIR(about.st_mode) ? ~Rights{0} : kOfFiles),
                         place};
  const long failed = ::syscall(kAddRule, rules_, kPathBeneath, &rule, 0);
  ::close(place);
  if (failed != 0) throw failure(path.string());
}

void LandlockRules::allow_writing(const std::filesystem::path& folder) {
  allow(folder, kOfTemporary);
}

void LandlockRules::restrict_self() const {
  if (::syscall(kRestrictSelf, rules_, 0) != 0) throw failure("the rules cannot be put in force");
}

}  // namespace tumble::grading
