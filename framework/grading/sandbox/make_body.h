/// The body of each kind of sandbox.
#pragma once

#include <memory>

#include "framework/grading/sandbox/body.h"

namespace tumble::grading {

/// @param job  must outlive the body
/// @throws std::runtime_error when this machine cannot provide it
std::unique_ptr<SandboxBody> make_body(const SandboxJob& job);

}  // namespace tumble::grading
