/// main() of a worker that a submission is linked into, for a sandbox in which no file can be
/// opened: it is a program of its own, and loads nothing.
#pragma once

#include <cstdio>
#include <exception>

#include "framework/core/keep_memory.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/modules/serve.h"

namespace tumble::grading {

/// @param exported  what the submission exports by TUMBLE_MODULE
template <class Module>
int run_linked_worker(const void* (*exported)()) {
  keep_freed_memory();
  try {
    modules::Channel channel(modules::Channel::End::kAnswers, kChannelFd, kChannelFd);
    modules::serve(Module::of(*static_cast<const typename Module::Addresses*>(exported())),
                   channel);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

}  // namespace tumble::grading
