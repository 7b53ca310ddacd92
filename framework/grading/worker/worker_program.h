/// main() of a worker: answers calls to a submission's module over the channel. It runs inside the
/// sandbox with the submission, so it contains only the module's header: no test, no expected
/// value, no other module.
#pragma once

#include <cstdio>
#include <exception>

#include "framework/core/keep_memory.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/worker/dying_words.h"
#include "framework/modules/load.h"
#include "framework/modules/serve.h"

namespace tumble::grading {

/// Command line of a worker: worker_a1 FILE.so, with the channel as descriptor 3.
template <class Module>
int run_worker(int argc, char** argv) {
  keep_freed_memory();
  if (argc != 2) return 2;
  say_frames_when_dying(argv[1]);
  try {
    const modules::AnyModule module = modules::module_of<Module>(
        modules::load_functions({Module::kId, Module::kId, ""}, argv[1]));
    modules::Channel channel(modules::Channel::End::kAnswers, kChannelFd, kChannelFd);
    modules::serve(*static_cast<const Module*>(module.get()), channel);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

}  // namespace tumble::grading
