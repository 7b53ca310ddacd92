/// The folder that results are written to: this grader's own, or nobody's.
///
///   OUT/.tumble-grade.json   which assignment, and the folders that this grader has made here
///   OUT/.tumble-lock         held while a grading runs; the kernel lets go of it when the last of its processes is gone
/// Whatever else lies in OUT was written by somebody else: then nothing is written at all.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace tumble::grading {

class OutputFolder {
 public:
  /// Opens OUT for one grading and makes it where it is missing. Nothing is touched before everything has been looked at.
  /// @param out          may be a relative path, or lead through links
  /// @param submissions  the folder that is graded
  /// @throws UserError that names what is in the way: OUT is or holds or lies in `submissions`, holds a file that this grader did not
  ///         write or the results of another assignment, or another grading runs there
  OutputFolder(const std::filesystem::path& out, const std::filesystem::path& submissions, const std::string& id);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Absolute, without links.
  const std::filesystem::path& path() const { return path_; }

  /// Says in OUT that these folders are this grader's from now on; call it before they are made.
  /// @throws UserError when one is there already and is not ours
  void claim(const std::set<std::string>& folders);

  /// A folder of this name that this grader has made.
  bool owns(const std::string& folder) const { return folders_.contains(folder); }

 private:
  void read_manifest();
  void refuse_foreign_files() const;
  void lock();
  void sweep_drafts() const;

  std::filesystem::path path_;
  std::string id_;
  std::set<std::string> folders_;   // made here
  int lock_ = -1;
};

/// Where drafts of a submission's folder are made, beside it.
std::string draft_name(const std::string& folder);

}  // namespace tumble::grading
