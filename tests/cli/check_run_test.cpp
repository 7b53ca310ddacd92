// tumble check as a student runs it, on files of this test beside the stub.
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <sys/resource.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

ProgramOutcome check(const std::vector<std::string>& more, const std::string& id = "a1") {
  ::setenv("TUMBLE_ROOT", test::source_dir().c_str(), 1);
  std::vector<std::string> words = {test::binary_dir() + "/bin/tumble_check", "check", id};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words, Output::kCaptured, 100.0);
}

// In a folder whose name has a space, as students' folders may have.
struct File {
  explicit File(const std::string& text) { write_whole(path, text); }
  ~File() { fs::remove_all(path.parent_path()); }
  fs::path path =
      fs::temp_directory_path() / ("tumble check " + std::to_string(::getpid())) / "mine.cpp";
};

TEST(Check, AnErrorOfTheCompilerIsAVerdictWithItsPlace) {
  const File file("#include \"assignments/a1_impulse/a1_impulse.h\"\nint x = ;\n");
  const ProgramOutcome outcome = check({file.path.string()});
  EXPECT_EQ(outcome.code, 1) << outcome.printed;
  EXPECT_NE(outcome.printed.find("does not compile: mine.cpp"), std::string::npos)
      << outcome.printed;
  EXPECT_NE(outcome.printed.find("mine.cpp:2:9: error:"), std::string::npos) << outcome.printed;
}

void expect_said(const ProgramOutcome& outcome, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.code, code) << outcome.printed;
  for (const std::string& part : parts)
    EXPECT_NE(outcome.printed.find(part), std::string::npos) << part << "\nin: " << outcome.printed;
}

TEST(Check, AFunctionThatIsMissingIsNamedWithWhatIsExpected) {
  const File file("#include \"assignments/a1_impulse/a1_impulse.h\"\n");
  expect_said(check({file.path.string()}), 1,
              {"intersect_ray_triangle is missing",
               "expected: std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const "
               "Triangle& triangle)",
               "declared in a1_impulse.h:"});
}

TEST(Check, JsonHasTheCompilersWordsAndTheSameExitCode) {
  const File file("#include \"assignments/a1_impulse/a1_impulse.h\"\nint x = ;\n");
  expect_said(check({file.path.string(), "--json"}), 1,
              {"\"assignment\": \"a1\"", "mine.cpp:2:9: error:", "\"tests\": []"});
}

TEST(Check, AnErrorInsideEigenBeginsWithTheStudentsLine) {
  const File file(
      "#include \"assignments/a1_impulse/a1_impulse.h\"\nnamespace tumble::a1 {\nVector3d "
      "sum(const Vector3d& a, const Eigen::Vector2d& b) {\n  return a + b;\n}\n}\n");
  expect_said(check({file.path.string()}), 1,
              {"    mine.cpp:4:14: error: required from here\n", "    4 |   return a + b;",
               "YOU_MIXED_MATRICES_OF_DIFFERENT_SIZES"});
}

// The student's file of this tree; the tests below add their lines to it.
std::string stub() {
  std::ifstream in(test::source_dir() + "/assignments/a1_impulse/a1_impulse.cpp");
  return {std::istreambuf_iterator<char>(in), {}};
}

// An untouched file: every test is not attempted. Always so in a tree with the reference; in a
// released tree a student's unfinished file is no failure of this test.
bool untouched() {
  if (fs::exists(test::source_dir() + "/solutions_private")) return true;
  static const bool is = check({File(stub()).path.string()}).code == 4;
  return is;
}
#define SKIP_UNLESS_UNTOUCHED() \
  if (!untouched()) GTEST_SKIP() << "somebody has worked in this tree's a1"

TEST(Check, JsonOfAPatternThatNoTestHasIsRefused) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(stub());
  expect_said(check({file.path.string(), "--json", "nosuch.*"}), 2,
              {"is no part of a test's title or name, and no function", "All titles: --all"});
}

TEST(Check, WarningsOfTheFileAreShownAboveTheTests) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(
      stub() +
      "\ndouble half(double a) {\n  double never_set;\n  if (a > never_set) return a;\n}\n");
  expect_said(check({file.path.string(), "PointForce.*"}), 4,
              {"the compiler warns: mine.cpp", "control reaches end of non-void function",
               "is used uninitialized"});
}

TEST(Check, AnInitialValueThatDoesNotEndIsOutOfTime) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(stub() +
                  "\nstatic int endless() {\n  for (volatile int i = 0;; i = i + 1) {}\n}\nint "
                  "at_load = endless();\n");
  expect_said(check({file.path.string(), "PointForce.*"}), 1, {"no answer within 2 s"});
}

// A file outside the own folder stays in the sandbox: it sees nothing of the tree.
TEST(Check, AnotherFileRunsInTheSandbox) {
  SKIP_UNLESS_UNTOUCHED();
  std::string text = stub();
  const std::string first = "throw NotImplemented(\"intersect_ray_triangle\"";
  text.insert(text.find(first),
              "if (std::FILE* seen = std::fopen(\"" + test::source_dir() +
                  "/README.md\", \"r\")) { std::fclose(seen); std::abort(); }\n  ");
  const File file("#include <cstdio>\n#include <cstdlib>\n" + text);
  const ProgramOutcome outcome = check({file.path.string()});
  expect_said(outcome, 4, {"not attempted"});
  EXPECT_EQ(outcome.printed.find("SIGABRT"), std::string::npos)
      << "the file could read the tree: " << outcome.printed;
}

double children_cpu_s() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

TEST(Check, AnEndlessLoopIsKnownWithinSeconds) {
  SKIP_UNLESS_UNTOUCHED();
  std::string text = stub();
  // without side effects: the compiler may not drop it
  text.insert(text.find("throw NotImplemented("), "for (;;) {}\n  ");
  const File file(text);
  check({file.path.string(), "PointForce.*"});  // builds what is missing
  const double before_s = children_cpu_s();
  const ProgramOutcome outcome = check({file.path.string()});
  const double took_s = children_cpu_s() - before_s;
  EXPECT_NE(outcome.printed.find("no answer within 2 s, in intersect_ray_triangle"),
            std::string::npos)
      << outcome.printed;
  EXPECT_NE(outcome.printed.find("no answer within 0.2 s, in intersect_ray_triangle"),
            std::string::npos)
      << outcome.printed;
  // s of CPU time, whatever else the machine does: 6 to 10, compiling included; twelve tests of 5 s
  // were 60
  EXPECT_LT(took_s, 20.0);
}

// The stub with normals in the plane: of a corner on an edge as given, of an edge on an edge by that
// function, and of a corner on a corner without unit length.
std::string with_normals(const std::string& of_edge) {
  std::string text = stub();
  const auto write = [&](const std::string& function, const std::string& rest) {
    const std::string head = "Vector2d contact_normal_" + function + "(";
    const std::size_t begin = text.find(head);
    text.replace(begin, text.find("}\n", begin) + 2 - begin, head + rest + "\n}\n");
  };
  write("vertex_edge",
        "const Vector2d& x, const Vector2d& a, const Vector2d& b) {\n  const Vector2d e = (b - "
        "a).normalized();\n  " +
            of_edge);
  write("edge_edge",
        "const Vector2d& a, const Vector2d& b, const Vector2d& x) {\n  return "
        "contact_normal_vertex_edge(x, a, b);");
  write("vertex_vertex", "const Vector2d& a, const Vector2d& b) {\n  return a - b;");
  return text;
}

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Check, AStoryIsToldOnceAndNamesTheMistakeThatTheAnswerShows) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(with_normals(
      "const Vector2d n(e.y(), -e.x());\n  return n.dot(x - a) < 0 ? Vector2d(-n) : n;"));
  const std::string printed = check({file.path.string(), "ContactNormal2d.*"}).printed;
  // one of its own test, one in each of two units: for either side of an edge it is the same
  EXPECT_EQ(count(printed, "likely:   normal not unit: divide by its length"), 3) << printed;
  EXPECT_EQ(count(printed, "absolute threshold"), 0) << printed;
  EXPECT_EQ(count(printed, "\nmend first\n    wrong in contact_normal_vertex_vertex (which begins"),
            1)
      << printed;
}

TEST(Check, WhatAsksAWrongFunctionFollowsFromItAndNothingIsCalledLikelyWithoutReason) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(with_normals("return Vector2d(1.5 * e.y(), x.x() + e.x());"));
  const std::string printed = check({file.path.string(), "ContactNormal2d.*Edge*"}).printed;
  EXPECT_EQ(count(printed, "likely:"), 0) << printed;
  EXPECT_GT(count(printed, "look at:"), 0) << printed;
  EXPECT_GT(
      count(printed, "probably follows from contact_normal_vertex_edge (which begins in line"), 0)
      << printed;
  EXPECT_EQ(count(printed, "\nmend first\n    contact_normal_vertex_edge (which begins in line"), 1)
      << printed;
}

// What the module's header brings is there for own tests, too, whether or not the fixtures use it.
TEST(Check, OwnTestsMayCallWhateverTheModulesHeaderDeclares) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(stub());
  const fs::path tests = file.path.parent_path() / "tests.cpp";
  write_whole(tests, R"(#include "tests/a1_impulse/a1_fixtures.h"
using namespace tumble;
TEST(Mine, ABodyIsNoWall) {
  EXPECT_GT(finite_inertia(2, Matrix3d::Identity()).inverse_mass, infinite_inertia().inverse_mass);
}
TEST(Mine, AForceAtTheCentreTurnsNothing) {
  modules::under_test<a1::Module>().wrench_of_point_force({4, 5, 6}, {1, 2, 3}, {1, 2, 3});
}
)");
  expect_said(check({file.path.string(), "--my-tests", tests.string()}), 4,
              {"Mine.ABodyIsNoWall", "Mine.AForceAtTheCentreTurnsNothing", "not attempted"});
}

TEST(Check, APatternThatChoosesNothingIsAnsweredWithTheNearestNames) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(stub());
  const ProgramOutcome outcome = check({file.path.string(), "ColisionImpuls.*"});
  EXPECT_EQ(outcome.code, 2) << outcome.printed;
  EXPECT_NE(outcome.printed.find("ColisionImpuls.*: is no part of a test's title or name, and no "
                                 "function. Nearest: 'Impulse of a central hit' "
                                 "(CollisionImpulse."),
            std::string::npos)
      << outcome.printed;
}

TEST(Check, ATitleOrAFunctionChoosesTests) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(with_normals("return Vector2d(1.5 * e.y(), x.x() + e.x());"));
  const std::string title = check({file.path.string(), "two WALLS"}).printed;
  EXPECT_NE(title.find("\n1 test: 1 not attempted"), std::string::npos) << title;
  EXPECT_NE(title.find("CollisionImpulse.TwoWallsExchangeNone"), std::string::npos) << title;
  EXPECT_EQ(check({file.path.string(), "Two", "walls"}).printed, title) << "words of one title";
  const std::string function = check({file.path.string(), "contact_normal_vertex_vertex"}).printed;
  EXPECT_NE(function.find("wrong in contact_normal_vertex_vertex"), std::string::npos) << function;
  EXPECT_EQ(function.find("wrong in contact_normal_vertex_edge"), std::string::npos) << function;
  EXPECT_EQ(function.find("not attempted"), std::string::npos) << function;
  expect_said(check({file.path.string(), "two wals"}), 2,
              {"Nearest: 'Two walls' (CollisionImpulse.TwoWallsExchangeNone)."});
  expect_said(check({file.path.string(), "colision_impulse"}), 2, {"Nearest: collision_impulse."});
}

TEST(Check, RightTestsAreOneLineAGroupAndNoLineIsWiderThanAScreen) {
  SKIP_UNLESS_UNTOUCHED();
  const File file(with_normals(
      "const Vector2d n(e.y(), -e.x());\n  return n.dot(x - a) < 0 ? Vector2d(-n) : n;"));
  const std::string folded = check({file.path.string()}).printed,
                    whole = check({file.path.string(), "--all"}).printed;
  EXPECT_NE(folded.find("\n        3 of  5  Contact normal 2d         2 wrong\n"),
            std::string::npos)
      << folded;
  EXPECT_EQ(count(folded, "ContactNormal2d.VertexEdgeIsPerpendicularTowardsTheVertex"), 0);
  EXPECT_EQ(count(whole, "ContactNormal2d.VertexEdgeIsPerpendicularTowardsTheVertex"), 1) << whole;
  for (const std::string& printed : {folded, whole}) {
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
    EXPECT_LT(printed.find("\nmend first\n"), printed.find("\n72 tests: "));
  }
}

// Of a4, in a tree with the reference: its stub answers nothing, so what is left is told.
TEST(Check, TheFirstChecksLeaveTheTestsOfWholeScenesOut) {
  const ProgramOutcome outcome = check({"--first", "--all"}, "a4");
  expect_said(outcome, 4, {"ComesBefore.", "The tests of whole scenes were not run"});
  EXPECT_EQ(outcome.printed.find("Scheduler."), std::string::npos) << outcome.printed;
  expect_said(check({"--first"}), 2, {"--first: a1 has no tests of whole scenes here"});
  const File file("#include \"assignments/a1_impulse/a1_impulse.h\"\n");
  expect_said(check({"--first", file.path.string()}), 2, {"--first: is of the public tests"});
}

TEST(Check, AMissingFileAndAnUnknownAssignmentAreReportedWithTheRemedy) {
  EXPECT_EQ(check({"/nowhere/mine.cpp"}).code, 2);
  const ProgramOutcome outcome =
      run_program({test::binary_dir() + "/bin/tumble_check", "check", "a99"}, Output::kCaptured);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.printed.find("Known: a1"), std::string::npos) << outcome.printed;
}

}  // namespace
}  // namespace tumble::grading
