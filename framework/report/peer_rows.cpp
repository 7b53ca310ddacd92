#include "framework/report/peer_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace tumble::report {
namespace {

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find('\t', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

double number(const std::string& word) { return std::strtod(word.c_str(), nullptr); }

void read_file(const std::filesystem::path& file, PeerRows& measured) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::vector<std::string> f = fields_of(line);
    if (f.size() == 4 && f[0] == "#")
      measured.engines.push_back({f[1], f[2], f[3]});
    else if (f.size() == 9)
      measured.rows.push_back({f[0], f[1], f[2], number(f[3]), number(f[4]), number(f[5]),
                               number(f[6]), f[7] == "done", f[8]});
    else
      throw std::runtime_error(file.string() + ": not a row: " + line);
  }
}

}  // namespace

PeerRows read_peer_rows(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".tsv") files.push_back(entry.path());
  const auto place = [](const std::filesystem::path& file) {
    return std::pair(file.stem() != "tumble", file.stem().string());
  };
  std::sort(files.begin(), files.end(),
            [&](const auto& a, const auto& b) { return place(a) < place(b); });
  PeerRows measured;
  for (const auto& file : files) read_file(file, measured);
  return measured;
}

const PeerRow* cheapest_row(const std::vector<PeerRow>& rows, const std::string& bench,
                            const std::string& engine, bool of_others, double error) {
  const PeerRow* best = nullptr;
  for (const PeerRow& row : rows)
    if (row.bench == bench && (row.engine == engine) != of_others && row.done &&
        row.error <= error && (best == nullptr || row.cpu_s < best->cpu_s))
      best = &row;
  return best;
}

}  // namespace tumble::report
