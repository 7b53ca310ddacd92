/// The platforms that Tumble can grade on.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

enum class Platform { kGradescope, kArtemis, kGithubClassroom, kAutolab };

/// "gradescope", "artemis", "github-classroom", "autolab"
const std::string& name_of(Platform platform);
/// @throws UserError that names the nearest platform
Platform platform_named(const std::string& name);

/// Whether hidden tests may run there: everybody who may push to a repository on GitHub can read
/// what its workflow reads, so public tests alone run there.
bool has_hidden_tests(Platform platform);

}  // namespace tumble::grading
