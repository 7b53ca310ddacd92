#include "framework/cli/engine_rows.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/events/trace.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/run.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/judging/time_parts.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/trajectory/fault_words.h"

namespace tumble::cli {
namespace {

using report::EngineRow;

constexpr int kShortRuns = 4;
constexpr double kShort = 0.5;              // [s] of CPU: longer runs are timed once
constexpr double kNoFrames = 1e-6;          // [1/s], for timed runs
constexpr std::size_t kFewestSamples = 25;  // a fraction is then known to 10 %
constexpr double kNoTime = 1e-9;            // steps: a run that ends before anything moves

std::string meaning_of(const std::string& engine) {
  for (const auto& [word, meaning] : engines::engine_words())
    if (word == engine) return meaning;
  std::vector<std::string> words;
  for (const auto& [word, meaning] : engines::engine_words()) words.push_back(word);
  throw UserError("--engines " + engine, "there is no engine of that name",
                  fmt::format("Known: {}.", fmt::join(words, ", ")));
}

// Agreement before chaos: largest difference in time of the first collisions of each body.
constexpr std::size_t kFirstCollisions = 5;
constexpr double kSamePlace = 1e-3;  // [m]: far above rounding, far below what is visible
constexpr double kSameTime = 1e-9;   // [s], of frames

using Pairs = std::set<std::pair<int, int>>;

/// Pairs in persistent contact: engines record the impacts within such a contact differently.
Pairs in_contact(const Trajectory& run) {
  Pairs pairs;
  for (const Event& event : run.events)
    if (event.kind == EventKind::kContact) pairs.emplace(event.body_a, event.body_b);
  return pairs;
}

std::vector<std::vector<double>> first_collisions(const Trajectory& run, const Pairs& left_out,
                                                  double until) {
  std::vector<std::vector<double>> times(run.bodies.size());
  for (const Event& event : run.events) {
    if (event.kind != EventKind::kCollision || event.time > until ||
        left_out.contains({event.body_a, event.body_b}))
      continue;
    for (const int body : {event.body_a, event.body_b})
      if (body >= 0 && !run.bodies[static_cast<std::size_t>(body)].immovable &&
          times[static_cast<std::size_t>(body)].size() < kFirstCollisions)
        times[static_cast<std::size_t>(body)].push_back(event.time);
  }
  return times;
}

/// The time until which every body's centre agrees with the other run [s], at common frames;
/// nothing: to the end.
std::optional<double> parted_at(const Trajectory& reference, const Trajectory& run) {
  std::size_t k = 0;
  for (const Frame& frame : run.frames) {
    while (k < reference.frames.size() && reference.frames[k].time < frame.time - kSameTime) ++k;
    if (k == reference.frames.size()) break;
    if (reference.frames[k].time > frame.time + kSameTime) continue;
    for (std::size_t body = 0; body < frame.poses.size(); ++body)
      if (!((frame.poses[body].com_world - reference.frames[k].poses[body].com_world).norm() <=
            kSamePlace))
        return frame.time;
  }
  return std::nullopt;
}

std::string agreement_of(const Trajectory& reference, const Trajectory& run) {
  if (!engines::compare_traces(reference, run)) return "same trace, bit for bit";
  const auto parted = parted_at(reference, run);
  Pairs left_out = in_contact(reference);
  left_out.merge(in_contact(run));
  const double until = parted.value_or(std::numeric_limits<double>::infinity());
  const auto expected = first_collisions(reference, left_out, until),
             found = first_collisions(run, left_out, until);
  double farthest = 0.0;
  std::size_t compared = 0, missing = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t both = std::min(expected[i].size(), found[i].size());
    for (std::size_t k = 0; k < both; ++k, ++compared)
      farthest = std::max(farthest, std::abs(expected[i][k] - found[i][k]));
    missing += std::max(expected[i].size(), found[i].size()) - both;
  }
  const std::string places = parted ? fmt::format("positions within 1 mm until {:.2f} s", *parted)
                                    : "positions within 1 mm to the end";
  // one of the two resolves impacts within steps, and records none
  if (compared == 0) return places;
  return fmt::format("{}; first {} collisions of each body within {} s ({} compared{})", places,
                     kFirstCollisions, few_digits(farthest), compared,
                     missing > 0 ? fmt::format(", {} in one only", missing) : "");
}

/// Energy and duration of the shown run. Counts and time are those of the run without pictures.
void keep(EngineRow& row, const Trajectory& run) {
  row.stopped_by = run.stopped_by;
  row.faults = in_words(run.counters.faults);
  row.step_s = run.info.step_s;
  row.simulated_s = run.frames.empty() ? 0.0 : run.frames.back().time;
  row.w_h = engines::discontinuities_a_body_and_step(run);
  for (const Frame& frame : run.frames) {
    const Frame& first = run.frames.front();
    const double scale = first.kinetic_energy + std::abs(first.potential_energy);
    row.frame_times.push_back(frame.time);
    row.energy_error.push_back(std::abs(frame.kinetic_energy + frame.potential_energy -
                                        first.kinetic_energy - first.potential_energy) /
                               (scale > 0 ? scale : 1.0));
  }
}

/// Stops a run at its CPU limit, at a call of a law: of a step, or of an impact.
class Deadline {
 public:
  explicit Deadline(double most_s) : most_s_(most_s), until_(cpu_seconds() + most_s) {}
  bool is_over() const { return is_over_; }
  void look() {
    // per thread: a shared counter would move between the threads' caches
    thread_local std::uint64_t looks = 0;
    if (++looks % kLooksAClock != 0 || !(cpu_seconds() > until_)) return;
    is_over_ = true;
    throw engines::OutOfTime(fmt::format("it takes more than {:.0f} s", most_s_));
  }
  Laws watched(const Laws& laws) {
    Laws watched = laws;
    if (!std::isfinite(most_s_)) return watched;
    if (laws.integrate_step)
      watched.integrate_step = [this, inner = laws.integrate_step](const OdeFunction& f, double t,
                                                                   const VectorXd& y, double h) {
        look();
        return inner(f, t, y, h);
      };
    if (laws.relative_normal_velocity)
      watched.relative_normal_velocity = [this, inner = laws.relative_normal_velocity](
                                             const Contact& contact, const Body& a, const Body& b) {
        look();
        return inner(contact, a, b);
      };
    return watched;
  }

 private:
  static constexpr std::uint64_t kLooksAClock = 64;
  double most_s_, until_;  // [s] of CPU
  std::atomic<bool> is_over_ = false;
};

/// CPU time, or wall time, of a run without pictures [s]. Set-up before the first step (models,
/// shapes, overlaps) is the same for all engines and is not part of their cost. The fastest of
/// several short runs counts.
/// @param counts  its counters
/// @param shares  fractions of its time
/// @return nothing where it takes more than most_s
std::optional<double> seconds_of_run(const scene::Scene& scene, const Laws& laws,
                                     engines::RunOptions options, bool by_the_clock, double most_s,
                                     std::map<std::string, std::uint64_t>& counts,
                                     engines::TimeShares& shares) {
  options.frame_rate_hz = kNoFrames;
  engines::RunOptions nothing = options;
  nothing.duration_s = kNoTime * scene.step_s;
  bool is_over = false;
  const auto seconds_of = [&](const engines::RunOptions& how) {
    TrajectoryRecorder recorder;
    Deadline deadline(most_s);
    const Laws watched = deadline.watched(laws);
    const auto clock = std::chrono::steady_clock::now();
    const double begin = thread_seconds();  // several threads are timed by wall time
    engines::run_scene(scene, watched, how, recorder);
    is_over = is_over || deadline.is_over();
    const double seconds =
        by_the_clock
            ? std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count()
            : thread_seconds() - begin;
    counts = recorder.trajectory().counters.counts;
    return seconds;
  };
  StackSamples samples;
  // While samples are taken, the system's clock of CPU time has a resolution of milliseconds: short
  // runs are timed without samples.
  double building = seconds_of(nothing);
  samples.begin();
  double whole = seconds_of(options);
  for (int k = 1; k < kShortRuns && whole < kShort; ++k) seconds_of(options);
  samples.end();
  if (whole < kShort) {
    whole = seconds_of(options);
    for (int k = 1; k < kShortRuns; ++k) {
      building = std::min(building, seconds_of(nothing));
      whole = std::min(whole, seconds_of(options));
    }
  }
  shares = engines::time_shares(samples);
  if (is_over) return std::nullopt;
  return std::max(1e-6, whole - building);
}

}  // namespace

std::vector<EngineChoice> engines_named(const std::string& words) {
  std::vector<EngineChoice> choices(1);
  for (const char c : words) {
    if (c == ',')
      choices.emplace_back();
    else
      choices.back().engine += c;
  }
  for (const EngineChoice& choice : choices) meaning_of(choice.engine);  // refused before any run
  return choices;
}

EngineRun measure_engine(const Context& context, const scene::Scene& scene,
                         const ChosenLaws& chosen, const EngineChoice& choice) {
  engines::RunOptions options;
  options.engine = choice.engine;
  if (choice.engine == "rd") options.propagator = choice.propagator;
  options.threads = choice.engine == "tw" ? choice.threads : 1;
  VirtualTimes times;
  options.timewarp = engines::fast_timewarp();
  options.step_s = choice.step_s;
  options.duration_s = choice.duration_s;
  options.command = context.command_line;
  options.instants_s = engines::instants_of_checks(scene);
  // The row of the table.
  EngineRun measured;
  EngineRow& row = measured.row;
  row.engine = choice.engine;
  row.meaning = meaning_of(choice.engine);
  // the others have closed forms
  if (choice.engine == "rd")
    row.meaning += choice.propagator == "auto" ? ", in closed form" : ", by the laws' integrator";
  row.label = choice.label.empty() ? choice.engine : choice.label;
  for (const scene::BodySpec& body : scene.bodies) row.bodies += body.immovable ? 0 : 1;
  // One run for the time, one for the frames.
  engines::TimeShares shares;
  try {
    const auto seconds = choice.is_timed
                             ? seconds_of_run(scene, chosen.laws, options, choice.by_the_clock,
                                              choice.most_s, row.counts, shares)
                             : std::optional(kUnset);
    if (!seconds) {
      row.counts.clear();
      row.stopped_by = fmt::format("left out: it takes more than {:.0f} s", choice.most_s);
      return measured;
    }
    row.cpu_s = *seconds;
    if (shares.samples >= kFewestSamples) {
      row.time_parts = shares.parts;
      row.physics = shares.physics;
    }
    TrajectoryRecorder recorder;
    options.frame_rate_hz = choice.frame_rate_hz;
    options.timewarp = engines::fast_timewarp(&times);
    Deadline deadline(choice.is_timed ? std::numeric_limits<double>::infinity() : choice.most_s);
    engines::run_scene(scene, deadline.watched(chosen.laws), options, recorder);
    measured.run = recorder.trajectory();
  } catch (const UserError& error) {
    row.stopped_by = error.what();
    row.counts.clear();
    return measured;
  }
  if (measured.run.virtual_times.moves.empty()) measured.run.virtual_times = std::move(times);
  keep(row, measured.run);
  return measured;
}

void tell_agreement(std::vector<EngineRun>& runs) {
  std::size_t reference = 0;  // an event-driven run, if there is one
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (runs[k].row.engine != "rd" && runs[k].row.stopped_by.empty()) reference = k;
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (!runs[k].row.counts.empty())
      runs[k].row.agreement = k == reference ? "the others are compared with this one"
                                             : agreement_of(runs[reference].run, runs[k].run);
}

std::vector<EngineRow> rows_of(const std::vector<EngineRun>& runs) {
  std::vector<EngineRow> rows;
  for (const EngineRun& run : runs) rows.push_back(run.row);
  return rows;
}

void print_rows(const std::vector<EngineRow>& rows) {
  double quickest = 1e300;
  for (const EngineRow& row : rows)
    if (row.stopped_by.empty()) quickest = std::min(quickest, row.cpu_s);
  fmt::print("{:<8}", "engine");
  for (const auto& [name, heading] : report::compared_counts()) fmt::print(" {:>15}", heading);
  fmt::print(" {:>8} {:>9} {:>13} {:>8}  {}\n", "w h", "w [1/s]", "mean step[ms]", "time",
             "agreement");
  for (const EngineRow& row : rows) {
    fmt::print("{:<8}", row.label);
    if (row.counts.empty()) {
      fmt::print(" not run: {}\n", row.stopped_by);
      continue;
    }
    for (const auto& [name, heading] : report::compared_counts())
      fmt::print(" {:>15}", report::count_of(row, name));
    fmt::print(" {:>8.3g} {:>9.3g} {:>13.3g} {:>7.2f}x  {}\n", row.w_h, row.w_h / row.step_s,
               1e3 * report::mean_step_s(row), row.cpu_s / quickest,
               row.stopped_by.empty() ? row.agreement : "STOPPED " + row.stopped_by);
    if (!row.faults.empty()) fmt::print("{:<8} NOT TO BE TRUSTED: {}\n", "", row.faults);
  }
}

}  // namespace tumble::cli
