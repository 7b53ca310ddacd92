// tumble sample and tumble sweep spread over processes: the same bytes for any number of them,
// after one was killed, and after all were; words that mean nothing are refused.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/cli/command_line.h"

namespace tumble::testing {
namespace {

using namespace std::chrono_literals;

class Farm : public CommandLine {
 protected:
  /// Starts the program and goes on.
  pid_t start(const std::vector<std::string>& words) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    std::vector<std::string> all = {test::binary_dir() + "/bin/tumble"};
    all.insert(all.end(), words.begin(), words.end());
    std::vector<char*> argv;
    for (std::string& word : all) argv.push_back(word.data());
    argv.push_back(nullptr);
    ::setenv("TUMBLE_ROOT", test::source_dir().c_str(), 1);
    if (::chdir(folder_.c_str()) == 0 && std::freopen("said.out", "w", stdout) != nullptr &&
        std::freopen("said.err", "w", stderr) != nullptr)
      ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  /// Waits for something at most a minute.
  template <class Is>
  bool comes(const Is& is) const {
    for (int i = 0; i < 6000 && !is(); ++i) std::this_thread::sleep_for(10ms);
    return is();
  }
  static std::vector<pid_t> children_of(pid_t process) {
    const std::string id = std::to_string(process);
    std::ifstream in("/proc/" + id + "/task/" + id + "/children");
    return {std::istream_iterator<pid_t>(in), {}};
  }
  static int code_of(pid_t process) {
    int status = 0;
    ::waitpid(process, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string file(const std::string& name) const { return contents_of(folder_ / name); }
};

// A free body and a spring need no module: every tree has the library's laws.
const std::string kTop = "sweep t_handle --modules library --duration-s 0.5 ";

TEST_F(Farm, ASweepGivesTheSameBytesForAnyNumberOfJobs) {
  const std::string words =
      kTop + "--over step_s=1/60,1/120,1/240 --over method=rk4,euler --measure energy,cpu ";
  const Said one = type(words + "--jobs 1 --out one"), three = type(words + "--jobs 3 --out three");
  EXPECT_EQ(one.code, three.code) << three.err;
  EXPECT_NE(one.code, 2) << one.err;
  for (const std::string name : {"table.csv", "table.json"}) {
    const std::string bytes = file("one/t_handle/" + name);
    EXPECT_GT(bytes.size(), 100u) << name;
    EXPECT_EQ(bytes, file("three/t_handle/" + name)) << name;
  }
  const auto table = nlohmann::json::parse(file("one/t_handle/table.json"));
  ASSERT_EQ(table.at("points").size(), 6u);
  EXPECT_EQ(table["points"][1]["method"], "euler");
  // Half the step: of a method of order 4 a sixteenth of the change of energy, at most an eighth.
  const auto change = [&](std::size_t i) {
    return std::abs(table["points"][i]["measured"]["energy"].get<double>());
  };
  EXPECT_LT(change(2), change(0) / 8);
  EXPECT_FALSE(table["points"][0]["measured"].contains("cpu")) << "times are in times.json";
  const std::string page = file("one/t_handle/index.html");
  EXPECT_TRUE(holds(page, "<svg"));
  // people read a step as what was typed; the table for programs has all digits
  EXPECT_TRUE(holds(page, ">1/240<") && holds(one.out, " 1/240 ")) << one.out;
  EXPECT_FALSE(holds(page, "0.0041666")) << page;
  EXPECT_TRUE(holds(file("one/t_handle/table.csv"), "0.004166666666666667"));
}

TEST_F(Farm, APointThatCannotBeTrustedIsMarkedAndChangesTheExitCode) {
  // Euler's method at half a second feeds a free top with energy.
  const Said said = type(
      "sweep t_handle --modules library --over method=rk4,euler --over "
      "step_s=0.01,0.3 --json");
  EXPECT_EQ(said.code, 1) << said.err;
  const auto table = nlohmann::json::parse(said.out);
  EXPECT_EQ(table["points"][0]["run"], "fine") << table["points"][0];
  EXPECT_NE(table["points"][3]["run"], "fine");
  EXPECT_NE(table["points"][3]["reason"], "");
  const std::string page = file("out/sweep/t_handle/index.html");
  EXPECT_TRUE(holds(page, "points are left out"));
  // one point alone is fine: there is nothing to lie between
  EXPECT_FALSE(holds(page, "at the start: from "));
}

TEST_F(Farm, ASweepTakesOverWhatAnEarlierStartHasFinished) {
  type(kTop + "--over step_s=0.01,0.02");
  const std::string page = file("out/sweep/t_handle/index.html");
  const auto range = page.find("Energy at the end less that at the start: from ");
  EXPECT_LT(range, page.find("<svg")) << page;  // what came of it stands above the curves
  const Said more = type(kTop + "--over step_s=0.01:0.04:0.01");
  EXPECT_TRUE(holds(more.err, "2 points of an earlier start taken over")) << more.err;
  const Said again = type(kTop + "--over step_s=0.01:0.04:0.01 --again");
  EXPECT_FALSE(holds(again.err, "taken over")) << again.err;
  const Said other = type(kTop + "--over step_s=0.01,0.02 --method rk4");
  EXPECT_FALSE(holds(other.err, "taken over")) << "it is another work: " << other.err;
}

TEST_F(Farm, ShardsOfASweepAreTakenOver) {
  const std::string words = kTop + "--over step_s=0.01:0.04:0.01 ";
  const Said part = type(words + "--shard 2/2");
  EXPECT_FALSE(fs::exists(folder_ / "out/sweep/t_handle/index.html"));
  EXPECT_TRUE(holds(part.out, "shard 2/2")) << part.out;
  EXPECT_TRUE(holds(type(words).err, "2 points of an earlier start taken over"));
  type(words + "--out whole");
  EXPECT_EQ(file("out/sweep/t_handle/table.csv"), file("whole/t_handle/table.csv"));
}

TEST_F(Farm, AShardThatBeginsAnewLeavesTheOthersPoints) {
  const std::string words = kTop + "--over step_s=0.01:0.04:0.01 ";
  type(words + "--shard 1/2 --again");
  type(words + "--shard 2/2 --again");
  EXPECT_TRUE(holds(type(words).err, "4 points of an earlier start taken over"));
}

TEST_F(Farm, AnotherModelUnderTheSameNameIsAnotherWork) {
  const fs::path models = fs::path(test::source_dir()) / "models";
  const std::string words = "sweep mine.3ds --modules library --duration-s 0.1 --over step_s=0.01";
  fs::copy_file(models / "box.3ds", folder_ / "mine.3ds");
  type(words);
  EXPECT_TRUE(holds(type(words).err, "taken over"));
  fs::copy_file(models / "card.3ds", folder_ / "mine.3ds", fs::copy_options::overwrite_existing);
  EXPECT_FALSE(holds(type(words).err, "taken over"));
}

TEST_F(Farm, WordsOfASweepThatMeanNothingAreRefused) {
  const auto refusal = [&](const std::string& over) {
    const Said said = type("sweep t_handle --modules library " + over);
    EXPECT_EQ(said.code, 2) << over << ": " << said.out << said.err;
    return said.err;
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"--over restitutio=0,1", "Did you mean 'restitution'"},
      {"--over restitution", "expected WORD=VALUES"},
      {"--over restitution=", "no value stands after"},
      {"--over restitution=0,2", "restitution cannot be 2"},
      {"--over step_s=0:1:0.1", "step_s cannot be 0"},
      {"--over restitution=1:0:0.1", "reversed"},
      {"--over restitution=0:1:0", "no step above 0"},
      {"--over restitution=0:1", "START:END:STEP"},
      {"--over gravity=-9.81,9.81", "it is a size"},
      {"--over friction=0,0.5", "persistent contact only"},
      {"--over step_s=0.1 --out /dev/null/x", "cannot be written"},
      {"--over restitution=a,b", "'a' is no number"},
      {"--over restitution=0,0.5,0", "given twice"},
      {"--over restitution=0,1 --over restitution=0.5", "varied twice"},
      {"--over restitution=0:1:0.001,step_s=0.001:0.02:0.001", "at most 10000"},
      {"--over gravity=0:1:1e-9", "at most 10000"},
      {"--over T_handl.velocity_x_m_s=1", "the scene has no body 'T_handl'"},
      {"--over method=rk5", "rk5"},
      {"--over engine=rd,sw", "there is no engine 'sw'"},
      {"--over step_s=0.1 --engine sw", "there is no engine of that name"},
      {"--over method=dopri5", "tolerance"},
      {"--over tolerance=1e-6,1e-8", "no method is named"},
      {"--over step_s=0.1 --step-s 0.1", "given for all runs too"},
      {"--over step_s=0.1 --measure energi", "Did you mean 'energy'"},
      {"--over step_s=0.1 --measure cpu,cpu", "named twice"},
      {"--over step_s=0.1 --measure joint", "no rods and no joints"},
      {"--over step_s=0.1 --on cloud", "is 'cloud'"},
      {"--over step_s=0.1 --shards 3", "nothing on this machine"},
      {"--over step_s=0.1 --on slurm --hosts a", "chosen by Slurm"},
      {"--over step_s=0.1 --shard 3/2", "--shard"}};
  for (const auto& [over, words] : cases) {
    const std::string told = refusal(over);
    EXPECT_TRUE(holds(told, words)) << over << ": " << told;
  }
  EXPECT_TRUE(left_nothing());
}

#ifdef TUMBLE_HAS_REFERENCE
TEST_F(Farm, AWordOfOneBodyWinsOverThatOfAllInEitherOrder) {
  std::ofstream(folder_ / "wall.json") << R"({"title": "wall", "duration_s": 1, "bodies": [
    {"name": "ball", "shape": {"sphere": {"radius_m": 0.1}}, "mass_kg": 1, "restitution": 1,
     "position_m": [-0.5, 0, 0], "velocity_m_s": [1, 0, 0]},
    {"name": "wall", "shape": {"box": {"size_m": [0.2, 1, 1]}}, "immovable": true,
     "restitution": 1, "position_m": [0.1, 0, 0]}]})";
  const std::string sweep = "sweep wall.json --modules reference --measure ball.x ";
  const Said one = type(sweep + "--over ball.restitution=0,0.5 --over restitution=1 --out one"),
             other = type(sweep + "--over restitution=1 --over ball.restitution=0,0.5 --out two");
  for (const Said& said : {one, other}) EXPECT_EQ(said.code, 0) << said.out << said.err;
  const auto places = [&](const std::string& folder) {
    std::vector<double> all;
    const auto table = nlohmann::json::parse(file(folder + "/wall/table.json"));
    for (const auto& point : table["points"]) all.push_back(point["measured"]["ball.x"]);
    return all;
  };
  EXPECT_EQ(places("one"), places("two"));
  ASSERT_EQ(places("one").size(), 2u);
  EXPECT_NE(places("one")[0], places("one")[1]);
}

const std::string kChains =
    "sample ball_into_bin --modules reference --samples 60 --warm-up 10 --chains ";

// Each world would be refused, and count as broken.
TEST_F(Farm, AnEngineThatThereIsNotIsRefusedBeforeAWorldIsDrawn) {
  const Said said = type("sample ball_into_bin --engine warp --modules reference");
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_TRUE(holds(said.err, "there is no engine of that name")) << said.err;
  const Said library = type("sample ball_into_bin --modules a5=library");
  EXPECT_EQ(library.code, 2) << library.out;
  EXPECT_TRUE(holds(library.err, "no functions of a Markov chain")) << library.err;
  EXPECT_TRUE(left_nothing());
}

TEST_F(Farm, ChainsGiveTheSameBytesForAnyNumberOfJobs) {
  const Said one = type(kChains + "3 --jobs 1 --prior 80 --out one"),
             three = type(kChains + "3 --jobs 3 --prior 80 --out three");
  // Of 60 samples each R-hat may be above 1.1, which is code 1, too.
  EXPECT_LE(one.code, 1) << one.err;
  EXPECT_EQ(three.code, one.code) << three.err;
  for (const std::string name : {"chains.csv", "answers.json"}) {
    const std::string bytes = file("one/ball_into_bin/" + name);
    EXPECT_GT(bytes.size(), 100u) << name;
    EXPECT_EQ(bytes, file("three/ball_into_bin/" + name)) << name;
  }
  const std::string table = file("one/ball_into_bin/chains.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3 * 60 + 1);
  EXPECT_TRUE(holds(type(kChains + "3 --prior 40").err, "too few to compare with"));
  // More chains: those that are there are taken over, and are the same.
  const Said more = type(kChains + "4 --out one");
  EXPECT_TRUE(holds(more.err, "3 chains of an earlier start taken over")) << more.err;
  EXPECT_TRUE(file("one/ball_into_bin/chains.csv").starts_with(table));
}

// On a machine that cannot draw, with another that makes the page of the same chains.
TEST_F(Farm, ChainsAreMadeWhereTheirPageCannotBe) {
  ::setenv("TUMBLE_GL", "none", 1);
  const Said without = type(kChains + "2");
  ::unsetenv("TUMBLE_GL");
  EXPECT_EQ(without.code, 2) << without.out;
  EXPECT_TRUE(holds(without.err, "here the page may fail")) << without.err;
  EXPECT_FALSE(fs::exists(folder_ / "out/sample/ball_into_bin/index.html"));
  const std::string answers = file("out/sample/ball_into_bin/answers.json");
  EXPECT_GT(answers.size(), 100u) << without.err;
  const Said drawn = type(kChains + "2");
  EXPECT_LE(drawn.code, 1) << drawn.err;
  EXPECT_TRUE(holds(drawn.err, "2 chains of an earlier start taken over")) << drawn.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/sample/ball_into_bin/index.html"));
  EXPECT_EQ(file("out/sample/ball_into_bin/answers.json"), answers);
}

const std::vector<std::string> kLong = {
    "sample",    "ball_into_bin", "--modules", "reference", "--chains", "3",
    "--samples", "300",           "--warm-up", "0",         "--jobs",   "2"};

TEST_F(Farm, AKilledWorkerCostsItsChainOnlyAndASecondStartGivesTheSameBytes) {
  std::string words;
  for (const std::string& word : kLong) words += word + ' ';
  const pid_t program = start(kLong);
  std::vector<pid_t> workers;
  ASSERT_TRUE(comes([&] { return (workers = children_of(program)).size() == 2; }));
  ::kill(workers.back(), SIGKILL);  // the second, while it goes
  EXPECT_EQ(code_of(program), 1);
  EXPECT_TRUE(holds(file("said.err"), "1 chain missing: chain 2")) << file("said.err");
  EXPECT_TRUE(holds(file("said.err"), "signal 9")) << file("said.err");
  EXPECT_TRUE(holds(file("out/sample/ball_into_bin/index.html"), "1 chain missing: chain 2"));
  const auto answers = nlohmann::json::parse(file("out/sample/ball_into_bin/answers.json"));
  EXPECT_EQ(answers["chains"], 2);
  EXPECT_EQ(answers["lost"], nlohmann::json::array({"chain-2"}));
  const Said second = type(words);
  EXPECT_LE(second.code, 1) << second.err;
  EXPECT_TRUE(holds(second.err, "2 chains of an earlier start taken over")) << second.err;
  EXPECT_EQ(type(words + "--out undisturbed").code, second.code);
  for (const std::string name : {"chains.csv", "answers.json"})
    EXPECT_EQ(file("out/sample/ball_into_bin/" + name), file("undisturbed/ball_into_bin/" + name));
}

TEST_F(Farm, AKilledCommandLeavesWhatItFinishedAndNoProcess) {
  const pid_t program = start(kLong);
  std::vector<pid_t> workers;
  const fs::path chains = folder_ / "out/sample/ball_into_bin/chains";
  ASSERT_TRUE(comes(
      [&] { return fs::exists(chains / "chain-1.part") || fs::exists(chains / "chain-2.part"); }));
  workers = children_of(program);
  ::kill(program, SIGKILL);
  EXPECT_EQ(code_of(program), 128 + SIGKILL);
  for (const pid_t worker : workers)
    EXPECT_TRUE(comes([&] { return !fs::exists("/proc/" + std::to_string(worker)); })) << worker;
  std::string words;
  for (const std::string& word : kLong) words += word + ' ';
  const Said second = type(words);
  EXPECT_LE(second.code, 1) << second.err;
  EXPECT_TRUE(holds(second.err, "of an earlier start taken over")) << second.err;
  EXPECT_EQ(type(words + "--out undisturbed").code, second.code);
  EXPECT_EQ(file("out/sample/ball_into_bin/chains.csv"),
            file("undisturbed/ball_into_bin/chains.csv"));
}
#endif

}  // namespace
}  // namespace tumble::testing
