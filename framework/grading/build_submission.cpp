#include "framework/grading/build_submission.h"

#include <sstream>

#include "framework/grading/compile.h"
#include "framework/grading/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr double kCompileWall = 120.0;          // s: a module takes 3 on an idle core
constexpr std::size_t kSaidLines = 40;          // of the compiler: the first errors are those that matter

}  // namespace

BuiltSubmission build_own(const Course& course, const fs::path& source, const fs::path& object) {
  const std::vector<std::string> words = {"g++", "-std=c++20", "-O2", "-fPIC", "-shared", "-ffp-contract=off", "-fno-gnu-unique", "-Wl,-z,defs",
                                          "-DTUMBLE_BUILDING_MODULE", "-I", course.root.string(), "-isystem", "/usr/include/eigen3",
                                          source.string(), "-o", object.string()};
  const ProgramOutcome outcome = run_program(words, Output::kCaptured, kCompileWall);
  if (outcome.code == 127) return {BuiltSubmission::Outcome::kGraderFault, "g++ cannot be started"};
  return {outcome.code == 0 ? BuiltSubmission::Outcome::kBuilt : BuiltSubmission::Outcome::kRefused, outcome.printed};
}

BuiltSubmission build_submission(const Course& course, const std::string& id, const fs::path& source, const fs::path& object) {
  using Outcome = BuiltSubmission::Outcome;
  const std::string folder = course.registry->find(id).folder;
  CompileJob job;
  job.root = course.root;
  job.header = fs::path("assignments") / folder / (folder + ".h");
  job.source = source;
  job.object = object;
  const Compiled compiled = compile_submission(job);
  switch (compiled.outcome) {
    case Compiled::Outcome::kBuilt: return {Outcome::kBuilt, compiled.said};
    case Compiled::Outcome::kRefused:
    case Compiled::Outcome::kOutOfResources: return {Outcome::kRefused, compiled.said};
    case Compiled::Outcome::kGraderFault: break;
  }
  return {Outcome::kGraderFault, compiled.said};
}

std::string compiler_story(const std::string& said, const fs::path& source) {
  const std::string name = source.filename().string();
  std::istringstream in(said);
  std::string story, all;
  std::size_t lines = 0;
  bool inside = false;
  for (std::string line; std::getline(in, line) && lines < kSaidLines;) {
    // What stands before the file's name on its line is a folder of this machine: nobody needs to know it.
    if (const auto at = line.find(name + ":"); at != std::string::npos && line.find_first_of(" '\"") > at) line.erase(0, at);
    all += line + "\n";
    const bool is_error = line.find("error:") != std::string::npos || line.find("undefined") != std::string::npos;
    const bool is_other = line.find("warning:") != std::string::npos || line.find("note:") != std::string::npos || line.find("In ") == 0;
    inside = is_error || (inside && !is_other);   // the lines of code that follow an error
    if (!inside) continue;
    story += line + "\n";
    ++lines;
  }
  return story.empty() ? all.substr(0, 4000) : story;
}

}  // namespace tumble::grading
