// tumble package: the course and its grader as two Debian packages, made by CPack from the build.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "framework/cli/private_files.h"
#include "framework/cli/verb.h"
#include "framework/core/files.h"
#include "framework/grading/course/course.h"
#include "framework/core/run_program.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCourse = "tumble-course_";  // its file begins like this

void run(const std::vector<std::string>& words, const std::string& remedy) {
  const auto outcome = run_program(words, Output::kCaptured);
  if (outcome.code == 0) return;
  throw UserError(
      words.front(),
      "ended with code " + std::to_string(outcome.code) + " and printed:\n" + outcome.printed,
      remedy);
}

std::string without_suite(const std::string& test) { return test.substr(test.find('.') + 1); }

// Names of hidden tests stand in programs too, where no line of source does. A name that a public
// test has as well tells nothing.
std::vector<std::string> private_names(const Context& context) {
  std::set<std::string> open, hidden;
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const fs::path secret = context.root / kPrivateFolder / kind->folder / "rubric_hidden.json";
    const fs::path rubric = context.root / "assignments" / kind->folder / "rubric.json";
    for (const auto& item : grading::read_rubric(rubric).items)
      open.insert(without_suite(item.test));
    if (!fs::exists(secret)) continue;
    for (const auto& item : grading::read_rubric(secret, true).items)
      hidden.insert(without_suite(item.test));
  }
  std::vector<std::string> names;
  std::set_difference(hidden.begin(), hidden.end(), open.begin(), open.end(),
                      std::back_inserter(names));
  return names;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// The proof of a release, for the tree of the package and for its other files, and a search of its
// programs for names.
std::vector<grading::ReleaseFault> private_parts(const Context& context, const fs::path& unpacked) {
  const auto secrets = private_files(context, {});
  std::vector<grading::ReleaseFault> found = grading::leaks(unpacked / "usr/share/tumble", secrets);
  for (const char* part : {"usr/bin", "usr/lib", "usr/share/doc", "usr/share/bash-completion"})
    for (const auto& finding : grading::leaks(unpacked / part, secrets)) found.push_back(finding);
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const std::string file = "assignments/" + kind->folder + "/" + kind->folder + ".cpp";
    const auto more = grading::what_is_no_stub(file, text_of(unpacked / "usr/share/tumble" / file),
                                               kind->functions);
    found.insert(found.end(), more.begin(), more.end());
  }
  const std::vector<std::string> names = private_names(context);
  for (const fs::path& file : files_below(unpacked)) {
    const std::string bytes = text_of(file);
    for (const std::string& name : names)
      if (bytes.find(name) != std::string::npos)
        found.push_back({file.lexically_relative(unpacked).string(),
                         "contains the name of the hidden test " + name});
  }
  return found;
}

void refuse_private_parts(const Context& context, const fs::path& package) {
  const PrivateFolder unpacked;
  run({"dpkg-deb", "-x", package.string(), unpacked.path().string()}, "Install dpkg.");
  const auto found = private_parts(context, unpacked.path());
  if (found.empty()) return;
  std::string all;
  for (const auto& finding : found) all += "\n  " + finding.where + ": " + finding.problem;
  throw UserError(
      package.filename().string(), "holds something private:" + all,
      "Take it out of the package's list (framework/packaging/CMakeLists.txt) or out of the "
      "public folders. No package was written.");
}

void package(const Context& context, const fs::path& out) {
  if (context.is_installed)
    throw UserError("tumble package", "makes packages of a source tree, and this is a package",
                    "Run ./tumble package in the instructor's tree.");
  const fs::path config = context.build / "CPackConfig.cmake";
  if (!fs::exists(config))
    throw UserError(config.string(), "is not there",
                    "Configure the build again: cmake -S . -B build");
  const PrivateFolder folder;
  run({"cpack", "--config", config.string(), "-G", "DEB", "-B", folder.path().string()},
      "Install what it misses: dpkg-dev and file are in packages.txt.");
  std::vector<fs::path> made;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    if (entry.path().extension() == ".deb") made.push_back(entry.path());
  std::sort(made.begin(), made.end());
  for (const fs::path& file : made)
    if (file.filename().string().starts_with(kCourse)) refuse_private_parts(context, file);
  for (const fs::path& file : made) {
    const fs::path to = out / file.filename();
    make_whole(to, [&](const fs::path& draft) {
      fs::copy_file(file, draft, fs::copy_options::overwrite_existing);
    });
    std::printf("%s  %.1f MB\n", to.string().c_str(),
                static_cast<double>(fs::file_size(to)) * 1e-6);
  }
  std::printf("nothing private in the package of the course\n");
}

}  // namespace

void add_package(CLI::App& app, Context& context) {
  auto out = std::make_shared<std::string>("out/packages");
  Verb verb(app, "package",
            "Make two Debian packages: the course for students, and the grader on top of it");
  verb.option("--out", *out, "Where they go").type_name("FOLDER").shows_default();
  verb.footer(
      "apt install ./tumble-course_*.deb gives students the course: tumble start a1 FOLDER. "
      "tumble-grader_*.deb adds judges, references and hidden tests, below /opt/tumble-grader.\n"
      "Refused: a package of the course with a line of a solution or the name of a hidden test.");
  verb.runs([&context, out] { package(context, fs::absolute(*out)); });
}

}  // namespace tumble::cli
