// Namespaces, rlimits and an unprivileged uid do most of the confinement; the filter takes what they leave:
// objects without a namespace of their own (keyrings, file locks), memory outside of RLIMIT_AS (memfd, System V),
// ways to touch another process, and the kernel's rarely used and often broken parts.
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
    // how soon a thread gets a core: a worker that slows itself would look like a busy machine
    "sched_setaffinity", "sched_setscheduler", "sched_setparam", "sched_setattr", "setpriority", "ioprio_set",
    // namespaces and mounts
    "unshare", "setns", "mount", "umount2", "pivot_root", "chroot", "move_mount", "open_tree", "fsopen", "fsconfig", "fsmount",
    "fspick", "mount_setattr", "open_by_handle_at", "name_to_handle_at",
    // network: the channel is an inherited descriptor and needs none of these
    "socket", "socketpair", "connect", "bind", "listen", "accept", "accept4",
    // files that a harness might trip over
    "symlink", "symlinkat", "link", "linkat", "mknod", "mknodat",
    // memory that no limit counts, and objects shared across sandboxes
    "memfd_create", "memfd_secret", "shmget", "shmat", "msgget", "semget", "mq_open", "add_key", "request_key", "keyctl", "flock",
    // the kernel's own matters
    "io_uring_setup", "io_uring_enter", "io_uring_register", "bpf", "perf_event_open", "userfaultfd", "fanotify_init",
    "kexec_load", "kexec_file_load", "init_module", "finit_module", "delete_module", "reboot", "swapon", "swapoff", "syslog",
    "quotactl", "acct", "settimeofday", "clock_settime", "clock_adjtime", "adjtimex", "sethostname", "setdomainname", "iopl",
    "ioperm", "personality", "lookup_dcookie", "vhangup",
};

using Filter = std::unique_ptr<void, void (*)(scmp_filter_ctx)>;

void check(int code, const char* what) {
  if (code < 0) throw std::runtime_error(std::string("the system call filter cannot be made: ") + what);
}

void refuse(scmp_filter_ctx filter, const char* name, int error) {
  const int number = seccomp_syscall_resolve_name(name);
  if (number == __NR_SCMP_ERROR) return;  // unknown to this library, so newer than it
  check(seccomp_rule_add(filter, SCMP_ACT_ERRNO(static_cast<unsigned>(error)), number, 0), name);
}

void refuse_by_argument(scmp_filter_ctx filter) {
  constexpr auto denied = SCMP_ACT_ERRNO(EPERM);
  for (const unsigned flag : {CLONE_NEWNS, CLONE_NEWUTS, CLONE_NEWIPC, CLONE_NEWUSER, CLONE_NEWPID, CLONE_NEWNET, CLONE_NEWCGROUP})
    check(seccomp_rule_add(filter, denied, SCMP_SYS(clone), 1, SCMP_A0(SCMP_CMP_MASKED_EQ, flag, flag)), "clone");
  // clone3 hides its flags behind a pointer. "No such call" (not "not permitted") makes libc fall back to clone.
  refuse(filter, "clone3", ENOSYS);
  // Limits of another process: pid 1 is ours.
  check(seccomp_rule_add(filter, denied, SCMP_SYS(prlimit64), 1, SCMP_A0(SCMP_CMP_NE, 0)), "prlimit64");
  for (const int command : {F_SETLK, F_SETLKW, F_OFD_SETLK, F_OFD_SETLKW, F_SETLEASE})
    check(seccomp_rule_add(filter, denied, SCMP_SYS(fcntl), 1, SCMP_A1(SCMP_CMP_EQ, static_cast<scmp_datum_t>(command))), "fcntl");
}

}  // namespace

int make_seccomp_filter() {
  const Filter filter(seccomp_init(SCMP_ACT_ALLOW), seccomp_release);
  if (!filter) throw std::runtime_error("the system call filter cannot be made: seccomp_init");
  // Calls of another architecture (32-bit, x32) would pass by the rules: libseccomp's default kills them.
  for (const char* name : kRefused) refuse(filter.get(), name, EPERM);
  refuse_by_argument(filter.get());
  // A binary tree instead of a list: read and write, which the channel lives on, are not compared with seventy numbers.
  check(seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_OPTIMIZE, 2), "optimise");
  const int fd = ::memfd_create("filter", MFD_CLOEXEC);
  if (fd < 0) throw std::runtime_error("the system call filter cannot be made: memfd_create");
  check(seccomp_export_bpf(filter.get(), fd), "export");
  ::lseek(fd, 0, SEEK_SET);
  return fd;
}

}  // namespace tumble::grading
