#include "framework/grading/build_submission.h"

#include <sstream>

#include "framework/grading/compile.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSaidLines = 40;  // of the compiler: the first errors are those that matter

// What to do about errors that a student cannot read off the line.
std::string advice_on(const std::string& said) {
  const auto has = [&](const char* words) { return said.find(words) != std::string::npos; };
  if (has("internal compiler error"))
    return "The compiler itself failed at that line: your code may be right. Write the line in another way (shorter expressions, a variable for a part); "
           "if that does not help, show it to your instructor.\n";
  if (has("No such file or directory"))
    return "Only this one file is compiled, with the course's own headers. Include those as the starter does (\"assignments/...\"), and put into the file what you have in headers of your own.\n";
  return "";
}

}  // namespace

BuiltSubmission build_submission(const Course& course, const std::string& id, const fs::path& source, const fs::path& object) {
  const std::string folder = course.registry->find(id).folder;
  const Compiled compiled = compile_submission({course.root, fs::path("assignments") / folder / (folder + ".h"), source, object, {}, course.build});
  switch (compiled.outcome) {
    case Compiled::Outcome::kBuilt: return {BuiltSubmission::Outcome::kBuilt, compiled.said};
    case Compiled::Outcome::kRefused: return {BuiltSubmission::Outcome::kRefused, compiled.said};
    case Compiled::Outcome::kOutOfResources: return {BuiltSubmission::Outcome::kRefused, "out of time or memory while compiling: " + compiled.said};
    case Compiled::Outcome::kGraderFault: break;
  }
  return {BuiltSubmission::Outcome::kGraderFault, compiled.said};
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
  return (story.empty() ? all.substr(0, 4000) : story) + advice_on(said);
}

}  // namespace tumble::grading
