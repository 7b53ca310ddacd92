#include "framework/grading/platforms/platform.h"

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"

namespace tumble::grading {
namespace {

const std::vector<std::string> kPlatforms = {"gradescope", "artemis", "github-classroom",
                                             "autolab"};

}  // namespace

const std::string& name_of(Platform platform) {
  return kPlatforms.at(static_cast<std::size_t>(platform));
}

Platform platform_named(const std::string& name) {
  for (std::size_t i = 0; i < kPlatforms.size(); ++i)
    if (kPlatforms[i] == name) return static_cast<Platform>(i);
  throw UserError(name, "is no platform that is known here." + did_you_mean(name, kPlatforms),
                  fmt::format("Known: {}.", fmt::join(kPlatforms, ", ")));
}

bool has_hidden_tests(Platform platform) { return platform != Platform::kGithubClassroom; }

}  // namespace tumble::grading
