#include "framework/grading/worker/guarded_calls.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "framework/core/not_implemented.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/grading/verdicts/death.h"
#include "framework/grading/worker/worker_connection.h"

namespace tumble::grading {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(250);  // between two checks of the calls
constexpr double kChecksPerSecond = 4.0;
std::atomic<double> limit_s{kGuardedCallLimit};
std::atomic<bool> tells_frames{false};
std::atomic<void (*)()> says_more{nullptr};
// A call has been too long: its thread is to say where it is.
constexpr int kWhere = SIGUSR2;
constexpr std::array kSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr const char* kLoading = "its global and static variables";

/// The current call of one thread. Written by that thread, read by watch() and by signal handlers.
struct CallPlace {
  std::atomic<const char*> function{nullptr};  // the innermost guarded function; null: none
  std::atomic<const char*> file{nullptr};      // its file
  std::atomic<unsigned long> outermost{0};     // number of outermost calls so far
  std::atomic<pthread_t> thread{};
  unsigned long seen = 0;  // used by watch() only
  int checks = 0;          // used by watch() only
};

constexpr std::size_t kThreads = 256;  // more run unguarded
CallPlace places[kThreads];
std::atomic<std::size_t> threads{0};
thread_local CallPlace* here = nullptr;
// prepared in advance: a signal handler must not allocate memory
char signal_words[kSignals.size()][256];

void say(const char* text) { say_in_handler(text); }

void say_frames() {
  void* places_in_code[48];
  const int count = ::backtrace(places_in_code, 48);
  for (int i = 0; i < count; ++i) {
    Dl_info object;
    if (::dladdr(places_in_code[i], &object) == 0 || object.dli_fname == nullptr) continue;
    // behind the call: one byte earlier is in its line
    auto offset = reinterpret_cast<std::uintptr_t>(places_in_code[i]) -
                  reinterpret_cast<std::uintptr_t>(object.dli_fbase) - 1;
    char digits[24] = "0x";
    int at = 2 + 2 * static_cast<int>(sizeof offset);
    digits[at] = '\0';
    for (; at > 2; offset >>= 4) digits[--at] = "0123456789abcdef"[offset & 15];
    say("frame ");
    say(object.dli_fname);
    say(" ");
    say(digits);
    say("\n");
  }
}

[[noreturn]] void leave(const char* what, const char* function, const char* file) {
  say("\ntumble: ");
  say(file);
  say(": ");
  say(what);
  say(", in ");
  say(function);
  say("\n  The run ends here. ./tumble check tests each function separately and shows its "
      "arguments.\n");
  ::_exit(1);
}

char out_of_time_words[96];

void on_signal(int signal) {
  const char* function = here != nullptr ? here->function.load() : nullptr;
  if (tells_frames) say_frames();
  if (void (*const more)() = says_more) more();
  if (signal == kWhere && function != nullptr) leave(out_of_time_words, function, here->file);
  if (function != nullptr)
    for (std::size_t i = 0; i < kSignals.size(); ++i)
      if (kSignals[i] == signal) leave(signal_words[i], function, here->file);
  ::signal(signal, SIG_DFL);  // not in a module: the default action
  ::raise(signal);
}

[[noreturn]] void watch() {
  char* const words = out_of_time_words;
  for (;;) {
    std::this_thread::sleep_for(kPeriod);
    for (std::size_t i = 0; i < std::min(threads.load(), kThreads); ++i) {
      CallPlace& place = places[i];
      const char* function = place.function.load();
      const unsigned long call = place.outermost.load();
      if (function == nullptr || call != place.seen)
        place.checks = 0;
      else if (++place.checks > static_cast<int>(kChecksPerSecond * limit_s)) {
        std::snprintf(words, sizeof out_of_time_words,
                      "out of time: no answer within %g s (an endless loop?)", limit_s.load());
        if (tells_frames) {
          ::pthread_kill(place.thread, kWhere);
          std::this_thread::sleep_for(kPeriod);
        }
        leave(words, function, place.file);
      }
      place.seen = call;
    }
  }
}

void start_guard() {
  static std::once_flag once;
  std::call_once(once, [] {
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_ONSTACK | SA_NODEFER;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      std::snprintf(signal_words[i], sizeof signal_words[i], "%s",
                    signal_words_of(kSignals[i]).c_str());
      ::sigaction(kSignals[i], &action, nullptr);
    }
    ::sigaction(kWhere, &action, nullptr);
    std::thread(watch).detach();
  });
}

// Endless recursion leaves no stack for the signal handler: each calling thread has an alternate
// stack.
void enter_thread() {
  constexpr std::size_t kStack = 1u << 16;  // bytes
  thread_local std::unique_ptr<char[]> stack;
  const std::size_t index = threads.fetch_add(1);
  if (index >= kThreads) return;
  here = &places[index];
  here->thread = ::pthread_self();
  stack = std::make_unique<char[]>(kStack);
  const stack_t aside{stack.get(), 0, kStack};
  ::sigaltstack(&aside, nullptr);
}

class Guard : public modules::CallWatcher {
 public:
  explicit Guard(std::string file) : file_(std::move(file)) { start_guard(); }

  const char* begin(const char* function) override {
    if (here == nullptr) enter_thread();
    if (here == nullptr) return nullptr;
    const char* outer = here->function.load(std::memory_order_relaxed);
    if (outer == nullptr)
      here->outermost.store(here->outermost.load(std::memory_order_relaxed) + 1,
                            std::memory_order_relaxed);
    here->file.store(file_.c_str(), std::memory_order_relaxed);
    here->function.store(function, std::memory_order_relaxed);
    return outer;
  }
  void end(const char* outer) override {
    if (here != nullptr) here->function.store(outer, std::memory_order_relaxed);
  }
  void threw(const char* function, const std::exception& error) override {
    // Exceptions of the framework, thrown by callbacks, are not the module's.
    const bool ours =
        dynamic_cast<const NotImplemented*>(&error) || dynamic_cast<const UserError*>(&error) ||
        dynamic_cast<const PreconditionError*>(&error) || dynamic_cast<const Final*>(&error) ||
        dynamic_cast<const engines::StoppedRun*>(&error);
    if (!ours) throw CallEnded(file_ + ": " + function + " threw an exception: " + error.what());
  }

 private:
  std::string file_;
};

// Never deleted, like the laws that were copied from the table.
Guard& lasting_guard(const std::string& file) { return *new Guard(file); }

}  // namespace

void say_in_handler(const char* text) {
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, text, std::strlen(text));
}

void say_in_handler(std::uint64_t number) {
  char digits[24];
  char* first = digits + sizeof digits;
  *--first = '\0';
  do {
    *--first = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number > 0);
  say_in_handler(first);
}

void guard_for_another(double seconds, void (*say_more)()) {
  limit_s = seconds;
  says_more = say_more;
  void* unused[1];
  ::backtrace(unused, 1);  // loads what it needs: not in a signal handler
  tells_frames = true;
}

modules::AnyModule guarded(const modules::ModuleKind& kind, const modules::AnyModule& module,
                           const std::string& file) {
  return kind.watched(module, lasting_guard(file));
}

modules::AnyModule guarded_load(const std::string& file,
                                const std::function<modules::AnyModule()>& load) {
  Guard& guard = lasting_guard(file);
  const modules::detail::WatchedCall call(guard, kLoading);
  return load();
}

}  // namespace tumble::grading
