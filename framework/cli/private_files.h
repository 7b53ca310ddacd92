/// What of the instructor's tree no student may see, for the proofs of a release and of a package.
#pragma once

#include <string>
#include <vector>

#include "framework/cli/verb.h"
#include "framework/grading/course/release_checks.h"

namespace tumble::cli {

inline constexpr const char* kPrivateFolder = "solutions_private";

/// Every private text, and the whole wrong solution that each slip makes. A flawed submission is a
/// student's file, whose unchanged part is the stub, and what CMake says of solutions is harmless:
/// neither is among them.
/// @param published  ids whose reference is public
std::vector<grading::PrivateFile> private_files(const Context& context,
                                                const std::vector<std::string>& published);

}  // namespace tumble::cli
