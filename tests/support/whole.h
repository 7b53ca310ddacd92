/// Whether the tests run whole: `./tumble test --whole`. By default the longest draw a sample, and
/// what only repeats a contract at greater length is skipped.
#pragma once

#include <cstdlib>

namespace tumble::test {

inline bool is_whole() {
  const char* whole = std::getenv("TUMBLE_TEST_WHOLE");
  return whole && *whole;
}

}  // namespace tumble::test

/// At the beginning of a test that only a whole run needs.
#define TUMBLE_ONLY_WHOLE() \
  if (!tumble::test::is_whole()) GTEST_SKIP() << "part of ./tumble test --whole"
