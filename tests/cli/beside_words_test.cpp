// Pages of runs on the command line: with another run or a recording beside, with a video, as plots.
#include <filesystem>
#include <fstream>
#include <regex>

#include "framework/core/files.h"
#include "framework/trajectory/trajectory.h"
#include "tests/cli/command_line.h"
#include "tests/support/places.h"

namespace tumble::testing {
namespace {

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
  EXPECT_TRUE(holds(page, "\"label\":\"step 1/50 s\"") && holds(page, "\"label\":\"step 1/100 s\""))
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

#ifdef TUMBLE_HAS_REFERENCE
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
}

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
#endif

}  // namespace
}  // namespace tumble::testing
