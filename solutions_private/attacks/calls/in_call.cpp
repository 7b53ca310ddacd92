// Attacks during a call. Each returns how far it got; most never return.
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>
#include <thread>

#include "tests/modules/waist.h"

extern char** environ;

namespace tumble::waist {
namespace {

std::string outcome(long result) { return result >= 0 ? "done" : std::strerror(errno); }

volatile int sink = 0;
int endless_recursion(int n) {
  volatile char frame[4096];
  frame[0] = static_cast<char>(n);
  return endless_recursion(n + 1) + frame[0];
}

// "open:PATH": the error of opening it, or its first bytes.
std::string open_file(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY);
  if (fd < 0) return std::strerror(errno);
  char text[200];
  const ssize_t n = ::read(fd, text, sizeof text);
  return n < 0 ? (errno == EISDIR ? "done" : std::strerror(errno))
               : "read: " + std::string(text, static_cast<std::size_t>(n));
}

// "write:PATH": number of bytes that could be written, at most a gigabyte.
std::string fill(const std::string& path) {
  static char block[1 << 20];
  long bytes = 0;
  for (int file = 0; file < 64; ++file) {
    const int fd = ::open((path + std::to_string(file)).c_str(), O_WRONLY | O_CREAT, 0600);
    if (fd < 0) break;
    for (int i = 0; i < 16; ++i) {
      const ssize_t n = ::write(fd, block, sizeof block);
      if (n <= 0) break;
      bytes += n;
    }
    ::close(fd);
  }
  return std::to_string(bytes);
}

std::string descriptors() {
  std::string all;
  for (int fd = 0; fd < 1024; ++fd)
    if (::fcntl(fd, F_GETFD) >= 0) all += std::to_string(fd) + " ";
  return all;
}

std::string environment() {
  std::string all;
  for (char** entry = environ; *entry != nullptr; ++entry) all += std::string(*entry) + "\n";
  return all;
}

std::string processes() {
  std::string all;
  DIR* folder = ::opendir("/proc");
  if (folder == nullptr) return std::strerror(errno);
  while (const dirent* entry = ::readdir(folder))
    if (std::atoi(entry->d_name) > 0) all += std::string(entry->d_name) + " ";
  return all;
}

// The judge's latest question, as who forges an answer finds it: in the worker's channel, which
// begins with its two descriptors and lies on the stack of main.
unsigned long question() {
  const auto* at =
      reinterpret_cast<const unsigned long*>(reinterpret_cast<unsigned long>(environ) & ~7ul);
  const unsigned long here = 0;
  while (--at > &here)
    if (at[0] == 0x300000003ul && at[1] >> 40 != 0) return at[1];
  return 0;
}

void frame(unsigned size, unsigned char kind, const void* payload, std::size_t bytes) {
  struct {
    unsigned size;
    unsigned char kind, padding[3];
    unsigned long question;
  } head{size, kind, {0, 0, 0}, question()};
  (void)!::write(3, &head, sizeof head);
  (void)!::write(3, payload, bytes);
}

std::string forge(const std::string& what) {
  const double answer = 42.0;
  if (what == "answer") frame(8, 2, &answer, 8), ::_exit(0);
  if (what == "kind") frame(0, 77, nullptr, 0);
  if (what == "size") frame(0xffffffffu, 2, nullptr, 0);
  if (what == "callback") frame(4, 3, "\5\0\0\0", 4);
  if (what == "count") frame(4, 2, "\377\377\377\377", 4);
  if (what == "stub") frame(5, 5, "\1\0\0\0x", 5);
  if (what == "half") frame(100, 2, &answer, 8);
  for (;;) ::pause();
}

[[noreturn]] void fork_bomb() {
  for (;;)
    if (::fork() == 0) continue;
}

// Number of processes that can be created and stay alive; they die with the worker.
std::string count_children() {
  int made = 0;
  for (; made < 1000; ++made) {
    const pid_t child = ::fork();
    if (child == 0)
      for (;;) ::pause();
    if (child < 0) break;
  }
  return std::to_string(made);
}

long raised_processes() {
  const rlimit more{100000, 100000};
  return ::setrlimit(RLIMIT_NPROC, &more);
}

long connect_out() {
  const int line = ::socket(AF_INET, SOCK_STREAM, 0);
  if (line < 0) return -1;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(80);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return ::connect(line, reinterpret_cast<sockaddr*>(&to), sizeof to);
}

using Attack = std::function<std::string()>;

const std::map<std::string, Attack>& attacks() {
  static const std::map<std::string, Attack> all = {
      {"exit", []() -> std::string { std::exit(0); }},
      {"_exit", []() -> std::string { ::_exit(0); }},
      {"quick_exit", []() -> std::string { std::quick_exit(0); }},
      {"loop",
       []() -> std::string {
         for (;;) sink = sink + 1;
       }},
      {"sleep",
       []() -> std::string {
         for (;;) ::sleep(1000);
       }},
      {"fork bomb", []() -> std::string { fork_bomb(); }},
      {"100 GB by new",
       [] { return std::to_string(reinterpret_cast<std::size_t>(new char[100'000'000'000])); }},
      {"memory in pieces",
       []() -> std::string {
         for (std::vector<char*> all;;)
           all.push_back(static_cast<char*>(std::memset(new char[1 << 26], 1, 1 << 26)));
       }},
      {"flood",
       []() -> std::string {
         for (;;) std::fputs("[  PASSED  ] 1000 tests.\n", stdout);
       }},
      {"fake lines",
       [] {
         return std::puts("[       OK ] All.Tests\n[  PASSED  ] 1000 tests.\n{\"score\": 100}"),
                std::fflush(stdout), std::string("answer");
       }},
      {"segmentation fault",
       []() -> std::string {
         *reinterpret_cast<volatile int*>(8) = 1;
         return "";
       }},
      {"stack", [] { return std::to_string(endless_recursion(0)); }},
      {"abort", []() -> std::string { std::abort(); }},
      {"throw", []() -> std::string { throw std::runtime_error("I give up"); }},
      {"throw int", []() -> std::string { throw 7; }},
      {"terminate", []() noexcept -> std::string { throw 7; }},
      {"thread left",
       [] {
         std::thread([] {
           for (;;) sink = sink + 1;
         }).detach();
         return std::string("answer");
       }},
      {"child left",
       [] {
         if (::fork() == 0) {
           ::setsid();
           for (;;) ::pause();
         }
         return std::string("answer");
       }},
      {"connect", [] { return outcome(connect_out()); }},
      {"kill all", [] { return outcome(::kill(-1, SIGKILL)); }},
      {"kill parent", [] { return outcome(::kill(::getppid(), SIGKILL)); }},
      {"stop parent", [] { return outcome(::kill(::getppid(), SIGSTOP)); }},
      {"trace parent",
       [] { return outcome(::ptrace(PTRACE_ATTACH, ::getppid(), nullptr, nullptr)); }},
      {"memfd", [] { return outcome(::memfd_create("x", 0)); }},
      {"shared memory", [] { return outcome(::shmget(IPC_PRIVATE, 4096, 0600)); }},
      {"link", [] { return outcome(::symlink("/etc/passwd", "/tmp/x")); }},
      {"pipe by name", [] { return outcome(::mkfifo("/tmp/x", 0600)); }},
      {"more processes", [] { return outcome(raised_processes()); }},
      {"long answer", [] { return std::string(64u << 20, 'x'); }},
      {"own core",
       [] {
         cpu_set_t one;
         CPU_ZERO(&one);
         CPU_SET(0, &one);
         return outcome(::sched_setaffinity(0, sizeof one, &one));
       }},
      {"idle class",
       [] {
         const sched_param none{};
         return outcome(::sched_setscheduler(0, SCHED_IDLE, &none));
       }},
      {"nice", [] { return outcome(::setpriority(PRIO_PROCESS, 0, 19)); }},
      {"hang up",
       []() -> std::string {
         ::close(3);
         for (;;) ::pause();
       }},
      {"nap",
       [] {
         ::usleep(400'000);
         return std::string("0.4 s");
       }},
      {"environment", environment},
      {"descriptors", descriptors},
      {"processes", processes},
      {"children", count_children},
  };
  return all;
}

}  // namespace

double twice(double x) { return 2.0 * x; }
Everything echo(const Everything& value) { return value; }
double call_back(const std::function<double(double)>& f, int calls) {
  double sum = 0.0;
  for (long i = 0; calls < 0 || i < calls; ++i) sum += f(static_cast<double>(i));
  return sum;
}
double missing(double) {
  forge("answer");
  return 0.0;
}
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>& f, const VectorXd& y,
              const std::string& what) {
  const VectorXd slope =
      what.starts_with("ask ") ? f(0.0, VectorXd::Zero(std::stol(what.substr(4)))) : f(0.0, y);
  return what.starts_with("answer ") ? VectorXd(VectorXd::Zero(std::stol(what.substr(7))))
                                     : VectorXd(y + slope);
}

std::string attack(const std::string& what) {
  if (what.starts_with("open:")) return open_file(what.substr(5));
  if (what.starts_with("write:")) return fill(what.substr(6));
  if (what.starts_with("forge:")) return forge(what.substr(6));
  return attacks().at(what)();
}

}  // namespace tumble::waist
