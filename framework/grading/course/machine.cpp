#include "framework/grading/course/machine.h"

#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/core/error.h"
#include "framework/grading/compiler/page_module.h"
#include "framework/core/run_program.h"
#include "framework/grading/sandbox/landlock.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/sandbox/sandbox_user.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using State = Finding::State;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
// GiB: a judge, a worker with its limit of 1 GiB, a compiler with 300 MB
constexpr double kMemory = 2.0;
// GiB: results of a class with pages and videos, and the compiler's files
constexpr double kDisk = 2.0;

std::string first_line(const std::vector<std::string>& command) {
  const ProgramOutcome outcome = run_program(command, Output::kCaptured, 60.0);
  return outcome.code == 0 ? outcome.printed.substr(0, outcome.printed.find('\n')) : "";
}

Finding kernel() { return {State::kGood, "kernel", first_line({"uname", "-sr"}), ""}; }

Finding user() {
  if (can_change_user())
    return {State::kGood, "user", "root, can give each run a user id of its own", ""};
  const std::string name = ::geteuid() == 0 ? "root without the capabilities to change its user"
                                            : fmt::format("user id {}", ::geteuid());
  return {State::kNote, "user",
          name +
              ": submissions run under the same id, so the number of their processes and their "
              "files' permissions protect nothing by themselves",
          "Grade as root; in a container, keep the capabilities CHOWN, DAC_OVERRIDE, FOWNER, KILL, "
          "SETGID and SETUID, which Docker gives by default."};
}

Finding seccomp() {
  const std::uint32_t action = SECCOMP_RET_USER_NOTIF;
  if (::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0)
    return {State::kGood, "system call filters", "yes, with notifications", ""};
  if (::prctl(PR_GET_SECCOMP) >= 0)
    return {State::kNote, "system call filters",
            "yes, without notifications, which the sandbox bare needs (Linux 5.5)", ""};
  return {State::kMissing, "system call filters", "no", "The kernel needs CONFIG_SECCOMP_FILTER."};
}

Finding landlock() {
  const int abi = landlock_abi();
  if (abi >= 3) return {State::kGood, "Landlock", fmt::format("ABI {}", abi), ""};
  if (abi >= 1)
    return {State::kGood, "Landlock",
            fmt::format("ABI {}: the filter refuses what it does not cover (truncation)", abi), ""};
  return {State::kNote, "Landlock", "no",
          "Linux 5.13 or newer, with \"landlock\" among the names in /sys/kernel/security/lsm "
          "(boot parameter lsm=landlock,...); in a container, a profile that permits landlock_* "
          "calls (Docker 20.10.10 or newer)."};
}

Finding control_groups() {
  const bool has_v2 = fs::exists("/sys/fs/cgroup/cgroup.controllers");
  const bool is_writable = has_v2 && ::access("/sys/fs/cgroup/cgroup.procs", W_OK) == 0;
  return {State::kGood, "control groups",
          !has_v2       ? "version 1 or none (not used)"
          : is_writable ? "version 2, writable (not used)"
                        : "version 2, read-only (not used)",
          ""};
}

Finding compiler() {
  const std::string version =
      fs::exists("/usr/bin/g++") ? first_line({"/usr/bin/g++", "--version"}) : "";
  if (!version.empty()) return {State::kGood, "compiler", version, ""};
  return {State::kMissing, "compiler", "no /usr/bin/g++", "apt-get install g++"};
}

Finding code_in_pages() {
  const auto missing = missing_page_packages();
  if (missing.empty())
    return {State::kGood, "code in pages", "clang 14 for WebAssembly with its libraries", ""};
  return {State::kNote, "code in pages",
          fmt::format("no: graded pages show pictures alone, because {} {} missing",
                      fmt::join(missing, " "), missing.size() == 1 ? "is" : "are"),
          fmt::format("apt-get install --yes --no-install-recommends {}", kPagePackages)};
}

Finding packages(const fs::path& root) {
  if (!fs::exists("/usr/bin/dpkg-query"))
    return {State::kNote, "packages",
            "this system has no dpkg, so they cannot be compared with packages.txt", ""};
  const auto missing = missing_packages(root / "packages.txt");
  if (missing.empty()) return {State::kGood, "packages", "all of packages.txt", ""};
  return {State::kMissing, "packages",
          fmt::format("{} missing: {}", missing.size(), fmt::join(missing, " ")),
          fmt::format("apt-get update && apt-get install --yes --no-install-recommends {}",
                      fmt::join(missing, " "))};
}

double available_memory_gib() {
  std::ifstream in("/proc/meminfo");
  for (std::string word; in >> word;)
    if (double kib = 0.0; word == "MemAvailable:" && in >> kib) return kib / (1024.0 * 1024.0);
  return 0.0;
}

Finding memory() {
  const double gib = available_memory_gib();
  return {gib >= kMemory ? State::kGood : State::kNote, "memory",
          fmt::format("{:.1f} GiB available", gib),
          gib >= kMemory
              ? ""
              : fmt::format("A grading uses up to {:g} GiB for each of --jobs.", kMemory)};
}

Finding disk(const std::string& what, const fs::path& place) {
  struct statvfs about {};
  if (::statvfs(place.c_str(), &about) != 0)
    return {State::kMissing, what, place.string() + " cannot be read",
            "Make the folder, or mount a disk there."};
  const double gib =
      static_cast<double>(about.f_bavail) * static_cast<double>(about.f_frsize) / kGiB;
  return {gib >= kDisk ? State::kGood : State::kNote, what,
          fmt::format("{:.1f} GiB free in {}", gib, place.string()),
          gib >= kDisk ? "" : "Make room there."};
}

Finding cores() {
  const unsigned count = std::max(1u, std::thread::hardware_concurrency());
  return {State::kGood, "cores", fmt::format("{}: --jobs {} by default", count, count), ""};
}

std::string remedy_of(SandboxKind kind) {
  switch (kind) {
    case SandboxKind::kNamespaces:
      return "The package bubblewrap, and a kernel and a container that permit namespaces: with "
             "Docker --security-opt seccomp=unconfined --cap-add SYS_ADMIN, which weakens the "
             "container itself; outside containers sysctl kernel.unprivileged_userns_clone=1.";
    case SandboxKind::kLandlock: return landlock().remedy;
    case SandboxKind::kBare: break;
  }
  return "Linux 5.5 or newer, and the package libseccomp-dev.";
}

// The chosen kind is missing where none works, or less than the policy asks for.
Finding sandbox(const MachineReport& report) {
  for (const SandboxFinding& found : report.sandboxes) {
    if (report.chosen != found.traits.kind) continue;
    const std::string words = protection_in_words(found.traits.kind);
    if (found.why_not)
      return {State::kMissing, "sandbox", words + ", which does not work: " + *found.why_not,
              remedy_of(found.traits.kind)};
    if (found.traits.is_official) return {State::kGood, "sandbox", words, ""};
    return {State::kMissing, "sandbox", words + ": less than the policy for grades asks for",
            remedy_of(SandboxKind::kLandlock)};
  }
  return {State::kMissing, "sandbox", "none works", remedy_of(SandboxKind::kLandlock)};
}

}  // namespace

bool MachineReport::allows_official_grades() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.state == State::kMissing; });
}

std::vector<std::string> missing_packages(const fs::path& list) {
  std::vector<std::string> wanted, missing;
  std::ifstream in(list);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) wanted.push_back(word);
  }
  std::vector<std::string> command = {"dpkg-query", "-W", "-f=${db:Status-Status} ${Package}\n"};
  command.insert(command.end(), wanted.begin(), wanted.end());
  std::istringstream lines(run_program(command, Output::kCaptured, 60.0).printed);
  std::set<std::string> installed;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("installed "))
      installed.insert(line.substr(std::string("installed ").size()));
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(missing),
               [&](const std::string& name) { return !installed.contains(name); });
  return missing;
}

MachineReport examine_machine(const fs::path& root, const fs::path& build) {
  MachineReport report;
  for (const SandboxTraits& traits : all_sandboxes())
    report.sandboxes.push_back({traits, why_no_sandbox(traits.kind)});
  const char* named = std::getenv("TUMBLE_SANDBOX");
  if (named != nullptr && *named != '\0') report.chosen = sandbox_from_name(named);
  for (const SandboxFinding& found : report.sandboxes)
    if (!report.chosen && !found.why_not) report.chosen = found.traits.kind;
  report.findings = {kernel(),
                     user(),
                     seccomp(),
                     landlock(),
                     control_groups(),
                     sandbox(report),
                     compiler(),
                     packages(root),
                     code_in_pages(),
                     memory(),
                     disk("disk, build", build),
                     disk("disk, temporary", "/tmp"),
                     cores()};
  return report;
}

}  // namespace tumble::grading
