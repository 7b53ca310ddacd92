/// A submission's own code in its page: which modules a page carries, and who gets the right law.
///
/// The right law compiled is the solution in another form: whoever has the module has the formula.
/// So it stands in the TA's page; in the student's only where the grader says that solutions may be
/// seen. Without it the page compares with what must hold for every right law: momentum, energy,
/// the speed after a bounce.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/grading/compiler/page_module.h"
#include "framework/grading/course/course.h"
#include "framework/report/bench.h"

namespace tumble::grading {

/// Which modules pages carry.
enum class CodeInPages {
  kNone,
  kOwn,   // the submission's; in the TA's page the right one, too
  kBoth,  // the right one also in the student's page: after the deadline
};

/// "none", "own", "both".
/// @throws UserError for another word
CodeInPages code_in_pages_of(const std::string& word);
std::string word_of(CodeInPages which);

/// The script of an assignment's experiments, which a page runs; empty where it has none.
std::string page_script(const Course& course, const std::string& id);

/// Everything that decides what pages carry, as one digest.
std::string page_code_digest(const Course& course, const std::string& id, CodeInPages which);

/// Makes the modules of one grading.
class PageCode {
 public:
  /// Compiles the right law, where the tree has it.
  PageCode(const Course& course, const std::string& id, CodeInPages which);

  /// Compiles a submission into FOLDER/media, where its pages take it from.
  /// @return why there is none; empty where there is one, or where none was asked for
  std::string add(const std::filesystem::path& source, const std::filesystem::path& folder) const;

  const std::string& right() const { return right_; }
  const std::string& script() const { return script_; }

 private:
  CodeInPages which_;
  std::string script_;
  std::optional<PageCompiler> compiler_;
  std::string right_;  // bytes
};

/// The bench of a submission's page.
/// @param right  the right law's module for the TA's page; empty: what the folder has for everybody
/// @return without `own` where the folder has no module, or the assignment no experiments
report::Bench bench_of(const std::filesystem::path& folder, const std::string& script,
                       const std::string& right = "");

/// Removes the modules that a folder has: they are of an earlier version of the file.
void forget_page_code(const std::filesystem::path& folder);

}  // namespace tumble::grading
