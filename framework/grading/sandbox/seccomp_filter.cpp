// Namespaces, rlimits and an unprivileged uid do most of the confinement. The filter covers the
// rest: objects without a namespace (keyrings, file locks), memory outside RLIMIT_AS (memfd, System
// V), access to other processes, and rarely used, error-prone parts of the kernel.
#include "framework/grading/sandbox/seccomp_filter.h"

#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <stdexcept>

namespace tumble::grading {
namespace {

constexpr const char* kRefused[] = {
    // other processes
    "ptrace", "process_vm_readv", "process_vm_writev", "pidfd_getfd", "kcmp", "process_madvise",
    // scheduling: a worker that slows itself down would look like a busy machine
    "sched_setaffinity", "sched_setscheduler", "sched_setparam", "sched_setattr", "setpriority", "ioprio_set",
    // namespaces and mounts
    "unshare", "setns", "mount", "umount2", "pivot_root", "chroot", "move_mount", "open_tree", "fsopen", "fsconfig", "fsmount",
    "fspick", "mount_setattr", "open_by_handle_at", "name_to_handle_at",
    // network: not needed, because the channel is an inherited descriptor
    "socket", "socketpair", "connect", "bind", "listen", "accept", "accept4",
    // special files that could confuse the grader
    "symlink", "symlinkat", "link", "linkat", "mknod", "mknodat",
    // memory that no limit covers, and objects shared across sandboxes
    "memfd_create", "memfd_secret", "shmget", "shmat", "msgget", "semget", "mq_open", "add_key", "request_key", "keyctl", "flock",
    // kernel administration
    "io_uring_setup", "io_uring_enter", "io_uring_register", "bpf", "perf_event_open", "userfaultfd", "fanotify_init",
    "kexec_load", "kexec_file_load", "init_module", "finit_module", "delete_module", "reboot", "swapon", "swapoff", "syslog",
    "quotactl", "acct", "settimeofday", "clock_settime", "clock_adjtime", "adjtimex", "sethostname", "setdomainname", "iopl",
    "ioperm", "personality", "lookup_dcookie", "vhangup",
};

using Filter = std::unique_ptr<void, void (*)(scmp_filter_ctx)>;

void check(int code, const char* what) {
  if (code < 0) throw std::runtime_error(std::string("the system call filter cannot be created: ") + what);
}

void refuse(scmp_filter_ctx filter, const char* name, int error) {
  const int number = seccomp_syscall_resolve_name(name);
  if (number == __NR_SCMP_ERROR) return;  // not known to this library
  check(seccomp_rule_add(filter, SCMP_ACT_ERRNO(static_cast<unsigned>(error)), number, 0), name);
}

void refuse_by_argument(scmp_filter_ctx filter) {
  constexpr auto denied = SCMP_ACT_ERRNO(EPERM);
  for (const unsigned flag : {CLONE_NEWNS, CLONE_NEWUTS, CLONE_NEWIPC, CLONE_NEWUSER, CLONE_NEWPID, CLONE_NEWNET, CLONE_NEWCGROUP})
    check(seccomp_rule_add(filter, denied, SCMP_SYS(clone), 1, SCMP_A0(SCMP_CMP_MASKED_EQ, flag, flag)), "clone");
  // The flags of clone3 are behind a pointer, which a filter cannot read. ENOSYS, not EPERM, makes
  // libc fall back to clone.
  refuse(filter, "clone3", ENOSYS);
  // Limits of other processes, such as process 1.
  check(seccomp_rule_add(filter, denied, SCMP_SYS(prlimit64), 1, SCMP_A0(SCMP_CMP_NE, 0)), "prlimit64");
  for (const int command : {F_SETLK, F_SETLKW, F_OFD_SETLK, F_OFD_SETLKW, F_SETLEASE})
    check(seccomp_rule_add(filter, denied, SCMP_SYS(fcntl), 1, SCMP_A1(SCMP_CMP_EQ, static_cast<scmp_datum_t>(command))), "fcntl");
}

}  // namespace

int make_seccomp_filter() {
  const Filter filter(seccomp_init(SCMP_ACT_ALLOW), seccomp_release);
  if (!filter) throw std::runtime_error("the system call filter cannot be created: seccomp_init");
  // Calls of other architectures (32-bit, x32) would bypass these rules: libseccomp kills them by
  // default.
  for (const char* name : kRefused) refuse(filter.get(), name, EPERM);
  refuse_by_argument(filter.get());
  // A binary tree instead of a list, so that read and write, which the channel uses, are not
  // compared with seventy numbers.
  check(seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_OPTIMIZE, 2), "optimise");
  const int fd = ::memfd_create("filter", MFD_CLOEXEC);
  if (fd < 0) throw std::runtime_error("the system call filter cannot be created: memfd_create");
  check(seccomp_export_bpf(filter.get(), fd), "export");
  ::lseek(fd, 0, SEEK_SET);
  return fd;
}

}  // namespace tumble::grading
