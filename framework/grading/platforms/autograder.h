/// What is uploaded to a platform, so that it grades an assignment: scripts in the platform's
/// layout and, in the same archive, the Debian packages that they run.
#pragma once

#include <filesystem>
#include <map>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/zip.h"
#include "framework/grading/platforms/platform.h"

namespace tumble::grading {

struct AutograderParts {
  std::string assignment;  // "a1"
  std::string file;        // that students hand in, "a1_impulse.cpp"
  std::string title;       // of the assignment
  double open_points = 0.0, hidden_points = 0.0;
  // a right solution below /opt/tumble-grader, by which an installation proves itself
  std::string proof;
  std::string containerfile;        // of the image with the grader (framework/packaging)
  std::vector<ZipMember> packages;  // name of the file, bytes
};

/// Members of the archive. The marks @id@, @file@ and so on of each script are filled in. Scripts
/// find the program, and the platform's folders, by variables with the platform's own places as
/// defaults, so that they can be tried anywhere.
/// @param scripts  framework/packaging/platforms: a folder a platform, in the layout that it takes
/// @throws UserError when there is none
std::vector<ZipMember> autograder(Platform platform, const std::filesystem::path& scripts,
                                  const AutograderParts& parts);

}  // namespace tumble::grading
