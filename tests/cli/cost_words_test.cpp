// Error against cost on the command line: tumble cost, and tumble run --accuracy and --budget-s.
#include <regex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command_line.h"

namespace tumble::testing {
namespace {

TEST_F(CommandLine, CostReadsTheOrderOfEachMethodAndDrawsIt) {
  const Said said = type(
      "cost t_handle --modules library --methods euler,rk4,dopri5 --engines none --steps "
      "1/60,1/120,1/240,1/480 --tolerances 1e-6,1e-9 --duration-s 1");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(holds(said.out, "Euler converges with order") &&
              holds(said.out, "as it should (1)") && holds(said.out, "RK4 converges with order") &&
              holds(said.out, "as it should (4)"))
      << said.out;
  const std::string page = contents_of(folder_ / "out" / "cost" / "t_handle" / "index.html");
  EXPECT_TRUE(holds(page, ">order<"));
  EXPECT_TRUE(holds(page, "Error against CPU time") &&
              holds(page, "error of the reference solution"))
      << page.size() << " bytes";
}

TEST_F(CommandLine, CostWritesStepsAndTolerancesInOneStyle) {
  const Said said = type(
      "cost t_handle --modules library --methods rk4,dopri5 --engines none --steps 0.125,0.0625 "
      "--tolerances 1e-4,1e-5 --duration-s 1");
  EXPECT_EQ(said.code, 0) << said.err;
  const std::string blank = "\u00a0";
  for (const std::string& words : {"1/8" + blank + "s", "1/16" + blank + "s",
                                   "tolerance" + blank + "1e-4", "tolerance" + blank + "1e-5"})
    EXPECT_TRUE(holds(said.err, words)) << words << '\n' << said.err;
  EXPECT_FALSE(holds(said.err, "tolerance" + blank + "0.0001") || holds(said.err, "0.125"));
}

TEST_F(CommandLine, AnAccuracyChoosesMethodAndStepAndReportsTheCost) {
  const Said said = type("run t_handle --modules a2=library --accuracy 1e-6 --duration-s 2");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  for (const char* words : {"asked    an error of at most 1e-06 m", "truth    closed form",
                            "chosen   ", "paid     ", "the same without a search: "})
    EXPECT_TRUE(holds(said.out, words)) << words << '\n' << said.out;
}

TEST_F(CommandLine, ABudgetChoosesTheLeastErrorForIt) {
  const Said said = type("run t_handle --modules a2=library --budget-s 2 --duration-s 1");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  EXPECT_TRUE(holds(said.out, "asked    the least error for 2 s of CPU time") &&
              holds(said.out, "the error floor of the reference solution"))
      << said.out;
}

TEST_F(CommandLine, AnAccuracyRefusesWhatContradictsItAndWhatCannotBe) {
  const Said both = type("run t_handle --modules a2=library --accuracy 1e-6 --step-s 0.01"),
             too_fine = type("run t_handle --modules a2=library --accuracy 1e-20 --duration-s 1");
  EXPECT_EQ(both.code, 2);
  EXPECT_TRUE(holds(both.err, "it chooses engine, method and step")) << both.err;
  EXPECT_EQ(too_fine.code, 2);
  EXPECT_TRUE(holds(too_fine.err, "the reference solution is known to") &&
              holds(too_fine.err, "Request "))
      << too_fine.err;
}

TEST_F(CommandLine, AMethodOfTheLibraryCanTakeTheLawsPlace) {
  EXPECT_TRUE(holds(
      type("run t_handle --modules a2=library --method dopri5 --tolerance 1e-9 --duration-s 1").out,
      "motion by Dormand-Prince 5(4) of the library"));
  EXPECT_TRUE(holds(type("run t_handle --modules a2=library --method dopri5 --duration-s 1").err,
                    "none is given"));
}

TEST_F(CommandLine, CostOfTimesOfImpactReadsEachRootFinder) {
  const Said said = type("cost toi --tolerances 1e-3,1e-9");
  EXPECT_EQ(said.code, 0) << said.err;
  for (const char* words : {"Bisection reaches", "Newton, safeguarded reaches", "TOMS 748 reaches",
                            "Closed form (ball, plane) has an error of"})
    EXPECT_TRUE(holds(said.out, words)) << words << '\n' << said.out;
  EXPECT_FALSE(holds(said.out, "e-0")) << said.out;  // 1e-9, not 1e-09
  EXPECT_TRUE(holds(said.out, "An error of 1e-9 s costs at least ")) << said.out;
  const std::string page = contents_of(folder_ / "out" / "cost" / "toi" / "index.html");
  EXPECT_FALSE(holds(page, ">order<")) << "a column without a number";
  EXPECT_TRUE(fs::exists(folder_ / "out" / "cost" / "toi" / "index.html"));
}

#ifdef TUMBLE_HAS_REFERENCE
TEST_F(CommandLine, CostComparesCoordinatesAtAnErrorThatBothReach) {
  // at this one step RK4 is right to 1e-6 m with rows, and to 1.4e-6 m in joint coordinates
  const Said said = type(
      "cost double_pendulum --modules reference --methods rk4 --engines none --duration-s 1 "
      "--steps 0.01");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(holds(said.out,
                    "Of these runs only those with six coordinates a body reach 1e-6 m (RK4). "
                    "1e-3 m costs "))
      << said.out;
  EXPECT_TRUE(holds(said.out, " in joint coordinates, and ")) << said.out;
}

// closed form, springs, contacts, a reference solution for a limited time; half a second of
// refinements each
TEST_F(CommandLine, CostWorksOnScenesOfEveryKind) {
  for (const char* scene :
       {"bullet_thin_wall", "hung_by_spring", "beam_on_two_supports", "collide_off_centre_e0"}) {
    const Said said = type(std::string("cost ") + scene +
                           " --modules reference --methods rk4 --engines none --budget-s 0.5");
    EXPECT_EQ(said.code, 0) << scene << '\n' << said.err;
    EXPECT_TRUE(fs::exists(folder_ / "out" / "cost" / scene / "index.html")) << scene;
  }
}

// A chain that hangs at rest is right by every method; one that falls is not at 1/120 s, where a
// method of second order errs by some 1e-2 of the way.
TEST_F(CommandLine, CostSaysWhereNothingPartsTheMethods) {
  const std::string words =
      " --modules reference --methods midpoint --engines none --steps 1/60,1/120 --budget-s 3 "
      "--duration-s 0.1";
  const Said at_rest = type("cost chain_100" + words), falling = type("cost chain_8" + words);
  EXPECT_EQ(at_rest.code, 0) << at_rest.err;
  EXPECT_TRUE(holds(at_rest.out, "Every method is right to 1e-9 m at every step here"))
      << at_rest.out;
  EXPECT_FALSE(holds(falling.out, "Every method is right")) << falling.out;
}

TEST_F(CommandLine, CostShowsSolversOverTheirTolerance) {
  const Said said = type(
      "cost double_pendulum --modules reference --methods none --solvers gradients --duration-s "
      "0.5 --tolerances 1e-1,1e-6 --budget-s 2");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(holds(said.out, "Links by conjugate gradients gets to")) << said.out;
  // of steps, where no method has one
  EXPECT_FALSE(holds(contents_of(folder_ / "out" / "cost" / "double_pendulum" / "index.html"),
                     "nothing to draw"));
  EXPECT_TRUE(holds(type("cost t_handle --modules reference --solvers gradients").err,
                    "has no rods and no joints"));
}

TEST_F(CommandLine, CostOfSolversNamesWhatTheyCount) {
  const Said said = type(
      "cost blocks_on_an_incline --modules reference --methods none --engines none --solvers "
      "sweeps,newton --duration-s 0.1 --tolerances 1e-2,1e-6 --budget-s 1");
  EXPECT_EQ(said.code, 0) << said.err;
  const std::string page =
      contents_of(folder_ / "out" / "cost" / "blocks_on_an_incline" / "index.html");
  EXPECT_TRUE(holds(page, "contact sweeps [-]") && !holds(page, "derivatives asked for [-]"))
      << said.out;
}

TEST_F(CommandLine, CostShowsTheMethodsOfAModuleChosenByName) {
  const Said own = type(
      "cost t_handle --modules a2=reference --methods rk4 --engines none --steps 1/60,1/120 "
      "--duration-s 0.5 --budget-s 1");
  EXPECT_EQ(own.code, 0) << own.err;
  EXPECT_TRUE(holds(own.out, "reference euler") && holds(own.out, "reference rk4")) << own.out;
  const Said library = type(
      "cost t_handle --modules library --methods rk4 --engines none --steps 1/60,1/120 "
      "--duration-s 0.5 --budget-s 1");
  EXPECT_FALSE(holds(library.out, "reference ") || holds(library.out, "your ")) << library.out;
}

TEST_F(CommandLine, CostReportsWhatItLeavesOut) {
  const Said said = type(
      "cost bowl --modules reference --methods rk4,euler,midpoint --duration-s 0.1 --budget-s "
      "0.01");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(holds(said.out, "Not run: ca: bodies at rest fall asleep")) << said.out;
}

TEST_F(CommandLine, AChoiceIsReportedBeforeItsRun) {
  const Said said =
      type("run double_pendulum --modules reference --accuracy 1e-9 --duration-s 0.2");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  const std::size_t chosen = said.err.find("tumble: chosen "), ran = said.err.find("ran in ");
  ASSERT_NE(chosen, std::string::npos) << said.err;
  EXPECT_LT(chosen, ran) << said.err;
  EXPECT_TRUE(holds(said.err.substr(chosen), ": expected are ")) << said.err;
}

// Flight, impacts, springs, rods, and a contact that slides until it rolls: the error of the run is
// within the request. A search that measured its error at another step, or with other frames, would
// be wrong by orders of magnitude.
TEST_F(CommandLine, AnAccuracyIsReachedInScenesOfEveryKind) {
  for (const char* scene :
       {"t_handle", "pong_1", "hung_by_spring", "double_pendulum", "sliding_to_rolling"})
    for (const double asked_m : {1e-3, 1e-6}) {
      const Said said = type(fmt::format(
          "run {} --modules reference --accuracy {:g} --duration-s 0.5 --json", scene, asked_m));
      // 1: the scene's own checks are stricter
      ASSERT_TRUE(said.code == 0 || said.code == 1) << scene << '\n' << said.err;
      const nlohmann::json search = nlohmann::json::parse(said.out).at("search");
      EXPECT_LE(search.at("error_m").get<double>(), asked_m) << scene;
      EXPECT_LT(search.at("truth_error_m").get<double>(), asked_m) << scene;
    }
}

TEST_F(CommandLine, AnAccuracyIsHeldAgainstTheFilesThatKnowTheScene) {
  const Said said = type("run bouncing_ball --modules reference --accuracy 1e-6 --duration-s 0.5");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(holds(said.out, "tests/truths/bouncing_ball__e0.8.json")) << said.out;
}

TEST_F(CommandLine, CostOfAnAssignmentReadsItsMethods) {
  const Said said = type(
      "cost a2 --modules reference --duration-s 0.5 --steps 1/60,1/120,1/240,1/480 --tolerances "
      "1e-6 --budget-s 1");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(std::regex_search(
      said.out,
      std::regex("The reference rk4_step converges with order [0-9.]+, as it should \\(4\\)")))
      << said.out;
  EXPECT_TRUE(holds(contents_of(folder_ / "out" / "cost" / "a2" / "index.html"), "reference rk4"))
      << "the reference is nobody's own, and its sentence is at the head";
  EXPECT_FALSE(holds(said.out, "our rk4")) << said.out;
}

TEST_F(CommandLine, CostOfChainsReadsEachProposalBesideBruteForce) {
  const Said said = type("cost a5 --modules reference --budget-s 2 --json");
  ASSERT_EQ(said.code, 0) << said.err;
  const nlohmann::json told = nlohmann::json::parse(said.out);
  ASSERT_EQ(told["ways"].size(), 6u);  // mixed, plain, small, large steps, hard; brute force
  // Half of the prior's worlds do it, so brute force has points at every length: the law of means.
  // Its errors at 7 lengths are of nested samples, some 20 % each: the slope is known to 0.2.
  const nlohmann::json& brute = told["ways"].back();
  EXPECT_NEAR(brute["slope"], -0.5, 0.25) << brute;
  EXPECT_GT(brute["done"], 0.3 * static_cast<double>(brute["samples"]));
  EXPECT_EQ(told["ways"][4]["done"], told["ways"][4]["samples"]) << "a hard chain never leaves";
  const std::string page = contents_of(folder_ / "out" / "cost" / "a5" / "index.html");
  EXPECT_TRUE(holds(page, "An answer to a tenth of its spread costs") &&
              holds(page, "a chain pays where fewer than about 1 world in") &&
              holds(page, "Error of an answer against CPU time"));
}

TEST_F(CommandLine, CostOfChainsRefusesWhatChangesNothing) {
  const Said said = type("cost a5 --modules reference --methods rk4"),
             other = type("cost a5 --modules reference --on pong_1");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "a chain chooses among worlds")) << said.err;
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(holds(other.err, "does not say in what its worlds differ")) << other.err;
}

TEST_F(CommandLine, AnAccuracyIsRefusedWhereASceneHasNoReferenceSolution) {
  const Said said = type("run collide_off_centre_e0 --modules reference --accuracy 1e-6");
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_TRUE(holds(said.err, "this scene has no reference solution for 4 s") &&
              holds(said.err, "--duration-s"))
      << said.err;
}
#endif

TEST_F(CommandLine, CostRefusesAMethodThatThereIsNot) {
  const Said said = type("cost t_handle --modules library --methods rk5");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "there is no method of integration of that name") &&
              holds(said.err, "bulirsch-stoer"))
      << said.err;
  EXPECT_TRUE(left_nothing());
}

TEST_F(CommandLine, CostRefusesBeforeItMeasures) {
  for (const auto& [words, part] :
       {std::pair{"t_handle --out /dev/null/x", "cannot be written"},
        {"all --out /dev/null/x", "cannot be written"},
        {"all --methods rk4,rk5", "no method of integration of that name"},
        {"all --engines sw", "--engines sw"},
        {"all --solvers jacobi", "--solvers jacobi"},
        {"all --steps 1/0", "--steps 1/0"},
        {"all --modules a1=nowhere.cpp", "there is no such file"},
        {"a5 --modules library", "the library has no functions of a Markov chain"},
        {"a2 --modules library", "the library has no functions of a2 to measure"},
        {"a1 --modules library", "the library has no functions of a1 to measure"},
        {"a4 --modules library", "the library has no scheduler"},
        {"toi --impacts bisection,nowton", "nowton"},
        {"toi --modules a2=nowhere.cpp", "there is no such file"}}) {
    const Said said = type(std::string("cost ") + words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_EQ(said.out, "") << words;
    EXPECT_TRUE(holds(said.err, part)) << words << ": " << said.err;
  }
  EXPECT_TRUE(left_nothing());
}

}  // namespace
}  // namespace tumble::testing
