// Two threads count in one place without a lock. Under the flags of test_threads_sanitized this
// must be reported: a sanitizer that is silent here would be silent there.
#include <cstdio>
#include <thread>

int main() {
  long count = 0;
  const auto work = [&count] {
    for (int k = 0; k < 100000; ++k) ++count;
  };
  std::thread first(work), second(work);
  first.join();
  second.join();
  std::printf("counted to %ld\n", count);
}
