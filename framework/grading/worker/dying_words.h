/// What a worker says when a signal ends it: where in the submission it was, as offsets into the
/// shared object. The judge finds their lines (crash_place.h).
#pragma once

#include <dlfcn.h>
#include <execinfo.h>
#include <signal.h>
#include <ucontext.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

namespace tumble::grading {

inline constexpr const char* kFrameWord = "frame ";  // then an offset in hexadecimal, on each line

namespace detail {

inline constexpr int kDeadly[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
inline const char* dying_object = nullptr;  // name of the submission's shared object

/// A line for a place in the submission; nothing for one elsewhere. Of a return address the byte
/// before it is meant, which is in the line of the call.
inline void say_frame(std::uintptr_t place, bool is_return) {
  Dl_info object;
  if (::dladdr(reinterpret_cast<void*>(place), &object) == 0 || object.dli_fname == nullptr ||
      std::strcmp(object.dli_fname, dying_object) != 0)
    return;
  std::uintptr_t offset =
      place - reinterpret_cast<std::uintptr_t>(object.dli_fbase) - (is_return ? 1 : 0);
  constexpr int kDigits = 2 * sizeof offset;
  char digits[kDigits + 1];
  digits[kDigits] = '\n';
  for (int at = kDigits; at > 0; offset >>= 4) digits[--at] = "0123456789abcdef"[offset & 15];
  [[maybe_unused]] ssize_t n = ::write(STDERR_FILENO, kFrameWord, std::strlen(kFrameWord));
  n = ::write(STDERR_FILENO, digits, sizeof digits);
}

/// Innermost first. Then the signal ends the process, as it would have without this.
inline void say_frames(int signal, siginfo_t*, void* context) {
#ifdef __x86_64__
  say_frame(static_cast<std::uintptr_t>(
                static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]),
            false);
#else
  (void)context;
#endif
  void* places[32];
  const int count = ::backtrace(places, 32);
  for (int i = 0; i < count; ++i) say_frame(reinterpret_cast<std::uintptr_t>(places[i]), true);
  ::raise(signal);  // its action is the default again
}

}  // namespace detail

/// @param object  the file's name, as it is loaded; lives as long as the process
inline void say_frames_when_dying(const char* object) {
  static char aside[1 << 16];  // endless recursion leaves no stack for a signal handler
  detail::dying_object = object;
  void* unused[1];
  ::backtrace(unused, 1);  // loads what it needs: not in a signal handler
  const stack_t stack{aside, 0, sizeof aside};
  ::sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_sigaction = detail::say_frames;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_ONSTACK | SA_RESETHAND);
  for (const int signal : detail::kDeadly) ::sigaction(signal, &action, nullptr);
}

}  // namespace tumble::grading
