#include "framework/live/child.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

namespace tumble::live {
namespace {

void close_once(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

}  // namespace

Child::Child(const std::vector<std::string>& words) {
  int in[2], out[2], err[2];
  if (::pipe2(in, O_CLOEXEC) != 0 || ::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(err, O_CLOEXEC) != 0)
    throw std::runtime_error("no descriptor left for a process");
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) {  // only what is safe after a fork of a program with threads
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    ::setpgid(0, 0);  // Ctrl-C is for the server, which ends the others
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::signal(SIGPIPE, SIG_DFL);
    ::dup2(in[0], STDIN_FILENO);
    ::dup2(out[1], STDOUT_FILENO);
    ::dup2(err[1], STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(in[0]);
  ::close(out[1]);
  ::close(err[1]);
  input_ = in[1];
  output_ = out[0];
  talk_ = err[0];
  for (const int fd : {input_, output_, talk_}) ::fcntl(fd, F_SETFL, O_NONBLOCK);
  if (pid_ < 0) throw std::runtime_error("no process can be started");
}

Child::~Child() {
  if (!has_ended_ && pid_ > 0) {
    ::kill(-pid_, SIGKILL);
    ::kill(pid_, SIGKILL);
    wait();
  }
  close_once(input_);
  close_once(output_);
  close_once(talk_);
}

void Child::say(const std::string& line) {
  const std::string text = line + "\n";
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = ::write(input_, text.data() + sent, text.size() - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) {  // a long document, or a process that does not read
      constexpr int kPatienceMs = 1000;
      pollfd waiting{input_, POLLOUT, 0};
      if (::poll(&waiting, 1, kPatienceMs) > 0) continue;
      return;
    }
    if (n <= 0) return;
    sent += static_cast<std::size_t>(n);
  }
}

void Child::close_input() { close_once(input_); }

void Child::read_talk(std::string& text) {
  if (talk_is_open_) talk_is_open_ = read_some(talk_, text);
}

bool Child::read_some(int fd, std::string& text) {
  constexpr std::size_t kAtOnce = 4u << 20;  // bytes: others have their turn
  char buffer[1 << 16];
  for (std::size_t got = 0; got < kAtOnce;) {
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return true;
    if (n <= 0) return false;
    text.append(buffer, static_cast<std::size_t>(n));
    got += static_cast<std::size_t>(n);
  }
  return true;
}

int Child::wait() {
  if (has_ended_) return code_;
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  has_ended_ = true;
  code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return code_;
}

}  // namespace tumble::live
