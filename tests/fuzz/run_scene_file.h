/// Runs a scene as `tumble run` does, in a process of its own, and reports how it ended.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::fuzz {

enum class Outcome {
  kRight,    // exit 0, and the recorded run passes the judgement
  kRefused,  // exit 2 or 4, with a message
  kStopped,  // exit 1, with a message: a check failed, or the run was stopped
  kNoted,    // exit 0, the recorded run fails the judgement, with a notice
  kSilent,   // exit 0, the recorded run fails the judgement, without a notice
  kMute,     // exit 1, 2 or 4 without a message
  kCrash,    // a signal, or exit 3: an error of the program
  kHang,     // `silence_s` of CPU without output
  kSlow,     // progress, but no end within `most_cpu_s`
};

struct RunWish {
  // tumble; empty: its engines in a forked child, which is the same without loading a program per
  // scene
  std::filesystem::path program;
  std::string engine;            // word of --engine
  std::filesystem::path folder;  // for the recorded run and the output; must exist
  double silence_s = 20.0;       // CPU without progress before a run counts as hanging
  double most_cpu_s = 60.0;      // CPU before a run with progress is ended
};

struct Verdict {
  Outcome outcome = Outcome::kRight;
  // a few words for equal failures: "silent energy", "crash signal 11", "refused: overlap"
  std::string family;
  std::string words;  // the message or the fault
  double cpu_s = 0.0;
  bool is_failure() const {
    return outcome != Outcome::kRight && outcome != Outcome::kRefused &&
           outcome != Outcome::kStopped;
  }
};

std::string word_of(Outcome outcome);

/// @param scene_file  a scene for `tumble run`
Verdict run_scene_file(const std::filesystem::path& scene_file, const RunWish& wish);

}  // namespace tumble::fuzz
