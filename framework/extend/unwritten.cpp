#include "framework/extend/unwritten.h"

#include <algorithm>
#include <fstream>

namespace tumble::extend {
namespace {

namespace fs = std::filesystem;

// The file itself, or every file below the folder, by name.
std::vector<fs::path> files_at(const fs::path& place) {
  std::vector<fs::path> files;
  if (fs::is_regular_file(place)) files.push_back(place);
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(place, ignored))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

bool is_unwritten(const std::string& line) {
  return line.find("(to be written") != std::string::npos ||
         (line.find("kUnwritten") != std::string::npos &&
          line.find("kUnwritten =") == std::string::npos);
}

}  // namespace

std::vector<Unwritten> unwritten_of(const fs::path& root, const std::string& folder) {
  std::vector<Unwritten> found;
  const fs::path solutions = root / "solutions_private" / folder;
  for (const fs::path& place :
       {root / "assignments" / folder, solutions / (folder + ".cpp"), root / "tests" / folder,
        solutions / "tests", solutions / "mutants", solutions / "flawed_submission",
        root / "handouts" / (folder + ".md")})
    for (const fs::path& file : files_at(place)) {
      std::ifstream in(file);
      int number = 0;
      for (std::string line; std::getline(in, line);) {
        ++number;
        if (!is_unwritten(line)) continue;
        const std::size_t first = line.find_first_not_of(" \t");
        found.push_back({file.lexically_relative(root).string() + ":" + std::to_string(number),
                         line.substr(first)});
      }
    }
  return found;
}

}  // namespace tumble::extend
