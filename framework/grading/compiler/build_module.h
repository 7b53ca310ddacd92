/// From a source that somebody handed in to a shared object of an assignment's module.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::grading {

struct BuiltSubmission {
  enum class Outcome { kBuilt, kRefused, kGraderFault };
  Outcome outcome = Outcome::kGraderFault;
  std::string said;  // the compiler's words, cut short; or why it could not be asked
};

/// Compiles in the sandbox, where nothing of the project but headers can be seen.
/// @param root, build   of the source tree and of the build tree
/// @param id, folder    of the assignment, e.g. "a1", "a1_impulse"
/// @param object        written where the outcome is kBuilt
BuiltSubmission build_module(const std::filesystem::path& root, const std::filesystem::path& build,
                             const std::string& id, const std::string& folder,
                             const std::filesystem::path& source,
                             const std::filesystem::path& object);

/// The same for a student's own tests of the module: `object` becomes a program for own_tests_ID.
BuiltSubmission build_own_tests(const std::filesystem::path& root,
                                const std::filesystem::path& build, const std::string& id,
                                const std::string& folder, const std::filesystem::path& source,
                                const std::filesystem::path& object);

/// What every submission is compiled with.
const char* submission_flags();

/// The words of a compilation of the user's own file outside the sandbox, with the same flags and
/// the same precompiled header: g++ and what follows.
std::vector<std::string> own_compilation(const std::filesystem::path& root,
                                         const std::filesystem::path& build,
                                         const std::filesystem::path& source,
                                         const std::filesystem::path& object);

/// The header that says what the module of an assignment is, from the root.
std::filesystem::path header_in(const std::string& folder);

}  // namespace tumble::grading
