#include "framework/grading/platforms/autograder.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/tar.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/platforms/formats.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Members = std::vector<ZipMember>;

std::map<std::string, std::string> words_of(const AutograderParts& parts) {
  return {{"@id@", parts.assignment},
          {"@file@", parts.file},
          {"@title@", parts.title},
          {"@proof@", parts.proof},
          {"@open@", kAutolabPublic},
          {"@hidden@", kAutolabHidden},
          {"@open_points@", points_text(parts.open_points)},
          {"@hidden_points@", points_text(parts.hidden_points)}};
}

std::string filled(std::string text, const AutograderParts& parts) {
  for (const auto& [mark, word] : words_of(parts))
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += word.size())
      text.replace(at, mark.size(), word);
  return text;
}

// Every file below the folder, by its path, with the words of the assignment in it.
Members scripts_below(const fs::path& folder, const AutograderParts& parts) {
  std::error_code failed;
  Members members;
  for (fs::recursive_directory_iterator it(folder, failed), end; !failed && it != end;
       it.increment(failed)) {
    if (!it->is_regular_file()) continue;
    const bool is_program = (it->status().permissions() & fs::perms::owner_exec) != fs::perms::none;
    members.push_back({it->path().lexically_relative(folder).generic_string(),
                       filled(text_of(it->path()), parts), is_program});
  }
  if (failed || members.empty())
    throw UserError(folder.string(), "has no scripts for this platform",
                    "They are part of the source tree.");
  std::sort(members.begin(), members.end(),
            [](const ZipMember& a, const ZipMember& b) { return a.name < b.name; });
  return members;
}

// What lies below NAME.tar/ becomes an archive NAME.tar.
Members with_tar(const Members& members, const std::string& name) {
  const std::string below = name + "/";
  Members others, inside;
  for (const ZipMember& member : members)
    if (member.name.starts_with(below))
      inside.push_back({member.name.substr(below.size()), member.bytes, member.is_program});
    else
      others.push_back(member);
  others.push_back({name, tar_of(inside), false});
  return others;
}

}  // namespace

std::vector<ZipMember> autograder(Platform platform, const fs::path& scripts,
                                  const AutograderParts& parts) {
  Members members = scripts_below(scripts / name_of(platform), parts);
  std::string packages = "packages/";
  switch (platform) {
    case Platform::kGradescope: break;
    case Platform::kGithubClassroom: packages = ".github/tumble/"; break;
    case Platform::kAutolab: members = with_tar(members, "autograde.tar"); [[fallthrough]];
    case Platform::kArtemis:
      packages = "image/";
      members.push_back({packages + "Containerfile", parts.containerfile, false});
  }
  for (const ZipMember& package : parts.packages)
    members.push_back({packages + package.name, package.bytes, false});
  return members;
}

}  // namespace tumble::grading
