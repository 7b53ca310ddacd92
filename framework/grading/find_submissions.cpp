// What lies in a folder of submissions. Students' folders hold anything: nothing here trusts a name, a link or a size.
#include <algorithm>
#include <fstream>
#include <set>

#include "framework/core/error.h"
#include "framework/grading/grade.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestSource = 1u << 20;  // bytes: 50x a long solution; more is data or an attack
constexpr int kDeepest = 6;                          // folders: archives wrap a few times, no more
constexpr std::size_t kMostFiles = 5000;             // looked at: a whole build tree handed in is smaller

struct Found {
  std::vector<fs::path> named, sources, archives;   // by the right name; other .cpp files; .zip and the like
  std::set<std::string> others;
  std::vector<std::pair<fs::path, std::string>> locked;   // folders that cannot be read, and why
  bool cut = false;
};

bool is_archive(const fs::path& file) {
  static const std::set<std::string> endings = {".zip", ".gz", ".tgz", ".xz", ".7z", ".rar", ".tar"};
  return endings.contains(file.extension().string());
}

void look(const fs::path& folder, const std::string& wanted, int depth, std::size_t& seen, Found& found) {
  std::error_code failed;
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    if (++seen > kMostFiles) return void(found.cut = true);
    entries.push_back(*it);
  }
  if (failed) found.locked.push_back({folder, failed.message()});
  std::sort(entries.begin(), entries.end());
  for (const auto& entry : entries) {
    const fs::path& path = entry.path();
    const std::string name = path.filename().string();
    const auto status = entry.symlink_status(failed);
    if (name.starts_with('.') || name == "__MACOSX") continue;
    if (fs::is_directory(status)) {
      if (depth < kDeepest) look(path, wanted, depth + 1, seen, found);
    } else if (name == wanted) {
      found.named.push_back(path);
    } else if (path.extension() == ".cpp" || path.extension() == ".cc" || path.extension() == ".cxx") {
      found.sources.push_back(path);
    } else if (is_archive(path)) {
      found.archives.push_back(path);
    } else {
      found.others.insert(name);
    }
  }
}

std::string listed(const std::vector<fs::path>& files, const fs::path& folder) {
  std::string text;
  for (std::size_t i = 0; i < files.size() && i < 5; ++i) text += (i > 0 ? ", " : "") + files[i].lexically_relative(folder).string();
  return text + (files.size() > 5 ? ", ..." : "");
}

// Why a file must not be compiled; empty where it may.
std::string why_not(const fs::path& file) {
  std::error_code failed;
  const auto status = fs::symlink_status(file, failed);
  const std::string name = file.filename().string();
  if (fs::is_symlink(status)) return name + " is a symbolic link, which is not followed. Hand in the file itself.";
  if (!fs::is_regular_file(status)) return name + " is no ordinary file. Hand in a source file.";
  const auto size = fs::file_size(file, failed);
  if (failed) return name + " cannot be read: " + failed.message();
  if (size == 0) return name + " is empty.";
  if (size > kLargestSource) return name + " has " + std::to_string(size) + " bytes; a source may have " + std::to_string(kLargestSource) + ".";
  if (!std::ifstream(file)) return name + " cannot be read. Check its permissions.";
  return "";
}

void choose_source(const Found& found, const std::string& wanted, const fs::path& folder, Submission& submission) {
  if (found.cut) submission.notes.push_back("more than " + std::to_string(kMostFiles) + " files: only the first were looked at");
  if (!found.locked.empty()) {
    const auto& [locked, why] = found.locked.front();
    submission.problem = "The folder " + (locked == folder ? folder.filename() : locked.lexically_relative(folder.parent_path())).string() + " cannot be read (" + why +
                         "), so it is not known what was handed in. Let the grader's user in, for example: chmod -R u+rX '" + folder.string() + "'.";
  } else if (found.named.size() > 1) {
    submission.problem = "Holds " + wanted + " " + std::to_string(found.named.size()) + " times: " + listed(found.named, folder) + ". Leave one, so that it is clear which counts.";
  } else if (found.named.empty() && found.sources.size() > 1) {
    submission.problem = "Holds no " + wanted + " but several other sources: " + listed(found.sources, folder) + ". Name the one that counts " + wanted + ".";
  } else if (found.named.empty() && found.sources.empty()) {
    submission.problem = "Holds no " + wanted;
    submission.problem += found.archives.empty() ? "." : ", only an archive: " + listed(found.archives, folder) + ". Unpack it first.";
  } else {
    submission.source = found.named.empty() ? found.sources[0] : found.named[0];
    if (found.named.empty()) submission.notes.push_back("its only source is named " + submission.source.filename().string() + ", not " + wanted + "; it was taken");
    if (!found.named.empty() && !found.sources.empty()) submission.notes.push_back("other sources were not compiled: " + listed(found.sources, folder));
    submission.problem = why_not(submission.source);
    if (!submission.problem.empty()) submission.source.clear();
  }
}

}  // namespace

std::vector<Submission> find_submissions(const fs::path& folder, const modules::ModuleKind& kind) {
  std::error_code failed;
  if (!fs::is_directory(folder, failed)) throw UserError(folder.string(), "is no folder", "Give the folder that holds one sub-folder a submission.");
  std::vector<fs::path> entries;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) entries.push_back(it->path());
  if (failed) throw UserError(folder.string(), "cannot be read: " + failed.message());
  std::sort(entries.begin(), entries.end());

  const std::string wanted = kind.folder + ".cpp";
  std::vector<Submission> submissions;
  for (const fs::path& path : entries) {
    Submission submission;
    submission.name = path.filename().string();
    if (submission.name.starts_with('.') || submission.name == "__MACOSX") continue;
    const auto status = fs::symlink_status(path, failed);
    if (fs::is_symlink(status)) {
      submission.problem = "This is a symbolic link, which is not followed. Copy the folder here.";
    } else if (!fs::is_directory(status)) {
      continue;  // a roster, an export's index: not a submission
    } else {
      Found found;
      std::size_t seen = 0;
      look(path, wanted, 0, seen, found);
      choose_source(found, wanted, path, submission);
    }
    submissions.push_back(std::move(submission));
  }
  if (submissions.empty())
    throw UserError(folder.string(), "holds no sub-folder", "One submission is one sub-folder that holds " + wanted + ", for example " + (folder / "alice" / wanted).string() + ".");
  return submissions;
}

}  // namespace tumble::grading
