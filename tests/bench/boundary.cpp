// The cost of a function of a submission in a sandbox: a call, a callback, a new worker; on the machine
// as it is, and beside two programs a core that compute without end, as compilers beside it do.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/places.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/modules/proxy.h"
#include "tests/modules/waist.h"

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Figure {
  double median_us, best_us;  // of batches: the best one was not disturbed by other programs
};

template <class Work>
Figure measure(int batches, int repeats, Work&& work) {
  std::vector<double> all;
  for (int b = 0; b < batches; ++b) {
    const auto start = Clock::now();
    for (int i = 0; i < repeats; ++i) work();
    all.push_back(1e6 * seconds_since(start) / repeats);
  }
  std::sort(all.begin(), all.end());
  return {all[static_cast<std::size_t>(batches / 2)], all.front()};
}

// Processes that compute until the end of this object.
class Strangers {
 public:
  explicit Strangers(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const pid_t child = ::fork();
      if (child == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (volatile int n = 0;; n = n + 1) {
        }
      }
      if (child > 0) children_.push_back(child);
    }
  }
  Strangers(const Strangers&) = delete;
  Strangers& operator=(const Strangers&) = delete;
  ~Strangers() {
    for (const pid_t child : children_) ::kill(child, SIGKILL);
    for (const pid_t child : children_) ::waitpid(child, nullptr, 0);
  }

 private:
  std::vector<pid_t> children_;
};

}  // namespace

int main() {
  using namespace tumble;
  grading::WorkerOptions options;
  options.id = "waist";
  options.module = tumble::test::binary_dir() + "/modules/waist_right.so";
  options.session_own_s = 60.0;
  options.call_own_s = 60.0;
  for (const auto& [sandboxed, busy] :
       {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    const Strangers strangers(busy ? 2 * std::thread::hardware_concurrency() : 0);
    options.sandboxed = sandboxed;
    grading::WorkerConnection connection(options);
    const auto module = modules::make_proxy<waist::Module>(connection);
    const Figure start = measure(11, 1, [&] {
      connection.reset();
      module.twice(1.0);
    });
    const Figure call = measure(101, 200, [&] { module.twice(1.0); });
    const Figure callback =
        measure(101, 1, [&] { module.call_back([](double x) { return x; }, 200); });
    std::printf(
        "%-10s %-4s  a call %6.2f us (best %.2f)   a callback %6.2f us (best %.2f)   "
        "a fresh worker %7.2f ms (best %.2f)\n",
        sandboxed ? "sandboxed" : "plain", busy ? "busy" : "", call.median_us, call.best_us,
        callback.median_us / 200, callback.best_us / 200, 1e-3 * start.median_us,
        1e-3 * start.best_us);
  }
}
