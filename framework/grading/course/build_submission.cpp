#include "framework/grading/course/build_submission.h"

#include "framework/grading/compiler/compile.h"

namespace tumble::grading {
namespace fs = std::filesystem;

BuiltSubmission build_submission(const Course& course, const std::string& id, const fs::path& source, const fs::path& object) {
  const std::string folder = course.registry->find(id).folder;
  const Compiled compiled = compile_submission({course.root, fs::path("assignments") / folder / (folder + ".h"), source, object, {}, id, course.build});
  switch (compiled.outcome) {
    case Compiled::Outcome::kBuilt: return {BuiltSubmission::Outcome::kBuilt, compiled.said};
    case Compiled::Outcome::kRefused: return {BuiltSubmission::Outcome::kRefused, compiled.said};
    case Compiled::Outcome::kOutOfResources: return {BuiltSubmission::Outcome::kRefused, "out of time or memory while compiling: " + compiled.said};
    case Compiled::Outcome::kGraderFault: break;
  }
  return {BuiltSubmission::Outcome::kGraderFault, compiled.said};
}

fs::path module_header(const Course& course, const std::string& id) {
  const std::string folder = course.registry->find(id).folder;
  return course.root / "assignments" / folder / (folder + ".h");
}

}  // namespace tumble::grading
