#include "tests/bench/peers/harness.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "framework/core/keep_memory.h"
#include "framework/effects/build_world.h"
#include "tests/bench/peers/judge.h"

namespace tumble::peers {
namespace {

struct Options {
  std::string out, cases;
  bool quick = false;
  int runs = 3;
  double cap_s = 60.0;  // CPU of one run
};

/// What a child process leaves for its parent.
struct Outcome {
  double cpu_s, error, reached_s;
  double stop_at_s;  // CPU time of the process at which the run is given up
  bool done;
  char words[1000];  // parts of the error, or why there is none
};

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLongRun = 0.5;    // s: not repeated
constexpr double kShortRun = 0.02;  // s: repeated three times as often

/// When a ball that falls from this state meets its floor; negative times are past. [s]
double time_to_floor(const BodyPose& pose, double height) {
  const double v = pose.velocity_world.z(), drop = pose.com_world.z() - height;
  return (v + std::sqrt(std::max(0.0, v * v + 2 * kGravity * drop))) / kGravity;
}

long steps_between(double from, double to, double h) { return std::lround((to - from) / h); }

Observed run_world(const BenchCase& bench, const World& world, const Engine& engine,
                   const Setting& setting, double& reached) {
  const std::unique_ptr<PeerWorld> peer = engine.build(bench, world, setting);
  const int bodies = static_cast<int>(world.bodies.size());
  Observed run;
  const auto look = [&] {
    peer->look();
    run.samples.emplace_back();
    for (int i = 0; i < bodies; ++i) {
      const RigidBodyState& still = world.bodies[i].state;
      run.samples.back().push_back(
          world.bodies[i].immovable()
              ? BodyPose{still.com_world, still.world_from_body, Vector3d::Zero(), Vector3d::Zero()}
              : peer->pose(i));
    }
  };
  look();
  const double floor =
      bench.watches_first_body ? std::get<Sphere>(world.bodies[0].shape).radius : 0.0;
  double before = 0.0;
  for (const double sample : bench.sample_times) {
    const double start = cpu_seconds();
    if (!peer->advance_to(sample)) {
      const long steps = steps_between(before, sample, setting.step);
      BodyPose last = bench.watches_first_body ? peer->pose(0) : BodyPose{};
      for (long k = 0; k < steps; ++k) {
        peer->step(setting.step);
        if (!bench.watches_first_body) continue;
        const BodyPose now = peer->pose(0);
        // The bounce is where the ball's last flight, as the engine had it, reaches the floor.
        if (last.velocity_world.z() < 0 && now.velocity_world.z() > 0)
          run.bounces.push_back(before + k * setting.step + time_to_floor(last, floor));
        last = now;
      }
    }
    run.cpu_s += cpu_seconds() - start;
    before = reached = sample;
    look();
  }
  return run;
}

void say(Outcome& outcome, const std::string& words) {
  std::snprintf(outcome.words, sizeof outcome.words, "%s", words.c_str());
}

void measure(const BenchCase& bench, const Engine& engine, const Setting& setting,
             const Options& options, Outcome& outcome) {
  const World world = build_world(bench.scene);
  std::vector<double> prices;
  Observed first;
  for (int k = 0, runs = options.runs; k < runs; ++k) {
    outcome.stop_at_s = cpu_seconds() + options.cap_s;
    Observed run = engine.run ? engine.run(bench, setting, outcome.reached_s)
                              : run_world(bench, world, engine, setting, outcome.reached_s);
    outcome.stop_at_s = kNever;  // judging takes its time
    prices.push_back(run.cpu_s);
    if (k == 0) first = std::move(run);
    if (prices.back() > kLongRun) break;
    if (prices.back() < kShortRun) runs = 3 * options.runs;
  }
  std::sort(prices.begin(), prices.end());
  const Judgement judgement = judge(bench, world, first);
  std::string parts;
  for (const auto& [name, value] : judgement.parts)
    parts += fmt::format("{}{}={:.3g}", parts.empty() ? "" : "; ", name, value);
  outcome.cpu_s = prices[prices.size() / 2];
  outcome.error = judgement.error;
  say(outcome, parts);
  outcome.done = true;
}

struct Ending {
  int status;
  bool capped;
};

/// Until a child ends, or has used as much CPU as it may. A limit of the system's own (RLIMIT_CPU)
/// would do, but with one the process's clock moves in ticks of 4 ms.
Ending wait_for(pid_t child, const volatile double& stop_at_s) {
  clockid_t clock{};
  const bool has_clock = clock_getcpuclockid(child, &clock) == 0;
  for (int status = 0;;) {
    if (waitpid(child, &status, WNOHANG) == child) return {status, false};
    timespec used{};
    if (has_clock && clock_gettime(clock, &used) == 0 &&
        static_cast<double>(used.tv_sec) > stop_at_s) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return {status, true};
    }
    usleep(2000);
  }
}

/// One setting in a process of its own: an engine that aborts or never ends costs its own row only.
Outcome measured_apart(const BenchCase& bench, const Engine& engine, const Setting& setting,
                       const Options& options) {
  void* memory =
      mmap(nullptr, sizeof(Outcome), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("no memory to share with the run");
  Outcome& shared = *new (memory) Outcome{std::nan(""), std::nan(""), 0.0, kNever, false, ""};
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    for (std::FILE* stream : {stdout, stderr})  // engines talk
      if (std::freopen("/dev/null", "w", stream) == nullptr) _exit(1);
    try {
      measure(bench, engine, setting, options, shared);
    } catch (const std::exception& error) {
      say(shared, error.what());
    }
    _exit(0);
  }
  const auto [status, capped] = wait_for(child, shared.stop_at_s);
  Outcome outcome = shared;
  munmap(memory, sizeof(Outcome));
  if (!outcome.done && WIFSIGNALED(status)) {
    say(outcome,
        capped ? fmt::format("did not finish: {:g} s of CPU were over at t = {:g} s of {:g} s",
                             options.cap_s, outcome.reached_s, bench.sample_times.back())
               : fmt::format("ended by signal {} ({}) after t = {:g} s", WTERMSIG(status),
                             strsignal(WTERMSIG(status)), outcome.reached_s));
  }
  return outcome;
}

std::string cleaned(std::string words) {
  for (char& c : words)
    if (c == '\t' || c == '\n') c = ' ';
  return words;
}

void write_row(std::ostream& file, const BenchCase& bench, const Engine& engine,
               const Setting& setting, const Outcome& outcome) {
  file << fmt::format("{}\t{}\t{}\t{:.17g}\t{:.17g}\t{:.6g}\t{:.6g}\t{}\t{}\n", bench.id,
                      engine.name, setting.method, setting.step, setting.tolerance, outcome.cpu_s,
                      outcome.error, outcome.done ? "done" : "failed", cleaned(outcome.words))
       << std::flush;
  const std::string fineness =
      std::isfinite(setting.tolerance) ? fmt::format("tol {:g}", setting.tolerance)
      : std::isfinite(setting.step)    ? fmt::format("1/{:g} s", 1 / setting.step)
                                       : "no step";
  fmt::print(stderr, "{:8} {:8} {:34} {:10} {:>10.4g} s  error {:<10.3g} {}\n", bench.id,
             engine.name, setting.method, fineness, outcome.cpu_s, outcome.error,
             cleaned(outcome.words));
}

void run_ladder(const BenchCase& bench, const Engine& engine, const std::vector<Setting>& ladder,
                const Options& options, std::ostream& file) {
  double last = 0.0;
  for (const Setting& setting : ladder) {
    Outcome outcome{std::nan(""), std::nan(""), 0.0, kNever, false, ""};
    // A finer rung costs about twice the last: what would pass the cap is not begun.
    if (last > 0.6 * options.cap_s)
      say(outcome, "not run: it would take more than the cap");
    else
      outcome = measured_apart(bench, engine, setting, options);
    if (std::isfinite(outcome.cpu_s))
      last = outcome.cpu_s;
    else if (std::strstr(outcome.words, "did not finish") != nullptr)
      last = options.cap_s;
    write_row(file, bench, engine, setting, outcome);
  }
}

Options read_words(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (word == "--quick")
      options.quick = true;
    else if (word == "--out")
      options.out = value();
    else if (word == "--cases")
      options.cases = value();
    else if (word == "--runs")
      options.runs = std::max(1, std::atoi(value().c_str()));
    else if (word == "--cap-s")
      options.cap_s = std::max(1.0, std::atof(value().c_str()));
    else
      throw std::runtime_error(
          "unknown word " + word +
          "; there are --out FILE, --quick, --cases S1,S5, --runs N, --cap-s S");
  }
  if (options.out.empty()) throw std::runtime_error("--out FILE is missing");
  return options;
}

bool wanted(const std::string& list, const std::string& id) {
  if (list.empty()) return true;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string word = list.substr(begin, end - begin);
    if (id == word || id.substr(0, id.find('-')) == word) return true;
    begin = end + 1;
  }
  return false;
}

}  // namespace

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<std::vector<Setting>> step_ladders(const BenchCase& bench,
                                               const std::vector<std::string>& methods) {
  std::vector<std::vector<Setting>> ladders;
  for (const std::string& method : methods) {
    ladders.emplace_back();
    for (const double step : bench.steps) ladders.back().push_back({method, step});
  }
  return ladders;
}

int peer_main(int argc, char** argv, const Engine& engine) try {
  keep_freed_memory();  // for all engines alike
  const Options options = read_words(argc, argv);
  std::ofstream file(options.out);
  if (!file) throw std::runtime_error(options.out + ": cannot be written");
  file << "#\t" << engine.name << '\t' << engine.version << '\t' << engine.settings << '\n';
  for (const BenchCase& bench : all_cases(options.quick)) {
    if (!wanted(options.cases, bench.id)) continue;
    for (const auto& ladder : engine.ladders(bench))
      run_ladder(bench, engine, ladder, options, file);
  }
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}: {}\n", argv[0], error.what());
  return 2;
}

}  // namespace tumble::peers
