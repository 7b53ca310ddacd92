/// The sandbox by namespaces: bubblewrap creates them, and starts process 1 inside.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/sandbox/body.h"

namespace tumble::grading {

class BubblewrapBody : public SandboxBody {
 public:
  explicit BubblewrapBody(const SandboxJob& job) : job_(job) {}
  [[noreturn]] void become() override;

 private:
  std::vector<std::string> command() const;  // absolute path of bubblewrap, then its arguments
  const SandboxJob& job_;
};

}  // namespace tumble::grading
