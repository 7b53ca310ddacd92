#include "framework/grading/sandbox/make_body.h"

#include "framework/grading/sandbox/bubblewrap.h"
#include "framework/grading/sandbox/host_body.h"

namespace tumble::grading {

std::unique_ptr<SandboxBody> make_body(const SandboxJob& job) {
  if (job.kind == SandboxKind::kNamespaces) return std::make_unique<BubblewrapBody>(job);
  return std::make_unique<HostBody>(job);
}

}  // namespace tumble::grading
