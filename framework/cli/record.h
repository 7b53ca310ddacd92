/// Provenance: the last line of a page, and the head of JSON output: command, version, and scene.
#pragma once

#include <string>

#include "framework/cli/command.h"
#include "framework/core/version.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/record.h"

namespace tumble::cli {

inline std::string record_of(const Command& command) {
  return joined_record({command.command_line, version_in_words(kProgramVersion)});
}
inline std::string record_of(const Command& command, const scene::Scene& scene) {
  return joined_record({record_of(command), scene_in_words(scene.name, scene.digest, scene.seeds)});
}

}  // namespace tumble::cli
