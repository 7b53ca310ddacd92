// The page of the peers: one table, one picture a scene, every row below it.  usage: peers_page
// ROWS_DIR PAGE.html [--quick]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>

#include <fmt/format.h>

#include "framework/report/cost_page.h"
#include "framework/report/html.h"
#include "framework/report/peer_rows.h"
#include "tests/bench/peers/cases.h"

namespace tumble::peers {
namespace {

using report::Cell;
using report::cheapest_row;
using report::Look;
using report::PeerRow;
using report::PeerRows;
using report::PeerWords;
using report::read_peer_rows;

const std::string kOurs = "Tumble";
constexpr double kMarks[] = {1e-3, 1e-6, 1e-9};
constexpr double kExact = 1e-17;      // an error of nothing at all is drawn here
constexpr std::size_t kMostWays = 4;  // of running Tumble, in a picture
constexpr double kBlownUp = 1e3;      // what is worse is in the table, not in the picture

constexpr const char* kRules[] = {
    "Price: CPU time of the process around the engine's steps only. Building the world, loading "
    "models and looking at the bodies are not in it, except for Tumble, whose frames at the "
    "samples are part of its run. Each setting runs in a process of its own; runs shorter than "
    "half a second are repeated and the median counts. All engines ran on this machine one after "
    "another, on one core each: ratios matter, not seconds.",
    "Error: against a truth that comes from none of the engines: a closed form, a file of "
    "tests/truths (60 digits, two methods), or what physics forbids (energy that changes, joints "
    "that open, solids that "
    "overlap). Where two things must hold, the worse counts. All engines are looked at at the same "
    "instants, by the same code, from places, orientations and velocities alone.",
    "Settings: what each engine's own manual recommends, over a ladder of steps (or of tolerances, "
    "where it controls its error). Of a pair the smaller friction and restitution count "
    "everywhere. Sleep and "
    "damping are off. A curve is one way to run an engine; of a peer with several only what no "
    "other of its own ways beats is drawn, and every row stands in the fold below the picture.",
    "Tumble goes through run_scene, the entry that `tumble run` uses, with the laws of the "
    "course's reference modules: retroactive detection with RK4 at a fixed step, or with "
    "Dormand-Prince or Fehlberg 7(8) (error control, from Boost.Odeint) or Gauss's implicit method "
    "of order 6 behind the same law, links as rows or in joint coordinates; and, "
    "where nothing but gravity and impacts acts and the tree has them, conservative advancement "
    "and timewarp, whose flights are closed forms.",
};

std::string fineness(const PeerRow& row) {
  if (std::isfinite(row.tolerance)) return fmt::format("tolerance {:.0e}", row.tolerance);
  return std::isfinite(row.step) ? fmt::format("1/{:g} s", std::round(1 / row.step)) : "no step";
}

/// What none of the same engine's rows beats in both price and error, by price.
std::vector<PeerRow> not_beaten(const std::vector<PeerRow>& rows) {
  std::vector<double> prices, errors;
  for (const PeerRow& row : rows) {
    prices.push_back(row.cpu_s);
    errors.push_back(row.error);
  }
  std::vector<PeerRow> best;
  for (const std::size_t i : report::not_beaten(prices, errors)) best.push_back(rows[i]);
  return best;
}

std::vector<PeerRow> rows_of(const PeerRows& measured, const std::string& bench,
                             const std::string& engine) {
  std::vector<PeerRow> rows;
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench && row.engine == engine && row.done && std::isfinite(row.error) &&
        row.error < kBlownUp)
      rows.push_back(row);
  return rows;
}

report::Curve curve_of(const std::string& name, const std::vector<PeerRow>& rows) {
  report::Curve curve{name, {}, {}, true};
  for (const PeerRow& row : rows) {
    curve.x.push_back(row.cpu_s);
    curve.y.push_back(std::max(row.error, kExact));
  }
  return curve;
}

std::vector<std::string> methods_of(const std::vector<PeerRow>& rows) {
  std::vector<std::string> methods;
  for (const PeerRow& row : rows)
    if (std::find(methods.begin(), methods.end(), row.method) == methods.end())
      methods.push_back(row.method);
  return methods;
}

report::Plot plot_of(const BenchCase& bench, const PeerRows& measured) {
  report::Plot plot{bench.id + ": " + bench.title,
                    {"CPU time", "s", report::Scale::kLog},
                    {bench.error_name, bench.error_unit, report::Scale::kLog},
                    {},
                    {},
                    "Left is cheaper, down is more accurate. Truth: " + bench.truth + "."};
  for (const PeerWords& engine : measured.engines) {
    const std::vector<PeerRow> rows = rows_of(measured, bench.id, engine.name);
    // empty where it does not run: an engine looks the same in all pictures
    if (engine.name != kOurs) {
      plot.curves.push_back(curve_of(rows.empty() ? "" : engine.name, not_beaten(rows)));
      continue;
    }
    for (std::size_t k = 0; k < kMostWays; ++k) {
      const std::vector<std::string> methods = methods_of(rows);
      std::vector<PeerRow> of_method;
      if (k < methods.size())
        std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_method),
                     [&](const PeerRow& row) { return row.method == methods[k]; });
      plot.curves.push_back(curve_of(of_method.empty() ? "" : "Tumble, " + methods[k], of_method));
    }
  }
  for (const Goal& goal : bench.goals) {
    const bool is_drawn =
        std::any_of(plot.limits.begin(), plot.limits.end(),
                    [&](const report::Limit& limit) { return limit.y == goal.error; });
    if (std::isfinite(goal.error) && !is_drawn)
      plot.limits.push_back({goal.error, "goal: " + goal.words});
  }
  return plot;
}

/// Words that stay on one line.
std::string unbroken(const std::string& words) {
  std::string whole;
  for (const char c : words) whole += c == ' ' ? std::string("\u00a0") : std::string(1, c);
  return whole;
}

Cell price_cell(const PeerRow* row, bool with_name, Look look) {
  if (row == nullptr) return {"-", "", Look::kMuted};
  return {(with_name ? row->engine + " " : "") + unbroken(report::price_of(row->cpu_s)), "", look};
}

bool is_ahead(const PeerRow* ours, const PeerRow* theirs) {
  return ours != nullptr && (theirs == nullptr || ours->cpu_s <= theirs->cpu_s);
}

/// Ahead or behind, and by how much.
Cell standing(const PeerRow* ours, const PeerRow* theirs) {
  if (ours == nullptr && theirs == nullptr) return {"-", "", Look::kMuted};
  if (theirs == nullptr) return {"alone", "", Look::kGood};
  if (ours == nullptr) return {"behind", "", Look::kBad};
  const bool ahead = is_ahead(ours, theirs);
  const double ratio = ahead ? theirs->cpu_s / ours->cpu_s : ours->cpu_s / theirs->cpu_s;
  return {unbroken(fmt::format(
              "{} {}", ahead ? "ahead" : "behind",
              ratio < 100 ? fmt::format("{:.2g}", ratio) : fmt::format("{:.0f}", ratio))),
          "", ahead ? Look::kGood : Look::kBad};
}

/// In how many cells of the overview that some peer reaches Tumble is ahead of all of them.
std::string score(const std::vector<BenchCase>& cases, const PeerRows& measured) {
  int reached = 0, won = 0, alone = 0;
  for (const BenchCase& bench : cases)
    for (const double mark : kMarks) {
      const PeerRow *ours = cheapest_row(measured.rows, bench.id, kOurs, false, mark),
                    *theirs = cheapest_row(measured.rows, bench.id, kOurs, true, mark);
      if (theirs != nullptr) ++reached, won += is_ahead(ours, theirs) ? 1 : 0;
      if (theirs == nullptr && ours != nullptr) ++alone;
    }
  return fmt::format(
      "Tumble is ahead of every peer in {} of the {} cells that some peer reaches, and alone in {} "
      "others.",
      won, reached, alone);
}

report::Table overview(const std::vector<BenchCase>& cases, const PeerRows& measured) {
  report::Table table;
  table.caption =
      "What an error of at most 1e-3, 1e-6, 1e-9 costs: Tumble's CPU time, the cheapest peer's, "
      "and how many times the peer's is Tumble's (ahead), or Tumble's the peer's (behind). alone: "
      "no peer gets there. - : none gets there.";
  table.columns = {{"Scene"}};
  for (const double mark : kMarks)
    table.columns.insert(
        table.columns.end(),
        {{fmt::format("1e{:.0f}", std::log10(mark)), true}, {"peer", true}, {"", true}});
  for (const BenchCase& bench : cases) {
    std::vector<Cell> cells{{unbroken(bench.id.substr(0, 2) + " " + bench.name), "#" + bench.id}};
    for (const double mark : kMarks) {
      const PeerRow *ours = cheapest_row(measured.rows, bench.id, kOurs, false, mark),
                    *theirs = cheapest_row(measured.rows, bench.id, kOurs, true, mark);
      const bool wins = is_ahead(ours, theirs);
      cells.push_back(price_cell(ours, false, wins ? Look::kGood : Look::kPlain));
      cells.push_back(
          price_cell(theirs, true, !wins && theirs != nullptr ? Look::kWarning : Look::kPlain));
      cells.push_back(standing(ours, theirs));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// Where Tumble stands in this scene, in words made of the numbers.
std::string verdict(const BenchCase& bench, const PeerRows& measured) {
  std::string words;
  for (const double mark : kMarks) {
    const PeerRow *ours = cheapest_row(measured.rows, bench.id, kOurs, false, mark),
                  *theirs = cheapest_row(measured.rows, bench.id, kOurs, true, mark);
    std::string sentence;
    if (ours == nullptr && theirs == nullptr)
      sentence = "no engine gets there";
    else if (ours == nullptr)
      sentence = fmt::format("Tumble does not get there; {} needs {}", theirs->engine,
                             report::price_of(theirs->cpu_s));
    else if (theirs == nullptr)
      sentence = fmt::format("Tumble needs {} ({}, {}); no peer gets there",
                             report::price_of(ours->cpu_s), ours->method, fineness(*ours));
    else if (ours->cpu_s <= theirs->cpu_s)
      sentence =
          fmt::format("Tumble needs {}, {} {:.1f} times as much", report::price_of(ours->cpu_s),
                      theirs->engine, theirs->cpu_s / ours->cpu_s);
    else
      sentence = fmt::format("Tumble loses: {} against {} of {} ({}, {}), {:.1f} times as much",
                             report::price_of(ours->cpu_s), report::price_of(theirs->cpu_s),
                             theirs->engine, theirs->method, fineness(*theirs),
                             ours->cpu_s / theirs->cpu_s);
    words += fmt::format("{}At {:.0e}: {}.", words.empty() ? "" : " ", mark, sentence);
  }
  const PeerRow* closest = nullptr;  // of the peers
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench.id && row.engine != kOurs && row.done && std::isfinite(row.error) &&
        (closest == nullptr || row.error < closest->error))
      closest = &row;
  if (closest != nullptr)
    words += fmt::format(" The least error of a peer is {:.1e}: {} ({}, {}), {}.", closest->error,
                         closest->engine, closest->method, fineness(*closest),
                         report::price_of(closest->cpu_s));
  return words;
}

/// What of Tumble's ended early.
std::string trouble(const BenchCase& bench, const PeerRows& measured) {
  std::string words;
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench.id && row.engine == kOurs && !row.done)
      words += fmt::format(
          "{}Tumble, {}, {}: {}.", words.empty() ? "" : " ", row.method, fineness(row),
          row.words.substr(0, std::min(row.words.find(" (integrator"), row.words.find(';'))));
  return words;
}

/// Whether a goal is reached, and by what; an empty verdict where the rows do not say.
struct Judged {
  std::string found;
  Look look = Look::kMuted;
};

const PeerRow* row_at(const PeerRows& measured, const std::string& bench, const std::string& engine,
                      double step) {
  const PeerRow* best = nullptr;  // of several ways with that step, the cheapest
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench && row.engine == engine && std::abs(row.step - step) < 1e-9 &&
        (best == nullptr || row.done > best->done ||
         (row.done == best->done && row.cpu_s < best->cpu_s)))
      best = &row;
  return best;
}

const PeerRow* cheapest_of(const PeerRows& measured, const std::string& bench,
                           const std::string& engine, double error) {
  const PeerRow* best = nullptr;
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench && row.engine == engine && row.done && row.error <= error &&
        (best == nullptr || row.cpu_s < best->cpu_s))
      best = &row;
  return best;
}

std::string told(double error) {
  return error == 0.0 ? "none at all" : fmt::format("{:.1e}", error);
}

Judged judged(bool holds, std::string found) {
  return {std::move(found), holds ? Look::kGood : Look::kBad};
}

Judged judged_by_step(const BenchCase& bench, const Goal& goal, const PeerRows& measured) {
  const PeerRow* ours = row_at(measured, bench.id, kOurs, goal.step);
  if (ours == nullptr) return {"not measured"};
  if (std::isfinite(goal.error))
    return ours->done ? judged(ours->error <= goal.error, told(ours->error))
                      : judged(false, "it stops");
  const bool among_cases = !goal.bench.empty();
  const PeerRow* theirs = among_cases ? row_at(measured, goal.bench, kOurs, goal.step)
                                      : row_at(measured, bench.id, goal.peer, goal.step);
  if (theirs == nullptr || !theirs->done || !ours->done) return {"not measured"};
  double ratio = ours->cpu_s / theirs->cpu_s;
  if (among_cases)
    for (const BenchCase& other : all_cases(false))
      // a step, not a run
      if (other.id == goal.bench) ratio *= other.sample_times.back() / bench.sample_times.back();
  return judged(ratio <= goal.ratio, fmt::format("{:.2g} times", ratio));
}

Judged judged_by_price(const BenchCase& bench, const Goal& goal, const PeerRows& measured) {
  const PeerRow* ours = cheapest_of(measured, bench.id, kOurs, goal.error);
  if (ours == nullptr) return judged(false, "no row gets there");
  if (std::isfinite(goal.price_s))
    return judged(ours->cpu_s <= goal.price_s, report::price_of(ours->cpu_s));
  if (!std::isfinite(goal.ratio))
    return judged(true, fmt::format("{} for {}", told(ours->error), report::price_of(ours->cpu_s)));
  const PeerRow* theirs = cheapest_of(measured, bench.id, goal.peer, goal.error);
  if (theirs == nullptr) return judged(true, goal.peer + " does not get there");
  return judged(ours->cpu_s <= goal.ratio * theirs->cpu_s,
                fmt::format("{:.2g} times ({} against {})", ours->cpu_s / theirs->cpu_s,
                            report::price_of(ours->cpu_s), report::price_of(theirs->cpu_s)));
}

report::Table goals_table(const std::vector<BenchCase>& cases, const PeerRows& measured) {
  report::Table table;
  table.caption = "What the project set out to reach, and what these rows say";
  table.columns = {{"Scene"}, {"Goal"}, {"Found"}, {""}};
  for (const BenchCase& bench : cases)
    for (const Goal& goal : bench.goals) {
      const Judged found = std::isfinite(goal.step) ? judged_by_step(bench, goal, measured)
                                                    : judged_by_price(bench, goal, measured);
      const std::string verdict = found.look == Look::kGood  ? "holds"
                                  : found.look == Look::kBad ? "missed"
                                                             : "";
      table.rows.push_back({{unbroken(bench.id.substr(0, 2) + " " + bench.name), "#" + bench.id},
                            {goal.words},
                            {found.found},
                            {verdict, "", found.look}});
    }
  return table;
}

/// Where Tumble is not the cheapest, in one paragraph.
std::string losses(const std::vector<BenchCase>& cases, const PeerRows& measured) {
  std::string words;
  for (const BenchCase& bench : cases) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const double mark : kMarks) {
      const PeerRow *ours = cheapest_row(measured.rows, bench.id, kOurs, false, mark),
                    *theirs = cheapest_row(measured.rows, bench.id, kOurs, true, mark);
      if (theirs == nullptr || (ours != nullptr && ours->cpu_s <= theirs->cpu_s)) continue;
      const double factor =
          ours == nullptr ? std::numeric_limits<double>::infinity() : ours->cpu_s / theirs->cpu_s;
      least = std::min(least, factor), most = std::max(most, factor);
    }
    const std::string what = bench.id + " (" + bench.name;
    if (rows_of(measured, bench.id, kOurs).empty())
      words += fmt::format("{}{}: it does not finish)", words.empty() ? "" : ", ", what);
    else if (most > 0.0)
      words += fmt::format("{}{}: {} times the best peer's price)", words.empty() ? "" : ", ", what,
                           most > 1.05 * least ? fmt::format("{:.1f} to {:.1f}", least, most)
                                               : fmt::format("{:.1f}", most));
  }
  return words.empty() ? "Tumble is the cheapest at every error in every scene."
                       : "Where Tumble loses: " + words + ".";
}

/// Every engine's CPU time a simulated second at one step.
std::string prices_at(const BenchCase& bench, const PeerRows& measured, double step) {
  std::string words;
  const double duration = bench.sample_times.back();
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench.id && row.done && std::abs(row.step - step) < 1e-9)
      words += fmt::format("{}{}, {}: {}, {} {:.1e} m", words.empty() ? "" : "; ", row.engine,
                           row.method, report::price_of(row.cpu_s / duration), bench.error_name,
                           row.error);
  return fmt::format("CPU time a simulated second at 1/{:g} s: {}.", 1 / step, words);
}

std::string all_rows(const BenchCase& bench, const PeerRows& measured) {
  std::string text;
  for (const PeerRow& row : measured.rows)
    if (row.bench == bench.id)
      text += fmt::format(
          "{:8} {:36} {:16} {:>11}  {}\n", row.engine, row.method, fineness(row),
          row.done ? report::price_of(row.cpu_s) : "-",
          row.done ? fmt::format("error {:.2e}   {}", row.error, row.words) : row.words);
  return text;
}

void write(const std::filesystem::path& rows, const std::filesystem::path& file, bool quick) {
  const PeerRows measured = read_peer_rows(rows);
  std::vector<BenchCase> cases;
  for (BenchCase& bench : all_cases(quick))
    if (std::any_of(measured.rows.begin(), measured.rows.end(),
                    [&](const PeerRow& row) { return row.bench == bench.id; }))
      cases.push_back(std::move(bench));
  report::Page page("What accuracy costs: Tumble beside the engines people use today",
                    quick ? "Quick run: few steps, short scenes. Figures of a quick run prove "
                            "nothing but that it runs."
                          : "Scenes S1 to S8, error against CPU time");
  page.table(overview(cases, measured));
  page.paragraph(score(cases, measured));
  page.paragraph(losses(cases, measured));
  page.table(goals_table(cases, measured));
  page.heading("How it was measured");
  for (const char* rule : kRules) page.paragraph(rule);
  report::Table engines{"", {{"Engine"}, {"Version"}, {"Settings"}}, {}};
  for (const PeerWords& engine : measured.engines)
    engines.rows.push_back({{engine.name}, {engine.version}, {engine.settings}});
  page.table(engines);
  for (const BenchCase& bench : cases) {
    page.heading(bench.id + ": " + bench.title, 2, bench.id);
    page.paragraph(verdict(bench, measured));
    if (const std::string words = trouble(bench, measured); !words.empty())
      page.paragraph(words, Look::kMuted);
    if (bench.id == "S8" && !quick) page.paragraph(prices_at(bench, measured, 1.0 / 240));
    page.plot(plot_of(bench, measured));
    page.paragraph(bench.note, Look::kMuted);
    page.fold("Every row", all_rows(bench, measured));
  }
  page.record("tests/bench/peers/run.sh");
  page.write(file);
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: peers_page ROWS_DIR PAGE.html [--quick]\n");
    return 2;
  }
  tumble::peers::write(argv[1], argv[2], argc > 3 && std::string(argv[3]) == "--quick");
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::fprintf(stderr, "peers_page: %s\n", error.what());
  return 2;
}
