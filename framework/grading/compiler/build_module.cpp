#include "framework/grading/compiler/build_module.h"

#include <sstream>

#include "framework/grading/compiler/compile.h"

namespace tumble::grading {
namespace fs = std::filesystem;

fs::path header_in(const std::string& folder) {
  return fs::path("assignments") / folder / (folder + ".h");
}

const char* submission_flags() { return TUMBLE_SUBMISSION_FLAGS; }

std::vector<std::string> own_compilation(const fs::path& root, const fs::path& build,
                                         const fs::path& source, const fs::path& object) {
  // No -Wpedantic: the precompiled header is refused by it, and a check takes 2 s longer.
  std::vector<std::string> words = {"g++"};
  std::istringstream flags(submission_flags());
  for (std::string flag; flags >> flag;) words.push_back(flag);
  const fs::path sdk = build / "submission_sdk";
  const bool has_kernels = fs::exists(sdk / "libkernels.a");
  if (!has_kernels) words.push_back("-DTUMBLE_NO_KERNELS");
  words.insert(words.end(), {"-Wall", "-Wextra", "-fdiagnostics-color=never", "-shared",
                             "-Wl,-z,defs", "-I", root.string(), "-isystem", TUMBLE_EIGEN_INCLUDE,
                             "-include", (sdk / "precompiled.h").string(), source.string()});
  if (has_kernels) words.push_back((sdk / "libkernels.a").string());
  words.insert(words.end(), {"-o", object.string()});
  return words;
}

namespace {

BuiltSubmission built(const CompileJob& job) {
  const Compiled compiled = compile_submission(job);
  switch (compiled.outcome) {
    case Compiled::Outcome::kBuilt: return {BuiltSubmission::Outcome::kBuilt, compiled.said};
    case Compiled::Outcome::kRefused: return {BuiltSubmission::Outcome::kRefused, compiled.said};
    case Compiled::Outcome::kOutOfResources:
      return {BuiltSubmission::Outcome::kRefused,
              "out of time or memory while compiling: " + compiled.said};
    case Compiled::Outcome::kGraderFault: break;
  }
  return {BuiltSubmission::Outcome::kGraderFault, compiled.said};
}

}  // namespace

BuiltSubmission build_module(const fs::path& root, const fs::path& build, const std::string& id,
                             const std::string& folder, const fs::path& source,
                             const fs::path& object) {
  return built({root, header_in(folder), source, object, {}, id, build});
}

BuiltSubmission build_own_tests(const fs::path& root, const fs::path& build, const std::string& id,
                                const std::string& folder, const fs::path& source,
                                const fs::path& object) {
  return built({root, header_in(folder), source, object, {}, id, build, CompileJob::Form::kTests});
}

}  // namespace tumble::grading
