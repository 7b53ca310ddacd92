// Every option here prevents an attack (tests/grading/attacks has the attacks).
#include "framework/grading/sandbox/bubblewrap.h"

#include <filesystem>

#include "framework/grading/sandbox/sandbox_wire.h"

namespace tumble::grading {
namespace {

constexpr const char* kInitInside = "/sandbox_init";

}  // namespace

std::vector<std::string> bubblewrap_command(const SandboxJob& job) {
  std::vector<std::string> words = {"/usr/bin/bwrap"};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  // New namespaces of every kind, and no way to create more.
  add({"--unshare-user", "--unshare-all", "--disable-userns", "--die-with-parent", "--new-session", "--cap-drop", "ALL"});
  add({"--uid", "1000", "--gid", "1000", "--hostname", "sandbox", "--clearenv"});
  add({"--setenv", "PATH", "/usr/bin", "--setenv", "HOME", "/tmp", "--setenv", "LC_ALL", "C.UTF-8"});
  add({"--ro-bind", "/usr", "/usr"});
  // Files that do not belong to packages of the system are hidden.
  for (const char* folder : {"/usr/local", "/usr/src"})
    if (std::filesystem::is_directory(folder)) add({"--size", "4096", "--tmpfs", folder, "--remount-ro", folder});
  for (const char* folder : {"/lib", "/lib64", "/bin"}) {
    if (std::filesystem::is_symlink(folder)) add({"--symlink", std::filesystem::read_symlink(folder).string(), folder});
    else if (std::filesystem::exists(folder)) add({"--ro-bind", folder, folder});
  }
  add({"--proc", "/proc", "--dev", "/dev"});
  add({"--size", std::to_string(job.limits.tmp_bytes), "--tmpfs", "/tmp"});
  add({"--size", std::to_string(job.limits.tmp_bytes / 16), "--tmpfs", "/dev/shm"});
  add({"--ro-bind", job.init.string(), kInitInside});
  for (const Bind& bind : job.binds) add({"--ro-bind", bind.from.string(), bind.to});
  add({"--chdir", "/tmp"});
  // Both are tmpfs without a size limit unless read-only.
  add({"--remount-ro", "/dev", "--remount-ro", "/"});
  add({"--seccomp", std::to_string(kFilterFd), "--as-pid-1", kInitInside, std::to_string(job.limits.processes)});
  words.insert(words.end(), job.command.begin(), job.command.end());
  return words;
}

}  // namespace tumble::grading
