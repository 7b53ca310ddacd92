#include "framework/grading/attacks/watchers.h"

#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr int kPatience_ms = 3000;  // for ending processes to be reaped, on a loaded machine
constexpr const char* kStage = "tumble-stage-";

std::vector<pid_t> children() {
  std::istringstream in(text_of("/proc/self/task/" + std::to_string(::getpid()) + "/children"));
  std::vector<pid_t> all;
  for (pid_t child; in >> child;) all.push_back(child);
  return all;
}

// "shm 7": all of the machine.
std::set<std::string> system_v_objects() {
  std::set<std::string> all;
  for (const std::string kind : {"shm", "sem", "msg"}) {
    std::ifstream in("/proc/sysvipc/" + kind);
    std::string line;
    for (std::getline(in, line); std::getline(in, line);) {
      std::istringstream words(line);
      std::string key, id;
      words >> key >> id;
      all.insert(kind + " " + id);
    }
  }
  return all;
}

// Of processes that are gone.
std::set<std::string> abandoned_stages() {
  std::set<std::string> all;
  for (const auto& entry : fs::directory_iterator("/tmp")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kStage)) continue;
    const pid_t maker = std::atoi(name.c_str() + std::strlen(kStage));
    if (::kill(maker, 0) != 0 && errno == ESRCH) all.insert(name);
  }
  return all;
}

int listener(const sockaddr* address, socklen_t size) {
  const int socket = ::socket(address->sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket >= 0 && ::bind(socket, address, size) == 0 && ::listen(socket, 8) == 0) return socket;
  if (socket >= 0) ::close(socket);
  return -1;
}

void look_for_mark(const fs::path& folder, const std::string& mark, bool is_deep,
                   std::vector<std::string>& faults) {
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    const bool is_marked = it->path().filename().string().find(mark) != std::string::npos;
    if (is_marked) faults.push_back("a file was left: " + it->path().string());
    if (is_deep && fs::is_directory(it->symlink_status(failed)))
      look_for_mark(it->path(), mark, true, faults);
  }
}

}  // namespace

Watchers::Watchers(std::string mark)
    : mark_(std::move(mark)), objects_(system_v_objects()), stages_(abandoned_stages()) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  tcp_ = listener(reinterpret_cast<const sockaddr*>(&local), sizeof local);
  socklen_t size = sizeof local;
  if (tcp_ >= 0 && ::getsockname(tcp_, reinterpret_cast<sockaddr*>(&local), &size) == 0)
    port_ = ntohs(local.sin_port);
  sockaddr_un abstract{};
  abstract.sun_family = AF_UNIX;
  std::strncpy(abstract.sun_path + 1, mark_.c_str(), sizeof abstract.sun_path - 2);
  const auto named = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + mark_.size());
  local_ = listener(reinterpret_cast<const sockaddr*>(&abstract), named);
  if (tcp_ < 0 || local_ < 0)
    throw UserError("127.0.0.1", "no service can be started there",
                    "The attacks need one, to see that nobody connects to it.");
}

Watchers::~Watchers() {
  for (const int socket : {tcp_, local_})
    if (socket >= 0) ::close(socket);
}

std::vector<std::string> Watchers::found(const std::vector<fs::path>& folders) {
  std::vector<std::string> faults;
  end_processes(faults);
  look_for_connections(faults);
  for (const char* folder : {"/", "/tmp", "/var/tmp", "/dev", "/dev/shm", "/dev/mqueue", "/run"})
    look_for_mark(folder, mark_, false, faults);
  for (const fs::path& folder : folders) look_for_mark(folder, mark_, true, faults);
  for (const std::string& object : system_v_objects())
    if (!objects_.contains(object)) faults.push_back("an object of System V was left: " + object);
  for (const std::string& stage : abandoned_stages())
    if (!stages_.contains(stage)) faults.push_back("a folder was left: /tmp/" + stage);
  return faults;
}

void Watchers::end_processes(std::vector<std::string>& faults) const {
  for (int waited_ms = 0; waited_ms < kPatience_ms; waited_ms += 10) {
    const pid_t gone = ::waitpid(-1, nullptr, WNOHANG);
    if (gone < 0) return;
    if (gone == 0) ::usleep(10'000);
  }
  for (const pid_t child : children()) {
    std::string command = text_of("/proc/" + std::to_string(child) + "/comm");
    command = command.substr(0, command.find('\n'));
    faults.push_back("a process was left: " + std::to_string(child) + " " + command);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
}

void Watchers::look_for_connections(std::vector<std::string>& faults) const {
  for (const int socket : {tcp_, local_}) {
    const int caller = ::accept(socket, nullptr, nullptr);
    if (caller < 0) continue;
    ::close(caller);
    faults.push_back("a service of this machine was reached by " +
                     std::string(socket == tcp_ ? "network" : "an abstract socket"));
  }
}

}  // namespace tumble::grading
