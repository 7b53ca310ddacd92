#include "tests/fuzz/run_scene_file.h"

#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/scene/load_scene.h"
#include "framework/trajectory/trajectory.h"
#include "tests/fuzz/judge_trajectory.h"
#include "tests/fuzz/run_here.h"

namespace tumble::fuzz {
namespace {

namespace fs = std::filesystem;

std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// User and system time of a running process, from /proc. [s]
double cpu_of(pid_t process) {
  const std::string text = contents_of(fmt::format("/proc/{}/stat", process));
  const std::size_t end = text.rfind(')');  // of the name, which may contain anything
  unsigned long user = 0, system = 0;
  if (end == std::string::npos ||
      std::sscanf(text.c_str() + end + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu",
                  &user, &system) != 2)
    return 0.0;
  return static_cast<double>(user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// Lines of a run that report progress; a line that it stands still is output, but no progress.
std::uintmax_t words_of_progress(const fs::path& err) {
  std::ifstream in(err);
  std::uintmax_t lines = 0;
  for (std::string line; std::getline(in, line);)
    lines += line.find("no frame has come") == std::string::npos;
  return lines;
}

struct Ended {
  int status = 0;
  bool hung = false, slow = false;
  double cpu_s = 0.0;
};

[[noreturn]] void run_in_child(const fs::path& scene_file, const fs::path& record,
                               const fs::path& out, const fs::path& err, const RunWish& wish) {
  const int to_out = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644),
            to_err = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::dup2(to_out, 1);
  ::dup2(to_err, 2);
  // a run that uses too much memory ends with a message or a signal, and does not affect the
  // machine
  const rlimit no_core{0, 0}, memory{8UL << 30, 8UL << 30};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_AS, &memory);
  if (wish.program.empty()) {
    const int code = run_here(scene_file, wish.engine, record);
    std::fflush(nullptr);
    ::_exit(code);
  }
  const std::vector<std::string> words{wish.program,   "run",      scene_file,  "--modules",
                                       "reference",    "--engine", wish.engine, "--json",
                                       "--trajectory", record};
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

/// Waits for the end, and ends a process without output for too long.
Ended run_and_watch(const fs::path& scene_file, const fs::path& record, const fs::path& out,
                    const fs::path& err, const RunWish& wish) {
  if (wish.program.empty()) load_laws();
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw UserError("fork", "no process can be started", "Close other programs.");
  if (child == 0) run_in_child(scene_file, record, out, err, wish);
  Ended ended;
  double heard_at = 0.0;     // CPU time at the last output
  std::uintmax_t heard = 0;  // bytes
  for (useconds_t pause = 1000;; pause = std::min<useconds_t>(pause * 2, 100000)) {
    rusage usage{};
    if (::wait4(child, &ended.status, WNOHANG, &usage) == child) {
      const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
      };
      ended.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
      return ended;
    }
    const double cpu = cpu_of(child);
    std::error_code none;
    const std::uintmax_t said = fs::file_size(progress_of(record), none) + words_of_progress(err);
    if (said != heard) heard_at = cpu, heard = said;
    if (!ended.hung && !ended.slow && (cpu - heard_at > wish.silence_s || cpu > wish.most_cpu_s)) {
      (cpu - heard_at > wish.silence_s ? ended.hung : ended.slow) = true;
      ::kill(child, SIGKILL);
    }
    ::usleep(pause);
  }
}

/// The common part of equal messages: without numbers and names, and only the beginning.
std::string skeleton(std::string words) {
  words = std::regex_replace(words, std::regex("'[^']*'"), "X");
  words = std::regex_replace(words, std::regex("[-+]?[0-9][-+.0-9e]*"), "#");
  words = std::regex_replace(words, std::regex("[ \n]+"), " ");
  return words.substr(0, 90);
}

std::string without_place(const std::string& words) {  // "tumble: FILE:LINE: /pointer: problem"
  static const std::regex place("^.*\\.json(:[0-9]+)?: (/[^ :]*: )?");
  return std::regex_replace(words, place, "");
}

Verdict verdict_of_end(const Ended& ended, const fs::path& scene_file, const fs::path& record,
                       const std::string& out, const std::string& err) {
  const auto verdict = [&](Outcome outcome, const std::string& kind, const std::string& words) {
    return Verdict{outcome, word_of(outcome) + (kind.empty() ? "" : " " + kind), words,
                   ended.cpu_s};
  };
  if (ended.hung) return verdict(Outcome::kHang, "", "no word of progress");
  if (ended.slow) return verdict(Outcome::kSlow, "", "words of progress, and no end");
  if (WIFSIGNALED(ended.status))
    return verdict(Outcome::kCrash, fmt::format("signal {}", WTERMSIG(ended.status)), err);
  const int code = WEXITSTATUS(ended.status);
  if (code == 3 || code > 4)
    return verdict(Outcome::kCrash, fmt::format("exit {} {}", code, skeleton(err)), err);
  if (code == 2 || code == 4)
    return err.empty() ? verdict(Outcome::kMute, fmt::format("exit {}", code), "")
                       : verdict(Outcome::kRefused, skeleton(without_place(err)), err);

  const auto page = nlohmann::json::parse(out, nullptr, false);
  if (page.is_discarded()) return verdict(Outcome::kMute, "no result", out.substr(0, 200));
  const std::string stopped = page.value("stopped_by", "");
  if (code == 1) {
    if (!stopped.empty()) return verdict(Outcome::kStopped, skeleton(stopped), stopped);
    for (const auto& check : page["checks"])
      if (!check.value("passed", true))
        return verdict(Outcome::kStopped, "check " + check.value("kind", ""), check.dump());
    for (const auto& notice : page["notices"])
      return verdict(Outcome::kStopped, skeleton(notice), notice);
    return verdict(Outcome::kMute, "exit 1", "");
  }
  const std::vector<Fault> faults =
      faults_of(scene::load_scene(scene_file), read_trajectory(record));
  if (faults.empty()) return verdict(Outcome::kRight, "", "");
  std::string kinds, words;
  for (const Fault& fault : faults) {
    kinds += (kinds.empty() ? "" : ", ") + fault.kind;
    words += (words.empty() ? "" : "; ") + fault.words;
  }
  // a notice about the start says nothing about the result
  for (const std::string notice : page["notices"]) {
    if (notice.find("the start ") != std::string::npos) continue;
    return verdict(Outcome::kNoted, kinds, words + "; the note: " + notice);
  }
  return verdict(Outcome::kSilent, kinds, words);
}

}  // namespace

std::string word_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kRight: return "right";
    case Outcome::kRefused: return "refused";
    case Outcome::kStopped: return "stopped";
    case Outcome::kNoted: return "noted";
    case Outcome::kSilent: return "silent";
    case Outcome::kMute: return "mute";
    case Outcome::kCrash: return "crash";
    case Outcome::kHang: return "hang";
    case Outcome::kSlow: return "slow";
  }
  return "?";
}

Verdict run_scene_file(const fs::path& scene_file, const RunWish& wish) {
  const fs::path record = wish.folder / "run.tumble", out = wish.folder / "out",
                 err = wish.folder / "err";
  fs::remove(record);
  fs::remove(progress_of(record));
  const Ended ended = run_and_watch(scene_file, record, out, err, wish);
  return verdict_of_end(ended, scene_file, record, contents_of(out), contents_of(err));
}

}  // namespace tumble::fuzz
