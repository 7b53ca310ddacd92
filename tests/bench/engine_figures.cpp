#include "tests/bench/engine_figures.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/report/engines_model.h"
#include "framework/report/html.h"
#include "framework/scene/sized_scenes.h"
#include "tests/bench/engine_measures.h"
#include "tests/bench/engine_profiles.h"
#include "tests/engines/late_row.h"

namespace tumble::testing {
namespace {

/// One goal, and the measured figure.
struct Figure {
  std::string what;
  double found;
  bool at_least;
  double goal;
  double w_h;  // of timewarp's run; NaN for a figure of several runs
  int n;
  std::string note = {};
};

/// Figures of the same runs, and their picture.
struct Chapter {
  std::string name;
  std::vector<Figure> figures;
  report::Plot plot;
  std::vector<report::StackedBars> bars = {};  // the parts of the time of its runs
};

report::Plot plot_of(const std::string& title, const std::string& x, const std::string& y,
                     const std::string& unit = "") {
  report::Plot plot;
  plot.title = title;
  plot.x = {x, "", report::Scale::kLog};
  plot.y = {y, unit, report::Scale::kLog};
  return plot;
}

void add_point(report::Curve& curve, double x, double y) {
  curve.x.push_back(x);
  curve.y.push_back(y);
}

/// Slope in a doubly logarithmic plot, from the first to the last point.
double slope_of(const report::Curve& curve) {
  return std::log(curve.y.back() / curve.y.front()) / std::log(curve.x.back() / curve.x.front());
}

// ---- The paper's scenes ------------------------------------------------------------------------

/// At the paper's sizes. Retroactive detection needs hours for seconds of the heaviest: all are
/// measured over the same part.
struct PaperScene {
  const char* name;
  int n;
  double duration;          // [s]
  double goal_rd, goal_ca;  // of times relative to timewarp's
  double heaped_at = 0.0;   // started there instead of at the scene's start [s]
};
constexpr PaperScene kPaper[] = {{"atoms", 300, 2.0, 20, 30},
                                 {"cars", 400, 2.0, 5, 5},
                                 {"robots", 20, 0.8, 3, 3},
                                 {"avalanche", 300, 0.7, 5, 5}};
// rocks lie on each other at the foot of the mountain
constexpr PaperScene kHeaped = {"avalanche", 300, 0.1, 1.5, 1.5, 3.0};
constexpr double kMostUndone = 0.15;

/// Three runs of one scene, and their figures.
struct Compared {
  Measured tw, rd, ca;
};

Compared compare(const PaperScene& paper) {
  scene::Scene scene = scene::make_sized_scene(paper.name, paper.n);
  if (paper.heaped_at > 0) scene = at_a_later_time(scene, paper.heaped_at);
  // By wall time, as the goals are; none of them has more than one thread, and CPU times are in the
  // notes.
  return {measure(scene, "tw", paper.duration, Clock::kWall),
          measure(scene, "rd_auto", paper.duration, Clock::kWall),
          measure(scene, "ca", paper.duration, Clock::kWall)};
}

void add_figures(const PaperScene& paper, const Compared& runs, Chapter& chapter) {
  const auto& [tw, rd, ca] = runs;
  const std::string scene = std::string(paper.name) + (paper.heaped_at > 0 ? ", heaped" : "");
  const double model = *report::modelled_integrations("rd", tw.bodies, tw.w_h(), 1.0) /
                       *report::modelled_integrations("tw", tw.bodies, tw.w_h(), 1.0);
  const std::string note = fmt::format(
      "{:g} s{}; by the model RD / TW is {:.2f} at this w h; RD {:.3g} s, CA {:.3g} s, TW {:.3g} s "
      "of CPU; integrations {:.2f}, {:.2f} of TW's; undone {:.1f} %. ",
      paper.duration, paper.heaped_at > 0 ? fmt::format(" from {:g} s on", paper.heaped_at) : "",
      model, rd.cpu, ca.cpu, tw.cpu, rd.count("integrations") / tw.count("integrations"),
      ca.count("integrations") / tw.count("integrations"), 100 * tw.undone());
  const double rd_over = rd.seconds / tw.seconds, ca_over = ca.seconds / tw.seconds;
  if (paper.goal_rd == paper.goal_ca) {
    chapter.figures.push_back({scene + ": the better of RD and CA / TW", std::min(rd_over, ca_over),
                               true, paper.goal_rd, tw.w_h(), tw.bodies,
                               note + why(tw, rd_over < ca_over ? rd : ca)});
  } else {
    chapter.figures.push_back({scene + ": RD-1/30 / TW", rd_over, true, paper.goal_rd, tw.w_h(),
                               tw.bodies, note + why(tw, rd)});
    chapter.figures.push_back({scene + ": CA / TW", ca_over, true, paper.goal_ca, tw.w_h(),
                               tw.bodies, note + why(tw, ca)});
  }
  chapter.bars.push_back(
      bars_of(scene + ": where the time went", {{"RD", &rd}, {"CA", &ca}, {"TW", &tw}},
              "All but pairs that may meet and scheduling is physics, done by the same "
              "functions for all engines."));
}

Chapter paper_scenes() {
  Chapter chapter{"The paper's scenes", {}, {}};
  chapter.plot.title = "Time over timewarp's: 1 atoms, 2 cars, 3 robots, 4 avalanche";
  chapter.plot.x = {"scene", "", report::Scale::kLinear};
  chapter.plot.y = {"time over timewarp's", "", report::Scale::kLog};
  chapter.plot.limits.push_back({1.0, "timewarp"});
  chapter.plot.curves = {{"RD, closed forms", {}, {}, true},
                         {"CA", {}, {}, true},
                         {"goal against RD", {}, {}, true},
                         {"goal against CA", {}, {}, true}};
  double place = 0.0, undone = 0.0, committed = 0.0;
  for (const PaperScene& paper : kPaper) {
    const Compared runs = compare(paper);
    const Measured& tw = runs.tw;
    place += 1.0;
    const double ratios[] = {runs.rd.seconds / tw.seconds, runs.ca.seconds / tw.seconds,
                             paper.goal_rd, paper.goal_ca};
    for (std::size_t k = 0; k < chapter.plot.curves.size(); ++k)
      add_point(chapter.plot.curves[k], place, ratios[k]);
    add_figures(paper, runs, chapter);
    chapter.figures.push_back({std::string(paper.name) + ": undone integrations of TW", tw.undone(),
                               false, kMostUndone, tw.w_h(), tw.bodies});
    undone += tw.count("undone_integrations") / 4;
    committed += (tw.count("integrations") - tw.count("undone_integrations")) / 4;
  }
  chapter.figures.push_back({"the four scenes: undone over committed, on average",
                             undone / committed, false, kMostUndone, std::nan(""), 0});
  return chapter;
}

// Rocks roll, rest and collide close together: scheduling matters less than the search for impacts.
Chapter heaped() {
  Chapter chapter{"The avalanche when it is heaped",
                  {},
                  plot_of("The heap: time over timewarp's", "rocks", "time over timewarp's")};
  const Compared runs = compare(kHeaped);
  chapter.plot.curves = {{"RD, closed forms", {}, {}, true}, {"CA", {}, {}, true}};
  chapter.plot.limits = {{kHeaped.goal_ca, "goal"}};
  add_point(chapter.plot.curves[0], runs.tw.bodies, runs.rd.seconds / runs.tw.seconds);
  add_point(chapter.plot.curves[1], runs.tw.bodies, runs.ca.seconds / runs.tw.seconds);
  add_figures(kHeaped, runs, chapter);
  return chapter;
}

// ---- Growth ------------------------------------------------------------------------------------

Chapter growth() {
  Chapter chapter{"Cost a body at constant density",
                  {},
                  plot_of("A gas: CPU time a body and simulated second", "balls", "time", "s")};
  chapter.plot.curves = {
      {"TW", {}, {}, true}, {"RD, closed forms", {}, {}, true}, {"CA", {}, {}, true}};
  std::vector<double> steps, checks, times;
  std::vector<Measured> all;
  double w_h = 0.0;
  for (const int n : {100, 1000, 10'000, 100'000}) {
    // the same duration for each: the first advances are part of it
    const Measured tw = measure("gas", n, "tw", 2.0);
    steps.push_back(tw.a_body_second(tw.count("integrations")));
    checks.push_back(tw.a_body_second(tw.count("pair_checks")));
    times.push_back(tw.a_body_second(tw.seconds));
    add_point(chapter.plot.curves[0], n, times.back());
    w_h = tw.w_h();
    all.push_back(tw);
  }
  std::vector<std::pair<std::string, const Measured*>> bars;
  for (const Measured& tw : all) bars.emplace_back(fmt::format("{} balls", tw.bodies), &tw);
  chapter.bars.push_back(bars_of("A gas by timewarp: where the time went", bars));
  report::Curve integrations[2];  // of RD and CA
  for (const auto& [n, duration] : {std::pair{100, 2.0}, {300, 2.0}, {1000, 0.5}})
    for (const auto& [curve, engine] : {std::pair{1, "rd_auto"}, {2, "ca"}}) {
      const Measured run = measure("gas", n, engine, duration);
      add_point(chapter.plot.curves[static_cast<std::size_t>(curve)], n,
                run.a_body_second(run.seconds));
      // a small gas hits its walls more often
      add_point(integrations[curve - 1], n,
                run.count("integrations") / run.count("discontinuities"));
    }
  const auto spread = [](const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end()) /
           *std::min_element(values.begin(), values.end());
  };
  chapter.figures.push_back({"gas of 10^2 to 10^5: most over least integrations a body",
                             spread(steps), false, 1.5, w_h, 100'000});
  chapter.figures.push_back({"gas of 10^2 to 10^5: most over least pair checks a body",
                             spread(checks), false, 1.5, w_h, 100'000});
  chapter.figures.push_back(
      {"gas of 10^2 to 10^5: most over least time a body", spread(times), false, 2.5, w_h, 100'000,
       fmt::format("{:.1f} to {:.1f} us. Of {}: {}. Of {}: {}",
                   1e6 * *std::min_element(times.begin(), times.end()),
                   1e6 * *std::max_element(times.begin(), times.end()), all[1].bodies,
                   a_collision_of(all[1]), all.back().bodies, a_collision_of(all.back()))});
  for (const auto& [curve, name] : {std::pair{1, "RD"}, {2, "CA"}})
    chapter.figures.push_back(
        {fmt::format("{}: integrations a discontinuity grow as n to the power", name),
         slope_of(integrations[curve - 1]), true, 0.8, w_h, 1000,
         fmt::format("of 100 to 1,000 balls; time a body to the power {:.2f}",
                     slope_of(chapter.plot.curves[static_cast<std::size_t>(curve)]))});
  return chapter;
}

// ---- Collisions a second -----------------------------------------------------------------------

Chapter collisions() {
  Chapter chapter{"Committed collisions of balls a second and core",
                  {},
                  plot_of("A gas by timewarp: collisions a second of CPU", "balls",
                          "collisions a second", "1/s")};
  chapter.plot.curves = {{"TW", {}, {}, true}};
  chapter.plot.limits = {{80'000, "first goal"}, {200'000, "aim"}};
  for (const auto& [n, duration] :
       {std::pair{300, 20.0}, {1000, 10.0}, {10'000, 2.0}, {100'000, 2.0}}) {
    const Measured tw = measure("gas", n, "tw", duration);
    const double rate = static_cast<double>(tw.tally.collisions) / tw.seconds;
    add_point(chapter.plot.curves[0], n, rate);
    chapter.figures.push_back(
        {fmt::format("gas of {}: collisions a second", n), rate, true, 80'000, tw.w_h(), n,
         fmt::format("{}; {}", rate >= 200'000 ? "reaches the aim of 200,000" : "aim: 200,000",
                     a_collision_of(tw))});
  }
  return chapter;
}

// ---- Few bodies --------------------------------------------------------------------------------

Chapter few_bodies() {
  Chapter chapter{
      "One body and two",
      {},
      plot_of("A gas of one and two: time over retroactive detection's", "balls", "TW / RD")};
  chapter.plot.curves = {{"TW / RD in closed form", {}, {}, true}};
  chapter.plot.limits = {{1.3, "goal"}};
  for (const int n : {1, 2}) {
    const Measured tw = measure("gas", n, "tw", 2000.0), rd = measure("gas", n, "rd_auto", 2000.0);
    add_point(chapter.plot.curves[0], n, tw.seconds / rd.seconds);
    chapter.figures.push_back(
        {fmt::format("gas of {}: TW / RD", n), tw.seconds / rd.seconds, false, 1.3, tw.w_h(), n});
  }
  return chapter;
}

// ---- A late event ------------------------------------------------------------------------------

/// CPU time of a row minus that of its set-up, the least of several runs. [s]
double seconds_of_row(int n) {
  double run = 1e9, building = 1e9, all = 0.0;
  for (int k = 0; k < 200 && (k < 5 || all < 0.5); ++k) {
    double began = cpu_seconds();
    taken_back_row(n, 1e-9);
    building = std::min(building, cpu_seconds() - began);
    began = cpu_seconds();
    taken_back_row(n);
    run = std::min(run, cpu_seconds() - began);
    all += run;
  }
  return run - building;
}

Chapter late_event() {
  Chapter chapter{"A late event at the first of a row",
                  {},
                  plot_of("A row of balls that is taken back: CPU time", "balls", "time", "s")};
  chapter.plot.curves = {{"TW", {}, {}, true}};
  for (const int n : {10, 32, 100, 316, 1000})
    add_point(chapter.plot.curves[0], n, seconds_of_row(n));
  const double power = slope_of(chapter.plot.curves[0]);
  const double nan = std::nan("");
  chapter.figures = {
      {"row of 10 to 1,000: CPU time grows as n to the power", power, false, 1.1, nan, 0},
      {"row of 10 to 1,000: the same, from below", power, true, 0.9, nan, 0}};
  return chapter;
}

// ---- Threads -----------------------------------------------------------------------------------

Chapter threads() {
  Chapter chapter{"Two threads, by the clock",
                  {},
                  plot_of("The best engine on one thread over timewarp on two, by the clock",
                          "movable bodies", "times quicker")};
  chapter.plot.curves = {{"atoms", {}, {}, true}, {"avalanche", {}, {}, true}};
  chapter.plot.limits = {{1.0, "one thread"}};
  struct Sized {
    const char* name;
    int n;
    double duration, goal;
    // of the duration: where retroactive detection would take minutes, the time of this part is
    // scaled to all of it
    double part_of_rd;
  };
  const std::vector<Sized> all = {{"atoms", 3000, 2.0, 1.5, 0.01},
                                  {"avalanche", 300, 0.7, 1.3, 1.0}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Sized& sized = all[k];
    const Measured one = measure(sized.name, sized.n, "tw", sized.duration, Clock::kWall),
                   two = measure(sized.name, sized.n, "tw2", sized.duration, Clock::kWall);
    const Measured ca = measure(sized.name, sized.n, "ca", sized.duration, Clock::kWall),
                   rd = measure(sized.name, sized.n, "rd_auto", sized.part_of_rd * sized.duration,
                                Clock::kWall);
    const double rd_seconds = rd.seconds / sized.part_of_rd,
                 best = std::min({one.seconds, ca.seconds, rd_seconds});
    const auto spent = [&](const char* stage) {
      return two.tally.stages.at(stage) - two.building.stages.at(stage);
    };
    add_point(chapter.plot.curves[k], two.bodies, best / two.seconds);
    const double path = spent("threads_together") + spent("thread_alone");
    chapter.figures.push_back(
        {fmt::format("{}: two threads", sized.name), best / two.seconds, true, sized.goal,
         two.w_h(), two.bodies,
         fmt::format(
             "one thread: TW {:.3g} s, CA {:.3g} s, RD {:.3g} s{}; CPU of one thread over the "
             "critical path of two, which a busy machine does not lengthen: {:.2f}; {}",
             one.seconds, ca.seconds, rd_seconds,
             sized.part_of_rd < 1 ? fmt::format(" (from {:g} of it)", sized.part_of_rd) : "",
             one.cpu / path, threads_of(two))});
    chapter.bars.push_back(bars_of(std::string(sized.name) + ": where the CPU time went",
                                   {{"TW, one thread", &one}, {"TW, two threads", &two}}));
  }
  return chapter;
}

// ---- All of it ---------------------------------------------------------------------------------

bool holds(const Figure& figure) {
  return figure.at_least ? figure.found >= figure.goal : figure.found <= figure.goal;
}

std::string goal_of(const Figure& figure) {
  return fmt::format("{} {:g}", figure.at_least ? "at least" : "at most", figure.goal);
}

std::string or_dash(double value) { return std::isnan(value) ? "-" : fmt::format("{:.3g}", value); }

void print(const Figure& figure) {
  std::printf("%-62s %10.4g %16s %8s %7s  %-6s %s\n", figure.what.c_str(), figure.found,
              goal_of(figure).c_str(), or_dash(figure.w_h).c_str(),
              figure.n > 0 ? or_dash(figure.n * figure.w_h).c_str() : "-",
              holds(figure) ? "holds" : "MISSED", figure.note.c_str());
  std::fflush(stdout);
}

}  // namespace

bool measure_figures(const std::filesystem::path& file, const std::string& only) {
  report::Page page("Timewarp's figures",
                    "each beside its goal, measured in one run, and where the time went");
  report::Table table;
  table.caption =
      "A figure that is missed is reported as it is; the last column says where timewarp's time "
      "goes. w h: discontinuities a body and largest step; where n w h is above 2, whoever stops "
      "all bodies at each discontinuity begins to pay for it.";
  table.columns = {{"Figure"},      {"Found", true}, {"Goal"}, {"w h", true},
                   {"n w h", true}, {"Verdict"},     {"How"}};
  std::printf("%-62s %10s %16s %8s %7s\n", "figure", "found", "goal", "w h", "n w h");
  std::vector<Chapter> chapters;
  bool all_hold = true;
  const auto begun = std::chrono::steady_clock::now();
  const std::pair<const char*, std::function<Chapter()>> work[] = {
      {"one body and two", few_bodies},
      {"collisions", collisions},
      {"growth", growth},
      {"late event", late_event},
      {"threads", threads},
      {"the paper's scenes", paper_scenes},
      {"the heap", heaped}};
  for (const auto& [name, chapter] : work) {
    if (!only.empty() && only != name) continue;
    std::fprintf(stderr, "[%4.0f s] %s\n",
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(),
                 name);
    chapters.push_back(chapter());
    for (const Figure& figure : chapters.back().figures) {
      print(figure);
      all_hold = all_hold && holds(figure);
      table.rows.push_back({{figure.what},
                            {fmt::format("{:.4g}", figure.found)},
                            {goal_of(figure)},
                            {or_dash(figure.w_h)},
                            {figure.n > 0 ? or_dash(figure.n * figure.w_h) : "-"},
                            {holds(figure) ? "holds" : "missed", "",
                             holds(figure) ? report::Look::kGood : report::Look::kBad},
                            {figure.note, "", report::Look::kMuted}});
    }
  }
  page.table(table);
  for (const Chapter& chapter : chapters) {
    page.heading(chapter.name);
    page.plot(chapter.plot);
    for (const report::StackedBars& bars : chapter.bars)
      if (!bars.rows.empty()) page.plot(bars);
  }
  page.record("bench_engines");
  page.write(file);
  std::printf("%s\n", file.c_str());
  return all_hold;
}

}  // namespace tumble::testing
