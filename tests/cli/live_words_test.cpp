// tumble live in a terminal: Ctrl-C there ends it, and it says what is left.
#include <chrono>
#include <fstream>
#include <thread>
#include <utility>

#include "tests/cli/own_terminal.h"

namespace tumble::testing {
namespace {

// Processes of this program whose words name the folder.
int processes_about(const fs::path& folder) {
  int count = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored))
    count += holds(contents_of(entry.path() / "cmdline"), folder.string());
  return count;
}

TEST_F(CommandLine, CtrlCEndsTheLivePageAndItSaysWhatIsLeft) {
  std::ofstream(folder_ / "s.json")
      << R"({"title": "A ball that flies", "duration_s": 5, "step_s": 0.01, "bodies":
             [{"name": "b", "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1}]})";
  Terminal terminal(folder_, "live '" + (folder_ / "s.json").string() + "' --modules library");
  ASSERT_TRUE(terminal.shows("Ctrl-C ends")) << terminal.said;
  EXPECT_TRUE(holds(terminal.said, "http://127.0.0.1:"));
  terminal.press("\x03");
  EXPECT_TRUE(terminal.shows("ended; nothing is left running")) << terminal.said;
  EXPECT_EQ(terminal.exit_code(), 0);
  EXPECT_FALSE(holds(terminal.said, "kept")) << "nothing was done by hand";
  // a process that was told to end may need a moment
  for (int i = 0; i < 100 && processes_about(folder_) > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(processes_about(folder_), 0);
}

TEST_F(CommandLine, LiveRefusesInTheTerminalWhatItsPageCouldNotDo) {
  for (const auto& [words, part] : {std::pair{"--modules a1=nowhere.cpp", "no such file"},
                                    {"--engine warp", "no engine of that name"},
                                    {"--tolerance 1e-8", "no method is named"},
                                    {"--saves /dev/null/x", "cannot be written"}}) {
    Terminal terminal(folder_, std::string("live t_handle ") + words);
    ASSERT_TRUE(terminal.shows(part)) << words << ": " << terminal.said;
    EXPECT_EQ(terminal.exit_code(), 2) << words;
  }
  Terminal unknown(folder_, "live a77");
  EXPECT_TRUE(unknown.shows("Known: a1, a2")) << unknown.said;
  EXPECT_EQ(unknown.exit_code(), 2);
  EXPECT_TRUE(left_nothing());
}

// Of an empty file a shared object without a module is made.
TEST_F(CommandLine, AModuleOfAnEmptyFileIsSaidToBeOne) {
  const std::string object = (folder_ / "empty.so").string();
  ASSERT_EQ(std::system(("g++ -shared -x c++ /dev/null -o '" + object + "'").c_str()), 0);
  const Said said = type("run pong_1 --modules a1='" + object + "'");
  EXPECT_EQ(said.code, 1);
  EXPECT_TRUE(holds(said.out, ".so: defines nothing of a1")) << said.out;
  EXPECT_TRUE(holds(said.out, "is that file empty?")) << said.out;
}

#ifdef TUMBLE_HAS_REFERENCE
// What the run has compiled is judged as it is: the verdicts come without a second compilation, here
// where there is none to be had.
TEST_F(CommandLine, VerdictsOfThePageNeedNoSecondCompilation) {
  const fs::path object = fs::path(test::binary_dir()) / "modules" / "a1_student.so",
                 own = fs::path(test::source_dir()) / "assignments/a1_impulse/a1_impulse.cpp";
  if (fs::last_write_time(object) < fs::last_write_time(own)) GTEST_SKIP() << "not built anew";
  const Said alone =
      type("--version >/dev/null; TUMBLE_ROOT='" + test::source_dir() + "' PATH=/nowhere '" +
           test::binary_dir() + "/bin/tumble' live poked_box --part judge --id a1");
  EXPECT_TRUE(holds(alone.out, "\"said\":\"\",\"tests\":[{\"test\":\"RayTriangle."))
      << alone.out.substr(0, 300) << alone.err;
}
#endif

// The default folder of saved scenes cannot be made where "out" is a file. A sized scene is made by
// code, and Save is greyed out.
TEST_F(CommandLine, LiveGoesOnWhereNoSceneCouldBeSavedUnlessAFolderIsNamed) {
  std::ofstream(folder_ / "out") << "a file";
  for (const auto& [scene, is_told] : {std::pair{"t_handle", true}, {"gas --n 5", false}}) {
    Terminal terminal(folder_, std::string("live ") + scene + " --modules library");
    ASSERT_TRUE(terminal.shows("Ctrl-C ends")) << scene << ": " << terminal.said;
    EXPECT_EQ(holds(terminal.said, "Save in the page will fail"), is_told) << terminal.said;
    terminal.press("\x03");
    EXPECT_TRUE(terminal.shows("ended; nothing is left running")) << scene << ": " << terminal.said;
    EXPECT_EQ(terminal.exit_code(), 0) << scene;
  }
  Terminal named(folder_, "live t_handle --modules library --saves out/live");
  EXPECT_TRUE(named.shows("cannot be written")) << named.said;
  EXPECT_EQ(named.exit_code(), 2);
}

}  // namespace
}  // namespace tumble::testing
