// Pieces of a work spread over processes: the same bytes for any number of them, and a lost process
// costs its own piece only.
#include "framework/farm/spread.h"

#include <csignal>
#include <fstream>

#include <sys/prctl.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::farm {
namespace {

namespace fs = std::filesystem;

class Spread : public ::testing::Test {
 protected:
  Spread() : folder(fs::temp_directory_path() / ("tumble spread " + std::to_string(::getpid()))) {
    fs::create_directories(folder);
    for (int i = 0; i < 6; ++i) work.names.push_back("piece-" + std::to_string(i));
    work.unit = "piece";
    // Later pieces end first, and each leaves a line for itself.
    work.make = [this](std::size_t index) {
      ::usleep(static_cast<useconds_t>(2000 * (6 - index)));
      std::ofstream(folder / "made", std::ios::app) << index << '\n';
      if (fs::exists(folder / ("kill-" + std::to_string(index)))) ::raise(SIGKILL);
      return "bytes of " + std::to_string(index);
    };
  }
  ~Spread() override { fs::remove_all(folder); }

  KeptParts parts(const std::string& name = "parts") const {
    return KeptParts(folder / name, "key");
  }
  std::string bytes_of(const KeptParts& parts) const {
    std::string all;
    for (const std::string& name : work.names) all += parts.result(name).value_or("-") + '\n';
    return all;
  }
  std::size_t made() const {
    std::ifstream in(folder / "made");
    return static_cast<std::size_t>(
        std::count(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>(), '\n'));
  }

  fs::path folder;
  SplitWork work;
};

TEST_F(Spread, GivesTheSameBytesForAnyNumberOfProcesses) {
  std::vector<std::size_t> told;
  const auto note = [&](std::size_t done, std::size_t all, double) {
    EXPECT_EQ(all, 6u);
    told.push_back(done);
  };
  EXPECT_TRUE(make_here(parts("one"), work, {1, {}, note}).lost.empty());
  EXPECT_EQ(told, (std::vector<std::size_t>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(make_here(parts("three"), work, {3, {}, {}}).lost.empty());
  EXPECT_EQ(bytes_of(parts("one")), bytes_of(parts("three")));
}

TEST_F(Spread, ALostProcessCostsItsPieceOnlyAndASecondStartMakesIt) {
  write_whole(folder / "kill-2", "");
  const Outcome first = make_here(parts(), work, {2, {}, {}});
  ASSERT_EQ(first.lost.size(), 1u);
  EXPECT_EQ(first.lost[0].name, "piece-2");
  EXPECT_NE(first.lost[0].why.find("signal 9"), std::string::npos) << first.lost[0].why;
  EXPECT_EQ(made(), 6u);
  fs::remove(folder / "kill-2");
  const Outcome second = make_here(parts(), work, {2, {}, {}});
  EXPECT_TRUE(second.lost.empty());
  EXPECT_EQ(second.taken_over, 5u);
  EXPECT_EQ(made(), 7u) << "only what was missing is made again";
  make_here(parts("undisturbed"), work, {1, {}, {}});
  EXPECT_EQ(bytes_of(parts()), bytes_of(parts("undisturbed")));
}

TEST_F(Spread, AShardMakesItsPiecesOnly) {
  make_here(parts(), work, {2, Shard{2, 4}, {}});
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(parts().has(work.names[i]), i % 4 == 1) << i;
}

TEST_F(Spread, AnErrorOfAPieceIsThrownHereAndEndsTheWork) {
  work.make = [this](std::size_t index) -> std::string {
    std::ofstream(folder / "made", std::ios::app) << index << '\n';
    if (index == 1) throw UserError("piece 1", "cannot be made", "");
    return "bytes";
  };
  try {
    make_here(parts(), work, {1, {}, {}});
    FAIL() << "nothing was thrown";
  } catch (const UserError& error) {
    EXPECT_EQ(error.where(), "piece 1");
  }
  EXPECT_EQ(made(), 2u) << "the others are not begun";
}

// GNU parallel and the ranks of MPI run what Slurm would: the script of a job, with the number of a
// shard.
class OnCluster : public Spread, public ::testing::WithParamInterface<Cluster> {
 protected:
  void SetUp() override {
    const std::string program = GetParam() == Cluster::kMpi ? "mpirun" : "parallel";
    if (run_program({program, "--version"}, Output::kDropped).code != 0)
      GTEST_SKIP() << program << " is not here: apt-get install parallel openmpi-bin";
    // A task stands for the program: it makes the pieces of its shard, all in one process.
    write_whole(folder / "task.sh",
                "while [ \"$1\" != --shard ]; do shift; done\n"
                "k=${2%/*} n=${2#*/} i=0\n"
                "while [ $i -lt 6 ]; do\n"
                "  if [ $((i % n)) = $((k - 1)) ]; then\n"
                "    if [ -e \"$FOLDER/kill-$i\" ]; then echo \"no power for $i\"; kill -9 $$; fi\n"
                "    if [ -e \"$FOLDER/kill-rank-$i\" ]; then kill -9 $PPID; kill -9 $$; fi\n"
                "    if [ -e \"$FOLDER/slow\" ]; then sleep 1; fi\n"
                "    cp \"$FOLDER/made-here/piece-$i.part\" \"$FOLDER/parts/\"\n"
                "  fi\n"
                "  i=$((i + 1))\n"
                "done\n");
    make_here(parts("made-here"), work, {2, {}, {}});
    fs::create_directories(folder / "parts");
    job.cluster = GetParam();
    job.name = "test";
    job.command = {"/bin/sh", (folder / "task.sh").string()};
    job.needed = {folder.string()};
    job.environment = {{"FOLDER", folder.string()}};
    job.directory = folder;
    job.shards = 3;
    job.jobs = 2;
    job.notice = [this](const std::string& sentence) { said += sentence + '\n'; };
  }
  ClusterJob job;
  std::string said;
};

TEST_P(OnCluster, TasksGiveTheBytesOfThisProcess) {
  EXPECT_TRUE(make_on(parts(), work, job).lost.empty()) << said;
  EXPECT_EQ(bytes_of(parts()), bytes_of(parts("made-here")));
}

TEST_P(OnCluster, ALostTaskIsNamedWithWhatItSaidAndASecondStartMakesTheRest) {
  write_whole(folder / "kill-4", "");
  const Outcome first = make_on(parts(), work, job);
  ASSERT_EQ(first.lost.size(), 1u) << said;  // piece 1 of the same shard was finished before
  EXPECT_EQ(first.lost[0].name, "piece-4");
  EXPECT_NE(first.lost[0].why.find("no power for 4"), std::string::npos) << first.lost[0].why;
  fs::remove(folder / "kill-4");
  const Outcome second = make_on(parts(), work, job);
  EXPECT_TRUE(second.lost.empty()) << said;
  EXPECT_EQ(second.taken_over, 5u);
  EXPECT_EQ(bytes_of(parts()), bytes_of(parts("made-here")));
}

TEST_P(OnCluster, AJobThatFinishesNothingIsRefused) {
  job.needed.push_back("/no/such/path");
  try {
    make_on(parts(), work, job);
    FAIL() << "nothing was thrown";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("there is no /no/such/path"), std::string::npos)
        << error.what();
  }
}

TEST_P(OnCluster, AHostThatIsNotThereIsNamed) {
  if (run_program({"ssh", "-V"}, Output::kDropped).code != 0)
    GTEST_SKIP() << "ssh is not here: apt-get install openssh-client";
  job.hosts = "no-such-host-here";
  try {
    make_on(parts(), work, job);
    FAIL() << "nothing was thrown";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("no-such-host-here"), std::string::npos)
        << error.what();
  }
}

// mpirun ends all ranks when one is lost, unless it is told otherwise.
TEST_P(OnCluster, ALostRankCostsItsShardOnly) {
  if (GetParam() != Cluster::kMpi) GTEST_SKIP() << "GNU parallel has no ranks";
  write_whole(folder / "kill-rank-1", "");
  write_whole(folder / "slow", "");  // the other rank is at work when this one is lost
  const Outcome first = make_on(parts(), work, job);
  ASSERT_EQ(first.lost.size(), 2u) << said;
  EXPECT_EQ(first.lost[0].name, "piece-1");
  EXPECT_EQ(first.lost[1].name, "piece-4");
  EXPECT_TRUE(said.starts_with("1 of 3 shards did not come to their end")) << said;
  fs::remove(folder / "kill-rank-1");
  fs::remove(folder / "slow");
  EXPECT_TRUE(make_on(parts(), work, job).lost.empty()) << said;
  EXPECT_EQ(bytes_of(parts()), bytes_of(parts("made-here")));
}

INSTANTIATE_TEST_SUITE_P(Schedulers, OnCluster,
                         ::testing::Values(Cluster::kParallel, Cluster::kMpi),
                         [](const auto& chosen) {
                           return chosen.param == Cluster::kMpi ? "Mpi" : "Parallel";
                         });

}  // namespace
}  // namespace tumble::farm
