#include "framework/grading/sandbox/start_once.h"

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace tumble::grading {
namespace {

union Control {
  char bytes[CMSG_SPACE(sizeof(int))];
  cmsghdr align;
};

}  // namespace

void send_start_permit(int socket) {
  // Other architectures are the second filter's matter: it kills their calls.
  sock_filter asks[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_execve, 1, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_execveat, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  sock_fprog program{sizeof asks / sizeof asks[0], asks};
  int listener = static_cast<int>(
      ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program));
  if (listener < 0) throw std::runtime_error("the kernel refuses a filter that asks about execve");
  char byte = 0;
  iovec text{&byte, 1};
  Control control{};
  msghdr message{};
  message.msg_iov = &text;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes;
  message.msg_controllen = sizeof control.bytes;
  cmsghdr* head = CMSG_FIRSTHDR(&message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof listener);
  std::memcpy(CMSG_DATA(head), &listener, sizeof listener);
  const bool is_sent = ::sendmsg(socket, &message, 0) == 1;
  ::close(listener);
  ::close(socket);
  if (!is_sent) throw std::runtime_error("the keeper has ended");
}

void permit_one_start(int socket) {
  char byte = 0;
  iovec text{&byte, 1};
  Control control{};
  msghdr message{};
  message.msg_iov = &text;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes;
  message.msg_controllen = sizeof control.bytes;
  if (::recvmsg(socket, &message, MSG_CMSG_CLOEXEC) != 1) return;
  const cmsghdr* head = CMSG_FIRSTHDR(&message);
  if (head == nullptr || head->cmsg_type != SCM_RIGHTS) return;
  int listener = -1;
  std::memcpy(&listener, CMSG_DATA(head), sizeof listener);
  seccomp_notif asked{};
  pollfd waiting{listener, POLLIN, 0};  // also ends when the child does
  if (::poll(&waiting, 1, -1) == 1 && (waiting.revents & POLLIN) != 0 &&
      ::ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &asked) == 0) {
    seccomp_notif_resp answer{};
    answer.id = asked.id;
    answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
    ::ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &answer);
  }
  ::close(listener);
}

}  // namespace tumble::grading
