#include "framework/grading/test_program/crash_line.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <signal.h>
#include <ucontext.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

DyingPlaces* noted = nullptr;

void note(int signal, siginfo_t*, void* context) {
  std::size_t count = 0;
#ifdef __x86_64__
  noted->places[count++] = static_cast<std::uintptr_t>(
      static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
#else
  (void)context;
#endif
  // Of a return address the byte before it is meant, which is in the line of the call.
  void* frames[DyingPlaces::kMost - 1];
  const int found = ::backtrace(frames, static_cast<int>(DyingPlaces::kMost - 1));
  for (int i = 0; i < found; ++i)
    noted->places[count++] = reinterpret_cast<std::uintptr_t>(frames[i]) - 1;
  noted->count = count;
  ::raise(signal);  // its action is the default again
}

}  // namespace

void note_places_when_dying(DyingPlaces& places) {
  static char aside[1 << 16];  // endless recursion leaves no stack for a signal handler
  noted = &places;
  void* unused[1];
  ::backtrace(unused, 1);  // loads what it needs: not in a signal handler
  const stack_t stack{aside, 0, sizeof aside};
  ::sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_sigaction = note;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_ONSTACK | SA_RESETHAND);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    ::sigaction(signal, &action, nullptr);
}

std::string line_in_source(const std::string& told, const std::string& source) {
  std::error_code ignored;
  const fs::path wanted = fs::weakly_canonical(source, ignored);
  std::istringstream lines(told);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.rfind(':');
    if (colon == line.npos || fs::weakly_canonical(line.substr(0, colon), ignored) != wanted)
      continue;
    if (const int number = std::atoi(line.c_str() + colon + 1); number > 0)
      return fmt::format("{}:{}", wanted.filename().string(), number);
  }
  return "";
}

std::string line_of_crash(const DyingPlaces& places, const std::string& source) {
  constexpr double kLimit = 20.0;  // s
  if (source.empty()) return "";
  // The program itself, or the shared object of an installed course.
  std::string told, file;
  std::vector<std::string> words;
  const auto look_up = [&] {
    if (words.empty()) return;
    words.insert(words.begin(), {"addr2line", "-i", "-e", file});
    told += run_program(words, Output::kCaptured, kLimit).printed;
    words.clear();
  };
  for (std::size_t i = 0; i < std::min(places.count.load(), DyingPlaces::kMost); ++i) {
    Dl_info object;
    if (::dladdr(reinterpret_cast<void*>(places.places[i]), &object) == 0 ||
        object.dli_fname == nullptr)
      continue;
    const auto base = reinterpret_cast<std::uintptr_t>(object.dli_fbase);
    static const auto own = [] {
      Dl_info program{};
      ::dladdr(reinterpret_cast<void*>(&note_places_when_dying), &program);
      return reinterpret_cast<std::uintptr_t>(program.dli_fbase);
    }();
    const std::string in =
        base == own ? fs::read_symlink("/proc/self/exe").string() : std::string(object.dli_fname);
    if (in != file) look_up();
    file = in;
    words.push_back(fmt::format("{:#x}", places.places[i] - base));
  }
  look_up();
  return line_in_source(told, source);
}

}  // namespace tumble::grading
