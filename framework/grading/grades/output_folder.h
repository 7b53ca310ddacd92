/// The folder of results, which must be new or belong to this grader.
///
///   OUT/.tumble-grade.json   the assignment, and the folders that this grader has created here
///   OUT/.tumble-lock         held while a grading runs; the kernel releases it when the last of
///   its processes has ended
///   OUT/.shards/             results of parts of the class (shard.h)
/// If OUT contains any other file, nothing is written. Where the list itself cannot be read, it is
/// made anew only if the user says so (BrokenList).
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace tumble::grading {

/// What a grading was asked to do, kept in the manifest for commands that come later.
struct RunSettings {
  std::string assignment;             // "a1"
  std::filesystem::path submissions;  // absolute
  double budget_s = 60.0;
  bool media = true;
  std::filesystem::path policy;  // absolute; empty: none
  std::string code_in_pages = "own";
};

/// Whether OUT has a manifest, readable or not.
bool has_manifest(const std::filesystem::path& out);

/// The settings of the last grading into a folder of results.
/// @throws UserError when the folder has no manifest of this grader, or one that cannot be read
RunSettings settings_of(const std::filesystem::path& out);

/// Where results may be written: `out` as it is named without links.
/// @throws UserError where it is no folder, or one of the two folders holds the other
std::filesystem::path place_of_results(const std::filesystem::path& out,
                                       const std::filesystem::path& submissions);

/// What is done with a manifest that is half-written, edited or of another version.
enum class BrokenList {
  kRefuse,
  // Made anew: a folder is this grader's where the ledger or its own record names it, or where it
  // is a draft. What else lies there stays foreign; the settings are those of the command.
  kMend,
};

class OutputFolder {
 public:
  /// Opens OUT for one grading, and creates it if it is missing. Nothing is changed before
  /// everything has been checked.
  /// @param out          may be a relative path, or lead through links
  /// @param submissions  the folder to be graded
  /// @param settings     kept in the manifest; without an assignment: those that are there stay
  /// @throws UserError with the obstacle: OUT is, contains or is inside `submissions`, contains a
  ///   file that this grader did not write or the results of another assignment, or another grading
  ///   runs there
  OutputFolder(const std::filesystem::path& out, const std::filesystem::path& submissions,
               const std::string& id, const RunSettings& settings = {},
               BrokenList broken = BrokenList::kRefuse);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Absolute, without links.
  const std::filesystem::path& path() const { return path_; }

  /// Adds these folders to the manifest; to be called before they are created.
  /// @throws UserError when one exists already and was not created by this grader
  void claim(const std::set<std::string>& folders);

  /// The folders that this grader has created.
  const std::set<std::string>& folders() const { return folders_; }

  /// Whether this grader has created a folder of this name.
  bool owns(const std::string& folder) const { return folders_.contains(folder); }

 private:
  void read_manifest();
  void list_anew();
  void refuse_foreign_files() const;
  void lock();
  void sweep_drafts() const;

  std::filesystem::path path_;
  std::string id_;
  RunSettings settings_;
  BrokenList broken_;
  std::set<std::string> folders_;  // in the manifest
  int lock_ = -1;
};

/// Name of the draft of a submission's folder, beside it.
std::string draft_name(const std::string& folder);

/// Folder in OUT where parts of a class are graded (shard.h).
inline constexpr const char* kShards = ".shards";

/// Removes an output folder and the results in it, but no file that this grader did not write.
void remove_results(const std::filesystem::path& out);

}  // namespace tumble::grading
