// Engines on the command line: compared, and what their tables and pages refuse.
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/cli/command_line.h"

namespace tumble::testing {
namespace {

#ifdef TUMBLE_HAS_REFERENCE
// Every engine reports w h, in words and as JSON: 2 x discontinuities x step over bodies and time.
TEST_F(CommandLine, RunReportsDiscontinuitiesPerBodyAndStepForEveryEngine) {
  for (const std::string engine : {"rd", "ca", "ordered", "tw"}) {
    const std::string words =
        "run gas --n 8 --modules reference --duration-s 1 --propagator auto --engine " + engine;
    const nlohmann::json page = nlohmann::json::parse(type(words + " --json").out);
    const double expected = 2.0 * page.at("counts").at("discontinuities").get<double>() *
                            page.at("step_s").get<double>() / (8 * page.at("end_s").get<double>());
    ASSERT_GT(expected, 0.1) << engine;
    EXPECT_DOUBLE_EQ(page.at("w_h").get<double>(), expected) << engine;
    EXPECT_TRUE(holds(type(words).out, "w h ")) << engine;
  }
}

TEST_F(CommandLine, EnginesAreComparedInATableAndOnAPage) {
  const Said said = type("engines gas --sizes 10,20 --duration-s 0.5 --modules a1=reference");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  for (const char* words : {"n = 10", "n = 20", "Anti-messages", "same trace, bit for bit",
                            "out/engines/gas/index.html"})
    EXPECT_TRUE(holds(said.out, words)) << words << "\n" << said.out;
  const std::string page = contents_of(folder_ / "out/engines/gas/index.html");
  for (const char* words :
       {"conservative advancement", "Average integration step", "Error of the energy"})
    EXPECT_TRUE(holds(page, words)) << words;
}

// What is missing is of pictures alone.
TEST_F(CommandLine, JsonOfAllEnginesHasItsRowsWhereNothingCanBeDrawn) {
  if (!fs::exists(fs::path(test::binary_dir()) / "modules" / "a3_reference.so"))
    GTEST_SKIP() << "this tree has no a3 but the student's";
  const std::string words = "engines --small --no-videos --modules reference";
  ::setenv("TUMBLE_GL", "none", 1);
  const Said page = type(words), json = type(words + " --json");
  ::unsetenv("TUMBLE_GL");
  EXPECT_EQ(page.code, 2);
  EXPECT_EQ(page.out, "");
  EXPECT_TRUE(holds(page.err, "TUMBLE_GL")) << page.err;
  EXPECT_EQ(json.code, 1) << json.err;
  EXPECT_TRUE(holds(json.err, "TUMBLE_GL: \"none\" is not known")) << json.err;
  const auto scenes = nlohmann::json::parse(json.out).at("scenes");
  ASSERT_FALSE(scenes.empty());
  for (const auto& scene : scenes) {
    EXPECT_TRUE(holds(scene.at("problem").get<std::string>(), "TUMBLE_GL")) << scene;
    EXPECT_FALSE(scene.at("engines").empty()) << scene;
  }
  EXPECT_TRUE(fs::exists(folder_ / "out/engines/atoms/index.html"));
}

// Who computes springs, rods and contact stands beside who computes the rest, on every path; what
// rubs, is linked or is one of many contacts is solved by the framework.
TEST_F(CommandLine, WhoComputesRodsAndContactIsSaidWhereverLawsAre) {
  const std::string by = "springs, rods and contact by a3 reference";
  const Said engines = type("engines four_bar --engines rd --duration-s 0.05 --modules reference");
  EXPECT_TRUE(holds(engines.out, by)) << engines.out << engines.err;
  const Said run = type("run blocks_on_an_incline --duration-s 0.05 --modules reference");
  EXPECT_TRUE(holds(run.out, by + ", where it rubs, is linked or is one of many by the framework"))
      << run.out << run.err;
  EXPECT_FALSE(holds(engines.out, "where it rubs")) << engines.out;
}

TEST_F(CommandLine, ThePageOfAllEnginesRefusesWhatBelongsToOneSceneAndTheOtherWayRound) {
  const Said size = type("engines --n 5");
  EXPECT_EQ(size.code, 2);
  EXPECT_TRUE(holds(size.err, "belong to one scene")) << size.err;
  const Said full = type("engines gas --full");
  EXPECT_EQ(full.code, 2);
  EXPECT_TRUE(holds(full.err, "page of all scenes")) << full.err;
  const Said engine = type("engines --engines rd,warp");
  EXPECT_EQ(engine.code, 2);
  EXPECT_TRUE(holds(engine.err, "there is no engine of that name")) << engine.err;
}

TEST_F(CommandLine, AnEngineAndASizeThatThereAreNotAreRefusedWithWhatThereIs) {
  const Said engine = type("run gas --n 5 --engine timewarp --modules a1=reference");
  EXPECT_EQ(engine.code, 2);
  EXPECT_TRUE(holds(engine.err, "there is no engine of that name") &&
              holds(engine.err, "tw (timewarp)"))
      << engine.err;
  const Said propagator =
      type("run gas --n 5 --engine tw --propagator laws --modules a1=reference");
  EXPECT_EQ(propagator.code, 2);
  EXPECT_TRUE(holds(propagator.err, "closed form only")) << propagator.err;
  const Said size = type("run bouncing_ball --n 5");
  EXPECT_EQ(size.code, 2);
  EXPECT_TRUE(holds(size.err, "has one size") && holds(size.err, "atoms")) << size.err;
  for (const char* words : {"--engine tw", "--html f.html --beside engine=tw"}) {
    const Said scene = type(std::string("run bowl --modules reference ") + words);
    EXPECT_EQ(scene.code, 2);
    EXPECT_EQ(scene.out, "");
    EXPECT_TRUE(holds(scene.err, "sleep") && holds(scene.err, "use --engine rd")) << scene.err;
  }
  const Said sizes = type("engines atoms --sizes 5,0 --modules a1=reference");
  EXPECT_EQ(sizes.code, 2);
  EXPECT_EQ(sizes.out, "");  // not even of the size that there is
}

// A student whose a2 and a3 are unfinished still runs a scheduler on scenes that need them: right
// modules are used where the tree has them.
TEST_F(CommandLine, ASchedulerIsTriedOnScenesOfOtherAssignments) {
  for (const char* id : {"a3", "a4"})
    if (!std::ifstream(std::string(test::binary_dir() + "/modules/") + id + "_reference.so"))
      GTEST_SKIP() << "this tree has no " << id << " but the student's";
  const Said said =
      type("run dominoes_row --n 2 --duration-s 0.1 --engine tw --modules a4=reference");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  EXPECT_TRUE(holds(said.out, "rollbacks")) << said.out;
}

// How many moves there are is known after the run only.
TEST_F(CommandLine, AMoveThatThereIsNotCostsTheChartAlone) {
  if (!fs::exists(fs::path(test::binary_dir()) / "modules" / "a4_reference.so"))
    GTEST_SKIP() << "this tree has no a4 but the student's";
  const Said said = type(
      "run late_hit --modules reference --virtual-times v.png --moves 100000 --png p.png --html "
      "p.html");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "move 100000")) << said.err;
  for (const char* file : {"p.png", "p.html"}) EXPECT_TRUE(fs::exists(folder_ / file)) << file;
  EXPECT_FALSE(fs::exists(folder_ / "v.png"));
}
#endif

}  // namespace
}  // namespace tumble::testing
