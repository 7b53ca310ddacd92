#include "framework/farm/cluster.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::farm {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostUnasked = 1000;  // Slurm's default limit: 1001
constexpr int kMostRounds = 5;
constexpr const char* kNoPath = ": there is no ";
constexpr auto kLook = 2s;             // between two looks at what is finished, at least
constexpr int kMostOfTime = 10;        // and ten times as long as a look takes
constexpr int kMostSilentLooks = 150;  // of a controller that does not answer: five minutes

std::string quoted(const std::string& word) {
  std::string safe = "'";
  for (const char c : word) safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return safe + "'";
}

/// Plain ASCII: a log may hold what a submission printed, and a terminal would obey it.
std::string printable(std::string line) {
  for (char& c : line)
    if (c < ' ' || c > '~') c = '?';
  return line;
}

// With a shell's word for the signal that ended what said it: "no such model (Killed)".
std::string last_line_of(const std::string& text) {
  static const std::set<std::string> signals = {"Killed", "Terminated", "Aborted", "Hangup",
                                                "Segmentation fault"};
  std::istringstream in(text);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    last = !last.empty() && signals.contains(line) ? last + " (" + line + ")" : line;
  }
  return printable(last);
}

class Rounds {
 public:
  explicit Rounds(const ClusterJob& job) : job_(job), folder_(job.folder) {
    const std::size_t wanted =
        job.shards > 0 ? static_cast<std::size_t>(job.shards)
                       : std::min(kMostUnasked, (job.total + job.unasked - 1) / job.unasked);
    shards_ = static_cast<int>(std::max<std::size_t>(1, std::min(wanted, job.total)));
  }

  std::vector<LostShard> run() {
    attach();
    for (int number = 1; number <= shards_; ++number) {
      if (!attached_ && job_.begin) job_.begin({number, shards_});
      if (attached_ || !is_done(number)) todo_.push_back(number);
    }
    for (int round = 1; !todo_.empty(); ++round) {
      const std::size_t before = job_.finished(), left = todo_.size();
      write_script();
      switch (job_.cluster) {
        case Cluster::kSlurm: run_on_slurm(); break;
        case Cluster::kParallel: run_by_parallel(); break;
        case Cluster::kMpi: run_by_mpi(); break;
      }
      if (job_.is_refused)
        for (const int number : todo_) job_.is_refused({number, shards_});
      std::erase_if(todo_, [&](int number) { return is_done(number); });
      if (todo_.empty()) break;
      const bool is_idle = todo_.size() == left && job_.finished() == before;
      if (is_idle && round == 1 && static_cast<int>(left) == shards_) refuse();
      if (is_idle || round == kMostRounds) return rest();
      notice(fmt::format("{} of {} shards did not come to their end; they are run again",
                         todo_.size(), shards_));
    }
    return {};
  }

 private:
  void notice(const std::string& sentence) const {
    if (job_.notice) job_.notice(sentence);
  }

  fs::path log_of(int number) const { return folder_ / fmt::format("log-{}.txt", number); }

  std::string said_by(int number) const { return last_line_of(text_of(log_of(number))); }

  bool is_done(int number) const { return job_.is_done({number, shards_}); }

  [[noreturn]] void refuse() const {
    const std::string said = said_by(todo_.front());
    throw UserError(log_of(todo_.front()).string(),
                    "no shard finished a " + job_.unit +
                        (!said.empty()              ? "; this one said: " + said
                         : !scheduler_said_.empty() ? "; " + scheduler_said_
                                                    : ", and this one printed nothing"),
                    "Every machine needs the course and the files of this work under these paths.");
  }

  std::vector<LostShard> rest() const {
    std::vector<LostShard> lost;
    for (const int number : todo_) lost.push_back({{number, shards_}, said_by(number)});
    return lost;
  }

  // The first lines of a script: nothing runs on a machine that does not see the files.
  std::string script_of(const std::string& what) const {
    std::string text = "#!/bin/sh\n# " + what + ", made by a command of tumble with --on.\n";
    if (job_.cluster == Cluster::kSlurm) text += fmt::format("#SBATCH --job-name={}\n", job_.name);
    for (const std::string& path : job_.needed)
      text += fmt::format("[ -e {0} ] || {{ echo \"$(hostname){1}\"{0}; exit 2; }}\n", quoted(path),
                          kNoPath);
    return text;
  }

  // What a task runs. The number of its shard is its argument, or comes from Slurm.
  void write_script() const {
    std::string text = script_of("One shard of a work");
    for (const auto& [name, value] : job_.environment)
      text += fmt::format("export {}={}\n", name, quoted(value));
    if (!job_.directory.empty())
      text += fmt::format("cd {} || exit 2\n", quoted(job_.directory.string()));
    text += "exec";
    for (const std::string& word : job_.command) text += ' ' + quoted(word);
    text += fmt::format(" --jobs 1 --shard \"${{1:-$SLURM_ARRAY_TASK_ID}}/{}\"\n", shards_);
    write_executable("job.sh", text);
  }

  void write_executable(const std::string& name, const std::string& text) const {
    write_whole(folder_ / name, text);
    ::chmod((folder_ / name).c_str(), 0755);
  }

  void report_progress() {
    if (!job_.progress || Clock::now() < next_look_) return;
    const auto began = Clock::now();
    const std::size_t done = std::min(job_.finished(), job_.total);
    next_look_ = Clock::now() + kMostOfTime * (Clock::now() - began);
    if (done == reported_) return;
    reported_ = done;
    const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
    const double left =
        done == 0 ? -1.0
                  : spent / static_cast<double>(done) * static_cast<double>(job_.total - done);
    job_.progress(done, job_.total, left);
  }

  // ---- Slurm

  // A job that an earlier start of this command has left running.
  void attach() {
    std::istringstream known(text_of(folder_ / "job.id"));
    std::string id;
    int shards = 0;
    if (job_.cluster != Cluster::kSlurm || !(known >> id >> shards) || !is_queued(id)) return;
    attached_ = true;
    job_id_ = id;
    shards_ = shards;
    notice("job " + id + " of an earlier start is still in the queue: waiting for it (scancel " +
           id + " ends it)");
  }

  bool is_queued(const std::string& id) {
    const ProgramOutcome queue = run_program(
        {"squeue", "--noheader", "--jobs", id, "--format", "%T"}, Output::kCaptured, 60.0);
    if (queue.code == 0) {
      silent_ = 0;
      return queue.printed.find_first_not_of(" \n") != std::string::npos;
    }
    if (queue.printed.find("Invalid job id") != std::string::npos) return false;
    if (++silent_ == kMostSilentLooks)
      throw UserError("squeue", "does not answer: " + last_line_of(queue.printed),
                      "The job goes on; the same command waits for it again.");
    return true;
  }

  void submit() {
    std::string array;
    for (const int number : todo_) array += (array.empty() ? "" : ",") + std::to_string(number);
    if (static_cast<int>(todo_.size()) == shards_) array = fmt::format("1-{}", shards_);
    const ProgramOutcome answer =
        run_program({"sbatch", "--parsable", "--requeue", "--open-mode=append", "--cpus-per-task=1",
                     "--array=" + array, "--output=" + (folder_ / "log-%a.txt").string(),
                     (folder_ / "job.sh").string()},
                    Output::kCaptured, 120.0);
    if (answer.code == 127)
      throw UserError("sbatch", "is not on this machine",
                      "Run this where jobs are submitted (Debian: slurm-client), or use --on "
                      "parallel.");
    job_id_ = answer.printed.substr(0, answer.printed.find_first_of(";\n"));
    if (answer.code != 0 || job_id_.empty() ||
        job_id_.find_first_not_of("0123456789") != std::string::npos)
      throw UserError("sbatch", "refused the job: " + last_line_of(answer.printed),
                      "Slurm's options come from SBATCH_* variables (SBATCH_PARTITION, "
                      "SBATCH_ACCOUNT, SBATCH_TIMELIMIT).");
    write_whole(folder_ / "job.id", fmt::format("{} {}\n", job_id_, shards_));
    notice(
        fmt::format("job {}: {} shards of {} {}s (scancel {} ends it; this command can "
                    "be stopped and started again)",
                    job_id_, todo_.size(), job_.total, job_.unit, job_id_));
  }

  void run_on_slurm() {
    if (!attached_) submit();
    attached_ = false;
    while (is_queued(job_id_)) {
      report_progress();
      std::this_thread::sleep_for(kLook);
    }
    report_progress();
    std::error_code ignored;
    fs::remove(folder_ / "job.id", ignored);
  }

  // ---- GNU parallel and MPI

  // The command of a shell that runs shard `number`, a shell's word.
  std::string shell_command(const std::string& number) const {
    const std::string log = quoted((folder_ / "log-").string()) + number + ".txt";
    return "sh " + quoted((folder_ / "job.sh").string()) + ' ' + number + " >" + log + " 2>&1";
  }

  // Runs the scheduler's program to its end, and reports progress meanwhile.
  void run_reporting(const std::vector<std::string>& words, const std::string& package) {
    std::atomic<bool> is_over = false;
    std::thread reporter([&] {
      while (!is_over) {
        report_progress();
        std::this_thread::sleep_for(200ms);
      }
    });
    constexpr double kWeek = 7 * 24 * 3600.0;
    const ProgramOutcome outcome = run_program(words, Output::kCaptured, kWeek);
    is_over = true;
    reporter.join();
    report_progress();
    if (outcome.code == 127)
      throw UserError(words.front(), "is not on this machine",
                      "Debian: apt-get install " + package + ".");
    if (job_.finished() > 0) return;
    scheduler_said_ = telling_line_of(outcome.printed);
    if (!scheduler_said_.empty()) scheduler_said_ = words.front() + " said: " + scheduler_said_;
  }

  // That a machine does not see the files; else the first line with words: what comes later is of
  // its consequences.
  static std::string telling_line_of(const std::string& printed) {
    std::istringstream lines(printed);
    std::string first;
    for (std::string line; std::getline(lines, line);) {
      if (line.find(kNoPath) != std::string::npos) return printable(line);
      if (first.empty() && std::any_of(line.begin(), line.end(),
                                       [](unsigned char c) { return std::isalpha(c) != 0; }))
        first = printable(line);
    }
    return first;
  }

  void run_by_parallel() {
    std::vector<std::string> words = {
        "parallel",  "--will-cite",
        "--retries", "3",
        "--joblog",  (folder_ / "job.log").string(),
        "--workdir", "/",
        "--jobs",    job_.jobs > 0 ? std::to_string(job_.jobs) : std::string("100%")};
    if (!job_.hosts.empty()) words.insert(words.end(), {"--sshlogin", job_.hosts});
    words.push_back(shell_command("{}"));
    words.push_back(":::");
    for (const int number : todo_) words.push_back(std::to_string(number));
    run_reporting(words, "parallel");
  }

  // A shard runs beside the shell, which says nothing of a killed one then: the log ends with what
  // the shard said.
  void run_by_mpi() {
    const fs::path taken = folder_ / "taken";
    fs::remove_all(taken);
    fs::create_directories(taken);
    std::string text = script_of("A rank: takes the next shard that no other rank has taken");
    text += "for number in";
    for (const int number : todo_) text += fmt::format(" {}", number);
    text += fmt::format(
        "; do\n  mkdir {}/$number 2>/dev/null || continue\n  {} &\n  wait $!\ndone\nexit 0\n",
        quoted(taken.string()), shell_command("$number"));
    write_executable("rank.sh", text);
    std::vector<std::string> words = {"mpirun", "--enable-recovery", "--bind-to", "none"};
    if (::geteuid() == 0) words.push_back("--allow-run-as-root");
    if (!job_.hosts.empty()) words.insert(words.end(), {"--host", job_.hosts});
    // as many as were asked for, also where mpirun counts fewer cores (it counts no hyperthreads)
    if (job_.jobs > 0)
      words.insert(words.end(), {"--oversubscribe", "-n", std::to_string(job_.jobs)});
    words.push_back((folder_ / "rank.sh").string());
    run_reporting(words, "openmpi-bin");
  }

  const ClusterJob& job_;
  const fs::path folder_;
  int shards_ = 1;
  std::vector<int> todo_;
  bool attached_ = false;
  std::string job_id_;
  int silent_ = 0;
  std::string scheduler_said_;  // why it began no shard
  std::size_t reported_ = static_cast<std::size_t>(-1);
  const Clock::time_point start_ = Clock::now();
  Clock::time_point next_look_ = start_;
};

}  // namespace

std::string names_of_clusters() {
  return "slurm (an array job), parallel (GNU parallel over ssh) or mpi (ranks of Open MPI)";
}

Cluster cluster_of(const std::string& word) {
  if (word == "slurm") return Cluster::kSlurm;
  if (word == "parallel") return Cluster::kParallel;
  if (word == "mpi") return Cluster::kMpi;
  throw UserError("--on", "is '" + word + "'",
                  names_of_clusters() + "; without --on all is done on this machine.");
}

std::vector<LostShard> run_on(const ClusterJob& job) {
  fs::create_directories(job.folder);
  return Rounds(job).run();
}

}  // namespace tumble::farm
