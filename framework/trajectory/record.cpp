#include "framework/trajectory/record.h"

namespace tumble {

std::string joined_record(const std::vector<std::string>& parts) {
  std::string record;
  for (const std::string& part : parts)
    if (!part.empty()) record += (record.empty() ? "" : " · ") + part;
  return record;
}

std::string version_in_words(const std::string& version) {
  return version.empty() ? "" : "Tumble " + version;
}

std::string scene_in_words(const std::string& name, const std::string& digest,
                           const std::vector<std::uint64_t>& seeds) {
  // 64 bits: enough that two scenes do not share them by chance
  constexpr std::size_t kShownDigits = 16;
  // a scene with a size has its name in front: "atoms n=300"
  const std::string known =
      digest.starts_with(name + ' ') ? digest.substr(name.size() + 1) : digest;
  std::string words =
      name.empty() ? ""
                   : "scene " + name + (known.empty() ? "" : " " + known.substr(0, kShownDigits));
  for (std::size_t i = 0; i < seeds.size(); ++i)
    words += (i > 0 ? ", " : seeds.size() > 1 ? ", seeds " : ", seed ") + std::to_string(seeds[i]);
  return words;
}

std::string record_of(const TrajectoryInfo& info) {
  return joined_record({info.command, version_in_words(info.version),
                        scene_in_words(info.scene_name, info.scene_digest, info.seeds)});
}

}  // namespace tumble
