/// Runs a scene as `tumble run` does, in a process of its own, and says how it ended.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::fuzz {

enum class Outcome {
  kRight,       // exit 0, and the recorded run holds
  kRefused,     // exit 2 or 4, with words
  kStopped,     // exit 1, with words: a check failed, or the run was ended for a reason
  kNoted,       // exit 0, the recorded run does not hold, and a notice was given
  kSilent,      // exit 0, the recorded run does not hold, and nothing was said
  kMute,        // exit 1, 2 or 4 without a word of why
  kCrash,       // a signal, or exit 3: the program's own fault
  kHang,        // `silence_s` of CPU without a word
  kSlow,        // words of progress, but not the end within `most_cpu_s`
};

struct RunWish {
  std::filesystem::path program;     // tumble; empty: its engines in a forked child, which is the same without loading a program a scene
  std::string engine;                // word of --engine
  std::filesystem::path folder;      // where the recorded run and the words go; must exist
  double silence_s = 20.0;           // CPU without a word of progress before a run counts as hanging
  double most_cpu_s = 60.0;          // CPU before a run that does say something is given up
};

struct Verdict {
  Outcome outcome = Outcome::kRight;
  std::string family;   // a few words that equal failures share: "silent energy", "crash signal 11", "refused: overlap"
  std::string words;    // what was said or found
  double cpu_s = 0.0;
  bool is_failure() const { return outcome != Outcome::kRight && outcome != Outcome::kRefused && outcome != Outcome::kStopped; }
};

std::string word_of(Outcome outcome);

/// @param scene_file  a scene as `tumble run` takes it
Verdict run_scene_file(const std::filesystem::path& scene_file, const RunWish& wish);

}  // namespace tumble::fuzz
