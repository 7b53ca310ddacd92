// Ctrl-C during verbs that make one page from many pieces: it says what is kept, and where.
#include <chrono>

#include "tests/cli/own_terminal.h"

namespace tumble::testing {
namespace {

/// Presses Ctrl-C when `begun` stands on the screen. @return what was said from then on
std::string said_at_stop(Terminal& terminal, const std::string& begun) {
  EXPECT_TRUE(terminal.shows(begun)) << terminal.said;
  terminal.said.clear();
  terminal.press("\x03");
  const auto pressed = std::chrono::steady_clock::now();
  EXPECT_TRUE(terminal.shows("stopped by Ctrl-C: ")) << terminal.said;
  terminal.shows("never said, so all of it is read");
  EXPECT_EQ(terminal.exit_code(), 130);
  // a second on an idle machine
  EXPECT_LT(std::chrono::steady_clock::now() - pressed, std::chrono::seconds(20));
  return terminal.said;
}

TEST_F(CommandLine, CtrlCKeepsWhatCostHasMeasured) {
  Terminal terminal(folder_,
                    "cost t_handle --modules library --methods euler,rk4 --engines none "
                    "--budget-s 100 --out measured");
  const std::string said = said_at_stop(terminal, "2/2 RK4");
  EXPECT_TRUE(holds(said, "kept in measured/t_handle/index.html: 1 of 2 methods")) << said;
  const std::string page = contents_of(folder_ / "measured/t_handle/index.html");
  EXPECT_TRUE(holds(page, "Euler")) << page.size() << " bytes";
  EXPECT_TRUE(holds(page, "RK4: its turn had not come when this page was written"));
}

TEST_F(CommandLine, CtrlCBeforeAnythingIsFinishedSaysSo) {
  Terminal terminal(folder_, "cost t_handle --modules library --methods rk4 --budget-s 100");
  EXPECT_TRUE(holds(said_at_stop(terminal, "tumble: "), "nothing is kept"));
  EXPECT_FALSE(fs::exists(folder_ / "out/cost/t_handle/index.html"));
}

#ifdef TUMBLE_HAS_REFERENCE
TEST_F(CommandLine, CtrlCKeepsTheEnginesThatHaveRun) {
  Terminal terminal(folder_, "engines atoms --n 100 --engines tw,rd --modules reference");
  const std::string said = said_at_stop(terminal, "atoms by rd");
  EXPECT_TRUE(holds(said, "kept in out/engines/atoms/index.html: 1 of 2 runs")) << said;
  EXPECT_TRUE(fs::exists(folder_ / "out/engines/atoms/index.html"));
}

TEST_F(CommandLine, CtrlCKeepsTheCasesOfTheBatteryThatHaveRun) {
  Terminal terminal(folder_, "battery --only 1 2");
  const std::string said = said_at_stop(terminal, "tumble: 2 mass ratio, hanging");
  EXPECT_TRUE(holds(said, "kept in out/battery.html: 1 of 2 cases")) << said;
  EXPECT_TRUE(holds(contents_of(folder_ / "out/battery.html"), "1 of 2 cases so far"));
}
#endif

}  // namespace
}  // namespace tumble::testing
