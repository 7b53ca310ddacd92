// Figures, no test: when rd and tw part in random piles, by step, and how fast rd parts from itself
// when one body starts 1e-12 m beside.
//
//   pile_figures [FIRST LAST]      piles FIRST to LAST, 1 to 48 without
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/engines/events/trace.h"
#include "tests/engines/reference_laws.h"
#include "tests/fuzz/draw_pile.h"
#include "tests/fuzz/pile_pairs.h"

namespace tumble::fuzz {
namespace {

constexpr double kTimes[] = {0.2, 0.25, 0.3, 0.4, 0.5, 0.75};
constexpr double kApart[] = {1e-9, 1e-6, 1e-3};

/// By pile, of one pair of runs.
struct Column {
  std::string name;
  std::vector<Trajectory> a, b;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void tell(const Column& column) {
  std::string line = fmt::format("| {} |", column.name);
  for (const double time : kTimes) {
    std::vector<double> apart;
    for (std::size_t k = 0; k < column.a.size(); ++k)
      apart.push_back(apart_at(column.a[k], column.b[k], time));
    line += fmt::format(" {:.0e} |", median(apart));
  }
  for (const double distance : kApart) {
    std::vector<double> times;
    for (std::size_t k = 0; k < column.a.size(); ++k)
      times.push_back(parted_at(column.a[k], column.b[k], distance));
    const auto parted =
        std::count_if(times.begin(), times.end(), [](double time) { return std::isfinite(time); });
    line += fmt::format(" {:.2f} s, {} |", median(times), parted);
  }
  fmt::print("{}\n", line);
}

void measure(std::uint64_t first, std::uint64_t last) {
  const Laws laws = testing::reference_laws();
  std::vector<Column> columns{{"rd and tw, h", {}, {}},
                              {"rd and tw, h/4", {}, {}},
                              {"rd and tw, h/16", {}, {}},
                              {"rd and itself 1e-12 m beside, h/16", {}, {}}};
  int other_traces = 0;
  for (std::uint64_t number = first; number <= last; ++number) {
    const scene::Scene pile = draw_pile(number);
    for (std::size_t k = 0; k < 3; ++k) {
      const double steps = std::pow(4.0, static_cast<double>(k));
      columns[k].a.push_back(run_pile(pile, laws, {"rd", steps}));
      columns[k].b.push_back(run_pile(pile, laws, {"tw", steps}));
      other_traces +=
          engines::compare_traces(run_pile(pile, laws, {"ordered", steps}), columns[k].b.back())
              .has_value();
    }
    columns[3].a.push_back(columns[2].a.back());
    columns[3].b.push_back(run_pile(pile, laws, {"rd", 16.0, 1e-12}));
  }
  fmt::print("piles {} to {}: median distance [m] at {} s; median time and number parted by {} m\n",
             first, last, fmt::join(kTimes, ", "), fmt::join(kApart, ", "));
  for (const Column& column : columns) tell(column);
  fmt::print("traces of tw that are not those of ordered: {}\n", other_traces);
}

}  // namespace
}  // namespace tumble::fuzz

int main(int argc, char** argv) {
  tumble::fuzz::measure(argc > 2 ? std::strtoull(argv[1], nullptr, 10) : 1,
                        argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 48);
}
