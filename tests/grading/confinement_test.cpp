// What a submission cannot do, one system call at a time, in every kind of sandbox. Each is tried
// on something that exists and that this process may use, so that only the sandbox can refuse it.
#include <fcntl.h>
#include <signal.h>
#include <sys/msg.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <sstream>

#include "framework/core/files.h"
#include "framework/grading/sandbox/protection.h"
#include "tests/grading/attack_fixture.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

std::atomic<int> signals_seen = 0;

class Confinement : public Attack {
 protected:
  void SetUp() override {
    Attack::SetUp();
    if (IsSkipped()) return;
    victim_ = std::make_unique<Victim>(attack_object("kernel.cpp"));
  }
  void TearDown() override {
    victim_.reset();
    EXPECT_EQ(descendants_left(), 0);
  }

  template <class... Words>
  std::string call(long number, const Words&... words) {
    std::ostringstream text;
    text << number;
    ((text << ' ' << words), ...);
    return victim_->attack(text.str());
  }

  std::unique_ptr<Victim> victim_;
};

constexpr const char* kDenied = "Operation not permitted";
bool is_refused(const std::string& answer) {
  return answer == kDenied || answer == "Permission denied" ||
         answer == "No such file or directory" || answer == "No such process";
}

TEST_F(Confinement, SignalsReachNobodyElse) {
  struct sigaction count {
  }, before{};
  count.sa_handler = [](int) { ++signals_seen; };
  ::sigaction(SIGUSR1, &count, &before);
  signals_seen = 0;
  const pid_t judge = ::getpid();
  for (const std::string& answer :
       {call(SYS_kill, judge, SIGUSR1), call(SYS_tkill, judge, SIGUSR1),
        call(SYS_tgkill, judge, judge, SIGUSR1), call(SYS_rt_sigqueueinfo, judge, SIGUSR1, "@"),
        call(SYS_kill, -1, SIGUSR1), call(SYS_kill, -::getpgrp(), SIGUSR1)})
    EXPECT_TRUE(is_refused(answer)) << answer;
  ::usleep(50'000);
  EXPECT_EQ(signals_seen, 0);
  ::sigaction(SIGUSR1, &before, nullptr);
}

TEST_F(Confinement, SignalsReachNobodyByADescriptorsOwner) {
  // The kernel sends a signal of one's choice to the owner of a socket: with the judge as its
  // owner, a worker would end the judge.
  if (chosen_sandbox() == SandboxKind::kNamespaces)
    GTEST_SKIP() << "the judge has no process id inside";
  EXPECT_EQ(call(SYS_fcntl, 3, F_SETOWN, ::getpid()), kDenied);
  EXPECT_EQ(call(SYS_fcntl, 3, F_SETSIG, SIGKILL), kDenied);
  // The kernel reads the lower half of the command.
  EXPECT_EQ(call(SYS_fcntl, 3, F_SETOWN + (1l << 32), ::getpid()), kDenied);
  EXPECT_EQ(call(SYS_prctl, 1 + (1l << 32), 0), kDenied);
}

TEST_F(Confinement, LocksOfFilesAreRefused) {
  // They would tell a parallel run something.
  EXPECT_EQ(call(SYS_fcntl, 3, F_SETLK, "@"), kDenied);
  EXPECT_EQ(call(SYS_fcntl, 3, F_SETLK + (1l << 32), "@"), kDenied)
      << "the kernel reads the lower half of the command";
  EXPECT_EQ(call(SYS_flock, 3, 2), kDenied);
}

TEST_F(Confinement, OtherProcessesCannotBeReadOrTraced) {
  const pid_t judge = ::getpid();
  for (const char* file : {"environ", "mem", "maps", "cmdline", "fd"})
    EXPECT_TRUE(is_refused(call(SYS_open, "/proc/" + std::to_string(judge) + "/" + file, O_RDONLY)))
        << file;
  EXPECT_TRUE(is_refused(call(SYS_ptrace, 16, judge, 0, 0)));
  EXPECT_TRUE(is_refused(call(SYS_process_vm_readv, judge, "@", 1, "@", 1, 0)));
  EXPECT_TRUE(is_refused(call(SYS_process_vm_writev, judge, "@", 1, "@", 1, 0)));
  EXPECT_TRUE(is_refused(call(SYS_kcmp, judge, judge, 0, 0, 0)));
}

TEST_F(Confinement, NoProcessOrThreadCanBeMade) {
  for (const std::string& answer : {call(SYS_fork), call(SYS_vfork), call(SYS_clone, SIGCHLD, 0)})
    EXPECT_EQ(answer, "Resource temporarily unavailable");
  EXPECT_EQ(call(SYS_clone3, "@", 88), "Function not implemented");
}

TEST_F(Confinement, NoNetworkAndNoSockets) {
  for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK, AF_VSOCK, AF_PACKET})
    for (const int type : {SOCK_STREAM, SOCK_DGRAM, SOCK_RAW})
      EXPECT_EQ(call(SYS_socket, family, type, 0), kDenied) << family << ' ' << type;
  EXPECT_EQ(call(SYS_socketpair, AF_UNIX, SOCK_STREAM, 0, "@"), kDenied);
}

TEST_F(Confinement, ObjectsOfOthersAreOutOfReach) {
  // Each is open to every user of the machine.
  const int memory = ::shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0666),
            queue = ::msgget(IPC_PRIVATE, IPC_CREAT | 0666),
            semaphore = ::semget(IPC_PRIVATE, 1, IPC_CREAT | 0666);
  EXPECT_EQ(call(SYS_shmat, memory, 0, 0), kDenied);
  EXPECT_EQ(call(SYS_msgsnd, queue, "@", 8, IPC_NOWAIT), kDenied);
  EXPECT_EQ(call(SYS_msgrcv, queue, "@", 8, 0, IPC_NOWAIT), kDenied);
  EXPECT_EQ(call(SYS_semctl, semaphore, 0, IPC_RMID), kDenied);
  for (const long get : {SYS_shmget, SYS_msgget, SYS_semget})
    EXPECT_EQ(call(get, 0, 4096, IPC_CREAT | 0666), kDenied) << get;
  EXPECT_EQ(call(SYS_mq_open, "queue", O_CREAT | O_RDWR, 0666, 0), kDenied);
  ::shmctl(memory, IPC_RMID, nullptr);
  ::msgctl(queue, IPC_RMID, nullptr);
  ::semctl(semaphore, 0, IPC_RMID);
}

TEST_F(Confinement, KeyringsIoUringAndTheRestOfTheKernelAreRefused) {
  EXPECT_EQ(call(SYS_add_key, "user", "name", "secret", 6, -3), kDenied);
  EXPECT_EQ(call(SYS_keyctl, 0, -3, 1), kDenied);
  EXPECT_EQ(call(SYS_request_key, "user", "name", 0, 0), kDenied);
  EXPECT_EQ(call(SYS_io_uring_setup, 8, "@"), kDenied);
  EXPECT_EQ(call(SYS_io_uring_enter, 3, 1, 0, 0, 0, 0), kDenied);
  for (const long number :
       {SYS_bpf, SYS_userfaultfd, SYS_perf_event_open, SYS_unshare, SYS_setns, SYS_mount,
        SYS_pivot_root, SYS_chroot, SYS_memfd_create, SYS_inotify_init1, SYS_fanotify_init,
        SYS_personality, SYS_sched_setaffinity, SYS_setpriority, SYS_flock, SYS_mknod})
    EXPECT_EQ(call(number, 0, 0, 0, 0, 0), kDenied) << number;
}

TEST_F(Confinement, AttributesOfFilesCannotBeChanged) {
  // Files of this user and open to all, so that neither their owner nor their mode protects them.
  const fs::path file = "/tmp/tumble-confinement-" + std::to_string(::getpid());
  std::ofstream(file) << "graded";
  ::chmod(file.c_str(), 0666);
  for (const std::string& answer :
       {call(SYS_chmod, file.string(), 0), call(SYS_truncate, file.string(), 0),
        call(SYS_unlink, file.string()), call(SYS_rename, file.string(), file.string() + "x"),
        call(SYS_link, file.string(), "/tmp/x"), call(SYS_utimensat, -100, file.string(), 0, 0),
        call(SYS_setxattr, file.string(), "user.mark", "text", 4, 0),
        call(SYS_open, file.string(), O_WRONLY | O_TRUNC),
        call(SYS_chown, file.string(), ::getuid(), ::getgid()),
        call(SYS_mkdir, "/tmp/tumble-made-here", 0777),
        call(SYS_mkdir, "/dev/shm/tumble-made-here", 0777)})
    EXPECT_TRUE(is_refused(answer) || answer == "Read-only file system") << answer;
  EXPECT_EQ(text_of(file), "graded");
  fs::remove(file);
}

// Linux goes on getting calls, such as fchmodat2, that the library of the filter has no names for.
TEST_F(Confinement, CallsNewerThanTheFiltersListDoNotExist) {
  const fs::path file = "/tmp/tumble-new-calls-" + std::to_string(::getpid());
  std::ofstream(file) << "graded";
  ::chmod(file.c_str(), 0666);
  constexpr long kAt = AT_FDCWD;
  for (const std::string& answer :
       {call(452, kAt, file.string(), 0, 0),                                      // fchmodat2
        call(463, kAt, file.string(), 0, "user.mark", "@", 16),                   // setxattrat
        call(466, kAt, file.string(), 0, "user.mark"),                            // removexattrat
        call(467, kAt, "/", 1, 0, 0), call(469, kAt, file.string(), "@", 24, 0),  // file_setattr
        call(451), call(457, "@", "@", 64, 0), call(1000), call(0x3fffffff)})
    EXPECT_EQ(answer, "Function not implemented");
  struct stat now {};
  ASSERT_EQ(::stat(file.c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777, 0666u);
  fs::remove(file);
}

TEST_F(Confinement, LimitsCannotBeRaisedNorTheDeathWithTheKeeperUndone) {
  EXPECT_NE(call(SYS_setrlimit, 7, "@"), "") << "this worker still answers";
  EXPECT_EQ(call(SYS_prlimit64, 1, 7, 0, "@"), kDenied);
  // there the kernel ends the namespace with its keeper
  if (chosen_sandbox() == SandboxKind::kNamespaces) return;
  EXPECT_EQ(call(SYS_prctl, 1, 0), kDenied);
}

TEST_F(Confinement, StartingAnotherProgramGainsNothing) {
  // Where a program of the system can be started, it is confined as its worker was. The worker is
  // gone, so the call has no answer.
  const std::string answer = call(SYS_execve, "/usr/bin/true", 0, 0);
  if (chosen_sandbox() == SandboxKind::kBare)
    EXPECT_TRUE(answer == kDenied || answer == "Function not implemented") << answer;
  else
    EXPECT_STREQ(words(victim_->verdict()), "crashed");
}

}  // namespace
}  // namespace tumble::grading
