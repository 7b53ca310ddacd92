// tumble check as a student runs it, on files of our own beside the stub.
#include <chrono>
#include <cstdlib>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

ProgramOutcome check(const std::vector<std::string>& more) {
  ::setenv("TUMBLE_ROOT", TUMBLE_SOURCE_DIR, 1);
  std::vector<std::string> words = {std::string(TUMBLE_BINARY_DIR) + "/bin/tumble", "check", "a1"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words, Output::kCaptured, 100.0);
}

// In a folder whose name has a space: students' folders have.
struct File {
  explicit File(const std::string& text) { write_whole(path, text); }
  ~File() { fs::remove_all(path.parent_path()); }
  fs::path path = fs::temp_directory_path() / ("tumble check " + std::to_string(::getpid())) / "mine.cpp";
};

TEST(Check, AnErrorOfTheCompilerIsAVerdictWithItsPlace) {
  const File file("#include \"assignments/a1_impulse/a1_impulse.h\"\nint x = ;\n");
  const ProgramOutcome outcome = check({file.path.string()});
  EXPECT_EQ(outcome.code, 1) << outcome.printed;
  EXPECT_NE(outcome.printed.find("does not compile: mine.cpp"), std::string::npos) << outcome.printed;
  EXPECT_NE(outcome.printed.find("mine.cpp:2:9: error:"), std::string::npos) << outcome.printed;
}

TEST(Check, AFunctionThatIsMissingIsToldToo) {
  const File file("#include \"assignments/a1_impulse/a1_impulse.h\"\n");
  const ProgramOutcome outcome = check({file.path.string()});
  EXPECT_EQ(outcome.code, 1) << outcome.printed;
  EXPECT_NE(outcome.printed.find("undefined"), std::string::npos) << outcome.printed;
  EXPECT_NE(outcome.printed.find("intersect_ray_triangle"), std::string::npos) << outcome.printed;
}

TEST(Check, AnEndlessLoopIsKnownWithinSeconds) {
  std::ifstream in(TUMBLE_SOURCE_DIR "/assignments/a1_impulse/a1_impulse.cpp");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.insert(text.find("throw NotImplemented("), "for (;;) {}\n  ");   // without side effects: the compiler may not drop it
  const File file(text);
  check({file.path.string(), "PointForce.*"});   // builds what there is to build
  const auto start = std::chrono::steady_clock::now();
  const ProgramOutcome outcome = check({file.path.string()});
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_NE(outcome.printed.find("no answer within 2 s, in intersect_ray_triangle"), std::string::npos) << outcome.printed;
  EXPECT_NE(outcome.printed.find("no answer within 0.2 s, in intersect_ray_triangle"), std::string::npos) << outcome.printed;
  EXPECT_LT(took_s, 20.0);   // s: 6 on an idle machine, compiling included; twelve tests of 5 s were 60
}

TEST(Check, APatternThatChoosesNothingIsAnsweredWithTheNearestNames) {
  const ProgramOutcome outcome = check({"ColisionImpuls.*"});
  EXPECT_EQ(outcome.code, 2) << outcome.printed;
  EXPECT_NE(outcome.printed.find("ColisionImpuls.*: no test has such a name. Nearest: CollisionImpulse."), std::string::npos) << outcome.printed;
}

TEST(Check, AFileThatIsNotThereAndAnUnknownAssignmentAreToldWithWhatToDo) {
  EXPECT_EQ(check({"/nowhere/mine.cpp"}).code, 2);
  const ProgramOutcome outcome = run_program({std::string(TUMBLE_BINARY_DIR) + "/bin/tumble", "check", "a99"}, Output::kCaptured);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.printed.find("Known: a1"), std::string::npos) << outcome.printed;
}

}  // namespace
}  // namespace tumble::grading
