#include "framework/extend/templates.h"

#include <algorithm>
#include <set>
#include <sstream>

#include <unistd.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::extend {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEach = "@each function@";
constexpr const char* kEnd = "@end@";

bool is_mark_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// A line of a template; `@` that opens no mark stays.
std::string filled_line(const std::string& line, const Marks& marks, const Marks& more,
                        const std::string& where) {
  std::string made;
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::size_t end = i + 1;
    while (line[i] == '@' && end < line.size() && is_mark_letter(line[end])) ++end;
    if (line[i] != '@' || end == i + 1 || end == line.size() || line[end] != '@') {
      made += line[i];
      continue;
    }
    const std::string name = line.substr(i + 1, end - i - 1);
    if (const auto found = more.find(name); found != more.end())
      made += found->second;
    else if (const auto general = marks.find(name); general != marks.end())
      made += general->second;
    else
      throw UserError(where, "the mark @" + name + "@ has no value here", "Correct the template.");
    i = end;
  }
  return made;
}

// Moves what stands in the draft to its place; what was moved is removed when one cannot be.
void move_whole(const fs::path& draft, const fs::path& root, const std::vector<fs::path>& parts) {
  std::vector<fs::path> moved;
  for (const fs::path& part : parts) {
    std::error_code failed;
    // rename() would replace a file: what came into the tree meanwhile stays
    if (fs::exists(fs::symlink_status(root / part)))
      failed = std::make_error_code(std::errc::file_exists);
    else
      fs::rename(draft / part, root / part, failed);
    if (!failed) {
      moved.push_back(part);
      continue;
    }
    for (const fs::path& done : moved) fs::remove_all(root / done);
    throw UserError((root / part).string(), "cannot be put there: " + failed.message(),
                    "Nothing was left behind.");
  }
}

}  // namespace

std::string filled(const std::string& text, const Marks& marks, const std::vector<Marks>& functions,
                   const std::string& where) {
  std::string made;
  std::vector<std::pair<std::string, int>> repeated;
  bool repeats = false;
  int number = 0;
  std::istringstream in(text);
  const auto at = [&](int line) { return where + ":" + std::to_string(line); };
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line == kEach) {
      repeats = true;
      repeated.clear();
    } else if (line == kEnd) {
      repeats = false;
      for (const Marks& function : functions)
        for (const auto& [each, place] : repeated)
          made += filled_line(each, marks, function, at(place)) + "\n";
    } else if (repeats) {
      repeated.emplace_back(line, number);
    } else {
      made += filled_line(line, marks, {}, at(number)) + "\n";
    }
  }
  if (repeats) throw UserError(where, std::string("has no ") + kEnd, "Correct the template.");
  return made;
}

std::vector<NewFile> files_from(const fs::path& templates, const Marks& marks,
                                const std::vector<Marks>& functions) {
  std::vector<NewFile> files;
  for (const auto& entry : fs::recursive_directory_iterator(templates)) {
    if (!entry.is_regular_file() || entry.path().extension() != ".in") continue;
    fs::path target = entry.path().lexically_relative(templates);
    target.replace_extension();
    files.push_back({filled_line(target.string(), marks, {}, entry.path().string()),
                     filled(text_of(entry.path()), marks, functions, entry.path().string())});
  }
  if (files.empty())
    throw UserError(templates.string(), "holds no templates", "Run this in a whole source tree.");
  std::sort(files.begin(), files.end(),
            [](const NewFile& a, const NewFile& b) { return a.file < b.file; });
  return files;
}

void put_in_place(const fs::path& root, const std::vector<NewFile>& files) {
  for (const NewFile& file : files)
    if (fs::exists(fs::symlink_status(root / file.file)))
      throw UserError(file.file.string(), "is there already",
                      "Nothing was written. Take another name, or move it away.");
  const fs::path draft = root / (".new-" + std::to_string(::getpid()));
  try {
    std::set<fs::path> parts;  // the highest that is not there yet: a folder or a file
    std::vector<std::string> format = {"clang-format", "-i"};
    for (const NewFile& file : files) {
      write_whole(draft / file.file, file.text);
      if (file.file.extension() == ".cpp" || file.file.extension() == ".h")
        format.push_back((draft / file.file).string());
      fs::path part;
      for (const fs::path& name : file.file) {
        part /= name;
        if (!fs::exists(fs::symlink_status(root / part))) break;
      }
      parts.insert(part);
    }
    if (format.size() > 2) run_program(format, Output::kCaptured);
    std::vector<fs::path> order(parts.begin(), parts.end());
    std::stable_partition(order.begin(), order.end(),
                          [](const fs::path& part) { return *part.begin() != "assignments"; });
    move_whole(draft, root, order);
  } catch (...) {
    fs::remove_all(draft);
    throw;
  }
  fs::remove_all(draft);
}

}  // namespace tumble::extend
