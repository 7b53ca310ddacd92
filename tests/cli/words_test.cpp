// The program on the command line: its output, exit codes, and files.
#include <fstream>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/trajectory/trajectory.h"
#include "tests/cli/command_line.h"

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

TEST_F(CommandLine, APageOfTwoTimewarpsHasTheVirtualTimesOfBoth) {
  const Said said = type(
      "run pong_1 --modules reference --engine tw --duration-s 0.5 --html both.html --beside "
      "engine=tw,a2=library");
  const std::string page = contents_of(folder_ / "both.html");
  std::size_t panels = 0;
  for (std::size_t at = page.find("\"kind\":\"virtual_times\""); at != std::string::npos;
       at = page.find("\"kind\":\"virtual_times\"", at + 1))
    ++panels;
  EXPECT_EQ(panels, 2u) << said.err;
  EXPECT_TRUE(holds(page, "\"title\":\"Virtual times, reference\"") &&
              holds(page, "\"title\":\"Virtual times, library\""))
      << said.err;
}
#endif

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

TEST_F(CommandLine, AVideoWithoutFfmpegIsRefusedBeforeTheRun) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  const Said run = type("run t_handle --modules library --video v.mp4"),
             engines = type("engines --small");
  ::setenv("PATH", path.c_str(), 1);
  for (const Said& said : {run, engines}) {
    EXPECT_EQ(said.code, 2);
    EXPECT_EQ(said.out, "");
    EXPECT_TRUE(holds(said.err, "ffmpeg is not installed")) << said.err;
  }
  EXPECT_TRUE(holds(engines.err, "--no-videos")) << engines.err;
  EXPECT_TRUE(left_nothing());
}

TEST_F(CommandLine, APagePlaysARunBesideAnotherOrBesideARecording) {
  const Said alone = type(
      "run t_handle --modules library --duration-s 0.5 --trajectory first.run --html alone.html");
  EXPECT_TRUE(holds(alone.err, "wrote alone.html")) << alone.err;
  const Said beside = type(
      "run t_handle --modules library --duration-s 0.5 --step-s 0.02 --beside step-s=0.01 --html "
      "beside.html");
  const std::string page = contents_of(folder_ / "beside.html");
  EXPECT_TRUE(holds(page, "\"label\":\"step 0.02 s\"") && holds(page, "\"label\":\"step 0.01 s\""))
      << beside.err;
  const Said recorded = type(
      "run t_handle --modules library --duration-s 0.5 --beside recording=first.run --html "
      "recorded.html");
  const std::string same = contents_of(folder_ / "recorded.html");
  // the recording is of the same run
  EXPECT_TRUE(holds(same, "\"label\":\"first\"") && holds(same, "\"difference\":null"))
      << recorded.err;
  EXPECT_FALSE(holds(recorded.err, "the recording is of")) << recorded.err;
}

// Of a page: what moves the bodies of each run.
std::vector<std::string> motions_of(const std::string& page) {
  std::vector<std::string> motions;
  const std::regex motion("\"motion\":\"([^\"]*)\"");
  for (std::sregex_iterator it(page.begin(), page.end(), motion), end; it != end; ++it)
    motions.push_back((*it)[1]);
  return motions;
}

// What is not named after --beside is that of the first run.
TEST_F(CommandLine, ARunBesideHasTheMethodOfTheFirst) {
  const Said said = type(
      "run t_handle --modules library --duration-s 0.5 --method euler --step-s 0.02 --beside "
      "step-s=0.01 --html method.html");
  const std::vector<std::string> motions = motions_of(contents_of(folder_ / "method.html"));
  ASSERT_EQ(motions.size(), 2U) << said.err;
  EXPECT_EQ(motions[0], motions[1]);
  EXPECT_TRUE(holds(motions[1], "Euler")) << motions[1];
}

// The method of the first run would stand in place of what was asked for.
TEST_F(CommandLine, AModuleOfMotionBesideMovesTheBodiesItself) {
  for (const char* beside : {"a2=library", "library"}) {
    const Said said = type(
        "run t_handle --modules library --duration-s 0.5 --method euler --step-s 0.02 --html "
        "own.html --beside " +
        std::string(beside));
    const std::string page = contents_of(folder_ / "own.html");
    const std::vector<std::string> motions = motions_of(page);
    ASSERT_EQ(motions.size(), 2U) << beside << ": " << said.err;
    EXPECT_TRUE(holds(motions[0], "Euler")) << beside << ": " << motions[0];
    EXPECT_FALSE(holds(motions[1], "Euler")) << beside << ": " << motions[1];
    EXPECT_TRUE(holds(page, "\"label\":\"" + motions[0] + "\"")) << beside;
    EXPECT_FALSE(holds(page, "\"difference\":null")) << beside;
  }
#ifdef TUMBLE_HAS_REFERENCE
  const Said said = type(
      "run t_handle --modules library --duration-s 0.5 --method euler --step-s 0.02 --html "
      "reference.html --beside a2=reference");
  const std::vector<std::string> motions = motions_of(contents_of(folder_ / "reference.html"));
  ASSERT_EQ(motions.size(), 2U) << said.err;
  EXPECT_EQ(motions[1], "a2 reference");
  const Said other = type(
      "run t_handle --modules library --duration-s 0.5 --method euler --step-s 0.02 --html "
      "other.html --beside a1=reference");
  const std::vector<std::string> same = motions_of(contents_of(folder_ / "other.html"));
  ASSERT_EQ(same.size(), 2U) << other.err;
  EXPECT_EQ(same[0], same[1]) << "a1 moves no body";
#endif
}

// The propagator of the first run is one that rd alone has.
TEST_F(CommandLine, AnEngineBesideIsNotRefusedForThePropagatorOfTheFirst) {
  write_whole(folder_ / "one.json", R"({"title": "one", "duration_s": 0.1, "bodies": [{
        "name": "b", "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1}]})");
  for (const std::string engine : {"ca", "ordered"}) {
    const Said said = type(
        "run one.json --modules library --engine rd --propagator laws --html p.html --beside "
        "engine=" +
        engine);
    EXPECT_EQ(said.code, 0) << said.out << said.err;
    EXPECT_TRUE(holds(contents_of(folder_ / "p.html"), "\"label\":\"engine " + engine + "\""))
        << said.err;
  }
}

#ifdef TUMBLE_HAS_REFERENCE
// A sandbox answers one thread; the run is the same with any number of them.
TEST_F(CommandLine, ASubmissionBesideIsNotRefusedForTheThreadsOfTheFirst) {
  fs::copy_file(fs::path(test::source_dir()) / "solutions_private/a1_impulse/a1_impulse.cpp",
                folder_ / "sub.cpp");
  const std::string words =
      "run pong_1 --duration-s 0.2 --engine tw --threads 2 --html p.html --modules ";
  const Said said = type(words + "reference --beside a1=sub.cpp");
  EXPECT_LE(said.code, 1) << said.out << said.err;
  EXPECT_TRUE(holds(contents_of(folder_ / "p.html"), "\"label\":\"sub\"")) << said.err;
  const Said first = type(words + "a1=sub.cpp,a2=reference");
  EXPECT_EQ(first.code, 2) << first.out;
  EXPECT_TRUE(holds(first.err, "one call at a time")) << first.err;
}
#endif

TEST_F(CommandLine, ARecordingOfAnotherSceneIsShownWithANote) {
  for (const char* name : {"one", "two"})
    write_whole(folder_ / (std::string(name) + ".json"),
                std::string(R"({"title": ")") + name + R"(", "duration_s": 0.1, "bodies": [{
        "name": "b", "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1}]})");
  ASSERT_EQ(type("run one.json --modules library --trajectory one.run").code, 0);
  const Said said = type("run two.json --modules library --beside recording=one.run --html p.html");
  EXPECT_TRUE(holds(said.err, "the recording is of another scene, one")) << said.err;
  EXPECT_TRUE(holds(contents_of(folder_ / "p.html"), "the recording is of another scene, one"));
}

TEST_F(CommandLine, ARecordingThatCannotBeTrustedIsShownWithAWarning) {
  write_whole(folder_ / "one.json", R"({"title": "one", "duration_s": 0.1, "bodies": [{
        "name": "b", "shape": {"sphere": {"radius_m": 1}}, "mass_kg": 1}]})");
  ASSERT_EQ(type("run one.json --modules library --trajectory one.run").code, 0);
  Trajectory run = read_trajectory(folder_ / "one.run");
  RunFault fault;
  fault.kind = "energy_rises";
  fault.subject = "'b'";
  fault.first_s = 0.05;
  fault.count = 1;
  run.counters.faults = {fault};
  write_trajectory(folder_ / "one.run", run);
  const Said said = type("run one.json --modules library --beside recording=one.run --html p.html");
  EXPECT_TRUE(holds(said.err, "one.run: cannot be trusted: energy_rises of 'b'")) << said.err;
  EXPECT_TRUE(holds(contents_of(folder_ / "p.html"), "energy_rises of 'b'"));
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

TEST_F(CommandLine, BesideThatCannotBeIsRefusedBeforeAnythingRuns) {
  for (const auto& [words, part] :
       {std::pair{"--beside reference", "Add --html"},
        {"--html f.html --beside step-s=fast", "'fast'"},
        {"--html f.html --beside recording=nowhere.run", "nowhere.run"},
        {"--html f.html --beside recording=a.run,engine=rd", "as it was made"},
        {"--html f.html --beside engine=warp", "no engine of that name"},
        {"--html f.html --beside a1=nowhere.cpp", "there is no such file"},
        {"--html f.html --beside a1=notes.txt", "this is none of student"},
        {"--html f.html --beside a1=.", "this folder holds no a1_impulse.cpp"},
        {"--html f.html --beside a9=reference", "a9"}}) {
    const Said said = type(std::string("run t_handle --modules library ") + words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_EQ(said.out, "") << words;
    EXPECT_TRUE(holds(said.err, part)) << said.err;
  }
  EXPECT_TRUE(left_nothing());
}

TEST_F(CommandLine, AMissingModelIsReportedByName) {
  const Said said = type("inspect nowhere.3ds");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "nowhere.3ds")) << said.err;
}

TEST_F(CommandLine, InspectWeighsABox) {
  const Said said = type("inspect box --density 2 --json");
  EXPECT_EQ(said.code, 0) << said.err;
  const nlohmann::json page = nlohmann::json::parse(said.out);
  const auto& object = page.at("objects").at(0);
  EXPECT_TRUE(object.at("closed").get<bool>());
}

// Known facts of a box: every line of the output, with its number.
TEST_F(CommandLine, InspectPrintsEveryLineOfAGoodModel) {
  const Said said = type("inspect box --density 1200");
  EXPECT_EQ(said.code, 0) << said.err;
  const nlohmann::json object =
      nlohmann::json::parse(type("inspect box --density 1200 --json").out).at("objects").at(0);
  for (const char* line :
       {"1 object ", "density 1200 kg/m^3", "closed, convex", "vertices, faces 8, 12",
        "bounding box", "size", "volume", "mass", "centre of mass", "inertia",
        "about the centre of mass", "principal axes"})
    EXPECT_TRUE(holds(said.out, line)) << line << "\n" << said.out;
  EXPECT_FALSE(holds(said.out, "wrong") || holds(said.out, "remedy")) << said.out;
  // For any size of the box: mass is density times volume, volume is that of the bounding box, and
  // a box's moment about an axis is m (b^2 + c^2) / 12. Its corners are float32 in the file: 1e-6
  // relative.
  const auto low = object.at("bounding_box_m").at("low"),
             high = object.at("bounding_box_m").at("high");
  double size[3], volume = 1.0;
  for (int i = 0; i < 3; ++i)
    size[i] = high.at(i).get<double>() - low.at(i).get<double>(), volume *= size[i];
  const double mass = object.at("mass_kg");
  EXPECT_NEAR(object.at("volume_m3").get<double>(), volume, 1e-6 * volume);
  EXPECT_NEAR(mass, 1200 * volume, 1e-6 * mass);
  for (int i = 0; i < 3; ++i) {
    const double b = size[(i + 1) % 3], c = size[(i + 2) % 3], moment = mass * (b * b + c * c) / 12;
    EXPECT_NEAR(object.at("inertia_com_mesh_kg_m2").at(i).at(i).get<double>(), moment,
                1e-6 * moment);
    EXPECT_NEAR(object.at("com_mesh_m").at(i).get<double>(),
                0.5 * (low.at(i).get<double>() + high.at(i).get<double>()), 1e-6 * size[i]);
  }
  EXPECT_EQ(object.at("principal_moments_kg_m2").size(), 3u);
}

TEST_F(CommandLine, InspectOfABrokenModelKeepsWhatIsKnownAndSaysWhatToDo) {
  const Said said = type("inspect broken/lampshade");
  for (const char* line : {"not a solid", "vertices, faces", "bounding box", "wrong", "remedy"})
    EXPECT_TRUE(holds(said.out, line)) << line << "\n" << said.out;
  EXPECT_FALSE(holds(said.out, "centre of mass")) << "what is no solid has no weight: " << said.out;
}

TEST_F(CommandLine, InspectOfAnOpenSurfaceSaysWhereAndExitsWith1) {
  const Said said = type("inspect broken/lampshade");
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_TRUE(holds(said.out, "thick") || holds(said.out, "open")) << said.out;
}

TEST_F(CommandLine, TruthsOfAnEmptyFolderAreAMistake) {
  EXPECT_EQ(type("truths .").code, 2);
  EXPECT_EQ(type("truths nowhere").code, 2);
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
#endif

#ifdef TUMBLE_HAS_REFERENCE
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

// 40 N for 0.2 s along y on a free body: momentum 8 kg m/s, for any point of the force.
TEST_F(CommandLine, APokeGivesMomentumForceTimesTime) {
  const Said said = type(
      "poke poked_box --modules reference --ray -0.6,-10,0.85,0,1,0 --force 0,40,0 --duration-s "
      "0.2");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  EXPECT_TRUE(holds(said.out + said.err, "face")) << said.out;
}

// The pixel of the first example in README and handout.
TEST_F(CommandLine, ThePixelOfTheReadmeHitsTheBox) {
  EXPECT_TRUE(holds(contents_of(test::source_dir() + "/README.md"),
                    "poke poked_box --pixel 200,250 --force 0,40,0"));
  EXPECT_TRUE(holds(contents_of(test::source_dir() + "/handouts/a1_impulse.md"),
                    "poke poked_box --pixel 200,250 --force 0,40,0"));
  const Said said =
      type("poke poked_box --modules reference --pixel 200,250 --force 0,40,0 --duration-s 0.2");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
}

TEST_F(CommandLine, APokeThatHitsNothingSaysWhatTheRayCameNearestTo) {
  const Said said = type(
      "poke poked_box --modules reference --ray -0.6,-10,90,0,1,0 --force 0,40,0 --duration-s 0.2");
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_TRUE(holds(said.err, "box")) << said.err;
}

TEST_F(CommandLine, PokeWantsOneWayToPoint) {
  EXPECT_EQ(type("poke poked_box --force 0,40,0 --duration-s 0.2").code, 2);
  EXPECT_EQ(type("poke poked_box --pixel 320 --force 0,40,0 --duration-s 0.2").code, 2);
  EXPECT_EQ(type("poke poked_box --pixel 320,240 --force up --duration-s 0.2").code, 2);
}

TEST_F(CommandLine, PlotsOfAPageBecomePicturesOfTheWidthAskedFor) {
  ASSERT_EQ(type("cost toi --budget-s 1 --out .").code, 0);
  if (std::system("command -v rsvg-convert >/dev/null") == 0) {
    const Said said = type("plots toi/index.html --width-px 900");
    ASSERT_EQ(said.code, 0) << said.err;
    ASSERT_FALSE(said.out.empty());
    const std::string png = contents_of(folder_ / said.out.substr(0, said.out.find('\n')));
    ASSERT_GT(png.size(), 24u);
    EXPECT_EQ(png.substr(1, 3), "PNG");
    // the width in its header
    EXPECT_EQ(static_cast<unsigned char>(png[18]) * 256 + static_cast<unsigned char>(png[19]), 900);
  }
  const Said drawn = type("plots toi/index.html --svg --out drawn");
  EXPECT_TRUE(contents_of(folder_ / drawn.out.substr(0, drawn.out.find('\n'))).starts_with("<?xml"))
      << drawn.err;
  std::ofstream(folder_ / "empty.html") << "<p>words</p>";
  for (const char* page : {"empty.html", "nowhere.html"}) {
    const Said refused = type(std::string("plots ") + page);
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(holds(refused.err, page)) << refused.err;
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

TEST_F(CommandLine, RunAndPokeTakeAModelAtOnce) {
  const Said free = type("run t_handle.3ds --modules reference"),
             dropped = type("run wedge.3ds --drop --scale 0.5 --modules reference");
  EXPECT_EQ(free.code, 0) << free.out << free.err;
  EXPECT_TRUE(holds(free.out, "free in space")) << free.out;
  EXPECT_TRUE(holds(free.out, "angular_momentum")) << free.out;
  EXPECT_EQ(dropped.code, 0) << dropped.out << dropped.err;
  EXPECT_TRUE(holds(dropped.out, "dropped on a floor")) << dropped.out;
  const Said poked =
      type("poke t_handle.3ds --pixel 320,240 --force 0,40,0 --duration-s 0.2 --modules reference");
  EXPECT_EQ(poked.code, 0) << poked.out << poked.err;
  EXPECT_TRUE(holds(poked.out, "hit body")) << poked.out;
  EXPECT_EQ(type("explain t_handle.3ds").code, 0);
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

TEST_F(CommandLine, AModelThatIsNotClosedIsRefusedInTheLoadersWords) {
  for (const std::string verb : {"run", "explain"}) {
    const Said said = type(verb + " '" + test::source_dir() + "/models/broken/missing_face.3ds'");
    EXPECT_EQ(said.code, 2) << verb;
    EXPECT_TRUE(holds(said.err, "open edge")) << said.err;
    EXPECT_FALSE(holds(said.err, "JSON")) << said.err;
  }
  EXPECT_EQ(type("run nowhere.3ds").code, 2);
}

TEST_F(CommandLine, WordsAboutAModelAreRefusedOfAScene) {
  const Said said = type("run t_handle --scale 2");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "is a scene")) << said.err;
}

TEST_F(CommandLine, InspectSaysHowToSeeAModelMove) {
  const Said said = type("inspect t_handle --scale 0.5");
  EXPECT_TRUE(holds(said.out, "tumble run") && holds(said.out, "t_handle.3ds --scale 0.5"))
      << said.out;
  EXPECT_FALSE(
      holds(type("inspect '" + test::source_dir() + "/models/broken/missing_face.3ds'").out,
            "tumble run"));
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

}  // namespace
}  // namespace tumble::testing
