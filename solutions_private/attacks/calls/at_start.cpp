// Attacks at program start, before any call. A macro selects one at compilation.
#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <new>

#include "tests/modules/waist.h"

#if defined(OWN_MAIN)
int main() { return 0; }
void* operator new(std::size_t) { ::_exit(0); }
extern "C" void* malloc(std::size_t) { ::_exit(0); }
#elif defined(OWN_NEW)
static char arena[1 << 24];
static std::size_t used = 0;
void* operator new(std::size_t n) { return arena + (used += (n + 63) / 64 * 64); }
void operator delete(void*) noexcept {}
void operator delete(void*, std::size_t) noexcept {}
#elif defined(LOOP)
static const int before_anything = [] {
  for (;;) ::pause();
  return 0;
}();
#else
static const int before_anything = [] {
  std::puts("[  PASSED  ] 81 tests.");
  std::fflush(stdout);
  ::exit(0);
  return 0;
}();
#endif

namespace tumble::waist {

double twice(double x) { return 2.0 * x; }
Everything echo(const Everything& value) { return value; }
double call_back(const std::function<double(double)>&, int) { return 0.0; }
std::string attack(const std::string& what) { return what; }
double missing(double) { return 0.0; }
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>&, const VectorXd& y,
              const std::string&) {
  return y;
}

}  // namespace tumble::waist
