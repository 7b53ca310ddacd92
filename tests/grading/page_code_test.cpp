// A right law that does not compile for a page: what is said of it, and to whom.
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/page_code.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// It compiles for a judge, and clang refuses it for a page: what a library's header may do, too.
constexpr const char* kNotForPages = "\n#ifdef __wasm__\n#error a line of the solution\n#endif\n";

class RightLaw : public ::testing::Test {
 protected:
  RightLaw() {
    register_assignments(registry_);
    fs::create_directories(root() / "solutions_private/a1_impulse");
    for (const char* room : {"assignments", "framework"})
      fs::create_directory_symlink(fs::path(test::source_dir()) / room, root() / room);
    write_whole(root() / "solutions_private" / file_, text_of(stub()) + kNotForPages);
  }
  void SetUp() override {
    if (!missing_page_packages().empty())
      GTEST_SKIP() << "this machine does not compile for pages: " << kPagePackages;
  }
  fs::path root() const { return folder_.path(); }
  // It stands in for what a student handed in.
  fs::path stub() const { return fs::path(test::source_dir()) / "assignments" / file_; }
  Course course() const { return {root(), test::binary_dir(), &registry_, ""}; }

  // The pages of a submission, the TA's first.
  std::pair<std::string, std::string> pages(CodeInPages which) const {
    const PageCode code(course(), "a1", which);
    Grade grade;
    grade.state = GradeState::kJudged;
    grade.name = grade.folder = "alice";
    const fs::path folder = root() / "alice";
    grade.no_page_code = code.add(stub(), folder);
    EXPECT_EQ(grade.no_page_code, "");
    write_grade(registry_.find("a1"), grade, {}, folder, "key", code.laws());
    return {text_of(folder / "index.html"), text_of(folder / "student.html")};
  }
  static bool holds(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  }

  const fs::path file_ = "a1_impulse/a1_impulse.cpp";
  PrivateFolder folder_;
  modules::Registry registry_;
};

TEST_F(RightLaw, ThatDoesNotCompileForAPageIsNamedToTheTaAlone) {
  const auto [ta, student] = pages(CodeInPages::kOwn);
  EXPECT_TRUE(holds(ta, "The right law is not beside it"));
  EXPECT_TRUE(holds(ta, "a line of the solution"));
  EXPECT_TRUE(holds(ta, "id=\"bench-own\""));
  EXPECT_FALSE(holds(student, "The right law is not beside it")) << "it never is";
  EXPECT_FALSE(holds(student, "a line of the solution"));
}

TEST_F(RightLaw, ThatAStudentWasToHaveIsSaidToBeMissingWithoutItsLines) {
  const auto [ta, student] = pages(CodeInPages::kBoth);
  EXPECT_TRUE(holds(ta, "a line of the solution"));
  EXPECT_TRUE(holds(student, "The right law is not beside it"));
  EXPECT_FALSE(holds(student, "a line of the solution"));
  EXPECT_FALSE(holds(student, "id=\"bench-right\""));
}

TEST_F(RightLaw, ThatTheTreeDoesNotHaveIsSaidWhereStudentsWereToHaveIt) {
  fs::remove(root() / "solutions_private" / file_);
  EXPECT_TRUE(holds(pages(CodeInPages::kBoth).first, "this tree has no right solution"));
  EXPECT_FALSE(holds(pages(CodeInPages::kOwn).first, "The right law is not beside it"));
}

}  // namespace
}  // namespace tumble::grading
