// like_docker [--no-landlock] PROGRAM ARGUMENTS...: starts a program confined as Docker confines a
// container by default, as far as a sandbox inside notices: its capabilities and the calls that its
// profile refuses. --no-landlock also refuses Landlock, as an older kernel does.
//
// Source: moby, profiles/seccomp/default.json and oci/caps/defaults.go (version 24).
#include <linux/capability.h>
#include <linux/sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace {

constexpr int kKept[] = {
    CAP_CHOWN,      CAP_DAC_OVERRIDE, CAP_FOWNER,      CAP_FSETID,           CAP_KILL,
    CAP_SETGID,     CAP_SETUID,       CAP_SETPCAP,     CAP_NET_BIND_SERVICE, CAP_NET_RAW,
    CAP_SYS_CHROOT, CAP_MKNOD,        CAP_AUDIT_WRITE, CAP_SETFCAP};

constexpr const char* kRefused[] = {
    "mount",
    "umount",
    "umount2",
    "unshare",
    "setns",
    "pivot_root",
    "move_mount",
    "open_tree",
    "fsopen",
    "fsconfig",
    "fsmount",
    "fspick",
    "mount_setattr",
    "add_key",
    "request_key",
    "keyctl",
    "bpf",
    "perf_event_open",
    "userfaultfd",
    "io_uring_setup",
    "io_uring_enter",
    "io_uring_register",
    "kexec_load",
    "kexec_file_load",
    "init_module",
    "finit_module",
    "delete_module",
    "reboot",
    "swapon",
    "swapoff",
    "syslog",
    "quotactl",
    "acct",
    "settimeofday",
    "clock_settime",
    "sethostname",
    "setdomainname",
    "iopl",
    "ioperm",
    "lookup_dcookie",
    "vhangup",
    "open_by_handle_at",
    "fanotify_init",
    "get_mempolicy",
    "set_mempolicy",
    "mbind",
    "move_pages",
    "nfsservctl",
    "uselib",
    "ustat",
    "sysfs",
};

void check(int code, const char* what) {
  if (code < 0)
    throw std::runtime_error(std::string(what) + ": " + std::strerror(code == -1 ? errno : -code));
}

void drop_capabilities() {
  unsigned low = 0;
  for (const int kept : kKept) low |= 1u << kept;
  for (int capability = 0; capability <= 63; ++capability)
    if (std::find(std::begin(kKept), std::end(kKept), capability) == std::end(kKept))
      ::prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[2] = {};
  check(static_cast<int>(::syscall(SYS_capget, &head, sets)), "capget");
  sets[0].effective &= low;
  sets[0].permitted &= low;
  sets[0].inheritable = 0;
  sets[1] = {};
  check(static_cast<int>(::syscall(SYS_capset, &head, sets)), "capset");
}

void refuse(scmp_filter_ctx filter, const char* name, unsigned error) {
  const int number = seccomp_syscall_resolve_name(name);
  if (number != __NR_SCMP_ERROR)
    check(seccomp_rule_add(filter, SCMP_ACT_ERRNO(error), number, 0), name);
}

void refuse_calls(bool has_landlock) {
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  for (const char* name : kRefused) refuse(filter, name, EPERM);
  for (const unsigned flag : {CLONE_NEWNS, CLONE_NEWUTS, CLONE_NEWIPC, CLONE_NEWUSER, CLONE_NEWPID,
                              CLONE_NEWNET, CLONE_NEWCGROUP})
    check(seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(clone), 1,
                           SCMP_A0(SCMP_CMP_MASKED_EQ, flag, flag)),
          "clone");
  refuse(filter, "clone3", ENOSYS);
  if (!has_landlock)
    for (const char* name :
         {"landlock_create_ruleset", "landlock_add_rule", "landlock_restrict_self"})
      refuse(filter, name, ENOSYS);
  check(seccomp_attr_set(filter, SCMP_FLTATR_CTL_NNP, ::geteuid() == 0 ? 0 : 1), "no_new_privs");
  check(seccomp_load(filter), "the filter");
}

}  // namespace

int main(int argc, char** argv) {
  const bool has_landlock = argc < 2 || std::string(argv[1]) != "--no-landlock";
  char** program = argv + (has_landlock ? 1 : 2);
  if (*program == nullptr)
    return std::fprintf(stderr, "like_docker [--no-landlock] PROGRAM ARGUMENTS...\n"), 2;
  try {
    // The filter first: as root, loading it needs CAP_SYS_ADMIN, which Docker's runtime still has.
    refuse_calls(has_landlock);
    drop_capabilities();
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "like_docker: %s\n", error.what()), 2;
  }
  ::execvp(program[0], program);
  std::perror(program[0]);
  return 2;
}
