/// The rows that engines' programs have written, read again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::peers {

struct Row {
  std::string bench, engine, method;
  double step, tolerance, cpu_s, error;   // NaN where there is none
  bool done;
  std::string words;                      // parts of the error, or why there is none
};

struct EngineWords {
  std::string name, version, settings;
};

struct Measured {
  std::vector<EngineWords> engines;
  std::vector<Row> rows;
};

/// All *.tsv files of a folder, Tumble's first, the others by name.
Measured read_rows(const std::filesystem::path& folder);

/// The cheapest row of an engine whose error is at most this; nullptr where none gets there.
/// @param of_others  of any engine but this one instead
const Row* cheapest(const std::vector<Row>& rows, const std::string& bench, const std::string& engine, bool of_others, double error);

}  // namespace tumble::peers
