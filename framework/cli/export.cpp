// tumble export PLATFORM a1 FILE: the autograder that a platform takes.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/private_files.h"
#include "framework/cli/verb.h"
#include "framework/core/files.h"
#include "framework/core/version.h"
#include "framework/grading/course/course.h"
#include "framework/grading/platforms/autograder.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using grading::Platform;

struct ExportWords {
  std::string platform, id, file, packages = "out/packages";
};

// The one package of this name, e.g. tumble-course_0.1.0+12.gabc_amd64.deb.
fs::path package_called(const std::string& name, const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    if (it->path().filename().string().starts_with(name + "_") && it->path().extension() == ".deb")
      found.push_back(it->path());
  if (found.empty())
    throw UserError((folder / (name + "_*.deb")).string(), "is not there",
                    "Make the packages first: ./tumble package; or say where they are with "
                    "--packages FOLDER.");
  if (found.size() > 1)
    throw UserError(folder.string(), "holds " + std::to_string(found.size()) + " packages " + name,
                    "Remove the old ones.");
  return found.front();
}

std::string version_of(const fs::path& package) {
  const std::string name = package.filename().string();
  return name.substr(name.find('_') + 1);
}

std::vector<ZipMember> packages_of(Platform platform, const fs::path& folder) {
  std::vector<fs::path> files = {package_called("tumble-course", folder)};
  if (grading::has_hidden_tests(platform)) files.push_back(package_called("tumble-grader", folder));
  if (version_of(files.front()) != version_of(files.back()))
    throw UserError(files.back().string(),
                    "is of another version than " + files.front().filename().string(),
                    "Make both again: ./tumble package");
  std::vector<ZipMember> members;
  for (const fs::path& file : files) {
    members.push_back({file.filename().string(), text_of(file), false});
    if (members.back().bytes.empty()) throw UserError(file.string(), "cannot be read");
  }
  return members;
}

grading::AutograderParts parts_of(const Context& context, const ExportWords& words,
                                  Platform platform) {
  const modules::ModuleKind& kind = context.registry.find(words.id);
  grading::AutograderParts parts;
  parts.assignment = words.id;
  parts.file = kind.folder + ".cpp";
  parts.title = kind.title;
  parts.proof = "/opt/tumble-grader/" + std::string(kPrivateFolder) + "/" + kind.folder + "/" +
                kind.folder + ".cpp";
  for (const auto& item :
       grading::rubric_of({context.root, context.build, &context.registry, ""}, words.id).items)
    (item.hidden ? parts.hidden_points : parts.open_points) += item.points;
  const fs::path containerfile = context.root / "framework/packaging/Containerfile.grader";
  parts.containerfile = text_of(containerfile);
  if (parts.containerfile.empty()) throw UserError(containerfile.string(), "cannot be read");
  parts.packages = packages_of(platform, words.packages);
  return parts;
}

void export_autograder(const Context& context, const ExportWords& words) {
  const Platform platform = grading::platform_named(words.platform);
  if (context.is_installed)
    throw UserError("tumble export", "works in the instructor's source tree",
                    "Run ./tumble export there.");
  const std::string archive =
      zip_of(grading::autograder(platform, context.root / "framework/packaging/platforms",
                                 parts_of(context, words, platform)));
  write_whole(words.file, archive);
  fmt::print("{}  {:.1f} MB\n", words.file, static_cast<double>(archive.size()) * 1e-6);
  fmt::print("{}\n", grading::has_hidden_tests(platform)
                         ? "It holds the solutions and the hidden tests: upload it, and keep it to "
                           "yourself."
                         : "It holds the public tests alone.");
}

}  // namespace

void add_export(CLI::App& app, Context& context) {
  auto words = std::make_shared<ExportWords>();
  Verb verb(app, "export", "Make the autograder that a platform takes, from the two packages");
  verb.option("platform", words->platform, "gradescope, artemis, github-classroom or autolab")
      .required()
      .type_name("PLATFORM");
  verb.option("assignment", words->id, "Which, e.g. a1").required().type_name("ID");
  verb.option("file", words->file, "Where it goes").required().type_name("FILE.zip");
  verb.option("--packages", words->packages, "Where ./tumble package put them")
      .type_name("FOLDER")
      .shows_default();
  verb.footer(
      "Its README says what to do with it. On github-classroom the public tests alone run, because "
      "students can read what runs there.\n"
      "Exit: 0 made, 2 something to repair.");
  verb.runs([&context, words] { export_autograder(context, *words); });
}

}  // namespace tumble::cli
