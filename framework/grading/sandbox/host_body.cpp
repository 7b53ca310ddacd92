#include "framework/grading/sandbox/host_body.h"

#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <vector>

#include "framework/grading/sandbox/landlock.h"
#include "framework/grading/sandbox/process_limits.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/sandbox/seccomp_filter.h"
#include "framework/grading/sandbox/start_once.h"
#include "framework/grading/verdicts/own_time.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// The system's programs, libraries and headers, as bubblewrap shows them: files that do not belong
// to packages of the system are not readable.
void allow_system(LandlockRules& rules) {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator("/usr", failed))
    if (const auto name = entry.path().filename(); name != "local" && name != "src")
      rules.allow_reading_and_running(entry.path());
  for (const char* folder : {"/lib", "/lib64", "/bin"}) rules.allow_reading_and_running(folder);
  rules.allow_reading("/etc/ld.so.cache");
  for (const char* device : {"/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom"})
    rules.allow_device(device);
}

// Processes and threads of a user, by /proc.
std::uint64_t tasks_of_user(uid_t user) {
  std::uint64_t tasks = 0;
  std::error_code failed;
  for (fs::directory_iterator it("/proc", failed), end; !failed && it != end;
       it.increment(failed)) {
    struct stat about {};
    if (std::atoi(it->path().filename().c_str()) <= 0 || ::stat(it->path().c_str(), &about) != 0 ||
        about.st_uid != user)
      continue;
    std::error_code gone;
    tasks += static_cast<std::uint64_t>(
        std::distance(fs::directory_iterator(it->path() / "task", gone), {}));
  }
  return tasks;
}

// Stops all descendants. Returns whether one was found that had not been stopped before.
bool stop_descendants(pid_t process, std::set<pid_t>& stopped) {
  bool is_new = false;
  for (const pid_t child : children_of(process)) {
    if (stopped.insert(child).second) is_new = ::kill(child, SIGSTOP) == 0 || is_new;
    is_new = stop_descendants(child, stopped) || is_new;
  }
  return is_new;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

bool is_or_is_below(const std::string& word, const std::string& path) {
  return word.starts_with(path) && (word.size() == path.size() || word[path.size()] == '/');
}

}  // namespace

HostBody::HostBody(const SandboxJob& job) : job_(job), user_(SandboxUser::lease_for_run()) {
  for (const Bind& bind : job.binds)
    if (!fs::exists(bind.from)) throw std::runtime_error(bind.from.string() + " does not exist");
  kill_rest();  // what a killed keeper may have left
  if (job.limits.tmp_bytes > 0) tmp_.emplace(&user_);
  if (starts_once() && ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, start_) != 0)
    throw std::runtime_error("no descriptor left for a sandbox");
}

HostBody::~HostBody() {
  for (const int end : start_)
    if (end >= 0) ::close(end);
}

// The name on the host of what a word of the command names inside.
std::string HostBody::named(const std::string& word) const {
  for (const Bind& bind : job_.binds)
    if (is_or_is_below(word, bind.to)) return bind.from.string() + word.substr(bind.to.size());
  if (tmp_ && is_or_is_below(word, kTmpInside))
    return tmp_->path().string() + word.substr(std::string(kTmpInside).size());
  return word;
}

std::string HostBody::as_inside(std::string printed) const {
  for (const Bind& bind : job_.binds) replace_all(printed, bind.from.string(), bind.to);
  if (tmp_) replace_all(printed, tmp_->path().string(), kTmpInside);
  return printed;
}

// The group is the job's, whose files its members can read: see Stage.
void HostBody::change_user() const {
  if (!user_.uid()) return;
  const gid_t group = job_.uid.value_or(*user_.uid());
  if (::setgroups(0, nullptr) != 0 || ::setgid(group) != 0 || ::setuid(*user_.uid()) != 0)
    throw std::runtime_error("the user cannot be changed");
}

void HostBody::become() {
  const std::string tmp = tmp_ ? tmp_->path().string() : "/";
  std::vector<std::string> words,
      environment = {"PATH=/usr/bin", "HOME=" + tmp, "TMPDIR=" + tmp, "LC_ALL=C.UTF-8"};
  for (const std::string& word : job_.command) words.push_back(named(word));
  std::vector<char*> arguments, variables;
  for (std::string& word : words) arguments.push_back(word.data());
  for (std::string& variable : environment) variables.push_back(variable.data());
  arguments.push_back(nullptr);
  variables.push_back(nullptr);

  std::optional<LandlockRules> rules;
  if (has_landlock()) {
    allow_system(rules.emplace());
    for (const Bind& bind : job_.binds) rules->allow_reading_and_running(bind.from);
    if (tmp_) rules->allow_writing(tmp_->path());
  }
  // started by other jobs of the grader while this one runs
  constexpr std::uint64_t kMeanwhile = 200;
  const bool counts_others = !user_.uid() && !job_.is_alone;
  const std::uint64_t tasks_of_others = counts_others ? tasks_of_user(::getuid()) + kMeanwhile : 0;
  SeccompFilter filter({.is_on_host = true,
                        .is_alone = job_.is_alone,
                        .has_no_files = starts_once(),
                        .self = ::getpid()});

  ::fcntl(kStatusFd, F_SETFD, FD_CLOEXEC);
  ::setsid();  // no terminal to write to
  ::umask(022);
  change_user();
  // After the change of the user, which clears it: the program dies with its keeper.
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != keeper_ ||
      ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
    throw std::runtime_error("the process cannot be prepared");
  if (::chdir(tmp.c_str()) != 0) throw std::runtime_error("its folder cannot be entered");
  if (rules) rules->restrict_self();
  // The kernel counts processes by user: where the user is the grader's, those that it has already
  // and those that it may start meanwhile are added. An is_alone program is refused by its filter.
  if (job_.limits.processes > 0 && (user_.uid() || counts_others))
    set_limit(RLIMIT_NPROC, tasks_of_others + job_.limits.processes);
  if (starts_once()) send_start_permit(kBodyFd);
  set_limits(job_.limits);
  filter.restrict_self();
  const InitReport started{InitReport::kStarted, 0, 0, 0.0};
  while (::write(kStatusFd, &started, sizeof started) < 0 && errno == EINTR) {
  }
  ::execve(arguments[0], arguments.data(), variables.data());
  ::_exit(kCannotStart);
}

void HostBody::attend() {
  if (!starts_once()) return;
  ::close(start_[1]);
  start_[1] = -1;
  permit_one_start(start_[0]);
}

// One signal to all processes of the user at once: a process that forks while it is sent has the
// signal pending, so the kernel refuses the fork. Where the user is the grader's, the descendants
// of this process are stopped, until none is left that could fork, and then killed.
void HostBody::kill_rest() {
  if (!user_.uid()) {
    std::set<pid_t> stopped;
    while (stop_descendants(::getpid(), stopped)) {
    }
    for (const pid_t process : stopped) ::kill(process, SIGKILL);
    return;
  }
  const pid_t killer = ::fork();
  if (killer == 0) {
    if (::setgroups(0, nullptr) == 0 && ::setuid(*user_.uid()) == 0) ::kill(-1, SIGKILL);
    ::_exit(0);
  }
  while (killer > 0 && ::waitpid(killer, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<std::uint64_t> HostBody::bytes_on_disk() const {
  if (!tmp_) return std::nullopt;
  std::uint64_t bytes = 0;
  std::error_code failed;
  for (fs::recursive_directory_iterator it(tmp_->path(), failed), end; !failed && it != end;
       it.increment(failed)) {
    std::error_code gone;
    const auto size = it->is_regular_file(gone) ? it->file_size(gone) : 0;
    constexpr std::uint64_t kOfAnEntry = 4096;  // so that many empty files count, too
    bytes += (gone ? 0 : size) + kOfAnEntry;
  }
  return bytes;
}

}  // namespace tumble::grading
