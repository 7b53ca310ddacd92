/// What a test says otherwise than before.
#pragma once

#include <string>

namespace tumble::grading {

/// A test with another result than in the earlier run of the same submission's folder.
struct TestChange {
  std::string test, title;
  std::string before, after;  // "wrong, 0 of 5"
  std::string reason;         // "the submission changed"
};

}  // namespace tumble::grading
