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

/// What pages carry beside a submission's own module.
struct PageLaws {
  std::string script = {};  // of the assignment's experiments; empty: no code runs in pages
  std::string right = {};   // the right law's module; empty: there is none
  // why there is none, for the grader's eyes: it may quote the solution; empty where there is one
  // or none was asked for
  std::string why_no_right = {};
  bool is_for_students = false;  // the right law also in the student's page
};

/// Makes the modules of one grading.
class PageCode {
 public:
  /// Compiles the right law, where the tree has it.
  PageCode(const Course& course, const std::string& id, CodeInPages which);

  /// Compiles a submission into FOLDER/media, where its pages take it from.
  /// @return why there is none; empty where there is one, or where none was asked for
  std::string add(const std::filesystem::path& source, const std::filesystem::path& folder) const;

  const PageLaws& laws() const { return laws_; }

 private:
  PageLaws laws_;
  std::optional<PageCompiler> compiler_;
};

/// The bench of a submission's page.
/// @param right  the right law's module for the TA's page; empty: what the folder has for everybody
/// @return without `own` where the folder has no module, or the assignment no experiments
report::Bench bench_of(const std::filesystem::path& folder, const std::string& script,
                       const std::string& right = "");

/// Removes the modules that a folder has: they are of an earlier version of the file.
void forget_page_code(const std::filesystem::path& folder);

}  // namespace tumble::grading
