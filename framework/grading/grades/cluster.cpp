#include "framework/grading/grades/cluster.h"

#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/course/machine_key.h"
#include "framework/grading/course/run_program.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kSubmissionsOfShard = 10, kMostUnasked = 1000;  // Slurm's default limit: 1001
constexpr int kMostRounds = 5;
constexpr auto kLook = 2s;             // between two looks at what is finished, at least
constexpr int kMostOfTime = 10;        // and ten times as long as a look takes
constexpr int kMostSilentLooks = 150;  // of a controller that does not answer: five minutes

std::string quoted(const std::string& word) {
  std::string safe = "'";
  for (const char c : word) safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return safe + "'";
}

std::string last_line_of(const std::string& text) {
  std::istringstream in(text);
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  return plain_text(last);
}

class Rounds {
 public:
  explicit Rounds(const ClusterJob& job) : job_(job), folder_(shards_folder(job.out)) {
    const std::size_t wanted = job.shards > 0
                                   ? static_cast<std::size_t>(job.shards)
                                   : std::min(kMostUnasked, job.total / kSubmissionsOfShard + 1);
    shards_ = static_cast<int>(std::max<std::size_t>(1, std::min(wanted, job.total)));
  }

  void run() {
    machine_key();  // made now, by one process
    attach();
    for (int number = 1; number <= shards_; ++number) todo_.push_back(number);
    std::error_code ignored;
    if (!attached_)
      for (const int number : todo_) fs::remove(done_file(job_.out, {number, shards_}), ignored);
    for (int round = 1; !todo_.empty(); ++round) {
      const std::size_t before = finished_in_shards(job_.out), left = todo_.size();
      write_script();
      if (job_.cluster == Cluster::kSlurm)
        run_on_slurm();
      else
        run_by_parallel();
      std::erase_if(todo_, [&](int number) {
        return fs::exists(done_file(job_.out, {number, shards_}));
      });
      if (todo_.empty()) break;
      const bool is_idle = todo_.size() == left && finished_in_shards(job_.out) == before;
      if (is_idle && round == 1 && static_cast<int>(left) == shards_) refuse();
      if (is_idle || round == kMostRounds) return report_rest();
      notice(fmt::format("{} of {} shards did not come to their end; they are run again",
                         todo_.size(), shards_));
    }
  }

 private:
  void notice(const std::string& sentence) const {
    if (job_.notice) job_.notice(sentence);
  }

  fs::path log_of(int number) const { return folder_ / fmt::format("log-{}.txt", number); }

  std::string said_by(int number) const { return last_line_of(text_of(log_of(number))); }

  [[noreturn]] void refuse() const {
    const std::string said = said_by(todo_.front());
    throw UserError(
        log_of(todo_.front()).string(),
        "no shard finished a submission" +
            (said.empty() ? ", and this one printed nothing" : "; this one said: " + said),
        "Every machine needs the course, the submissions, the results and the key "
        "under these paths.");
  }

  void report_rest() const {
    constexpr std::size_t kNamed = 5;
    for (std::size_t i = 0; i < std::min(kNamed, todo_.size()); ++i)
      notice(fmt::format("shard {} of {} did not come to its end: {}", todo_[i], shards_,
                         said_by(todo_[i])));
    notice("what these shards did not finish is graded by this process");
  }

  // What a task runs. The number of its shard comes from Slurm, or as its argument.
  void write_script() const {
    std::string text =
        "#!/bin/sh\n# One shard of a grading, made by `tumble grade --on`.\n"
        "#SBATCH --job-name=tumble-grade\n";
    const std::string key = machine_key_file().string();
    for (const std::string& path : {job_.command.front(), job_.root.string(),
                                    job_.submissions.string(), job_.out.string(), key})
      text += fmt::format("[ -e {0} ] || {{ echo \"$(hostname): there is no \"{0}; exit 2; }}\n",
                          quoted(path));
    text += fmt::format("export TUMBLE_ROOT={} TUMBLE_GRADER_KEY={}\nexec",
                        quoted(job_.root.string()), quoted(key));
    for (const std::string& word : job_.command) text += ' ' + quoted(word);
    text += fmt::format(" --jobs 1 --shard \"${{SLURM_ARRAY_TASK_ID:-$1}}/{}\"\n", shards_);
    write_whole(folder_ / "job.sh", text);
    ::chmod((folder_ / "job.sh").c_str(), 0755);
  }

  void report_progress() {
    if (!job_.progress || Clock::now() < next_look_) return;
    const auto began = Clock::now();
    const std::size_t done = std::min(finished_in_shards(job_.out), job_.total);
    next_look_ = Clock::now() + kMostOfTime * (Clock::now() - began);
    if (done == reported_) return;
    reported_ = done;
    const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
    const double left =
        done == 0 ? -1.0
                  : spent / static_cast<double>(done) * static_cast<double>(job_.total - done);
    job_.progress({done, job_.total, "", left});
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
        fmt::format("job {}: {} shards of {} submissions (scancel {} ends it; this command can "
                    "be stopped and started again)",
                    job_id_, todo_.size(), job_.total, job_id_));
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

  // ---- GNU parallel

  void run_by_parallel() {
    std::vector<std::string> words = {
        "parallel",  "--will-cite",
        "--retries", "3",
        "--joblog",  (folder_ / "job.log").string(),
        "--workdir", "/",
        "--jobs",    job_.per_host > 0 ? std::to_string(job_.per_host) : std::string("100%")};
    if (!job_.hosts.empty()) words.insert(words.end(), {"--sshlogin", job_.hosts});
    const std::string log = quoted((folder_ / "log-").string()) + "{}.txt";
    words.push_back("sh " + quoted((folder_ / "job.sh").string()) + " {} >" + log + " 2>&1");
    words.push_back(":::");
    for (const int number : todo_) words.push_back(std::to_string(number));
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
      throw UserError("parallel", "is not on this machine", "Debian: apt-get install parallel.");
    if (outcome.code != 0 && finished_in_shards(job_.out) == 0 && !outcome.printed.empty())
      notice("parallel: " + last_line_of(outcome.printed));
  }

  const ClusterJob& job_;
  const fs::path folder_;
  int shards_ = 1;
  std::vector<int> todo_;
  bool attached_ = false;
  std::string job_id_;
  int silent_ = 0;
  std::size_t reported_ = static_cast<std::size_t>(-1);
  const Clock::time_point start_ = Clock::now();
  Clock::time_point next_look_ = start_;
};

}  // namespace

Cluster cluster_of(const std::string& word) {
  if (word == "slurm") return Cluster::kSlurm;
  if (word == "parallel") return Cluster::kParallel;
  throw UserError("--on", "is '" + word + "'",
                  "slurm (an array job) or parallel (GNU parallel over ssh).");
}

void grade_on(const ClusterJob& job) {
  fs::create_directories(shards_folder(job.out));
  Rounds(job).run();
}

}  // namespace tumble::grading
