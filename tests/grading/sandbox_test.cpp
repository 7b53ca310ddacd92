// The sandbox itself: limits, endings, and clean-up.
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "framework/grading/sandbox/protection.h"
#include "framework/grading/sandbox/sandbox.h"
#include "tests/grading/attack_fixture.h"

namespace tumble::grading {
namespace {

using Ending = SandboxOutcome::Ending;

class SandboxEnds : public Attack {
 protected:
  void SetUp() override {
    Attack::SetUp();
    if (IsSkipped()) return;
    user_.emplace(SandboxUser::lease());
    stage_.emplace(&*user_);
    init_ = stage_->add_file(worker_programs("waist").init, "init", true);
  }
  void TearDown() override { EXPECT_EQ(descendants_left(), 0); }

  SandboxJob shell(const std::string& script) {
    SandboxJob job;
    job.command = {"/usr/bin/sh", "-c", script};
    job.kind = chosen_sandbox();
    job.init = init_;
    job.uid = user_->uid();
    job.limits.wall_s = 5.0;
    return job;
  }
  SandboxOutcome run(const std::string& script) { return Sandbox::start(shell(script)).wait(); }

  std::optional<SandboxUser> user_;
  std::optional<Stage> stage_;
  std::filesystem::path init_;
};

TEST_F(SandboxEnds, ExitCodesSignalsAndOutputAreReported) {
  const SandboxOutcome exited = run("echo out; echo err >&2; exit 7");
  EXPECT_EQ(exited.ending, Ending::kExited);
  EXPECT_EQ(exited.code, 7);
  EXPECT_EQ(exited.printed, "out\nerr\n");
  const SandboxOutcome killed = run("kill -BUS $$");
  EXPECT_EQ(killed.ending, Ending::kSignal);
  EXPECT_EQ(killed.code, SIGBUS);
}

TEST_F(SandboxEnds, MissingProgramIsNotAFaultOfTheSandbox) {
  SandboxJob job = shell("");
  job.command = {"/no/such/program"};
  EXPECT_EQ(Sandbox::start(job).wait().code, 127);
}

TEST_F(SandboxEnds, SandboxThatCannotStartSaysSo) {
  SandboxJob job = shell("true");
  job.binds = {{"/no/such/file", "/file"}};
  const SandboxOutcome outcome = Sandbox::start(job).wait();
  EXPECT_EQ(outcome.ending, Ending::kNotStarted);
  EXPECT_FALSE(outcome.printed.empty());
}

TEST_F(SandboxEnds, InitThatNeverReportsCountsAsNotStarted) {
  if (!traits_of(chosen_sandbox()).needs_init)
    GTEST_SKIP() << "the keeper itself sees the end of the program";
  // Fail-closed: if process 1 exits with code 0 but without a report, that is a fault of the
  // grader, never a result.
  SandboxJob job = shell("true");
  job.init = stage_->add_file("/usr/bin/true", "not_init", true);
  EXPECT_EQ(Sandbox::start(job).wait().ending, Ending::kNotStarted);
}

TEST_F(SandboxEnds, WallTimeCpuTimeAndOutputAreLimited) {
  SandboxJob sleeping = shell("sleep 100");
  sleeping.limits.wall_s = 0.3;
  EXPECT_EQ(Sandbox::start(sleeping).wait().ending, Ending::kWallLimit);
  SandboxJob spinning = shell("trap '' XCPU; while :; do :; done");
  spinning.limits.cpu_s = 1;
  spinning.limits.wall_s = 120.0;  // a loaded machine gives that second late
  const SandboxOutcome spun = Sandbox::start(spinning).wait();
  EXPECT_EQ(spun.ending, Ending::kSignal);
  EXPECT_TRUE(spun.code == SIGXCPU || spun.code == SIGKILL) << spun.code;
  EXPECT_EQ(run("exec yes").ending, Ending::kOutputLimit);
}

// Work between naps does not begin the count anew.
TEST_F(SandboxEnds, NapsAddUp) {
  SandboxJob job =
      shell("while :; do sleep 0.2; i=0; while [ $i -lt 3000 ]; do i=$((i+1)); done; done");
  job.limits.wall_s = 120.0;
  job.limits.stall_s = 60.0;
  EXPECT_EQ(job.limits.idle_s, 0.0);
  job.limits.idle_s = 2.0;
  EXPECT_EQ(Sandbox::start(job).wait().ending, Ending::kStalled);
}

TEST_F(SandboxEnds, ManySpinningProcessesEndAtTheWallLimit) {
  SandboxJob job = shell("for i in 1 2 3 4 5 6; do sh -c 'while :; do :; done' & done; wait");
  job.limits.wall_s = 0.5;
  EXPECT_EQ(Sandbox::start(job).wait().ending, Ending::kWallLimit);
}

TEST_F(SandboxEnds, DaemonsDieWithTheirParent) {
  EXPECT_EQ(run("setsid sleep 100 & exit 0").code, 0);
}

int processes_of_all() {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc"))
    count += std::atoi(entry.path().filename().c_str()) > 0 ? 1 : 0;
  return count;
}

TEST_F(SandboxEnds, ForkBombsOfToolsLeaveNoProcess) {
  // A tree of 1,023 processes that all become orphans and wait for the channel. It is finite and
  // ends with this test, so that without its limit it fails a test and does not fill the machine.
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  SandboxJob job = shell(
      "tree() { [ $1 = 0 ] || { tree $(($1 - 1)) & tree $(($1 - 1)) & }; read x <&3; }; tree 9");
  job.channel = ends[0];
  job.limits.processes = 40;
  const int before = processes_of_all();
  Sandbox sandbox = Sandbox::start(job);
  ::close(ends[0]);
  ::usleep(1'000'000);
  // 40, and 200 more where the user has other processes; up to 100 come and go on the machine
  // meanwhile.
  EXPECT_LT(processes_of_all() - before,
            can_change_user() || traits_of(chosen_sandbox()).generations > 1 ? 140 : 350);
  sandbox.stop();
  EXPECT_EQ(descendants_left(), 0);
  ::close(ends[1]);
}

TEST_F(SandboxEnds, TemporaryFolderIsLimitedAndRemoved) {
  SandboxJob job = shell(
      "cd \"$0\" && pwd && for i in 1 2 3 4 5 6 7 8; do head -c 4000000 /dev/zero > $i || exit 9; "
      "sleep 0.1; done");
  job.command.push_back(kTmpInside);
  job.limits.tmp_bytes = 8 << 20;
  const SandboxOutcome full = Sandbox::start(job).wait();
  EXPECT_TRUE(full.ending == Ending::kDiskLimit ||
              (full.ending == Ending::kExited && full.code == 9))
      << full.code << full.printed;
  EXPECT_EQ(full.printed.substr(0, 5), "/tmp\n") << "its name inside, whatever it is outside";
  job.limits.tmp_bytes = 64 << 20;
  EXPECT_EQ(Sandbox::start(job).wait().code, 0);
  std::size_t stages = 0;
  const std::string own = "tumble-stage-" + std::to_string(::getpid()) + "-",
                    name = "tumble-stage-";
  for (const auto& entry : std::filesystem::directory_iterator("/tmp")) {
    const std::string found = entry.path().filename().string();
    std::error_code hidden;  // another user's: no folder of this run
    const bool is_of_a_keeper = found.starts_with(name) && !found.starts_with(own) &&
                                std::filesystem::exists(entry.path() / "8", hidden);
    stages += is_of_a_keeper ? 1 : 0;
  }
  EXPECT_EQ(stages, 0u);
}

TEST_F(SandboxEnds, FilesInTheTemporaryFolderCannotBeRun) {
  if (traits_of(chosen_sandbox()).kind != SandboxKind::kLandlock)
    GTEST_SKIP() << "only Landlock tells running from reading";
  SandboxJob job = shell("cp /usr/bin/true \"$0/program\" && \"$0/program\"");
  job.command.push_back(kTmpInside);
  EXPECT_EQ(Sandbox::start(job).wait().code, 126) << "as a shell says: found, and may not be run";
}

TEST_F(SandboxEnds, UsersAreNeitherTheGradersNorSharedByRuns) {
  if (!can_change_user()) GTEST_SKIP() << "this user cannot take another";
  const std::string mine = std::to_string(::getuid()) + "\n";
  EXPECT_NE(run("id -u").printed, mine);
  // inside, namespaces show one number to all
  if (traits_of(chosen_sandbox()).generations > 1) return;
  Sandbox first = Sandbox::start(shell("id -u; sleep 1")),
          second = Sandbox::start(shell("id -u; sleep 1"));
  EXPECT_NE(first.wait().printed, second.wait().printed);
}

TEST_F(SandboxEnds, AUserWithAProcessIsNotLeased) {
  // as of a grader in a container with its own /run, whose locks are not seen here
  if (!can_change_user()) GTEST_SKIP() << "this user cannot take another";
  const uid_t free = *SandboxUser::lease().uid();
  const pid_t other = ::fork();
  if (other == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::_exit(::setresuid(free, free, free) == 0 ? (::pause(), 0) : 1);
  }
  struct stat about {};
  const std::string place = "/proc/" + std::to_string(other);
  for (int i = 0; i < 1000 && about.st_uid != free; ++i) {
    ::usleep(1000);
    ASSERT_EQ(::stat(place.c_str(), &about), 0);
  }
  EXPECT_NE(*SandboxUser::lease().uid(), free);
  ::kill(other, SIGKILL);
  ::waitpid(other, nullptr, 0);
  EXPECT_EQ(*SandboxUser::lease().uid(), free);
}

TEST_F(SandboxEnds, NewNamespacesCannotBeCreated) { EXPECT_NE(run("unshare -U true").code, 0); }

TEST_F(SandboxEnds, SandboxDiesWithItsOwner) {
  // The owner is killed; its keeper, adopted by this process, must notice and leave no process. At
  // any time: bubblewrap needs about 10 ms to set up the sandbox, and if it dies earlier its child
  // does not die with it.
  constexpr int kTimes = 60, kApart = 250;  // us
  for (int i = 0; i < kTimes; ++i) {
    const pid_t owner = ::fork();
    if (owner == 0) {
      Sandbox sandbox = Sandbox::start(shell("sleep 100"));
      ::usleep(static_cast<useconds_t>(i * kApart));
      ::raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(owner, &status, 0), owner);
    ASSERT_EQ(descendants_left(), 0) << "killed after " << i * kApart << " us";
  }
}

TEST_F(SandboxEnds, StagesAreReadableOnlyByTheSandboxAndRemoved) {
  std::filesystem::path path;
  {
    Stage stage(&*user_);
    path = stage.add_text("secret", "deep");
    // The group is that of the job's user, which only its runs have.
    const auto others = std::filesystem::perms::others_all | std::filesystem::perms::group_write;
    EXPECT_EQ(std::filesystem::status(path.parent_path()).permissions() & others,
              std::filesystem::perms::none);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(SandboxEnds, AFileIsShownWhereItLiesIfItsUserCanReadIt) {
  namespace fs = std::filesystem;
  std::string name = (fs::temp_directory_path() / "tumble-shown-XXXXXX").string();
  const fs::path folder = ::mkdtemp(name.data()), file = folder / "text";
  std::ofstream(file) << "as it lies\n";
  const auto may = [&](int of_folder, int of_file) {
    EXPECT_EQ(::chmod(folder.c_str(), static_cast<mode_t>(of_folder)), 0);
    EXPECT_EQ(::chmod(file.c_str(), static_cast<mode_t>(of_file)), 0);
    return stage_->can_be_shown(file);
  };
  EXPECT_FALSE(stage_->can_be_shown(folder / "missing"));
  if (user_->uid()) {
    EXPECT_FALSE(may(0755, 0640));
    EXPECT_FALSE(may(0750, 0644));
  }
  EXPECT_TRUE(may(0755, 0644));
  if (SandboxJob job = shell("cat /shown; echo mine > /shown || exit 3");
      job.kind == SandboxKind::kNamespaces) {
    job.binds = {{file, "/shown"}};
    const SandboxOutcome outcome = Sandbox::start(job).wait();
    EXPECT_TRUE(outcome.printed.starts_with("as it lies\n")) << outcome.printed;
    EXPECT_NE(outcome.code, 0) << "it was written to";
  }
  fs::remove_all(folder);
}

TEST_F(SandboxEnds, StagesHaveTheirMakersProcessId) {
  // So that the next process can remove the stages of a killed one.
  EXPECT_TRUE(stage_->path().filename().string().starts_with("tumble-stage-" +
                                                             std::to_string(::getpid()) + "-"))
      << stage_->path();
}

}  // namespace
}  // namespace tumble::grading
