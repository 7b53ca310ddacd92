#include "framework/grading/course/build_submission.h"

namespace tumble::grading {
namespace fs = std::filesystem;

BuiltSubmission build_submission(const Course& course, const std::string& id,
                                 const fs::path& source, const fs::path& object) {
  return build_module(course.root, course.build, id, course.registry->find(id).folder, source,
                      object);
}

fs::path module_header(const Course& course, const std::string& id) {
  return course.root / header_in(course.registry->find(id).folder);
}

}  // namespace tumble::grading
