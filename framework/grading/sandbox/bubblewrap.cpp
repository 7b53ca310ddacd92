// Every option here prevents an attack (solutions_private/attacks/calls has the attacks).
#include "framework/grading/sandbox/bubblewrap.h"

#include <fcntl.h>
#include <grp.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "framework/grading/sandbox/process_limits.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/sandbox/seccomp_filter.h"

namespace tumble::grading {
namespace {

constexpr const char* kInitInside = "/sandbox_init";
constexpr int kHigh = 100;                    // above every number of sandbox_wire.h
constexpr std::uint64_t kInitAndProgram = 2;  // processes of a program that is alone

}  // namespace

void BubblewrapBody::become() {
  // By way of a high number: a descriptor that has the agreed one already would not stay open for
  // bubblewrap.
  if (::dup2(::fcntl(make_seccomp_filter(), F_DUPFD_CLOEXEC, kHigh), kBodyFd) < 0)
    throw std::runtime_error("no descriptor left for the system call filter");
  set_limits(job_.limits);
  if (job_.uid &&
      (::setgroups(0, nullptr) != 0 || ::setgid(*job_.uid) != 0 || ::setuid(*job_.uid) != 0))
    throw std::runtime_error("the user cannot be changed");
  std::vector<std::string> words = command();
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  char* const no_environment[] = {nullptr};  // it would be visible inside as /proc/1/environ
  ::execve(arguments[0], arguments.data(), no_environment);
  throw std::runtime_error("bubblewrap (/usr/bin/bwrap) cannot be started");
}

std::vector<std::string> BubblewrapBody::command() const {
  const SandboxJob& job = job_;
  std::vector<std::string> words = {"/usr/bin/bwrap"};
  const auto add = [&](std::initializer_list<std::string> more) {
    words.insert(words.end(), more);
  };
  // New namespaces of every kind, and no way to create more.
  add({"--unshare-user", "--unshare-all", "--disable-userns", "--die-with-parent", "--new-session",
       "--cap-drop", "ALL"});
  add({"--uid", "1000", "--gid", "1000", "--hostname", "sandbox", "--clearenv"});
  add({"--setenv", "PATH", "/usr/bin", "--setenv", "HOME", "/tmp", "--setenv", "LC_ALL",
       "C.UTF-8"});
  add({"--ro-bind", "/usr", "/usr"});
  // Files that do not belong to packages of the system are hidden.
  for (const char* folder : {"/usr/local", "/usr/src"})
    if (std::filesystem::is_directory(folder))
      add({"--size", "4096", "--tmpfs", folder, "--remount-ro", folder});
  for (const char* folder : {"/lib", "/lib64", "/bin"}) {
    if (std::filesystem::is_symlink(folder))
      add({"--symlink", std::filesystem::read_symlink(folder).string(), folder});
    else if (std::filesystem::exists(folder))
      add({"--ro-bind", folder, folder});
  }
  add({"--proc", "/proc", "--dev", "/dev"});
  if (job.limits.tmp_bytes > 0)
    add({"--size", std::to_string(job.limits.tmp_bytes), "--tmpfs", kTmpInside});
  else
    add({"--dir", kTmpInside});  // part of /, which is read-only in the end
  add({"--ro-bind", job.init.string(), kInitInside});
  for (const Bind& bind : job.binds) add({"--ro-bind", bind.from.string(), bind.to});
  add({"--chdir", kTmpInside});
  // Two are tmpfs without a size limit unless read-only; what is written to the third can lower the
  // priority of the process that measures time (autogroup).
  add({"--remount-ro", "/dev", "--remount-ro", "/", "--remount-ro", "/proc"});
  add({"--seccomp", std::to_string(kBodyFd), "--as-pid-1", kInitInside,
       std::to_string(job.is_alone ? kInitAndProgram : job.limits.processes)});
  words.insert(words.end(), job.command.begin(), job.command.end());
  return words;
}

}  // namespace tumble::grading
