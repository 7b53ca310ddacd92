/// Results of the programs in tests/bench/peers: cost against error for each engine.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::report {

struct PeerRow {
  std::string bench, engine, method;
  double step, tolerance, cpu_s, error;  // NaN where there is none
  bool done;
  std::string words;  // parts of the error, or why there is none
};

struct PeerWords {
  std::string name, version, settings;
};

struct PeerRows {
  std::vector<PeerWords> engines;
  std::vector<PeerRow> rows;
};

/// All *.tsv files of a folder, Tumble's first, the others by name.
PeerRows read_peer_rows(const std::filesystem::path& folder);

/// The cheapest row of an engine with at most this error; nullptr where there is none.
/// @param of_others  searches all engines except this one instead
const PeerRow* cheapest_row(const std::vector<PeerRow>& rows, const std::string& bench,
                            const std::string& engine, bool of_others, double error);

}  // namespace tumble::report
