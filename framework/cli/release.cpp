// tumble release FOLDER [--publish a1]: the tree for students. It is the tree without
// solutions_private/, checked for leaks, with a README that starts with the student. It is built
// once, and every stub in it is "not attempted".
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <regex>
#include <vector>

#include "framework/cli/private_files.h"
#include "framework/cli/verb.h"
#include "framework/core/files.h"
#include "framework/core/version.h"
#include "framework/extend/unwritten.h"
#include "framework/grading/course/course.h"
#include "framework/grading/course/release_checks.h"
#include "framework/core/run_program.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

// read by framework/core/CMakeLists.txt: a released tree has no history
constexpr const char* kVersionFile = ".version";
constexpr const char* kStudentsReadme = "assignments/README.md";  // in the place of README.md

struct ReleaseOptions {
  std::string folder;
  std::vector<std::string> publish;
  bool build = true;
};

// Never part of a release, with or without version control: build trees, results, the version
// control's own folder.
bool is_made_here(const std::string& name) {
  return name == ".git" || name == "out" || name == "build" || name.starts_with("build-") ||
         name == kPrivateFolder;
}

// What git lists, relative to the root.
std::vector<fs::path> listed_by_git(const fs::path& root, const std::string& which) {
  const std::string command = "git -C '" + root.string() + "' ls-files -z " + which;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  std::string listing;
  std::array<char, 4096> part;
  for (std::size_t n; pipe && (n = std::fread(part.data(), 1, part.size(), pipe.get())) > 0;)
    listing.append(part.data(), n);
  std::vector<fs::path> files;
  for (std::size_t at = 0, end; (end = listing.find('\0', at)) != std::string::npos; at = end + 1)
    files.emplace_back(listing.substr(at, end - at));
  std::erase_if(files, [](const fs::path& file) { return is_made_here(file.begin()->string()); });
  std::sort(files.begin(), files.end());
  return files;
}

// The files of the project, relative to the root. In a git checkout these are the tracked files, so
// that untracked notes are not released by accident.
std::vector<fs::path> project_files(const fs::path& root) {
  if (fs::exists(root / ".git")) {
    const std::vector<fs::path> files = listed_by_git(root, "");
    if (files.empty())
      throw UserError(root.string(), "git lists no files here",
                      "Run the command in a whole checkout.");
    for (const fs::path& file : files)
      if (!fs::exists(root / file))
        throw UserError(file.string(), "is tracked by git and not there",
                        "Put it back, or remove it for good: git rm " + file.string());
    return files;
  }
  std::vector<fs::path> files;
  for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator();
       ++it) {
    const fs::path relative = it->path().lexically_relative(root);
    if (it->is_directory() && is_made_here(relative.begin()->string()))
      it.disable_recursion_pending();
    else if (it->is_regular_file())
      files.push_back(relative);
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The source of a published reference replaces the stub of the same name.
void publish_solution(const Context& context, const std::string& id, const fs::path& release) {
  const modules::ModuleKind& kind = context.registry.find(id);
  const fs::path file = fs::path(kind.folder) / (kind.folder + ".cpp");
  const fs::path solution = context.root / kPrivateFolder / file;
  if (!fs::exists(solution))
    throw UserError(solution.string(), "there is no reference to publish",
                    "Run the command in the instructor's tree.");
  fs::copy_file(solution, release / "assignments" / file, fs::copy_options::overwrite_existing);
}

void refuse(const std::vector<grading::ReleaseFault>& findings, const std::string& remedy) {
  if (findings.empty()) return;
  std::string more;
  for (std::size_t i = 1; i < findings.size(); ++i)
    more += "\n  " + findings[i].where + ": " + findings[i].problem;
  throw UserError(findings.front().where, findings.front().problem + more,
                  remedy + " Nothing was released.");
}

// The points of each assignment, public and hidden together, are read as the grader reads them: a
// sum other than 100 is refused.
void refuse_odd_rubrics(const Context& context) {
  const grading::Course course{context.root, context.build, &context.registry,
                               context.command_line};
  for (const modules::ModuleKind* kind : context.registry.all())
    if (fs::exists(context.root / kPrivateFolder / kind->folder / "rubric_hidden.json"))
      grading::rubric_of(course, kind->id);
}

// Files that no list names because the build finds them: left out, they would be missed by nothing.
void refuse_untracked_parts(const std::vector<fs::path>& untracked) {
  static const std::regex found_by_build(
      R"((assignments/a[0-9]+_\w+|framework/effects/\w+)/CMakeLists\.txt)"
      R"(|tests/(a[0-9]+_\w+|effects)/\w+_(test|fixtures)\.cpp)"
      R"(|handouts/drawings/draw_a[0-9]+\.cpp)");
  std::vector<grading::ReleaseFault> findings;
  for (const fs::path& file : untracked)
    if (std::regex_match(file.string(), found_by_build))
      findings.push_back({file.string(), "is part of this build and not tracked by git"});
  refuse(findings, "git add it, or move it away.");
}

// A new assignment is no student's before its author has written it.
void refuse_unwritten(const Context& context) {
  std::vector<grading::ReleaseFault> findings;
  for (const modules::ModuleKind* kind : context.registry.all())
    for (const extend::Unwritten& one : extend::unwritten_of(context.root, kind->folder))
      findings.push_back({one.place, one.what});
  refuse(findings, "Write it, or take the assignment's folders out of the tree for now.");
}

void refuse_what_is_no_stub(const Context& context, const fs::path& release,
                            const std::vector<std::string>& published) {
  for (const modules::ModuleKind* kind : context.registry.all()) {
    if (std::find(published.begin(), published.end(), kind->id) != published.end()) continue;
    const fs::path file = fs::path("assignments") / kind->folder / (kind->folder + ".cpp");
    refuse(grading::what_is_no_stub(file.string(), text_of(release / file), kind->functions),
           "Students write this file: take out what is written in it.");
  }
}

// Builds the tree completely, then checks each stub as a student does first.
void build_and_check(const Context& context, const fs::path& release,
                     const std::vector<std::string>& published) {
  const PrivateFolder folder;
  const auto launch = [&](const std::string& words) {
    const std::string script = "unset TUMBLE_ROOT; TUMBLE_BUILD='" +
                               (folder.path() / "build").string() + "' exec '" +
                               (release / "tumble").string() + "' " + words + " >'" +
                               (folder.path() / "said").string() + "'";
    return run_program({"/bin/sh", "-c", script}, Output::kOurs).code;
  };
  std::fprintf(stderr, "building the released tree (minutes; --no-build leaves this out)\n");
  if (launch("test --show-only") != 0)
    throw UserError(release.string(), "does not build: its errors stand above",
                    "A file that it needs may be untracked or private. Nothing was released.");
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const bool is_stub = std::find(published.begin(), published.end(), kind->id) == published.end();
    const int code = launch("check " + kind->id),
              expected = static_cast<int>(is_stub ? ExitCode::kNotAttempted : ExitCode::kFine);
    if (code != expected)
      throw UserError("tumble check " + kind->id,
                      "exits with " + std::to_string(code) + " in the released tree, not " +
                          std::to_string(expected) + ":\n" + text_of(folder.path() / "said"),
                      is_stub
                          ? "Each test of a stub must be \"not attempted\". Nothing was released."
                          : "The published reference must pass its tests. Nothing was released.");
  }
}

void release(Context& context, const ReleaseOptions& options) {
  const fs::path target = fs::absolute(options.folder);
  if (fs::exists(target) && !(fs::is_directory(target) && fs::is_empty(target)))
    throw UserError(target.string(), "exists already",
                    "Name a new folder, or remove this one first.");
  for (const std::string& id : options.publish) context.registry.find(id);
  const std::vector<fs::path> files = project_files(context.root);
  refuse_odd_rubrics(context);
  refuse_unwritten(context);
  if (fs::exists(context.root / ".git")) {
    const std::vector<fs::path> untracked = listed_by_git(context.root, "--others");
    refuse_untracked_parts(untracked);
    refuse(grading::missing_files(context.root, files, untracked),
           "git add it, or take out what needs it.");
  }

  // Built beside the target and renamed last: a release is complete or absent.
  const fs::path partial = target.string() + ".partial";
  fs::remove_all(partial);
  std::size_t count = 0;
  try {
    for (const fs::path& file : files) {
      fs::create_directories((partial / file).parent_path());
      fs::copy_file(context.root / file, partial / file);
      ++count;
    }
    for (const std::string& id : options.publish) publish_solution(context, id, partial);
    write_whole(partial / kVersionFile, std::string(kProgramVersion) + "\n");
    if (fs::exists(partial / kStudentsReadme))
      fs::rename(partial / kStudentsReadme, partial / "README.md"), --count;
    refuse_what_is_no_stub(context, partial, options.publish);
    refuse(grading::leaks(partial, private_files(context, options.publish)),
           "Take it out of the public folders.");
    if (options.build) build_and_check(context, partial, options.publish);
  } catch (...) {
    fs::remove_all(partial);
    throw;
  }
  fs::remove_all(target);
  fs::rename(partial, target);
  std::printf("%zu files in %s, none of them private\n", count, target.string().c_str());
  for (const std::string& id : options.publish)
    std::printf("published: the reference of %s stands where its stub was\n", id.c_str());
  std::printf("try it as a student would:  cd %s && ./tumble check a1\n", target.string().c_str());
}

}  // namespace

void add_release(CLI::App& app, Context& context) {
  auto options = std::make_shared<ReleaseOptions>();
  Verb verb(app, "release", "Write the starter tree for students: everything but the solutions");
  verb.option("folder", options->folder, "Where to write it (must not exist yet)").required();
  verb.option("--publish", options->publish,
              "Assignments whose reference replaces the stub, e.g. after a deadline")
      .separated_by(',');
  verb.flag("!--no-build", options->build,
            "Do not build what is released and check its stubs: seconds instead of minutes");
  verb.footer(
      "Refused: a file that is needed and not tracked, a stub that is more than a stub, lines of a "
      "solution anywhere, a rubric that does not sum to 100, "
      "a tree that does not build.");
  verb.runs([&context, options] { release(context, *options); });
}

}  // namespace tumble::cli
