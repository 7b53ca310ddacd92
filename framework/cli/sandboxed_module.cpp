#include "framework/cli/sandboxed_module.h"

#include <cstdio>

#include "framework/core/files.h"
#include "framework/grading/course/build_submission.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/worker/worker_connection.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

void compile(const Context& context, const modules::ModuleKind& kind, const fs::path& source,
             const fs::path& object) {
  using Outcome = grading::BuiltSubmission::Outcome;
  std::fprintf(stderr, "compiling %s in the sandbox (%s)\n", source.c_str(),
               grading::traits_of(grading::chosen_sandbox()).name);
  const grading::Course course{context.root, context.build, &context.registry,
                               context.command_line};
  const auto built = grading::build_submission(course, kind.id, source, object);
  if (built.outcome == Outcome::kGraderFault)
    throw std::runtime_error("the sandboxed compiler could not be asked: " + built.said);
  if (built.outcome == Outcome::kRefused)
    throw UserError(
        source.string(),
        "does not compile:\n" +
            grading::compiler_story(built.said, source, grading::module_header(course, kind.id)) +
            "\n",
        "Correct it, or name another file after --modules.");
}

}  // namespace

SandboxedModule load_sandboxed(const Context& context, const modules::ModuleKind& kind,
                               const fs::path& file) {
  const PrivateFolder folder;
  grading::WorkerOptions options;
  options.id = kind.id;
  options.module = file;
  if (file.extension() != ".cpp" && grading::traits_of(grading::chosen_sandbox()).links_worker)
    throw UserError(file.string(),
                    "is a shared object, which the sandbox of this machine cannot load",
                    "Give the source file: tumble doctor says why.");
  options.session_own_s = 600.0;            // for a whole scene, watched by its user
  options.callback_budget = 1'000'000'000;  // the wall limit comes first
  if (file.extension() == ".cpp") {
    options.module = folder.path() / (kind.id + ".so");
    compile(context, kind, file, options.module);
  }
  grading::call_log() = grading::CallLog{};
  const auto depth = [&]() -> SandboxedModule::Depth {
    // copies the object: the folder may be deleted
    auto connection = std::make_shared<grading::WorkerConnection>(options);
    return {kind.make_proxy(*connection), connection};
  };
  return {depth(), depth(), depth()};
}

}  // namespace tumble::cli
