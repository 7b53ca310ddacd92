#include "framework/dynamics/law_guard.h"

#include <fmt/format.h>

namespace tumble {

void LawGuard::refuse(const std::string& returned) const {
  throw StoppedRun(fmt::format("{} ({} of {}) returned {}", effect_, law_, source_, returned));
}

void LawGuard::refuse_size(Eigen::Index found, Eigen::Index expected) const {
  refuse(fmt::format("{} numbers instead of {}", found, expected));
}

void LawGuard::fail(const std::exception& error) const {
  const std::string words =
      fmt::format("{} ({} of {}) failed: {}", effect_, law_, source_, error.what());
  if (dynamic_cast<const Final*>(&error)) throw StoppedForGood(words);
  throw StoppedRun(words);
}

}  // namespace tumble
