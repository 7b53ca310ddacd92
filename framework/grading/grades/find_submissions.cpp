// Students' folders may contain anything: no name, link or size is trusted here.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// bytes: 50x a long solution; more is data or an attack
constexpr std::uintmax_t kLargestSource = 1u << 20;
constexpr int kDeepest = 6;               // folders: archives add only a few levels
constexpr std::size_t kMostFiles = 5000;  // examined: even a whole build tree has fewer

struct Found {
  // with the right name; other sources; .zip etc.
  std::vector<fs::path> named, sources, archives, headers;
  std::vector<std::pair<fs::path, std::string>> locked;  // folders that cannot be read, and why
  bool cut = false, is_deep = false;
};

bool ends_in(const fs::path& file, const std::set<std::string>& endings) {
  return endings.contains(lowercase(file.extension().string()));
}
bool is_archive(const fs::path& file) {
  return ends_in(file, {".zip", ".gz", ".tgz", ".xz", ".bz2", ".7z", ".rar", ".tar"});
}
bool is_source(const fs::path& file) { return ends_in(file, {".cpp", ".cc", ".cxx", ".c++"}); }
bool is_header(const fs::path& file) { return ends_in(file, {".h", ".hh", ".hpp", ".hxx"}); }

// Files that systems and tools leave in any folder.
bool is_litter(const std::string& name) {
  static const std::set<std::string> litter = {"__MACOSX", ".DS_Store", "Thumbs.db", "desktop.ini"};
  return litter.contains(name) || name.starts_with("._");
}
bool is_tools_folder(const std::string& name) {
  static const std::set<std::string> tools = {".git",  ".svn", ".hg",   ".vscode",
                                              ".idea", ".vs",  ".cache"};
  return tools.contains(name);
}

// Classifies a file by its name. Canvas and browsers number copies, "a1_impulse-1.cpp", "a1_impulse
// (1).cpp"; `name` is without the number.
void sort_in(const fs::path& path, const std::string& name, const std::string& wanted,
             Found& found) {
  if (lowercase(name) == lowercase(wanted))
    found.named.push_back(path);
  else if (is_source(name))
    found.sources.push_back(path);
  else if (is_archive(name))
    found.archives.push_back(path);
  else if (is_header(name))
    found.headers.push_back(path);
}

void search(const fs::path& folder, const std::string& wanted, int depth, std::size_t& seen,
            Found& found) {
  std::error_code failed;
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    if (++seen > kMostFiles) return void(found.cut = true);
    entries.push_back(*it);
  }
  if (failed) found.locked.push_back({folder, failed.message()});
  std::sort(entries.begin(), entries.end());
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (is_litter(name)) continue;
    if (!fs::is_directory(entry.symlink_status(failed)))
      sort_in(entry.path(), name, wanted, found);
    else if (is_tools_folder(name))
      continue;
    else if (depth < kDeepest)
      search(entry.path(), wanted, depth + 1, seen, found);
    else
      found.is_deep = true;
  }
}

std::string listed(const std::vector<fs::path>& files, const fs::path& folder) {
  std::string text;
  for (std::size_t i = 0; i < files.size() && i < 5; ++i)
    text += (i > 0 ? ", " : "") + files[i].lexically_relative(folder).string();
  return text + (files.size() > 5 ? ", ..." : "");
}

// Why a file must not be compiled; empty where it may be.
std::string why_not(const fs::path& file) {
  std::error_code failed;
  const auto status = fs::symlink_status(file, failed);
  const std::string name = file.filename().string();
  if (fs::is_symlink(status))
    return name + " is a symbolic link, which is not followed. Hand in the file itself.";
  if (!fs::is_regular_file(status))
    return name + " is not an ordinary file. Hand in a source file.";
  if (fs::hard_link_count(file, failed) > 1)
    // The other name may be that of a file that this user may read and its author may not.
    return name +
           " has a second name on this machine (a hard link). Grade a copy of the submissions: "
           "cp -r --no-preserve=links FOLDER COPY";
  const auto size = fs::file_size(file, failed);
  if (failed) return name + " cannot be read: " + failed.message();
  if (size == 0) return name + " is empty.";
  if (size > kLargestSource)
    return name + " has " + std::to_string(size) + " bytes; a source may have " +
           std::to_string(kLargestSource) + ".";
  if (!std::ifstream(file)) return name + " cannot be read. Check its permissions.";
  return "";
}

// Whether all files are readable and have the same bytes: then any of them may be taken.
bool are_equal(const std::vector<fs::path>& files) {
  return std::all_of(files.begin(), files.end(), [&](const fs::path& file) {
    return why_not(file).empty() && digest_of_file(file) == digest_of_file(files[0]);
  });
}

void choose_source(Found found, const std::string& wanted, const fs::path& folder,
                   Submission& submission) {
  const auto note = [&](const std::string& text) { submission.notes.push_back(text); };
  if (found.cut)
    note("more than " + std::to_string(kMostFiles) + " files: only the first were examined");
  if (found.is_deep)
    note("folders more than " + std::to_string(kDeepest) + " deep were not examined");
  for (std::vector<fs::path>* files : {&found.named, &found.sources}) {
    if (files->size() < 2 || (files == &found.sources && !found.named.empty()) ||
        !are_equal(*files))
      continue;
    note("copies of one file, byte for byte: " + listed(*files, folder) + "; the first was taken");
    files->resize(1);
  }
  if (!found.locked.empty()) {
    const auto& [locked, why] = found.locked.front();
    submission.problem =
        "The folder " +
        (locked == folder ? folder.filename() : locked.lexically_relative(folder.parent_path()))
            .string() +
        " cannot be read (" + why +
        "), so it is not known what was handed in. Give the grader's user access, for example: "
        "chmod -R u+rX " +
        shell_word(folder.string());
  } else if (found.named.size() > 1) {
    submission.problem = "Holds " + wanted + " " + std::to_string(found.named.size()) +
                         " times: " + listed(found.named, folder) +
                         ". Leave only the one that counts.";
  } else if (found.named.empty() && found.sources.size() > 1) {
    submission.problem = "Holds no " + wanted +
                         " but several other sources: " + listed(found.sources, folder) +
                         ". Name the one that counts " + wanted + ".";
  } else if (found.named.empty() && found.sources.empty()) {
    submission.problem = "Holds no " + wanted;
    submission.problem +=
        found.archives.empty()
            ? "."
            : ", only an archive: " + listed(found.archives, folder) + ". Unpack it first.";
  } else {
    submission.source = found.named.empty() ? found.sources[0] : found.named[0];
    const std::string name = submission.source.filename().string();
    if (found.named.empty())
      note("its only source is named " + name + ", not " + wanted + "; it was taken");
    else if (lowercase(name) == lowercase(wanted) && name != wanted)
      note("its file is named " + name + ", not " + wanted + "; it was taken");
    if (!found.named.empty() && !found.sources.empty())
      note("other sources were not compiled: " + listed(found.sources, folder));
    if (!found.headers.empty())
      note("headers beside it were not used: " + listed(found.headers, folder) +
           ". Only the one file is compiled, with the course's own headers");
    submission.problem = why_not(submission.source);
    if (!submission.problem.empty()) submission.source.clear();
  }
}

// STUDENT_[LATE_]USER_SUBMISSION_FILE: Canvas's names in an archive of all submissions.
struct CanvasName {
  std::string student, id, file;
};
std::optional<CanvasName> canvas_name(const std::string& name) {
  static const std::regex pattern(R"(^([^_]+)_(?:LATE_)?(\d+)_\d+_(.+)$)"),
      numbered(R"(^(.+?)(?:-\d+| \(\d+\))(\.[^.]*)$)");
  constexpr std::size_t kLongest = 255;  // bytes of a name; std::regex recurses by its length
  std::smatch parts, number;
  if (name.size() > kLongest || !std::regex_match(name, parts, pattern)) return std::nullopt;
  CanvasName canvas{parts[1], parts[2], parts[3]};
  if (std::regex_match(canvas.file, number, numbered))
    canvas.file = number[1].str() + number[2].str();
  return canvas;
}

// A submission whose name is known, and what finds out about it.
struct Named {
  Submission submission;
  std::function<void(Submission&)> look_into;
};

Submission called(const std::string& name, const std::string& student_id = "") {
  Submission submission;
  submission.name = name;
  submission.student_id = student_id;
  return submission;
}

}  // namespace

FoundSubmissions find_submissions(const fs::path& folder, const modules::ModuleKind& kind,
                                  const std::optional<Shard>& shard) {
  std::error_code failed;
  if (!fs::is_directory(folder, failed))
    throw UserError(folder.string(), "is not a folder",
                    "Give the folder that holds one sub-folder per submission.");
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    entries.push_back(*it);
  if (failed) throw UserError(folder.string(), "cannot be read: " + failed.message());
  std::sort(entries.begin(), entries.end());

  const std::string wanted = kind.folder + ".cpp";
  FoundSubmissions all{folder, {}, {}};
  std::vector<Named> named;
  // files from Canvas, by student and number
  std::map<std::pair<std::string, std::string>, std::vector<std::pair<fs::path, std::string>>> flat;
  for (const fs::directory_entry& entry : entries) {
    const fs::path& path = entry.path();
    const std::string name = path.filename().string();
    if (is_litter(name)) continue;
    if (entry.is_symlink(failed)) {
      named.push_back(
          {called(name), [](Submission& submission) {
             submission.problem =
                 "This is a symbolic link, which is not followed. Copy the folder here.";
           }});
    } else if (entry.is_directory(failed)) {
      if (is_tools_folder(name)) {
        all.passed_over.push_back(name + " (a folder of a tool)");
        continue;
      }
      named.push_back({called(name), [=](Submission& submission) {
                         Found found;
                         std::size_t seen = 0;
                         search(path, wanted, 0, seen, found);
                         choose_source(found, wanted, path, submission);
                       }});
    } else if (const auto canvas = canvas_name(name)) {
      flat[{canvas->student, canvas->id}].push_back({path, canvas->file});
    } else if (is_source(path) || is_archive(path)) {
      named.push_back({called(path.stem().string()), [=](Submission& submission) {
                         Found found;
                         sort_in(path, name, wanted, found);
                         choose_source(found, wanted, folder, submission);
                       }});
    } else {
      all.passed_over.push_back(name + " (neither a folder nor a source)");
    }
  }
  for (const auto& [student, files] : flat)
    named.push_back({called(student.first + "_" + student.second, student.second),
                     [=, &files = files](Submission& submission) {
                       Found found;
                       for (const auto& [path, name] : files) sort_in(path, name, wanted, found);
                       choose_source(found, wanted, folder, submission);
                     }});
  std::sort(named.begin(), named.end(),
            [](const Named& a, const Named& b) { return a.submission.name < b.submission.name; });
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!shard || shard->holds(i)) named[i].look_into(named[i].submission);
    all.all.push_back(std::move(named[i].submission));
  }
  if (all.all.empty())
    throw UserError(
        folder.string(),
        "holds no submission: no sub-folder, and no file with a name as Canvas gives it",
        "One submission is one sub-folder that holds " + wanted + ", for example " +
            (folder / "alice" / wanted).string() + ".");
  return all;
}

}  // namespace tumble::grading
