// Draws random scenes, runs each in a process of its own, and reports how each ended. --program
// build/bin/tumble runs them by the program itself; without it by its engines, which is faster.
//
//   fuzz_scenes --from 1 --count 200 [--engine rd|ca|tw|ordered|all] [--quick] [--shrink] [--out
//   FOLDER]
//   fuzz_scenes --print 17        writes scene 17 to stdout, with --quick and --engine as it was
//   drawn with them
//   fuzz_scenes --judge FILE      runs a scene file and judges it; the recorded run stays in FOLDER
//
// A failure (a crash, a hang, a wrong run that ends with 0) is written to FOLDER with its result
// and the command that repeats it, as small as possible with --shrink. Exit 1 where there was one.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "tests/fuzz/draw_scene.h"
#include "tests/fuzz/run_scene_file.h"
#include "tests/fuzz/shrink_scene.h"

namespace tumble::fuzz {
namespace {

namespace fs = std::filesystem;

struct Words {
  std::uint64_t from = 1, count = 100;
  std::vector<std::string> engines{"rd"};
  bool quick = false, shrink = false, verbose = false;
  int shrunk_a_family = 1;  // failures of a family that are shrunk
  fs::path out = "out/fuzz", program, judge;
  std::uint64_t print = 0;
  // of CPU without a frame; tumble run reports progress after 5 s, and every 10 s from then on
  double silence_s = 60.0;
};

Words parse(int argc, char** argv) {
  Words words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] {
      if (i + 1 < argc) return std::string(argv[++i]);
      fmt::print(stderr, "fuzz_scenes: {} needs a value\n", word);
      std::exit(2);
    };
    if (word == "--from")
      words.from = std::stoull(value());
    else if (word == "--count")
      words.count = std::stoull(value());
    else if (word == "--engine") {
      const std::string engine = value();
      words.engines = engine == "all" ? std::vector<std::string>{"rd", "ca", "tw", "ordered"}
                                      : std::vector<std::string>{engine};
    } else if (word == "--quick")
      words.quick = true;
    else if (word == "--shrink")
      words.shrink = true;
    else if (word == "--verbose")
      words.verbose = true;
    else if (word == "--out")
      words.out = value();
    else if (word == "--program")
      words.program = value();
    else if (word == "--print")
      words.print = std::stoull(value());
    else if (word == "--judge")
      words.judge = value();
    else if (word == "--silence-s")
      words.silence_s = std::stod(value());
    else {
      fmt::print(stderr, "fuzz_scenes: what is {}?\n", word);
      std::exit(2);
    }
  }
  return words;
}

class Fuzzer {
 public:
  explicit Fuzzer(Words words) : words_(std::move(words)) {}

  void run() {
    for (std::uint64_t number = words_.from; number < words_.from + words_.count; ++number)
      for (const std::string& engine : words_.engines) look_at(number, engine);
    report();
  }
  int judge_file() {
    RunWish wish = wish_for(words_.engines.front());
    wish.folder = words_.out;  // the recorded run stays there
    fs::create_directories(wish.folder);
    const Verdict verdict = run_scene_file(words_.judge, wish);
    fmt::print("{} in {:.2f} s of CPU: {}\n", verdict.family, verdict.cpu_s, verdict.words);
    return verdict.is_failure() ? 1 : 0;
  }
  bool has_failures() const { return failures_ > 0; }

 private:
  RunWish wish_for(const std::string& engine) const {
    return {words_.program, engine, scratch_.path(), words_.silence_s, 3.0 * words_.silence_s};
  }

  Verdict judged(const Json& scene, const std::string& engine) {
    const fs::path file = scratch_.path() / "scene.json";
    std::ofstream(file) << scene.dump(1) << "\n";
    return run_scene_file(file, wish_for(engine));
  }

  void look_at(std::uint64_t number, const std::string& engine) {
    const Json scene =
        draw_scene(number, {words_.quick, words_.engines.size() > 1 || engine != "rd"});
    const Verdict verdict = judged(scene, engine);
    ++outcomes_[word_of(verdict.outcome)];
    const int seen = ++families_[engine + ": " + verdict.family];
    cpu_s_ += verdict.cpu_s;
    if (words_.verbose)
      fmt::print("{} {} {:.2f} s {}\n", number, engine, verdict.cpu_s, verdict.family);
    std::fflush(stdout);
    if (!verdict.is_failure()) return;
    ++failures_;
    const bool is_made_small = words_.shrink && seen <= words_.shrunk_a_family;
    write_down(number, engine, verdict,
               is_made_small ? shrunk(scene, engine, verdict.family) : scene);
  }

  Json shrunk(const Json& scene, const std::string& engine, const std::string& family) {
    return shrink_scene(
        scene, [&](const Json& smaller) { return judged(smaller, engine).family == family; },
        family.starts_with("hang") || family.starts_with("slow") ? 12 : 200);
  }

  void write_down(std::uint64_t number, const std::string& engine, const Verdict& first,
                  const Json& scene) {
    fs::create_directories(words_.out);
    const std::string name = fmt::format("{}_{}_{}", engine, word_of(first.outcome), number);
    std::ofstream(words_.out / (name + ".json")) << scene.dump(1) << "\n";
    const std::string line = fmt::format(
        "{}.json | {} | {} bodies | tumble run {}.json --modules reference --engine {} | {}", name,
        first.family, scene["bodies"].size(), name, engine, first.words.substr(0, 300));
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }

  void report() const {
    fmt::print("\n{} runs, {:.0f} s of CPU\n", words_.count * words_.engines.size(), cpu_s_);
    for (const auto& [word, count] : outcomes_) fmt::print("  {:<8} {}\n", word, count);
    fmt::print("families\n");
    for (const auto& [family, count] : families_) fmt::print("  {:>5}  {}\n", count, family);
  }

  Words words_;
  PrivateFolder scratch_;
  std::map<std::string, int> outcomes_, families_;
  int failures_ = 0;
  double cpu_s_ = 0.0;
};

int fuzz(const Words& words) {
  if (words.print > 0) {
    std::cout << draw_scene(words.print, {words.quick, words.engines.front() != "rd"}).dump(1)
              << "\n";
    return 0;
  }
  Fuzzer fuzzer(words);
  if (!words.judge.empty()) return fuzzer.judge_file();
  fuzzer.run();
  return fuzzer.has_failures() ? 1 : 0;
}

}  // namespace
}  // namespace tumble::fuzz

int main(int argc, char** argv) { return tumble::fuzz::fuzz(tumble::fuzz::parse(argc, argv)); }
