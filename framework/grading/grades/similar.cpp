#include "framework/grading/grades/similar.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "/usr/bin/sim_c++";
constexpr double kLongest_s = 600.0;  // 300 sources that are all alike take 5 s

std::string trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos
             ? ""
             : line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
}

std::string run_sim(std::vector<std::string> words) {
  words.insert(words.begin(), kProgram);
  const ProgramOutcome outcome = run_program(words, Output::kCaptured, kLongest_s);
  constexpr int kNotStarted = 127;
  if (outcome.code == kNotStarted) throw std::runtime_error("sim_c++ could not be started");
  if (!outcome.in_time)
    throw SourcesNotCompared(fmt::format("sim_c++ did not end within {:g} s", kLongest_s));
  if (outcome.code != 0)
    throw SourcesNotCompared("sim_c++ failed: " + outcome.printed.substr(0, 300));
  return outcome.printed;
}

fs::path file_of(const fs::path& folder, std::size_t number) {
  return folder / fmt::format("{}.cpp", number);
}

// "/tmp/x/12.cpp: line 4-20 |/tmp/x/3.cpp: line 7-23 [57]"
std::vector<SimilarRun> runs_of(const fs::path& folder, const SimilarPair& pair) {
  const std::string said = run_sim({"-n", "-s", "-T", "-w", "400", file_of(folder, pair.a).string(),
                                    file_of(folder, pair.b).string()});
  std::vector<SimilarRun> runs;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    SimilarRun run;
    const auto a = line.find(": line "), bar = line.find('|');
    const auto b = line.find(": line ", bar == std::string::npos ? 0 : bar);
    const auto count = line.rfind('[');
    if (a == std::string::npos || bar == std::string::npos || b == std::string::npos ||
        count == std::string::npos)
      continue;
    if (std::sscanf(line.c_str() + a, ": line %zu-%zu", &run.a_first, &run.a_last) != 2 ||
        std::sscanf(line.c_str() + b, ": line %zu-%zu", &run.b_first, &run.b_last) != 2 ||
        std::sscanf(line.c_str() + count, "[%d]", &run.tokens) != 1)
      continue;
    const bool is_swapped = line.compare(0, a, file_of(folder, pair.b).string()) == 0;
    if (is_swapped) {
      std::swap(run.a_first, run.b_first);
      std::swap(run.a_last, run.b_last);
    }
    runs.push_back(run);
  }
  return runs;
}

}  // namespace

bool can_compare_sources() { return fs::exists(kProgram); }

std::string without_starter(const std::string& text, const std::string& starter) {
  std::set<std::string> known;
  std::istringstream given(starter);
  for (std::string line; std::getline(given, line);) known.insert(trimmed(line));
  std::string rest;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    rest += (known.contains(trimmed(line)) ? "" : line) + '\n';
  return rest;
}

std::vector<SimilarPair> similar_pairs(const std::vector<NamedSource>& sources,
                                       const std::string& starter, int least_percent,
                                       std::size_t with_runs) {
  if (sources.size() < 2) return {};
  const PrivateFolder folder;
  std::vector<std::string> words = {"-p", "-T", "-t", std::to_string(least_percent)};
  // every pair by itself; its cost grows with the third power of their number
  if (sources.size() <= kMostForEveryPair) words.push_back("-e");
  for (std::size_t i = 0; i < sources.size(); ++i) {
    write_whole(file_of(folder.path(), i), without_starter(sources[i].text, starter));
    words.push_back(file_of(folder.path(), i).string());
  }
  // "/tmp/x/12.cpp consists for 87 % of /tmp/x/3.cpp material"
  std::map<std::pair<std::size_t, std::size_t>, int> percents;
  std::istringstream lines(run_sim(words));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream parts(line);
    std::string a, b, consists, is_for, sign, of;
    int percent = 0;
    if (!(parts >> a >> consists >> is_for >> percent >> sign >> of >> b) || consists != "consists")
      continue;
    const std::size_t i = std::stoul(fs::path(a).stem()), j = std::stoul(fs::path(b).stem());
    int& most = percents[{std::min(i, j), std::max(i, j)}];
    most = std::max(most, percent);
  }
  std::vector<SimilarPair> pairs;
  for (const auto& [two, percent] : percents) pairs.push_back({two.first, two.second, percent, {}});
  std::stable_sort(pairs.begin(), pairs.end(), [](const SimilarPair& a, const SimilarPair& b) {
    return a.percent > b.percent;
  });
  for (std::size_t i = 0; i < std::min(with_runs, pairs.size()); ++i)
    pairs[i].runs = runs_of(folder.path(), pairs[i]);
  return pairs;
}

}  // namespace tumble::grading
