// Students' folders may contain anything: no name, link or size is trusted here.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/handins/layouts.h"
#include "framework/grading/handins/unpack.h"
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
  std::vector<fs::path> own_tests;                       // a1_impulse_tests.cpp for a1_impulse.cpp
  std::vector<std::pair<fs::path, std::string>> locked;  // folders that cannot be read, and why
  std::vector<fs::path> others;                          // documents and the like
  bool cut = false, is_deep = false;
  std::string refused;  // why a part of it was not unpacked; then nothing of it is used
};

// Folders for what is unpacked, which last as long as what was found.
class Unpacked {
 public:
  explicit Unpacked(std::unique_ptr<PrivateFolder>& folder) : folder_(folder) {}
  fs::path next() {
    if (!folder_) folder_ = std::make_unique<PrivateFolder>();
    const fs::path place = folder_->path() / std::to_string(count_++);
    fs::create_directories(place);
    return place;
  }

 private:
  std::unique_ptr<PrivateFolder>& folder_;
  std::size_t count_ = 0;
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
  else if (lowercase(name) == lowercase(fs::path(wanted).stem().string() + "_tests.cpp"))
    found.own_tests.push_back(path);
  else if (is_source(name))
    found.sources.push_back(path);
  else if (is_archive(name))
    found.archives.push_back(path);
  else if (is_header(name))
    found.headers.push_back(path);
  else
    found.others.push_back(path);
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
                   Unpacked* unpacked, Submission& submission);

// One archive and no source: what is in it counts. An archive in an archive does not.
void choose_from_archive(const fs::path& archive, const std::string& wanted, Unpacked& unpacked,
                         Submission& submission) {
  const fs::path place = unpacked.next();
  submission.problem = unpack_submission(archive, place);
  if (!submission.problem.empty()) return;
  const std::string name = archive.filename().string();
  Found found;
  std::size_t seen = 0;
  search(place, wanted, 0, seen, found);
  choose_source(found, wanted, place, nullptr, submission);
  if (submission.problem.empty())
    submission.notes.insert(submission.notes.begin(), "its file was in " + name);
  else
    submission.problem = "In " + name + ": " + submission.problem;
}

void choose_own_tests(const Found& found, const fs::path& folder, Submission& submission) {
  if (found.own_tests.empty()) return;
  const fs::path& first = found.own_tests.front();
  if (found.own_tests.size() > 1 && !are_equal(found.own_tests))
    submission.notes.push_back("its own tests were not run, because there are several: " +
                               listed(found.own_tests, folder));
  else if (const std::string why = why_not(first); !why.empty())
    submission.notes.push_back("its own tests were not run: " + why);
  else
    submission.own_tests = first;
}

void choose_source(Found found, const std::string& wanted, const fs::path& folder,
                   Unpacked* unpacked, Submission& submission) {
  const auto note = [&](const std::string& text) { submission.notes.push_back(text); };
  if (!found.refused.empty()) {
    submission.problem = "Was not unpacked: " + found.refused +
                         ". Take the submission from the platform, and give its folder.";
    return;
  }
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
  } else if (found.named.empty() && found.sources.empty() && found.archives.size() == 1 &&
             ends_in(found.archives[0], {".zip"}) && unpacked != nullptr) {
    choose_from_archive(found.archives[0], wanted, *unpacked, submission);
  } else if (found.named.empty() && found.sources.empty()) {
    submission.problem = "Holds no " + wanted;
    if (!found.archives.empty())
      submission.problem +=
          ", only an archive: " + listed(found.archives, folder) + ". Unpack it first.";
    else if (const auto& others = found.headers.empty() ? found.others : found.headers;
             !others.empty())
      submission.problem += ", but " + listed(others, folder) + ". Hand in " + wanted + ".";
    else
      submission.problem += ".";
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
    choose_own_tests(found, folder, submission);
    submission.problem = why_not(submission.source);
    if (!submission.problem.empty()) submission.source.clear();
  }
}

std::vector<fs::directory_entry> sorted_entries(const fs::path& folder) {
  std::error_code failed;
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    entries.push_back(*it);
  if (failed) throw UserError(folder.string(), "cannot be read: " + failed.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool is_real_folder(const fs::path& path) {
  std::error_code failed;
  return fs::is_directory(fs::symlink_status(path, failed));
}

// What is unpacked, and the folder of a Gradescope export, may hold the submissions one folder
// deeper: a lone folder with an export in it, or, in an archive, one with two folders or with names
// of a platform.
fs::path root_of(const fs::path& folder, bool is_unpacked) {
  std::vector<fs::path> entries;
  for (const fs::path& path : sorted_entries(folder))
    if (!is_litter(path.filename().string())) entries.push_back(path);
  if (entries.size() != 1 || !is_real_folder(entries[0])) return folder;
  if (fs::exists(fs::symlink_status(entries[0] / kGradescopeMetadata))) return entries[0];
  if (!is_unpacked) return folder;
  std::size_t folders = 0, files = 0, named = 0;
  for (const fs::path& inner : sorted_entries(entries[0])) {
    const std::string name = inner.filename().string();
    if (is_litter(name)) continue;
    ++(is_real_folder(inner) ? folders : files);
    named += canvas_name(name) || moodle_name(name);
  }
  return named > 0 || (folders > 1 && files == 0) ? entries[0] : folder;
}

// The name of a submission of Gradescope: of the first who handed in, with the number.
void name_as_gradescope(const std::vector<Submitter>& submitters, const std::string& folder,
                        Submission& submission) {
  const Submitter& first = submitters.front();
  submission.student_id = first.id;
  submission.name = first.name + "_" + (first.id.empty() ? folder : first.id);
  std::string others;
  for (std::size_t i = 1; i < submitters.size(); ++i)
    others += (i > 1 ? ", " : "") + submitters[i].name +
              (submitters[i].id.empty() ? "" : " (" + submitters[i].id + ")");
  if (!others.empty()) submission.notes.push_back("handed in together with " + others);
}

// By the first part of their paths below `root`: why parts of submissions were not unpacked.
std::map<std::string, std::string> refused_below(const fs::path& top, const fs::path& root,
                                                 const std::vector<ZipFault>& faults) {
  const std::string head = root == top ? "" : root.filename().string() + "/";
  std::map<std::string, std::string> refused;
  for (const ZipFault& fault : faults) {
    if (!fault.entry.starts_with(head)) continue;
    const std::string rest = fault.entry.substr(head.size());
    refused.insert({rest.substr(0, rest.find('/')), in_words(fault)});
  }
  return refused;
}

class Finder {
 public:
  Finder(const fs::path& what, const modules::ModuleKind& kind)
      : wanted_(kind.folder + ".cpp"), all_{what, {}, {}, {}}, unpacked_(all_.unpacked) {}

  FoundSubmissions many(const std::optional<Shard>& shard) {
    const fs::path& what = all_.folder;
    std::error_code failed;
    const bool is_archive = fs::is_regular_file(what, failed) && ends_in(what, {".zip"});
    if (!is_archive && !fs::is_directory(what, failed))
      throw UserError(what.string(), "is neither a folder nor a zip archive",
                      "Give the folder that holds one sub-folder per submission, or the archive "
                      "that a platform gave.");
    const fs::path top = is_archive ? unpacked_.next() : what;
    std::vector<ZipFault> faults;
    if (is_archive) faults = unpack_class(fs::canonical(what), top);
    root_ = root_of(top, is_archive);
    refused_ = refused_below(top, root_, faults);
    read_metadata();
    for (const fs::directory_entry& entry : sorted_entries(root_)) take(entry);
    // What is missing altogether, because its only file was refused.
    for (const auto& [name, why] : refused_)
      if (!fs::exists(fs::symlink_status(root_ / name, failed))) take_refused(name, why);
    add_by_student();
    if (named_.empty())
      throw UserError(what.string(),
                      "holds no submission: no sub-folder, and no file with a name as Canvas or "
                      "Moodle gives it",
                      "One submission is one sub-folder that holds " + wanted_ + ", for example " +
                          (what / "alice" / wanted_).string() + ".");
    return finished(shard);
  }

  FoundSubmissions one() {
    if (!is_real_folder(all_.folder))
      throw UserError(all_.folder.string(), "is not a folder",
                      "Give the folder with what was handed in.");
    Submission submission;
    submission.name = "submission";
    add(
        std::move(submission), [this] { return found_in(all_.folder); }, all_.folder);
    return finished({});
  }

 private:
  // A submission whose name is known, and what finds out about it.
  struct Named {
    Submission submission;
    std::function<Found()> look_into;  // empty where the submission has a problem already
    fs::path within;
  };

  FoundSubmissions finished(const std::optional<Shard>& shard) {
    std::sort(named_.begin(), named_.end(),
              [](const Named& a, const Named& b) { return a.submission.name < b.submission.name; });
    for (std::size_t i = 0; i < named_.size(); ++i) {
      auto& [submission, look_into, within] = named_[i];
      if (look_into && (!shard || shard->holds(i)))
        choose_source(look_into(), wanted_, within, &unpacked_, submission);
      all_.all.push_back(std::move(submission));
    }
    return std::move(all_);
  }

  void add(Submission submission, std::function<Found()> look_into, const fs::path& within) {
    named_.push_back({std::move(submission), std::move(look_into), within});
  }

  Found found_in(const fs::path& folder) const {
    Found found;
    std::size_t seen = 0;
    search(folder, wanted_, 0, seen, found);
    return found;
  }

  // Never through a link.
  void read_metadata() {
    constexpr std::uint64_t kMostBytes = 64u << 20;  // results of all submissions stand in it
    const fs::path file = root_ / kGradescopeMetadata;
    std::string why;
    if (!fs::exists(fs::symlink_status(file))) return;
    const auto text = read_plain_file(file, kMostBytes, why);
    if (!text) throw UserError(file.string(), why);
    gradescope_ = read_gradescope_metadata(*text);
  }

  void take(const fs::directory_entry& entry) {
    std::error_code failed;
    const fs::path path = entry.path();
    const std::string name = path.filename().string();
    if (is_litter(name) || name == kGradescopeMetadata) return;
    Submission submission;
    submission.name = name;
    if (entry.is_symlink(failed)) {
      submission.problem = "This is a symbolic link, which is not followed. Copy the folder here.";
      add(std::move(submission), {}, root_);
    } else if (entry.is_directory(failed)) {
      take_folder(path, std::move(submission));
    } else if (const auto file = platform_file(name)) {
      by_student_[{file->student, file->id}].push_back([=, this](Found& found) {
        sort_in(path, file->file, wanted_, found);
        note_refused(name, found);
      });
    } else if (is_source(path) || is_archive(path)) {
      submission.name = path.stem().string();
      const auto look_into = [=, this] {
        Found found;
        sort_in(path, name, wanted_, found);
        return found;
      };
      add(std::move(submission), look_into, root_);
    } else {
      all_.passed_over.push_back(name + " (neither a folder nor a source)");
    }
  }

  void take_folder(const fs::path& path, Submission submission) {
    const std::string name = submission.name;
    if (is_tools_folder(name)) {
      all_.passed_over.push_back(name + " (a folder of a tool)");
      return;
    }
    if (const auto moodle = moodle_name(name)) {
      by_student_[{moodle->student, moodle->id}].push_back([=, this](Found& found) {
        std::size_t seen = 0;
        search(path, wanted_, 0, seen, found);
        note_refused(name, found);
      });
      return;
    }
    if (const auto it = gradescope_.find(name); it != gradescope_.end())
      name_as_gradescope(it->second, name, submission);
    const auto look_into = [=, this] {
      Found found = found_in(path);
      note_refused(name, found);
      return found;
    };
    add(std::move(submission), look_into, path);
  }

  void take_refused(const std::string& name, const std::string& why) {
    const auto file = platform_file(name);
    const auto moodle = moodle_name(name);
    if (file || moodle) {
      by_student_[{file ? file->student : moodle->student, file ? file->id : moodle->id}].push_back(
          [why](Found& found) { found.refused = why; });
      return;
    }
    Submission submission;
    submission.name = name;
    if (const auto it = gradescope_.find(name); it != gradescope_.end())
      name_as_gradescope(it->second, name, submission);
    const auto look_into = [why] {
      Found found;
      found.refused = why;
      return found;
    };
    add(std::move(submission), look_into, root_);
  }

  static std::optional<PlatformName> platform_file(const std::string& name) {
    // Canvas first: its end is the student's own name of the file, which may look like Moodle's.
    if (auto canvas = canvas_name(name)) return canvas;
    auto moodle = moodle_name(name);
    return moodle && !moodle->file.empty() ? moodle : std::nullopt;
  }

  void note_refused(const std::string& name, Found& found) const {
    if (const auto it = refused_.find(name); it != refused_.end()) found.refused = it->second;
  }

  void add_by_student() {
    for (const auto& [student, parts] : by_student_) {
      Submission submission;
      submission.name = student.first + "_" + student.second;
      submission.student_id = student.second;
      const auto look_into = [&parts = parts] {
        Found found;
        for (const auto& look_into_part : parts) look_into_part(found);
        return found;
      };
      add(std::move(submission), look_into, root_);
    }
  }

  const std::string wanted_;
  FoundSubmissions all_;
  Unpacked unpacked_;
  fs::path root_;
  std::map<std::string, std::string> refused_;
  std::map<std::string, std::vector<Submitter>> gradescope_;
  // files of Canvas and Moodle, by student and number
  std::map<std::pair<std::string, std::string>, std::vector<std::function<void(Found&)>>>
      by_student_;
  std::vector<Named> named_;
};

}  // namespace

FoundSubmissions find_submissions(const fs::path& what, const modules::ModuleKind& kind,
                                  const std::optional<Shard>& shard) {
  return Finder(what, kind).many(shard);
}

FoundSubmissions find_submission(const fs::path& folder, const modules::ModuleKind& kind) {
  return Finder(folder, kind).one();
}

}  // namespace tumble::grading
