#include "framework/cli/private_files.h"

#include <algorithm>

#include "framework/core/files.h"
#include "framework/grading/course/course.h"
#include "framework/grading/course/slip.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

bool is_published(const Context& context, const std::vector<std::string>& published,
                  const fs::path& file) {
  return std::any_of(published.begin(), published.end(), [&](const std::string& id) {
    const std::string folder = context.registry.find(id).folder;
    return file == fs::path(kPrivateFolder) / folder / (folder + ".cpp");
  });
}

// The whole wrong solution of a slip, each line with its position in the slip or in its base.
grading::PrivateFile made_of_slip(const Context& context, const fs::path& slip) {
  const grading::MadeSolution made = grading::make_solution(slip, slip.parent_path().parent_path());
  grading::PrivateFile whole{slip.lexically_relative(context.root), made.text};
  for (const auto& origin : made.origins)
    whole.places.push_back(
        (origin.is_of_slip ? whole.file : made.base.lexically_relative(context.root)).string() +
        ":" + std::to_string(origin.line));
  return whole;
}

}  // namespace

std::vector<grading::PrivateFile> private_files(const Context& context,
                                                const std::vector<std::string>& published) {
  std::vector<grading::PrivateFile> files;
  if (!fs::exists(context.root / kPrivateFolder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(context.root / kPrivateFolder)) {
    const fs::path file = entry.path().lexically_relative(context.root),
                   folder = file.parent_path().filename();
    if (!entry.is_regular_file() || file.filename() == "CMakeLists.txt" ||
        folder == "flawed_submission" || *std::next(file.begin()) == "attacks" ||
        is_published(context, published, file))
      continue;
    // Once a reference is public, the parts that its wrong and alternative versions share with it
    // are public too.
    const bool of_published =
        std::any_of(published.begin(), published.end(), [&](const std::string& id) {
          return *std::next(file.begin()) == context.registry.find(id).folder;
        });
    if (of_published && (folder == "mutants" || folder == "alternatives")) continue;
    files.push_back({file, text_of(entry.path()), folder == "tests" || folder == "support"});
    if (file.extension() == grading::kSlipExtension)
      files.push_back(made_of_slip(context, entry.path()));
  }
  return files;
}

}  // namespace tumble::cli
