/// Which submissions are like each other: Debian's similarity-tester (sim_c++) compares them token
/// by token, without the lines of the starter. What it finds is a reason to look, not a verdict.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace tumble::grading {

struct NamedSource {
  std::string name, text;
};

/// Lines [first, last] of two texts that are the same but for layout, comments and names.
struct SimilarRun {
  std::size_t a_first = 0, a_last = 0, b_first = 0, b_last = 0;  // from 1
  int tokens = 0;
};

struct SimilarPair {
  std::size_t a = 0, b = 0;      // of the sources, a < b
  int percent = 0;               // of the one that has more in common with the other
  std::vector<SimilarRun> runs;  // longest first; filled for the first pairs only
};

/// That sim_c++ failed on these sources, which one odd file among them may cause.
struct SourcesNotCompared : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Whether sim_c++ is installed here.
bool can_compare_sources();

/// Up to so many sources every pair is compared by itself. Of more, each is compared with all
/// others at once, and forms a pair only with those that most of it is like.
inline constexpr std::size_t kMostForEveryPair = 300;

/// The text with an empty line for each line that the starter has too, so that line numbers stay.
std::string without_starter(const std::string& text, const std::string& starter);

/// @param least_percent  of a text that stands in the other, from which a pair counts
/// @param with_runs      pairs, the most similar ones, whose runs are found as well
/// @return pairs, most similar first, then in the order of the sources
/// @pre can_compare_sources()
/// @throws SourcesNotCompared when sim_c++ fails or takes too long; std::runtime_error when it
///   cannot be started, as with more names than a command line takes
std::vector<SimilarPair> similar_pairs(const std::vector<NamedSource>& sources,
                                       const std::string& starter, int least_percent = 50,
                                       std::size_t with_runs = 10);

}  // namespace tumble::grading
