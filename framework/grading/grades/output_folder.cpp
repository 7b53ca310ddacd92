#include "framework/grading/grades/output_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = ".tumble-grade.json";
constexpr const char* kLock = ".tumble-lock";
constexpr const char* kDraft = ".making-";
constexpr std::array<std::string_view, 9> kOverview = {
    "index.html", "gradebook.csv", "ledger.jsonl", "times.json",  "standing.json",
    "class.html", "pictures.html", "similar.html", "handout.html"};
constexpr std::array<std::string_view, 5> kOfASubmission = {
    "index.html", "student.html", "results.json", "record.json", "handout.html"};
const char* const kElsewhere = "Give --out a folder of its own, or one that does not exist yet.";

std::string shown(const fs::path& path) { return plain_name(path.string()); }

bool is_there(const fs::path& path) {
  std::error_code failed;
  return fs::exists(fs::symlink_status(path, failed));
}

// Whether a folder is, or is inside, another one, compared on the disk: independent of links, "..",
// and letter case where the file system ignores it.
bool lies_in(const fs::path& inner, const fs::path& outer) {
  for (fs::path at = inner;; at = at.parent_path()) {
    std::error_code failed;
    if (fs::equivalent(at, outer, failed) && !failed) return true;
    if (at == at.parent_path()) return false;
  }
}

// A draft from a killed run: ".index.draft123.html" beside "index.html".
bool is_draft_of(const std::string& name, std::string_view file) {
  const fs::path wanted(file);
  const std::string head = '.' + wanted.stem().string() + ".draft",
                    tail = wanted.extension().string();
  if (!name.starts_with(head) || !name.ends_with(tail) || name.size() <= head.size() + tail.size())
    return false;
  return name.substr(head.size(), name.size() - head.size() - tail.size())
             .find_first_not_of("0123456789") == std::string::npos;
}

template <std::size_t N>
bool is_one_of(const std::string& name, const std::array<std::string_view, N>& files) {
  for (const std::string_view file : files)
    if (name == file || is_draft_of(name, file)) return true;
  return false;
}

[[noreturn]] void refuse_foreign(const fs::path& path) {
  throw UserError(shown(path),
                  "was not written by this grader, and results are written only to a folder "
                  "without other files",
                  kElsewhere);
}

// The files of a submission's folder have known names; any other file is foreign.
void refuse_foreign_in(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const auto status = entry.symlink_status();
    if (fs::is_regular_file(status) && is_one_of(name, kOfASubmission)) continue;
    if (!fs::is_directory(status) || name != "media") refuse_foreign(entry.path());
    for (const auto& media : fs::directory_iterator(entry.path())) {
      const std::string ending = media.path().extension().string();
      const bool is_ours = fs::is_regular_file(media.symlink_status()) &&
                           (ending == ".png" || ending == ".mp4" || ending == ".html" ||
                            ending == ".wasm" || media.path().filename() == "three.js");
      if (!is_ours) refuse_foreign(media.path());
    }
  }
}

// Whether a name from the manifest is a single path component, as from folder_of(), and so safe to
// join to a path and remove.
bool is_one_component(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos;
}

UserError broken_list(const fs::path& file) {
  const fs::path folder = file.parent_path();
  if (folder.parent_path().filename() == kShards)
    return {shown(file), "cannot be read: it is half-written, or was edited",
            "Remove the folder " + shown(folder) +
                ": it holds parts of a grading, which are made again."};
  return {
      shown(file),
      "cannot be read as the list of what the grader made here: it is half-written, was edited, "
      "or is of another version. Nothing was changed",
      "Say tumble grade with this folder as --out and --mend-list: the list is made anew from "
      "the ledger and the records. Or give --out a folder that does not exist yet."};
}

// Whether the record of a folder of results says that it is one, of this assignment.
bool says_its_name(const fs::path& folder, const std::string& id) {
  const auto record = nlohmann::json::parse(text_of(folder / "record.json"), nullptr, false);
  const auto says = [&](const char* field, const std::string& value) {
    return record.contains(field) && record[field] == value;
  };
  return record.is_object() && says("assignment", id) && says("folder", folder.filename());
}

// Whether the process that took this lock, and wrote its id into it, is still alive.
bool holder_lives(int lock) {
  char text[24] = {};
  if (::pread(lock, text, sizeof text - 1, 0) <= 0) return false;
  const int holder = std::atoi(text);
  return holder > 0 && (::kill(holder, 0) == 0 || errno == EPERM);
}

}  // namespace

std::string draft_name(const std::string& folder) { return kDraft + folder; }

bool has_manifest(const fs::path& out) { return is_there(out / kManifest); }

RunSettings settings_of(const fs::path& out) {
  const fs::path file = out / kManifest;
  try {
    std::ifstream in(file);
    if (!in)
      throw UserError(shown(out), "is no folder of results: it has no " + std::string(kManifest),
                      "Name the folder that was given to grade as --out.");
    const auto json = nlohmann::json::parse(in);
    RunSettings settings;
    settings.assignment = json.at("assignment");
    settings.submissions = json.at("submissions").get<std::string>();
    settings.budget_s = json.at("budget_s");
    settings.media = json.at("media");
    settings.code_in_pages = json.value("code_in_pages", settings.code_in_pages);
    settings.policy = json.at("policy").get<std::string>();
    return settings;
  } catch (const nlohmann::json::exception&) {
    throw broken_list(file);
  }
}

fs::path place_of_results(const fs::path& out, const fs::path& submissions) {
  std::error_code failed;
  const fs::path place = fs::weakly_canonical(fs::absolute(out), failed);
  if (failed) throw UserError(shown(out), "cannot be reached: " + failed.message());
  if (is_there(place) && !fs::is_directory(place))
    throw UserError(shown(out), "is not a folder", kElsewhere);
  const fs::path graded = fs::canonical(submissions);
  const char* const kOverlaps =
      "Results must not be written among submissions, nor submissions read among results. Give "
      "--out a folder elsewhere.";
  if (lies_in(place, graded))
    throw UserError(shown(out),
                    lies_in(graded, place)
                        ? "is the folder of the submissions itself"
                        : "lies in the folder of the submissions, " + shown(submissions),
                    kOverlaps);
  if (lies_in(graded, place))
    throw UserError(shown(out), "holds the folder of the submissions, " + shown(submissions),
                    kOverlaps);
  return place;
}

OutputFolder::OutputFolder(const fs::path& out, const fs::path& submissions, const std::string& id,
                           const RunSettings& settings, BrokenList broken)
    : id_(id), settings_(settings), broken_(broken) {
  path_ = place_of_results(out, submissions);
  read_manifest();
  // otherwise the lock comes first: a grading that runs there creates and renames files
  if (!is_there(path_ / kLock)) refuse_foreign_files();
  std::error_code failed;
  fs::create_directories(path_, failed);
  if (failed)
    throw UserError(shown(out), "cannot be created: " + failed.message(),
                    "Give --out a folder that you may write to.");
  lock();
  // Again, because another grading may have been first.
  read_manifest();
  refuse_foreign_files();
  sweep_drafts();
  claim({});
}

OutputFolder::~OutputFolder() {
  if (lock_ < 0) return;
  // a failure is harmless: the id that stays is of a process that has ended
  if (::ftruncate(lock_, 0) != 0) {
  }
  ::close(lock_);
}

void OutputFolder::read_manifest() {
  const fs::path file = path_ / kManifest;
  folders_.clear();
  if (!is_there(file)) return;
  if (!fs::is_regular_file(fs::symlink_status(file))) refuse_foreign(file);
  try {
    std::ifstream in(file);
    const auto manifest = nlohmann::json::parse(in);
    const std::string other = manifest.at("assignment");
    if (other != id_)
      throw UserError(shown(path_), "holds results of " + plain_name(other) + ", not of " + id_,
                      kElsewhere);
    for (const std::string folder : manifest.at("folders")) {
      // not from this grader: it could lead out of this folder
      if (!is_one_component(folder) && broken_ == BrokenList::kMend) return list_anew();
      if (!is_one_component(folder)) refuse_foreign(file);
      folders_.insert(folder);
    }
  } catch (const nlohmann::json::exception&) {
    if (broken_ == BrokenList::kRefuse) throw broken_list(file);
    return list_anew();
  }
  if (!settings_.assignment.empty()) return;
  try {
    settings_ = settings_of(path_);
  } catch (const UserError&) {
    // a manifest without settings has none to keep
  }
}

void OutputFolder::list_anew() {
  folders_.clear();
  const LedgerContent ledger = read_ledger(path_ / kLedgerFile);
  if (!ledger.fault.empty())
    throw UserError(shown(path_ / kLedgerFile), "does not fit together: " + ledger.fault,
                    "Nothing was changed. Keep this folder as it is, and give --out another one.");
  std::set<std::string> named;
  for (const LedgerEntry& entry : ledger.entries) {
    if (entry.assignment != id_)
      throw UserError(shown(path_),
                      "holds results of " + plain_name(entry.assignment) + ", not of " + id_,
                      kElsewhere);
    named.insert(entry.folder);
  }
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (!fs::is_directory(entry.symlink_status())) continue;
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kDraft)) {
      const std::string of = name.substr(std::string_view(kDraft).size());
      if (is_one_component(of)) folders_.insert(of);
    }
    if (named.contains(name) || says_its_name(entry.path(), id_)) folders_.insert(name);
  }
}

void OutputFolder::refuse_foreign_files() const {
  if (!is_there(path_)) return;
  std::error_code failed;
  for (fs::directory_iterator it(path_, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string name = it->path().filename().string();
    const auto status = it->symlink_status();
    // Without a manifest every file is foreign, whatever its name, except a lock from a run that
    // was killed at its first step.
    const bool has_manifest = is_there(path_ / kManifest);
    if (fs::is_regular_file(status) && (name == kLock || is_draft_of(name, kManifest))) continue;
    if (has_manifest && fs::is_regular_file(status) &&
        (name == kManifest || is_one_of(name, kOverview)))
      continue;
    if (fs::is_directory(status) && name == kShards) continue;
    const bool is_drafts =
        name.starts_with(kDraft) && owns(name.substr(std::string_view(kDraft).size()));
    if (fs::is_directory(status) && is_drafts) continue;
    if (!fs::is_directory(status) || !owns(name)) refuse_foreign(it->path());
    refuse_foreign_in(it->path());
  }
  if (failed) throw UserError(shown(path_), "cannot be read: " + failed.message());
}

void OutputFolder::lock() {
  const fs::path file = path_ / kLock;
  lock_ = ::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock_ < 0)
    throw UserError(shown(file), "cannot be opened", "Give --out a folder that you may write to.");
  // flock: held by this process and its children, released when the last of them ends in any way.
  // The file contains the id of the process that took the lock. While that process lives, another
  // grading is running; after it was killed, its children may need seconds to die on a busy
  // machine, and this loop waits for them.
  constexpr int kTries = 3000, kTriesBesideALiving = 100, kPauseUs = 20'000;
  for (int i = 0; ::flock(lock_, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (i == kTries || (i >= kTriesBesideALiving && holder_lives(lock_)))
      throw UserError(shown(path_), "another grading writes there now",
                      "Wait for its end, or give --out another folder.");
    ::usleep(kPauseUs);
  }
  const std::string holder = std::to_string(::getpid()) + '\n';
  if (::ftruncate(lock_, 0) != 0 ||
      ::pwrite(lock_, holder.data(), holder.size(), 0) != static_cast<ssize_t>(holder.size()))
    throw UserError(shown(file), "cannot be written", "Is the disk full?");
}

void OutputFolder::sweep_drafts() const {
  std::error_code ignored;
  for (const std::string& folder : folders_) fs::remove_all(path_ / draft_name(folder), ignored);
  for (const auto& entry : fs::directory_iterator(path_)) {
    const std::string name = entry.path().filename().string();
    const bool is_ours = is_one_of(name, kOverview) || is_draft_of(name, kManifest);
    if (is_ours && name.starts_with('.')) fs::remove(entry.path(), ignored);
  }
}

void remove_results(const fs::path& out) {
  std::error_code ignored;
  try {
    std::ifstream in(out / kManifest);
    for (const std::string folder : nlohmann::json::parse(in).at("folders")) {
      if (!is_one_component(folder) || !is_there(out / folder)) continue;
      refuse_foreign_in(out / folder);
      fs::remove_all(out / folder, ignored);
      fs::remove_all(out / draft_name(folder), ignored);
    }
    for (const char* file : {kManifest, kLock}) fs::remove(out / file, ignored);
  } catch (const std::exception&) {
    // not ours, or foreign files in it: it stays
  }
  fs::remove(out, ignored);  // only when it is empty
}

void OutputFolder::claim(const std::set<std::string>& folders) {
  for (const std::string& folder : folders)
    if (!owns(folder) && is_there(path_ / folder)) refuse_foreign(path_ / folder);
  folders_.insert(folders.begin(), folders.end());
  const nlohmann::ordered_json manifest = {{"assignment", id_},
                                           {"submissions", settings_.submissions.string()},
                                           {"budget_s", settings_.budget_s},
                                           {"media", settings_.media},
                                           {"code_in_pages", settings_.code_in_pages},
                                           {"policy", settings_.policy.string()},
                                           {"folders", folders_}};
  write_whole(path_ / kManifest,
              manifest.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
}

}  // namespace tumble::grading
