// tumble release FOLDER [--publish a1]: the tree that students get. It is the tree without solutions_private/, proven so.
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <set>
#include <vector>

#include "framework/cli/verb.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrivate = "solutions_private";

struct Options {
  std::string folder;
  std::vector<std::string> publish;
};

// Never part of a release, whatever the tree is under: build trees, results, the version control's own folder.
bool is_made_here(const std::string& name) {
  return name == ".git" || name == "out" || name == "build" || name.starts_with("build-") || name == kPrivate;
}

// The files that belong to the project, relative to the root. In a git checkout these are the tracked ones, so that a
// teacher's notes lying about are not handed out by accident.
std::vector<fs::path> project_files(const fs::path& root) {
  std::vector<fs::path> files;
  if (fs::exists(root / ".git")) {
    const std::string command = "git -C '" + root.string() + "' ls-files -z";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
    std::string listing;
    std::array<char, 4096> part;
    for (std::size_t n; pipe && (n = std::fread(part.data(), 1, part.size(), pipe.get())) > 0;) listing.append(part.data(), n);
    for (std::size_t at = 0, end; (end = listing.find('\0', at)) != std::string::npos; at = end + 1)
      files.emplace_back(listing.substr(at, end - at));
    if (files.empty()) throw UserError(root.string(), "git lists no files here", "Run the command in a whole checkout.");
  } else {
    for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator(); ++it) {
      const fs::path relative = it->path().lexically_relative(root);
      if (it->is_directory() && is_made_here(relative.begin()->string())) it.disable_recursion_pending();
      else if (it->is_regular_file()) files.push_back(relative);
    }
  }
  std::erase_if(files, [&](const fs::path& file) { return is_made_here(file.begin()->string()) || !fs::exists(root / file); });
  std::sort(files.begin(), files.end());
  return files;
}

std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// The source of a published reference replaces the stub of the same name.
void publish_solution(const Context& context, const std::string& id, const fs::path& release) {
  const modules::ModuleKind& kind = context.registry.find(id);
  const fs::path file = fs::path(kind.folder) / (kind.folder + ".cpp");
  const fs::path solution = context.root / kPrivate / file;
  if (!fs::exists(solution)) throw UserError(solution.string(), "there is no reference to publish", "Run the command in the instructor's tree.");
  fs::copy_file(solution, release / "assignments" / file, fs::copy_options::overwrite_existing);
}

// Whole files of the private folder must not stand anywhere in the release under another name, unless published on purpose.
void refuse_private_copies(const Context& context, const fs::path& release, const std::vector<std::string>& published) {
  std::set<std::string> secrets;
  if (!fs::exists(context.root / kPrivate)) return;
  for (const auto& entry : fs::recursive_directory_iterator(context.root / kPrivate)) {
    if (!entry.is_regular_file() || entry.path().filename() == "CMakeLists.txt") continue;
    const bool is_published = std::any_of(published.begin(), published.end(), [&](const std::string& id) {
      const std::string folder = context.registry.find(id).folder;
      return entry.path() == context.root / kPrivate / folder / (folder + ".cpp");
    });
    if (!is_published) secrets.insert(contents_of(entry.path()));
  }
  for (const auto& entry : fs::recursive_directory_iterator(release))
    if (entry.is_regular_file() && secrets.contains(contents_of(entry.path())))
      throw UserError(entry.path().lexically_relative(release).string(), "is a copy of a private file",
                      "Take it out of the public folders; nothing was released.");
}

void release(Context& context, const Options& options) {
  const fs::path target = fs::absolute(options.folder);
  if (fs::exists(target) && !(fs::is_directory(target) && fs::is_empty(target)))
    throw UserError(target.string(), "exists already", "Name a new folder, or remove this one first.");
  for (const std::string& id : options.publish) context.registry.find(id);

  // Built beside the target and renamed last: a release is there whole or not at all.
  const fs::path partial = target.string() + ".partial";
  fs::remove_all(partial);
  std::size_t count = 0;
  try {
    for (const fs::path& file : project_files(context.root)) {
      fs::create_directories((partial / file).parent_path());
      fs::copy_file(context.root / file, partial / file);
      ++count;
    }
    for (const std::string& id : options.publish) publish_solution(context, id, partial);
    refuse_private_copies(context, partial, options.publish);
  } catch (...) {
    fs::remove_all(partial);
    throw;
  }
  fs::remove_all(target);
  fs::rename(partial, target);
  std::printf("%zu files in %s, none of them private\n", count, target.string().c_str());
  for (const std::string& id : options.publish) std::printf("published: the reference of %s stands where its stub was\n", id.c_str());
  std::printf("try it as a student would:  cd %s && ./tumble check a1\n", target.string().c_str());
}

}  // namespace

void add_release(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  Verb verb(app, "release", "Write the starter tree for students: everything but the solutions");
  verb.option("folder", options->folder, "Where to write it (must not exist yet)").required();
  verb.option("--publish", options->publish, "Assignments whose reference replaces the stub, e.g. after a deadline").separated_by(',');
  verb.runs([&context, options] { release(context, *options); });
}

}  // namespace tumble::cli
