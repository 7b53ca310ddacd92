// The program on the command line: its output, exit codes, and files.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "tests/cli/command_line.h"
#include "tests/support/places.h"

namespace tumble::testing {
namespace {

TEST_F(CommandLine, WithoutAVerbOrWithAnUnknownOneItReportsItAndExitsWith2) {
  EXPECT_EQ(type("").code, 2);
  const Said said = type("simulate");
  EXPECT_EQ(said.code, 2);
  EXPECT_EQ(said.out, "");
  EXPECT_TRUE(holds(said.err, "simulate")) << said.err;
}

TEST_F(CommandLine, AMistypedVerbOrSceneIsAnsweredWithTheNearest) {
  const Said verb = type("chek a1"), scene = type("run pon_200");
  EXPECT_EQ(verb.code, 2);
  EXPECT_TRUE(holds(verb.err, "chek: there is no such verb. Did you mean 'check'? Known: "))
      << verb.err;
  EXPECT_EQ(scene.code, 2);
  EXPECT_TRUE(holds(scene.err, "pon_200: there is no such scene. Did you mean 'pong_200'? "))
      << scene.err;
}

TEST_F(CommandLine, AnUnknownFlagIsAnsweredWithTheNearest) {
  const Said said = type("grade a1 somewhere --no-meda");
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.err.find("--no-meda: grade has no such flag. Did you mean '--no-media'? Known: "),
            std::string::npos)
      << said.err;
}

TEST_F(CommandLine, ASceneThatNeedsAnAssignmentThatThereIsNotIsRefusedAtItsLine) {
  std::ofstream(folder_ / "s.json")
      << "{ \"title\": \"t\", \"duration_s\": 1,\n  \"needs\": [\"a1\", \"a33\"],\n"
         "  \"bodies\": [{ \"name\": \"b\", \"shape\": { \"sphere\": { \"radius_m\": 1 } }, "
         "\"mass_kg\": 1 }] }\n";
  const Said said = type("run s.json");
  EXPECT_EQ(said.code, 2);
  for (const std::string word : {"s.json:2", "/needs/1", "'a33'", "Did you mean 'a3'"})
    EXPECT_NE(said.err.find(word), std::string::npos) << word << " in: " << said.err;
}

TEST_F(CommandLine, HelpListsEveryVerb) {
  const Said said = type("--help");
  EXPECT_EQ(said.code, 0);
  for (const char* verb : {"check", "watch", "run", "poke", "cost", "inspect", "truths", "grade",
                           "audit", "release", "demo"})
    EXPECT_TRUE(holds(said.out, verb)) << verb;
}

// Eighty columns: what a terminal has when a course's machines are logged in to.
TEST_F(CommandLine, HelpOfEveryVerbFitsEightyColumns) {
  std::istringstream lines(type("--help-all").out + type("--help").out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 80U) << line;
  EXPECT_GT(count, 300);
}

TEST_F(CommandLine, ScenesListsEverySceneOfTheTreeOnce) {
  const nlohmann::json page = nlohmann::json::parse(type("scenes --json").out);
  std::set<std::string> names, files;
  for (const auto& scene : page.at("scenes")) {
    EXPECT_TRUE(names.insert(scene.at("name")).second) << scene;
    EXPECT_FALSE(scene.at("title").get<std::string>().empty()) << scene;
  }
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(test::source_dir()) / "assignments"))
    if (entry.path().parent_path().filename() == "scenes" && entry.path().extension() == ".json") {
      files.insert(entry.path().stem());
      EXPECT_TRUE(names.contains(entry.path().stem())) << entry.path();
    }
  EXPECT_GT(files.size(), 40U);
  EXPECT_TRUE(names.contains("atoms"));  // of any size
  const std::string chosen = type("scenes newtons").out;
  EXPECT_TRUE(holds(chosen, "newtons_cradle_2") && !holds(chosen, "t_handle")) << chosen;
}

TEST_F(CommandLine, AnUnknownSceneIsAnsweredWithThoseThereAre) {
  const Said said = type("run nonsense");
  EXPECT_EQ(said.code, 2);
  EXPECT_EQ(said.out, "");
  EXPECT_TRUE(holds(said.err, "nonsense") && holds(said.err, "pong_1")) << said.err;
}

TEST_F(CommandLine, AMistakeInASceneNamesFilePlaceFoundAndExpected) {
  write_whole(folder_ / "mine.json", R"({"title": "t", "duration_s": "long", "bodies": []})");
  const Said said = type("run mine.json");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "mine.json") && holds(said.err, "/duration_s")) << said.err;
}

// A mistyped flag leaves the right one missing: the answer is about what was typed.
TEST_F(CommandLine, AMissingWordIsNamedAndAMistypedOneFirst) {
  const Said missing = type("poke poked_box --pixel 200,250 --force 0,40,0");
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(holds(missing.err, "tumble: tumble poke: --duration-s is required.")) << missing.err;
  EXPECT_TRUE(holds(missing.err, "tumble poke --help")) << missing.err;
  const Said mistyped = type("poke poked_box --pixel 200,250 --forse 0,40,0 --duration-s 0.2");
  EXPECT_EQ(mistyped.code, 2);
  EXPECT_TRUE(holds(mistyped.err, "--forse: poke has no such flag. Did you mean '--force'?"))
      << mistyped.err;
  EXPECT_TRUE(holds(type("run").err, "tumble: tumble run: scene is required."));
  EXPECT_TRUE(left_nothing());
}

TEST_F(CommandLine, WhatAFlagDoesNotTakeIsToldInTheSameWordsEverywhere) {
  const std::vector<std::pair<std::string, std::string>> told = {
      {"run t_handle --step-s 0", "tumble run: --step-s: Value 0 is not a number above 0."},
      {"run t_handle --step-s", "tumble run: --step-s: its value is missing."},
      {"run t_handle --step-s 1 --step-s 2", "tumble run: --step-s: is given 2 times."},
      {"run t_handle --json=perhaps", "tumble run: --json: Value perhaps is not what it takes."},
      {"run t_handle pong_1", "tumble run: pong_1: more than it takes."},
      {"sweep t_handle --n x", "tumble sweep: --n: Value x is not a number above 0."}};
  for (const auto& [words, answer] : told) {
    const Said said = type(words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_TRUE(holds(said.err, "tumble: " + answer) && holds(said.err, "--help says")) << said.err;
  }
}

#ifdef TUMBLE_HAS_REFERENCE
TEST_F(CommandLine, BodiesThatOverlapAreNamedWithTheLineOfOneThatCanBeMoved) {
  write_whole(folder_ / "mine.json", R"({"title": "t", "duration_s": 1, "bodies": [
  {"name": "a", "mass_kg": 1, "shape": {"sphere": {"radius_m": 0.1}}},
  {"name": "b", "mass_kg": 1, "shape": {"sphere": {"radius_m": 0.1}}, "position_m": [0.1, 0, 0]},
  {"name": "floor", "immovable": true, "shape": {"plane": {}}, "position_m": [0, 0, -1]}
]})");
  const Said said = type("run mine.json --modules reference");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "mine.json:3: /bodies/1: bodies 'a' and 'b' overlap at the start"))
      << said.err;
}
#endif

TEST_F(CommandLine, AnUnknownEngineOrAStepOfZeroIsAMistakeToRepair) {
  EXPECT_EQ(type("run t_handle --engine warp").code, 2);
  EXPECT_EQ(type("run t_handle --step-s 0").code, 2);
  EXPECT_EQ(type("run t_handle --size 12").code, 2);
}

TEST_F(CommandLine, ANumberThatIsNotFiniteIsAMistakeToRepair) {
  for (const char* words :
       {"run t_handle --duration-s nan", "run t_handle --step-s inf", "run t_handle --speed nan",
        "run t_handle --method dopri5 --tolerance nan", "run t_handle --step-s 1e999",
        "poke poked_box --pixel 200,250 --force 0,40,0 --duration-s nan", "cost --budget-s nan",
        "cost t_handle --tolerances 1e-3,nan"}) {
    const Said said = type(words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_TRUE(holds(said.err, "is not a finite number")) << words << ": " << said.err;
  }
  EXPECT_TRUE(left_nothing());
}

// C reads 010 as octal: 8.
TEST_F(CommandLine, AWholeNumberWithALeadingZeroIsAMistakeToRepair) {
  for (const auto& [words, told] : {std::pair{"run gas --n 010", "write 10, without the leading 0"},
                                    {"run gas --n 00", "write 0, without the leading 0"},
                                    {"engines gas --sizes 10,-020", "write -20,"}}) {
    const Said said = type(words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_TRUE(holds(said.err, told)) << words << ": " << said.err;
  }
}

// A ball at 1 m/s: three of its checks hold for its second only.
TEST_F(CommandLine, AnotherDurationLeavesOutTheChecksOfTheScenesOwn) {
  write_whole(folder_ / "ball.json", R"({"title": "t", "duration_s": 1, "bodies": [{"name": "b",
        "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1, "velocity_m_s": [1, 0, 0]}],
    "checks": [{"kind": "energy", "tolerance": 1e-9, "why": "w"},
      {"kind": "final_position", "body": "b", "expected": [1, 0, 0], "tolerance": 1e-9, "why": "w"},
      {"kind": "final_position", "body": "b", "expected": [0.25, 0, 0], "at_s": 0.25,
        "tolerance": 1e-9, "why": "w"},
      {"kind": "stands", "axis": [0, 0, 1], "tolerance": 1e-9, "why": "w"},
      {"kind": "drift", "at_s": 0.75, "tolerance": 0.6, "why": "w"}]})");
  const std::string run = "run ball.json --modules library";
  const Said whole = type(run), part = type(run + " --duration-s 0.5"),
             longer = type(run + " --duration-s 1.25");
  EXPECT_EQ(whole.code, 0) << whole.out << whole.err;
  EXPECT_TRUE(holds(whole.out, "5 of 5 right") && !holds(whole.out, "left out")) << whole.out;
  EXPECT_EQ(part.code, 0) << part.out << part.err;
  EXPECT_TRUE(holds(part.out, "2 of 2 right") &&
              holds(part.out, "3 of 5 checks are about the scene's whole duration"))
      << part.out;
  EXPECT_TRUE(holds(longer.out, "3 of 3 right") && holds(longer.out, "2 of 5 checks"))
      << longer.out;
}

TEST_F(CommandLine, WordsThatWouldDoNothingAreRefusedBeforeTheRun) {
  fs::create_directory(folder_ / "taken");
  for (const auto& [words, part] : {std::pair{"--at-s 0.1", "--png"},
                                    {"--speed 0.25", "--video"},
                                    {"--moves 3", "--virtual-times"},
                                    {"--chart-until-s 1", "--virtual-times"},
                                    {"--virtual-times v.png", "no move of a scheduler"},
                                    {"--png ''", "the name of the file is empty"},
                                    {"--png p.jpg", "does not end with .png"},
                                    {"--sheet s.pdf", "does not end with .png"},
                                    {"--virtual-times v.svg", "does not end with .png"},
                                    {"--video v.avi", "does not end with .mp4"},
                                    {"--html page", "does not end with .html"},
                                    {"--png p.png --at-s 1e6", "the run ends at"},
                                    {"--png p.png --sheet ./p.png", "is the file of --png, too"},
                                    {"--trajectory taken", "it is a folder"},
                                    {"--threads 0", "--threads"},
                                    {"--threads 2", "the engine is rd"},
                                    {"--engine ca --threads 2", "the engine is ca"},
                                    {"--most-states 8", "leave out --most-states"}}) {
    const Said said = type(std::string("run t_handle --modules library ") + words);
    EXPECT_EQ(said.code, 2) << words << ": " << said.out;
    EXPECT_EQ(said.out, "") << words;
    EXPECT_TRUE(holds(said.err, part)) << words << ": " << said.err;
  }
}

// A rest speed of 1 mm/s that a scene gives: for a ball of 1 mm it ends bounces of 5e-5 of its
// radius, for one of 1 m of 5e-8. One that it does not give is less for the small ball.
TEST_F(CommandLine, ExplainSaysWhereTheRestSpeedIsMuchForASmallBody) {
  const auto scene_of_radius = [](const char* radius,
                                  const char* rest = R"("rest_speed_m_s": 1e-3,)") {
    return fmt::format(
        R"({{"title": "t", "duration_s": 1, {1} "gravity_m_s2": [0, 0, -9.81], "bodies": [
      {{"name": "bead", "shape": {{"sphere": {{"radius_m": {0}}}}}, "mass_kg": 0.001,
        "restitution": 0.5, "position_m": [0, 0, 3]}},
      {{"name": "floor", "shape": {{"plane": {{}}}}, "immovable": true}}]}})",
        radius, rest);
  };
  write_whole(folder_ / "usual.json", scene_of_radius("0.001", ""));
  const Said usual = type("explain usual.json");
  EXPECT_EQ(usual.code, 0) << usual.err;
  EXPECT_FALSE(holds(usual.out, "rest_speed_m_s")) << usual.out;
  write_whole(folder_ / "small.json", scene_of_radius("0.001"));
  write_whole(folder_ / "large.json", scene_of_radius("1"));
  const Said small = type("explain small.json"), large = type("explain large.json");
  EXPECT_EQ(small.code, 0) << small.err;
  EXPECT_TRUE(holds(small.out, "rest_speed_m_s") && holds(small.out, "'bead'")) << small.out;
  EXPECT_EQ(large.code, 0) << large.err;
  EXPECT_FALSE(holds(large.out, "rest_speed_m_s")) << large.out;
}

TEST_F(CommandLine, ExplainSaysInWhichCoordinatesAnIslandGoes) {
  const std::string scene = test::source_dir() + "/assignments/a3_constraints/scenes/four_bar.json";
  const std::string text = contents_of(scene);
  for (const auto& [coordinates, says, leaves] :
       {std::tuple{"maximal", false, false}, {"reduced", true, false}, {"auto", true, true}}) {
    std::string with = text;
    with.insert(with.find("\"duration_s\""),
                std::string("\"coordinates\": \"") + coordinates + "\", ");
    write_whole(folder_ / "bars.json", with);
    const Said said = type("explain bars.json");
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_EQ(holds(said.out, "joint coordinates, 3 bodies"), says) << said.out;
    EXPECT_EQ(holds(said.out, "where a module's rows are what the run shows"), leaves) << said.out;
  }
}

TEST_F(CommandLine, APathThatIsNoPlainFileSaysSo) {
  fs::create_directory(folder_ / "f.json");
  for (const char* words : {"run f.json", "run ./f.json", "explain f.json"}) {
    const Said said = type(words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_TRUE(holds(said.err, "f.json: is a folder")) << words << ": " << said.err;
  }
}

TEST_F(CommandLine, TruthsOfAnEmptyFolderAreAMistake) {
  EXPECT_EQ(type("truths .").code, 2);
  EXPECT_EQ(type("truths nowhere").code, 2);
}

// A number would be compared as metres whatever its label.
TEST_F(CommandLine, ACheckInAUnitThatIsNotItsKindsIsRefusedAtItsLine) {
  write_whole(folder_ / "cm.json",
              R"({"title": "t", "duration_s": 1, "bodies": [{"name": "b",
        "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1}],
    "checks": [{"kind": "final_position", "body": "b", "expected": [0, 0, 0], "tolerance": 1,
                "unit": "cm", "why": "w"}]})");
  const Said said = type("run cm.json --modules library");
  EXPECT_EQ(said.code, 2) << said.out << said.err;
  for (const char* part : {"cm.json:4", "/checks/0/unit", "'cm'", "in m,"})
    EXPECT_TRUE(holds(said.err, part)) << part << " in: " << said.err;
}

#ifdef TUMBLE_HAS_REFERENCE
TEST_F(CommandLine, TruthsOfAFolderWithAnOddFileNameItAndCompareTheOthers) {
  fs::create_directory(folder_ / "some");
  std::ofstream(folder_ / "some" / "a_notes.json") << "{\"remarks\": []}\n";
  std::ofstream(folder_ / "some" / "b_cut.json") << "{\"id\": \"x";
  fs::copy_file(fs::path(test::source_dir()) / "tests/truths/bouncing_ball__e0.5.json",
                folder_ / "some" / "c_ball.json");
  const Said said = type("truths some");
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_TRUE(holds(said.err, "a_notes.json") && holds(said.err, "b_cut.json")) << said.err;
  EXPECT_TRUE(holds(said.out, "1 cases") && holds(said.out, "2 files could not be compared"))
      << said.out;
  EXPECT_EQ(nlohmann::json::parse(type("truths some --json").out).at("odd_files").size(), 2u);
}

TEST_F(CommandLine, ARunIsJudgedOnStdoutWithProgressOnStderr) {
  const Said said = type("run t_handle --modules reference --png t.png --trajectory t.run");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  EXPECT_TRUE(holds(said.out, "right") && !holds(said.out, "WRONG")) << said.out;
  EXPECT_TRUE(holds(said.err, "wrote t.png")) << said.err;
  EXPECT_GT(fs::file_size(folder_ / "t.png"), 10000u);
  EXPECT_GT(fs::file_size(folder_ / "t.run"), 10000u);
}

TEST_F(CommandLine, CountsAreATableOfWhatHappened) {
  const Said said = type("run pong_1 --modules reference --duration-s 1");
  const std::size_t at = said.out.find("  counts");
  ASSERT_NE(at, std::string::npos) << said.out;
  EXPECT_TRUE(std::regex_search(said.out, std::regex("gap evaluations +[1-9]"))) << said.out;
  EXPECT_FALSE(
      std::regex_search(said.out.substr(at, said.out.find("quantity") - at), std::regex(" 0\\s")))
      << "what is 0 is left out: " << said.out;
  std::istringstream lines(said.out);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(!holds(line, "evaluations") || line.size() <= 120) << line;
}

// Two balls of radius 0.5 whose centres are 0.8 apart overlap by 0.2 m.
TEST_F(CommandLine, BodiesThatOverlapAtTheStartAreRefusedByNameDepthAndRemedy) {
  write_whole(folder_ / "deep.json", R"({"title": "t", "duration_s": 1, "bodies": [
    {"name": "left", "shape": {"sphere": {"radius_m": 0.5}}, "mass_kg": 1, "position_m": [0, 0, 0],
      "velocity_m_s": [1, 0, 0]},
    {"name": "right", "shape": {"sphere": {"radius_m": 0.5}}, "mass_kg": 1, "position_m": [0.8, 0,
      0]}]})");
  const Said said = type("run deep.json --modules reference --png p.png");
  EXPECT_EQ(said.code, 2) << said.out << said.err;
  EXPECT_TRUE(holds(said.err, "left") && holds(said.err, "right") && holds(said.err, "overlap") &&
              holds(said.err, "0.2 m") && holds(said.err, "apart"))
      << said.err;
  EXPECT_FALSE(fs::exists(folder_ / "p.png"));
}

// A run is a function of its scene: the same command gives the same bytes.
TEST_F(CommandLine, TheSameWordsGiveTheSameBytes) {
  ASSERT_EQ(type("run pong_1 --modules reference --duration-s 1 --trajectory a.run").code == 3,
            false);
  ASSERT_EQ(type("run pong_1 --modules reference --duration-s 1 --trajectory b.run").code == 3,
            false);
  // The command line is kept in the file, so the names have equal lengths.
  std::string a = contents_of(folder_ / "a.run"), b = contents_of(folder_ / "b.run");
  ASSERT_GT(a.size(), 1000u);
  for (std::size_t at; (at = b.find("b.run")) != std::string::npos;) b[at] = 'a';
  EXPECT_TRUE(a == b);
}

TEST_F(CommandLine, AFileThatCannotBeWrittenIsReportedAndNothingIsLeft) {
  const Said said = type("run t_handle --modules reference --png /proc/t.png");
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_TRUE(holds(said.err, "/proc/t.png")) << said.err;
  EXPECT_TRUE(left_nothing());
}

// The student's tree: the stub is not attempted, which is no error. (In a student's own tree the
// file may contain anything.)
TEST_F(CommandLine, AStubIsNotAttempted) {
  const Said said = type("run ball_against_wall --modules a1=student,a2=reference");
  EXPECT_EQ(said.code, 4) << said.out << said.err;
  EXPECT_TRUE(holds(said.out + said.err, "not attempted") ||
              holds(said.out + said.err, "not written"))
      << said.err;
}

TEST_F(CommandLine, AnAuditOfAnUnknownSlipIsAnsweredWithTheNearest) {
  const Said said = type("audit a1 --only arm_cross_omga");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "Did you mean 'arm_cross_omega'?")) << said.err;
}
#endif

// 700 s and one body that nothing touches, in steps of 100 s.
TEST_F(CommandLine, ALongRunKeepsFewerFramesUnlessItIsRecorded) {
  std::ofstream(folder_ / "long.json")
      << R"({"title": "t", "duration_s": 700, "step_s": 100, "bodies": [
             {"name": "b", "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1,
              "velocity_m_s": [1, 0, 0]}]})";
  const Said plain = type("run long.json --modules library"),
             recorded = type("run long.json --modules library --trajectory long.bin"),
             ordinary = type("run long.json --modules library --duration-s 600");
  EXPECT_EQ(plain.code, 0) << plain.err;
  EXPECT_TRUE(holds(plain.out, "36001 frames")) << plain.out;
  EXPECT_TRUE(holds(plain.out, "beyond 600 s")) << plain.out;
  EXPECT_TRUE(holds(recorded.out, "42001 frames")) << recorded.out;
  EXPECT_FALSE(holds(recorded.out, "beyond 600 s")) << recorded.out;
  EXPECT_TRUE(holds(ordinary.out, "36001 frames")) << ordinary.out;
  EXPECT_FALSE(holds(ordinary.out, "beyond 600 s")) << ordinary.out;
}

}  // namespace
}  // namespace tumble::testing
